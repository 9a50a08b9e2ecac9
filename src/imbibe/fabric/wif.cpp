#include "imbibe/fabric/wif.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/core/portable.h"
#include "imbibe/fabric/wif_sections.h"

namespace imbibe {
namespace {

using namespace wif;

constexpr Real inch = 0.0254;

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
  const Section* section = r.find(rows_name);
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
  const Section* colours = r.find(prefix + " colors");
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

Real linear_from_srgb(Real c) { return c <= 0.04045 ? c / 12.92 : portable::pow((c + 0.055) / 1.055, 2.4); }

bool is_wif_name(std::string_view name) {
  constexpr std::string_view end = ".wif";
  if (name.size() < end.size()) return false;
  return std::equal(end.begin(), end.end(), name.end() - end.size(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

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
  if (!std::ifstream(file) || std::filesystem::is_directory(file))
    throw InputError(std::vector{Problem{file.string(), 0, 0, "", "cannot be opened"}});
  return parse_wif(read_whole_file(file, largest_wif_bytes), file.string());
}

}  // namespace imbibe
