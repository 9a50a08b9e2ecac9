// Random values for any described struct, and a bit-exact listing of one: visitors for round-trip tests.
#pragma once

#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/random.h"
#include "imbibe/scene/scene.h"

namespace imbibe::test {

// Fills a described struct with values that its description allows.
class RandomFiller {
 public:
  explicit RandomFiller(std::uint64_t seed) : counter_{.seed = seed} {}

  template <class T>
  void value(const char* name, T& field, const ParameterInfo& info = {}) {
    if (std::string_view(name) == "version") return;
    fill(field, info);
  }
  template <class Enum>
  void choice(const char*, Enum& field, const Choices<std::type_identity_t<Enum>>& choices, const char* = "") {
    field = choices[pick(choices.size())].second;
  }
  template <class P>
  void group(const char*, P& params, const char* = "") { describe(*this, params); }
  template <class P>
  void group(const char* name, std::optional<P>& params, const char* help = "") {
    params.reset();
    if (random() < 0.5) group(name, params.emplace(), help);
  }
  template <class P>
  void list(const char*, std::vector<P>& items, const char* = "") {
    items.resize(pick(4));
    for (P& item : items) describe(*this, item);
  }

 private:
  Real random() { return uniform({counter_.seed, 0, counter_.step++}); }
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random() * static_cast<Real>(n)); }
  Real number(const ParameterInfo& info) {
    if (random() < 0.2 && std::isfinite(info.max)) return info.max;
    const Real low = std::isfinite(info.min) ? info.min : -1e3, high = std::isfinite(info.max) ? info.max : low + 1e3;
    // Spread over the decades, so that small values come as often as large ones.
    return low + (high - low) * std::pow(10.0, -9 * random()) * (1 - 1e-9 * random());
  }
  void fill(Real& x, const ParameterInfo& info) { x = number(info); }
  void fill(float& x, const ParameterInfo& info) { x = static_cast<float>(number(info)); }
  void fill(int& x, const ParameterInfo& info) {
    x = static_cast<int>(std::min(1e9, std::ceil(number(info))));
  }
  void fill(std::uint64_t& x, const ParameterInfo&) { x = random_bits({counter_.seed, 1, counter_.step++}); }
  void fill(bool& x, const ParameterInfo&) { x = random() < 0.5; }
  void fill(std::string& x, const ParameterInfo&) {
    static const char* const words[] = {"plain", "twill 2/1", "true", "3", "a: b", "say \"hi\"", "null", "back\\slash",
                                        "tab\there", "-", "# no comment", "grüße", " lead", "two\nlines", "1.5 mm"};
    x = words[pick(std::size(words))];
  }
  template <class T>
  void fill(Vector3<T>& x, const ParameterInfo& info) { fill(x.x, info), fill(x.y, info), fill(x.z, info); }
  template <class T, std::size_t N>
  void fill(std::array<T, N>& x, const ParameterInfo& info) {
    for (T& item : x) fill(item, info);
  }
  template <class T>
  void fill(std::vector<T>& x, const ParameterInfo& info) {
    x.resize(pick(4));
    for (T& item : x) fill(item, info);
  }
  template <class T>
  void fill(std::optional<T>& x, const ParameterInfo& info) {
    x.reset();
    if (random() < 0.5) fill(x.emplace(), info);
  }

  RandomCounter counter_;
};

// Every value with its bits, one per line.
class BitListing {
 public:
  std::string text;

  template <class T>
  void value(const char* name, T& field, const ParameterInfo& = {}) { text += std::string(name) + "=" + bits(field) + "\n"; }
  template <class Enum>
  void choice(const char* name, Enum& field, const Choices<std::type_identity_t<Enum>>&, const char* = "") {
    text += std::string(name) + "=" + std::to_string(static_cast<int>(field)) + "\n";
  }
  template <class P>
  void group(const char* name, P& params, const char* = "") {
    text += std::string(name) + "{\n";
    describe(*this, params);
    text += "}\n";
  }
  template <class P>
  void group(const char* name, std::optional<P>& params, const char* help = "") {
    if (params) group(name, *params, help);
    else text += std::string(name) + " none\n";
  }
  template <class P>
  void list(const char* name, std::vector<P>& items, const char* = "") {
    text += std::string(name) + "[\n";
    for (P& item : items) describe(*this, item), text += ",\n";
    text += "]\n";
  }

 private:
  static std::string bits(Real x) { return std::to_string(std::bit_cast<std::uint64_t>(x)); }
  static std::string bits(float x) { return std::to_string(std::bit_cast<std::uint32_t>(x)); }
  static std::string bits(int x) { return std::to_string(x); }
  static std::string bits(std::uint64_t x) { return std::to_string(x); }
  static std::string bits(bool x) { return x ? "1" : "0"; }
  static std::string bits(const std::string& x) { return x; }
  template <class T>
  static std::string bits(const Vector3<T>& x) { return bits(x.x) + " " + bits(x.y) + " " + bits(x.z); }
  template <class T, std::size_t N>
  static std::string bits(const std::array<T, N>& x) {
    std::string all;
    for (const T& item : x) all += bits(item) + " ";
    return all;
  }
  template <class T>
  static std::string bits(const std::vector<T>& x) {
    std::string all;
    for (const T& item : x) all += bits(item) + " ";
    return all;
  }
  template <class T>
  static std::string bits(const std::optional<T>& x) { return x ? bits(*x) : "none"; }
};

template <class P>
std::string bit_listing(P params) {
  BitListing listing;
  describe(listing, params);
  return listing.text;
}

}  // namespace imbibe::test
