#include "imbibe/fabric/weave.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "imbibe/core/error.h"

namespace imbibe {
namespace {

constexpr const char* forms =
    "plain, twill 2/1 [left|right], satin 5/2, sateen 5/2, basket 2/2, rows of 0 and 1 like \"1100 0110 0011 1001\", "
    "or a .wif file";

WeaveDraft empty_draft(int picks, int ends) {
  if (picks < 1 || ends < 1) throw InputError("the weave is empty: it needs at least one pick and one end");
  if (picks > largest_weave_repeat || ends > largest_weave_repeat ||
      static_cast<std::size_t>(picks) * static_cast<std::size_t>(ends) > largest_weave)
    throw InputError(fmt::format("the weave repeat of {} picks x {} ends is larger than {} x {} or {} crossings", picks,
                                 ends, largest_weave_repeat, largest_weave_repeat, largest_weave));
  WeaveDraft draft{.picks = picks, .ends = ends, .warp_up = {}};
  draft.warp_up.assign(static_cast<std::size_t>(picks) * static_cast<std::size_t>(ends), 0);
  return draft;
}

template <class IsUp>
WeaveDraft filled(int picks, int ends, IsUp&& is_up) {
  WeaveDraft draft = empty_draft(picks, ends);
  for (int p = 0; p < picks; ++p)
    for (int e = 0; e < ends; ++e)
      draft.warp_up[static_cast<std::size_t>(p) * static_cast<std::size_t>(ends) + static_cast<std::size_t>(e)] =
          is_up(p, e) ? 1 : 0;
  return draft;
}

void check_satin(const char* name, int ends, int step) {
  if (ends < 5 || ends > largest_weave_repeat)
    throw InputError(fmt::format("{} {}/{}: the repeat must have 5 to {} ends", name, ends, step, largest_weave_repeat));
  std::string legal;
  for (int s = 2; s < ends - 1 && legal.size() < 60; ++s)
    if (std::gcd(s, ends) == 1) legal += fmt::format("{}{}", legal.empty() ? "" : ", ", s);
  if (step <= 1 || step >= ends - 1 || std::gcd(step, ends) != 1)
    throw InputError(fmt::format(
        "{} {}/{}: step {} is illegal: it must lie between 1 and {} and share no divisor with {} (legal: {})", name,
        ends, step, step, ends - 1, ends, legal.empty() ? "none, a regular satin of this repeat does not exist" : legal));
}

// Runs of `lengths` crossings, alternately up and down, shifted by one end from pick to pick.
WeaveDraft twill_of_runs(const std::vector<int>& lengths, TwillDirection direction) {
  std::vector<bool> line;
  bool up = true;
  for (int length : lengths) {
    if (length < 1) throw InputError(fmt::format("twill: a float of {} crossings; each number must be 1 or more", length));
    if (length > largest_weave_repeat) throw InputError(fmt::format("twill: a float of {} crossings is too long", length));
    line.insert(line.end(), static_cast<std::size_t>(length), up);
    up = !up;
  }
  const int n = static_cast<int>(line.size());
  return filled(n, n, [&](int p, int e) {
    const int k = direction == TwillDirection::right ? e - p : e + p;
    return static_cast<bool>(line[static_cast<std::size_t>(((k % n) + n) % n)]);
  });
}

struct Words {
  std::vector<std::string> words;
  std::vector<int> numbers;
};

// Letters make words, digits numbers; blanks, '/', ',', ':' and 'x' between digits separate.
Words split_words(std::string_view text) {
  Words out;
  std::size_t i = 0;
  while (i < text.size()) {
    const unsigned char c = static_cast<unsigned char>(text[i]);
    std::size_t j = i;
    if (std::isdigit(c)) {
      while (j < text.size() && std::isdigit(static_cast<unsigned char>(text[j]))) ++j;
      int value = 0;
      const auto [end, code] = std::from_chars(text.data() + i, text.data() + j, value);
      if (code != std::errc{} || end != text.data() + j)
        throw InputError(fmt::format("weave '{}': '{}' is too large a number", text, text.substr(i, j - i)));
      out.numbers.push_back(value);
      i = j;
    } else if (std::isalpha(c)) {
      std::string word;
      for (; j < text.size() && std::isalpha(static_cast<unsigned char>(text[j])); ++j)
        word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[j])));
      if (word != "x") out.words.push_back(word);
      i = j;
    } else if (std::isspace(c) || c == '/' || c == ',' || c == ':') {
      ++i;
    } else {
      throw InputError(fmt::format("weave '{}': unexpected '{}'; known forms: {}", text, text[i], forms));
    }
  }
  return out;
}

bool is_rows_text(std::string_view text) {
  bool digit = false;
  for (char c : text) {
    if (c == '0' || c == '1') digit = true;
    else if (!std::isspace(static_cast<unsigned char>(c)) && c != '/' && c != ',') return false;
  }
  return digit;
}

std::vector<std::string> split_rows(std::string_view text) {
  std::vector<std::string> rows(1);
  for (char c : text) {
    if (c == '0' || c == '1') rows.back() += c;
    else if (!rows.back().empty()) rows.emplace_back();
  }
  if (rows.back().empty()) rows.pop_back();
  return rows;
}

WeaveDraft named_weave(const std::string& name, const std::vector<int>& n, TwillDirection direction) {
  auto wants = [&](std::size_t least, std::size_t most, const char* form) {
    if (n.size() < least || n.size() > most)
      throw InputError(fmt::format("{} has {} number{}; write it as {}", name, n.size(), n.size() == 1 ? "" : "s", form));
  };
  if (name == "plain" || name == "tabby") {
    wants(0, 0, "plain");
    return plain_weave();
  }
  if (name == "twill") {
    if (n.empty() || n.size() % 2 != 0)
      throw InputError(fmt::format("twill needs pairs of numbers up/down, such as twill 2/1; {} given", n.size()));
    return twill_of_runs(n, direction);
  }
  if (name == "satin" || name == "sateen") {
    wants(2, 2, "satin 5/2 (ends/step)");
    return name == "satin" ? satin_weave(n[0], n[1]) : sateen_weave(n[0], n[1]);
  }
  wants(1, 2, "basket 2/2 (ends/picks)");
  return basket_weave(n[0], n.back());
}

}  // namespace

WeaveDraft plain_weave() {
  return filled(2, 2, [](int p, int e) { return (p + e) % 2 == 0; });
}

WeaveDraft twill_weave(int up, int down, TwillDirection direction) { return twill_of_runs({up, down}, direction); }

WeaveDraft satin_weave(int ends, int step) {
  check_satin("satin", ends, step);
  return filled(ends, ends, [&](int p, int e) { return e != (p * step) % ends; });
}

WeaveDraft sateen_weave(int ends, int step) {
  check_satin("sateen", ends, step);
  return filled(ends, ends, [&](int p, int e) { return e == (p * step) % ends; });
}

WeaveDraft basket_weave(int ends, int picks) {
  if (ends < 1 || picks < 1) throw InputError(fmt::format("basket {}/{}: both numbers must be 1 or more", ends, picks));
  if (ends > largest_weave_repeat / 2 || picks > largest_weave_repeat / 2)
    throw InputError(fmt::format("basket {}/{}: the groups are too large", ends, picks));
  return filled(2 * picks, 2 * ends, [&](int p, int e) { return (p / picks + e / ends) % 2 == 0; });
}

WeaveDraft weave_from_rows(const std::vector<std::string>& rows) {
  if (rows.empty() || std::all_of(rows.begin(), rows.end(), [](const std::string& r) { return r.empty(); }))
    throw InputError("the weave is empty: give rows of 0 and 1, one per pick");
  std::vector<Problem> problems;
  const std::size_t ends = rows.front().size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (char c : rows[i])
      if (c != '0' && c != '1') {
        problems.push_back(
            Problem{"", 0, 0, "", fmt::format("row {} of the weave, \"{}\": '{}' is neither 0 nor 1", i + 1, rows[i], c)});
        break;
      }
    if (rows[i].size() != ends)
      problems.push_back(Problem{"", 0, 0, "", fmt::format("the weave is ragged: row {} has {} ends, row 1 has {}",
                                                             i + 1, rows[i].size(), ends)});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  if (rows.size() > largest_weave_repeat || ends > largest_weave_repeat)
    throw InputError(fmt::format("the weave repeat of {} picks x {} ends is larger than {} x {}", rows.size(), ends,
                                 largest_weave_repeat, largest_weave_repeat));
  return filled(static_cast<int>(rows.size()), static_cast<int>(ends), [&](int p, int e) {
    return rows[static_cast<std::size_t>(p)][static_cast<std::size_t>(e)] == '1';
  });
}

WeaveDraft parse_weave(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); }))
    throw InputError(fmt::format("the weave is empty; known forms: {}", forms));
  if (is_rows_text(text)) return weave_from_rows(split_rows(text));
  const Words read = split_words(text);
  static const std::vector<std::string> names{"plain", "tabby", "twill", "satin", "sateen", "basket"};
  std::string name;
  TwillDirection direction = TwillDirection::right;
  bool directed = false;
  for (const std::string& word : read.words) {
    if (word == "left" || word == "right") {
      direction = word == "left" ? TwillDirection::left : TwillDirection::right;
      directed = true;
    } else if (word == "weave") {
      continue;
    } else if (name.empty() && std::find(names.begin(), names.end(), word) != names.end()) {
      name = word;
    } else {
      const std::string near = nearest_word(word, {"plain", "twill", "satin", "sateen", "basket", "left", "right"});
      throw InputError(fmt::format("weave '{}': '{}' is not known{}; known forms: {}", text, word,
                                   near.empty() ? "" : "; did you mean '" + near + "'?", forms));
    }
  }
  if (name.empty()) throw InputError(fmt::format("weave '{}' names no weave; known forms: {}", text, forms));
  if (directed && name != "twill") throw InputError(fmt::format("weave '{}': only a twill has a direction", text));
  return named_weave(name, read.numbers, direction);
}

std::vector<std::string> weave_rows(const WeaveDraft& draft) {
  std::vector<std::string> rows(static_cast<std::size_t>(draft.picks));
  for (std::size_t p = 0; p < rows.size(); ++p)
    for (int e = 0; e < draft.ends; ++e) rows[p] += draft.warp_on_face(p, static_cast<std::size_t>(e)) ? '1' : '0';
  return rows;
}

namespace {

struct LineFacts {
  int changes = 0;
  int longest = 0;  // 0 when the side never changes
};

// Facts of one closed line of the repeat.
template <class IsUp>
LineFacts line_facts(int count, IsUp&& is_up) {
  LineFacts facts;
  int start = -1;
  for (int k = 0; k < count; ++k)
    if (is_up(k) != is_up((k + count - 1) % count)) {
      ++facts.changes;
      if (start < 0) start = k;
    }
  if (facts.changes == 0) return facts;
  int run = 0;
  for (int k = 0; k < count; ++k) {
    const int here = (start + k) % count;
    run = (k > 0 && is_up(here) == is_up((here + count - 1) % count)) ? run + 1 : 1;
    facts.longest = std::max(facts.longest, run);
  }
  return facts;
}

}  // namespace

WeaveFacts weave_facts(const WeaveDraft& draft) {
  WeaveFacts facts;
  const auto up = [&](int p, int e) { return draft.warp_on_face(static_cast<std::size_t>(p), static_cast<std::size_t>(e)); };
  const Real crossings = static_cast<Real>(draft.picks) * draft.ends;
  facts.warp_face_share = static_cast<Real>(std::count(draft.warp_up.begin(), draft.warp_up.end(), 1)) / crossings;
  for (int e = 0; e < draft.ends; ++e) {
    const LineFacts line = line_facts(draft.picks, [&](int p) { return up(p, e); });
    facts.warp_interlacing += line.changes / crossings;
    facts.longest_warp_float = std::max(facts.longest_warp_float, line.longest);
    if (line.changes == 0) facts.loose_ends.push_back(e);
  }
  for (int p = 0; p < draft.picks; ++p) {
    const LineFacts line = line_facts(draft.ends, [&](int e) { return up(p, e); });
    facts.weft_interlacing += line.changes / crossings;
    facts.longest_weft_float = std::max(facts.longest_weft_float, line.longest);
    if (line.changes == 0) facts.loose_picks.push_back(p);
  }
  return facts;
}

}  // namespace imbibe
