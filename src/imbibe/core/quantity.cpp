#include "imbibe/core/quantity.h"

#include <fmt/format.h>
#include <udunits2.h>

#include <cctype>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <mutex>

namespace imbibe {
namespace {

constexpr std::size_t longest_unit = 100;  // UDUNITS parses by recursion

struct UnitFree {
  void operator()(ut_unit* u) const { ut_free(u); }
};
using Unit = std::unique_ptr<ut_unit, UnitFree>;

// UDUNITS is not thread-safe and reads its database once: one system behind one lock.
struct UnitSystem {
  std::mutex mutex;
  ut_system* system = nullptr;
  UnitSystem() {
    ut_set_error_message_handler(ut_ignore);
    system = ut_read_xml(nullptr);
    if (system == nullptr) throw QuantityError("cannot read the UDUNITS-2 unit database (package libudunits2-data)");
    add("deg", "arc_degree");
    add("tex", "1e-6 kg/m");
    add("dtex", "1e-7 kg/m");
    add("denier", "1.1111111111111111e-7 kg/m");
    add("gsm", "1e-3 kg/m2");
    add("ends", "1");
    add("picks", "1");
    add("byte", "1");
    add("MB", "1e6");
    add("GB", "1e9");
  }
  void add(const char* name, const char* definition) {
    Unit unit(ut_parse(system, definition, UT_UTF8));
    ut_unmap_name_to_unit(system, name, UT_UTF8);  // the database's denier is rounded to seven digits
    ut_map_name_to_unit(name, UT_UTF8, unit.get());
  }
};

UnitSystem& units() {
  static UnitSystem system;
  return system;
}

std::string trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return std::string(text);
}

Unit parse_unit(UnitSystem& s, std::string text) {
  if (!text.empty() && text.front() == '/') text.insert(text.begin(), '1');  // "24 /cm"
  if (text.empty()) text.push_back('1');
  return Unit(ut_parse(s.system, text.c_str(), UT_UTF8));
}

Real converted(const std::string& from, const std::string& to, Real value) {
  UnitSystem& s = units();
  std::lock_guard lock(s.mutex);
  Unit a = parse_unit(s, from), b = parse_unit(s, to);
  if (!a) throw QuantityError(fmt::format("'{}' is not a known unit", from));
  if (!b) throw QuantityError(fmt::format("'{}' is not a known unit", to));
  std::unique_ptr<cv_converter, void (*)(cv_converter*)> c(ut_get_converter(a.get(), b.get()), cv_free);
  if (!c) throw QuantityError(fmt::format("'{}' is not convertible to {}", from, to == "1" ? "a plain ratio" : to));
  return cv_convert_double(c.get(), value);
}

}  // namespace

Real parse_quantity(std::string_view text, std::string_view si_unit) {
  const std::string all = trimmed(text);
  Real value = 0;
  const char* begin = all.data() + (!all.empty() && all.front() == '+');
  const auto [end, code] = std::from_chars(begin, all.data() + all.size(), value);
  if (code != std::errc{}) throw QuantityError(fmt::format("'{}' is not a number with a unit", all));
  if (!std::isfinite(value)) throw QuantityError(fmt::format("'{}' is not a finite number", all));
  const std::string unit = trimmed(std::string_view(end, all.data() + all.size() - end));
  if (unit.empty() && (si_unit == "K" || si_unit == "rad"))
    throw QuantityError(fmt::format("'{}' needs a unit ({})", all, si_unit == "K" ? "degC or K" : "deg or rad"));
  if (unit.empty()) return value;
  if (unit.size() > longest_unit) throw QuantityError(fmt::format("a unit of {} letters is not known", unit.size()));
  Real si = 0;
  if (unit == "Ne") {  // indirect system: hanks of 840 yards in a pound; 590.5 tex at Ne 1
    if (si_unit != "kg/m") throw QuantityError(fmt::format("'Ne' is not convertible to {}", si_unit));
    if (value <= 0) throw QuantityError("a yarn count in Ne must be above 0");
    si = 0.45359237 / (840 * 0.9144) / value;
  } else {
    si = converted(unit, std::string(si_unit), value);
  }
  if (!std::isfinite(si)) throw QuantityError(fmt::format("'{}' is too large a number", all));
  return si;
}

Real convert_from_si(Real value, std::string_view si_unit, std::string_view shown_unit) {
  if (si_unit == shown_unit) return value;
  return converted(std::string(si_unit), std::string(shown_unit), value);
}

std::string format_quantity(Real value, std::string_view si_unit, std::string_view shown_unit) {
  return fmt::format("{:.6g} {}", convert_from_si(value, si_unit, shown_unit), shown_unit);
}

}  // namespace imbibe
