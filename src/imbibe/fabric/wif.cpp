#include "imbibe/fabric/wif.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <sstream>

#include "imbibe/core/error.h"

namespace imbibe {
namespace {

constexpr Real inch = 0.0254;

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

// The value of a number or boolean without a comment behind it.
std::string_view without_comment(std::string_view value) {
  const std::size_t at = value.find(';');
  return trimmed(at == std::string_view::npos ? value : value.substr(0, at));
}

struct Entry {
  std::string key;    // lower case
  std::string value;  // trimmed
  int line = 0;
};

struct Section {
  std::string name;  // as written
  int line = 0;
  std::vector<Entry> entries;
};

// A row of a numbered section: thread, pick, treadle or palette entry, with whole numbers behind it.
struct Row {
  int number = 0;
  std::vector<int> values;
  int line = 0;
};

class Reader {
 public:
  Reader(std::string_view text, std::string file) : file_(std::move(file)) { split(text); }

  const Section* find(const char* name) const {
    const auto it = sections_.find(name);
    return it == sections_.end() ? nullptr : &it->second;
  }

  void problem(int line, const Section* section, const std::string& key, std::string message) {
    if (++count_ > 100) return;  // a wrong file can be wrong on every line
    std::string place = section == nullptr ? std::string() : "[" + section->name + "]";
    if (!key.empty()) place += (place.empty() ? "" : " ") + key;
    problems_.push_back(Problem{file_, line, line > 0 ? 1 : 0, place, std::move(message)});
  }

  void finish() {
    if (count_ > 100)
      problems_.push_back(Problem{file_, 0, 0, "", fmt::format("{} more problems are not shown", count_ - 100)});
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }

  const Entry* entry(const Section* section, const char* key) const {
    if (section == nullptr) return nullptr;
    for (const Entry& e : section->entries)
      if (e.key == key) return &e;
    return nullptr;
  }

  std::optional<bool> boolean(const Section* section, const Entry& e) {
    const std::string word = lower(without_comment(e.value));
    if (word == "true" || word == "on" || word == "yes" || word == "1") return true;
    if (word == "false" || word == "off" || word == "no" || word == "0") return false;
    problem(e.line, section, e.key, fmt::format("'{}' is not a boolean: true, on, yes, 1, false, off, no or 0", e.value));
    return std::nullopt;
  }

  std::optional<int> whole(const Section* section, const Entry& e, std::string_view text, int least, int most) {
    text = trimmed(text);
    int value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || (code != std::errc{} && code != std::errc::result_out_of_range) ||
        end != text.data() + text.size()) {
      problem(e.line, section, e.key, fmt::format("'{}' is not a whole number", text));
      return std::nullopt;
    }
    if (code == std::errc::result_out_of_range || value < least || value > most) {
      problem(e.line, section, e.key, fmt::format("{} is outside [{}, {}]", text, least, most));
      return std::nullopt;
    }
    return value;
  }

  std::optional<Real> number(const Section* section, const Entry& e) {
    const std::string_view text = without_comment(e.value);
    Real value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value < 0) {
      problem(e.line, section, e.key, fmt::format("'{}' is not a number of 0 or more", e.value));
      return std::nullopt;
    }
    return value;
  }

  // Whole number under `key`, or `otherwise` where it is missing.
  int whole_or(const Section* section, const char* key, int otherwise, int least, int most) {
    const Entry* e = entry(section, key);
    if (e == nullptr) return otherwise;
    return whole(section, *e, without_comment(e->value), least, most).value_or(otherwise);
  }

  // All rows `n = a, b, ...` of a section with n in [1, last] and values in [least, most]; a second row for the same n
  // is a problem.
  std::vector<Row> rows(const Section* section, int last, const char* what, int least, int most, std::size_t fewest = 1,
                        std::size_t largest = static_cast<std::size_t>(largest_wif_shafts)) {
    std::vector<Row> out;
    if (section == nullptr) return out;
    std::map<int, int> seen;
    for (const Entry& e : section->entries) {
      const std::optional<int> n = row_number(section, e, last, what, seen);
      if (!n) continue;
      Row row{*n, {}, e.line};
      std::string_view rest = without_comment(e.value);
      bool good = true;
      if (rest.empty() && fewest <= 1) {
        out.push_back(std::move(row));
        continue;
      }
      while (true) {
        const std::size_t comma = rest.find(',');
        const std::optional<int> value = whole(section, e, rest.substr(0, comma), least, most);
        good = good && value.has_value();
        if (value) row.values.push_back(*value);
        if (comma == std::string_view::npos || row.values.size() > largest) break;
        rest.remove_prefix(comma + 1);
      }
      if (good && (row.values.size() < fewest || row.values.size() > largest)) {
        problem(e.line, section, e.key, fewest == largest ? fmt::format("needs {} numbers, has {}", fewest, row.values.size())
                                                          : fmt::format("has too many numbers ({})", row.values.size()));
        good = false;
      }
      if (good) out.push_back(std::move(row));
    }
    return out;
  }

  std::optional<int> row_number(const Section* section, const Entry& e, int last, const char* what,
                                std::map<int, int>& seen) {
    int n = 0;
    const auto [end, code] = std::from_chars(e.key.data(), e.key.data() + e.key.size(), n);
    if (code != std::errc{} || end != e.key.data() + e.key.size()) {
      problem(e.line, section, e.key, fmt::format("is not the number of a {}", what));
      return std::nullopt;
    }
    if (n < 1 || n > last) {
      problem(e.line, section, e.key, last < 1 ? fmt::format("there is no {}", what)
                                               : fmt::format("there is no {} {}: they run from 1 to {}", what, n, last));
      return std::nullopt;
    }
    const auto [it, fresh] = seen.emplace(n, e.line);
    if (!fresh) {
      problem(e.line, section, e.key, fmt::format("{} {} was given before, on line {}", what, n, it->second));
      return std::nullopt;
    }
    return n;
  }

 private:
  void split(std::string_view text) {
    if (text.size() >= 3 && text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    Section* open = nullptr;
    int line = 0;
    while (!text.empty()) {
      const std::size_t at = text.find_first_of("\r\n");
      std::string_view raw = trimmed(text.substr(0, at));
      if (at == std::string_view::npos) text = {};
      else text.remove_prefix(at + (text.substr(at, 2) == "\r\n" ? 2 : 1));
      ++line;
      if (raw.empty() || raw.front() == ';') continue;
      if (raw.front() == '[') open = open_section(raw, line);
      else if (open != nullptr) read_entry(raw, line, *open);
      else if (!skipping_) problem(line, nullptr, "", fmt::format("'{}' stands before the first [section]", shortened(raw)));
    }
  }

  Section* open_section(std::string_view raw, int line) {
    skipping_ = false;
    const std::size_t close = raw.find(']');
    const std::string_view name = close == std::string_view::npos ? raw.substr(1) : trimmed(raw.substr(1, close - 1));
    if (close == std::string_view::npos || name.empty()) {
      problem(line, nullptr, "", fmt::format("'{}' is not a [section]", shortened(raw)));
      skipping_ = true;
      return nullptr;
    }
    const auto [it, fresh] = sections_.emplace(lower(name), Section{std::string(name), line, {}});
    if (!fresh) {
      problem(line, &it->second, "", fmt::format("the section was given before, on line {}", it->second.line));
      skipping_ = true;
      return nullptr;
    }
    // Free text and other programs' own sections need not be key=value.
    it->second.entries.reserve(8);
    return &it->second;
  }

  void read_entry(std::string_view raw, int line, Section& section) {
    const std::string name = lower(section.name);
    const bool free_text = name == "notes" || name == "text" || name.substr(0, 7) == "private";
    const std::size_t equals = raw.find('=');
    if (equals == std::string_view::npos || equals == 0) {
      if (!free_text) problem(line, &section, "", fmt::format("'{}' is not key=value", shortened(raw)));
      return;
    }
    section.entries.push_back(
        {lower(trimmed(raw.substr(0, equals))), std::string(trimmed(raw.substr(equals + 1))), line});
  }

  static std::string shortened(std::string_view text) {
    return text.size() <= 40 ? std::string(text) : std::string(text.substr(0, 37)) + "...";
  }

  std::string file_;
  std::map<std::string, Section> sections_;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
  bool skipping_ = false;
};

// [WIF] must be there, with a version this reader knows.
void check_header(Reader& r) {
  const Section* wif = r.find("wif");
  if (wif == nullptr) {
    r.problem(1, nullptr, "", "this is not a WIF file: there is no [WIF] section");
    return;
  }
  const Entry* version = r.entry(wif, "version");
  if (version == nullptr) {
    r.problem(wif->line, wif, "version", "is missing");
  } else if (const std::optional<Real> v = r.number(wif, *version); v && (*v < 1 || *v >= 2)) {
    r.problem(version->line, wif, "version", fmt::format("{} is not supported; 1.0 and 1.1 are", *v));
  }
  const Section* contents = r.find("contents");
  if (contents == nullptr) return;
  for (const Entry& e : contents->entries) r.boolean(contents, e);
}

struct Palette {
  std::vector<Vec3> colour;  // linear, entry 1 first
  bool given = false;
};

Palette read_palette(Reader& r) {
  Palette palette;
  const Section* table = r.find("color table");
  const Section* head = r.find("color palette");
  int low = 0, high = 255;
  if (const Entry* range = r.entry(head, "range")) {
    const std::string_view text = without_comment(range->value);
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) {
      r.problem(range->line, head, "range", fmt::format("'{}' is not two numbers, such as 0,255", range->value));
    } else {
      const auto a = r.whole(head, *range, text.substr(0, comma), 0, 1 << 24);
      const auto b = r.whole(head, *range, text.substr(comma + 1), 0, 1 << 24);
      if (a && b && *a < *b) low = *a, high = *b;
      else if (a && b) r.problem(range->line, head, "range", fmt::format("{} is not below {}", *a, *b));
    }
  }
  if (const Entry* form = r.entry(head, "form"); form != nullptr && lower(without_comment(form->value)) != "rgb")
    r.problem(form->line, head, "form", fmt::format("'{}' is not supported; RGB is", form->value));
  constexpr int most = 1 << 16;
  const int entries = r.whole_or(head, "entries", most, 0, most);
  if (table == nullptr) return palette;
  const std::vector<Row> rows = r.rows(table, entries, "colour", low, high, 3, 3);
  int last = 0;
  for (const Row& row : rows) last = std::max(last, row.number);
  palette.colour.assign(static_cast<std::size_t>(last), Vec3{1, 1, 1});
  palette.given = !rows.empty();
  for (const Row& row : rows) {
    const auto part = [&](std::size_t k) { return linear_from_srgb(Real(row.values[k] - low) / (high - low)); };
    palette.colour[static_cast<std::size_t>(row.number - 1)] = {part(0), part(1), part(2)};
  }
  return palette;
}

// Factor from the units of [WARP] or [WEFT] to metres; nothing where no unit is written.
std::optional<Real> length_unit(Reader& r, const Section* section) {
  const Entry* units = r.entry(section, "units");
  if (units == nullptr) return std::nullopt;
  const std::string word = lower(without_comment(units->value));
  if (word == "decipoints") return inch / 720;
  if (word == "inches") return inch;
  if (word == "centimeters" || word == "centimetres") return 0.01;
  r.problem(units->line, section, "units", fmt::format("'{}' is not Decipoints, Inches or Centimeters", units->value));
  return std::nullopt;
}

// Spacing or thickness of every thread: the default of the family's section, then the rows of its own section.
std::vector<Real> thread_lengths(Reader& r, const Section* family, const char* key, const std::string& rows_name,
                                 int threads, std::optional<Real> unit, bool& without_unit) {
  const Entry* base = r.entry(family, key);
  const Section* section = r.find(rows_name.c_str());
  std::optional<Real> standard;
  if (base != nullptr) standard = r.number(family, *base);
  if (!standard && (section == nullptr || section->entries.empty())) return {};
  std::vector<Real> lengths(static_cast<std::size_t>(threads), standard.value_or(0));
  std::map<int, int> seen;
  if (section != nullptr)
    for (const Entry& e : section->entries) {
      const std::optional<int> n = r.row_number(section, e, threads, "thread", seen);
      const std::optional<Real> value = r.number(section, e);
      if (n && value) lengths[static_cast<std::size_t>(*n - 1)] = *value;
    }
  const bool whole = std::all_of(lengths.begin(), lengths.end(), [](Real l) { return l > 0; });
  if (!unit) {
    without_unit = without_unit || whole;
    return {};
  }
  if (!whole) {  // 0 = not given; then no thread's length is usable
    const bool some = std::any_of(lengths.begin(), lengths.end(), [](Real l) { return l > 0; });
    if (some)
      r.problem(section->line, section, "", fmt::format("some threads have a {}, others have none", key));
    return {};
  }
  for (Real& l : lengths) l *= *unit;
  return lengths;
}

WifThreads read_threads(Reader& r, const char* name, const Palette& palette) {
  WifThreads out;
  const Section* family = r.find(name);
  if (family == nullptr) {
    r.problem(1, nullptr, "", fmt::format("there is no [{}] section", name[1] == 'a' ? "WARP" : "WEFT"));
    return out;
  }
  if (r.entry(family, "threads") == nullptr) r.problem(family->line, family, "threads", "is missing");
  out.threads = r.whole_or(family, "threads", 0, 1, largest_weave_repeat);
  const std::optional<Real> unit = length_unit(r, family);
  const std::string prefix = name;
  out.spacing = thread_lengths(r, family, "spacing", prefix + " spacing", out.threads, unit, out.lengths_without_unit);
  out.thickness =
      thread_lengths(r, family, "thickness", prefix + " thickness", out.threads, unit, out.lengths_without_unit);

  const int entries = static_cast<int>(palette.colour.size());
  const Section* colours = r.find((prefix + " colors").c_str());
  int standard = 0;
  if (const Entry* e = r.entry(family, "color")) {
    const std::string_view text = without_comment(e->value);  // palette entry; direct r,g,b behind it is older usage
    standard = r.whole(family, *e, text.substr(0, text.find(',')), palette.given ? 1 : 0, palette.given ? entries : 1 << 16)
                   .value_or(0);
  }
  const std::vector<Row> rows = r.rows(colours, out.threads, "thread", 1, palette.given ? entries : 1 << 16, 1, 1);
  if (!palette.given || (standard == 0 && rows.empty())) return out;
  const Vec3 base = standard > 0 ? palette.colour[static_cast<std::size_t>(standard - 1)] : Vec3{1, 1, 1};
  out.colour.assign(static_cast<std::size_t>(out.threads), base);
  for (const Row& row : rows)
    if (!row.values.empty())
      out.colour[static_cast<std::size_t>(row.number - 1)] = palette.colour[static_cast<std::size_t>(row.values[0] - 1)];
  return out;
}

// Shafts that each pick moves, from the liftplan or from treadling and tie-up.
std::vector<std::vector<int>> moved_shafts(Reader& r, WifFile& wif) {
  std::vector<std::vector<int>> moved(static_cast<std::size_t>(wif.weft.threads));
  const Section* liftplan = r.find("liftplan");
  const Section* treadling = r.find("treadling");
  const Section* tieup = r.find("tieup");
  // Both ways are read, so that a mistake in the one that is not used is still reported.
  const std::vector<Row> lifts = r.rows(liftplan, wif.weft.threads, "pick", 0, wif.shafts);
  const std::vector<Row> ties = r.rows(tieup, wif.treadles, "treadle", 0, wif.shafts);
  const std::vector<Row> treads = r.rows(treadling, wif.weft.threads, "pick", 0, wif.treadles);
  wif.from_liftplan = liftplan != nullptr && !liftplan->entries.empty();
  if (wif.from_liftplan) {
    for (const Row& row : lifts) moved[static_cast<std::size_t>(row.number - 1)] = row.values;
    return moved;
  }
  if (treadling == nullptr || treadling->entries.empty()) {
    r.problem(1, nullptr, "", "there is neither a [LIFTPLAN] nor a [TREADLING] section with rows");
    return moved;
  }
  if (tieup == nullptr) {
    r.problem(treadling->line, treadling, "", "needs a [TIEUP] section, and there is none");
    return moved;
  }
  std::vector<std::vector<int>> tied(static_cast<std::size_t>(wif.treadles) + 1);
  for (const Row& row : ties) tied[static_cast<std::size_t>(row.number)] = row.values;
  for (const Row& row : treads)
    for (int treadle : row.values)
      for (int shaft : tied[static_cast<std::size_t>(treadle)]) moved[static_cast<std::size_t>(row.number - 1)].push_back(shaft);
  return moved;
}

WeaveDraft draw_down(const WifFile& wif, const std::vector<Row>& threading, const std::vector<std::vector<int>>& moved) {
  WeaveDraft draft{wif.weft.threads, wif.warp.threads, {}};
  const auto ends = static_cast<std::size_t>(wif.warp.threads);
  draft.warp_up.resize(moved.size() * ends);
  std::vector<std::vector<int>> shafts(ends);
  for (const Row& row : threading) shafts[static_cast<std::size_t>(row.number - 1)] = row.values;
  std::vector<std::uint8_t> is_moved(static_cast<std::size_t>(wif.shafts) + 1);
  for (std::size_t p = 0; p < moved.size(); ++p) {
    std::fill(is_moved.begin(), is_moved.end(), std::uint8_t{0});
    for (int shaft : moved[p])
      if (shaft > 0) is_moved[static_cast<std::size_t>(shaft)] = 1;
    for (std::size_t e = 0; e < ends; ++e) {
      const bool named = std::any_of(shafts[e].begin(), shafts[e].end(),
                                     [&](int s) { return is_moved[static_cast<std::size_t>(s)] != 0; });
      // An end on no shaft hangs in the middle: like an end that is not raised.
      const bool threaded = std::any_of(shafts[e].begin(), shafts[e].end(), [](int s) { return s > 0; });
      draft.warp_up[p * ends + e] = threaded && named == wif.rising_shed ? 1 : 0;
    }
  }
  return draft;
}

}  // namespace

Real linear_from_srgb(Real c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

WifFile parse_wif(std::string_view text, const std::string& file) {
  Reader r(text, file);
  WifFile wif;
  check_header(r);
  if (const Entry* title = r.entry(r.find("text"), "title")) wif.title = title->value;

  const Section* weaving = r.find("weaving");
  if (weaving == nullptr) {
    r.problem(1, nullptr, "", "there is no [WEAVING] section");
  } else {
    if (r.entry(weaving, "shafts") == nullptr) r.problem(weaving->line, weaving, "shafts", "is missing");
    wif.shafts = r.whole_or(weaving, "shafts", 0, 1, largest_wif_shafts);
    wif.treadles = r.whole_or(weaving, "treadles", 0, 0, largest_wif_shafts);
    if (const Entry* shed = r.entry(weaving, "rising shed")) wif.rising_shed = r.boolean(weaving, *shed).value_or(true);
  }
  const Palette palette = read_palette(r);
  wif.warp = read_threads(r, "warp", palette);
  wif.weft = read_threads(r, "weft", palette);
  const std::size_t crossings = static_cast<std::size_t>(wif.warp.threads) * static_cast<std::size_t>(wif.weft.threads);
  if (crossings > largest_weave)
    r.problem(1, nullptr, "", fmt::format("a draft of {} ends x {} picks is larger than {} crossings", wif.warp.threads,
                                          wif.weft.threads, largest_weave));

  const Section* threading = r.find("threading");
  if (threading == nullptr || threading->entries.empty())
    r.problem(threading == nullptr ? 1 : threading->line, threading, "",
              threading == nullptr ? "there is no [THREADING] section" : "is empty");
  const std::vector<Row> threaded = r.rows(threading, wif.warp.threads, "thread", 0, wif.shafts);
  const std::vector<std::vector<int>> moved = moved_shafts(r, wif);
  r.finish();
  wif.draft = draw_down(wif, threaded, moved);
  return wif;
}

WifFile read_wif(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file))
    throw InputError(std::vector{Problem{file.string(), 0, 0, "", "cannot be opened"}});
  std::error_code code;
  if (const auto bytes = std::filesystem::file_size(file, code); !code && bytes > largest_wif_bytes)
    throw InputError(std::vector{Problem{file.string(), 0, 0, "", fmt::format("has {} bytes; a WIF file of more than {} is refused",
                                                                              bytes, largest_wif_bytes)}});
  std::ostringstream text;
  text << in.rdbuf();
  return parse_wif(text.str(), file.string());
}

}  // namespace imbibe
