#include "imbibe/core/portable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <string>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

static_assert(LDBL_MANT_DIG >= 64, "the reference is long double");

double between(double low, double high, int i) {
  return low + (high - low) * uniform({.seed = 5, .id = static_cast<std::uint64_t>(i)});
}

// The greatest error in units in the last place of the result, over 20,000 arguments from `argument`.
double worst(const std::function<double(int)>& argument, const std::function<double(double)>& f,
             const std::function<long double(long double)>& exact) {
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = argument(i);
    const long double wanted = exact(x);
    int exponent = 0;
    std::frexp(wanted, &exponent);
    const long double unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
    most = std::max(most, static_cast<double>(std::abs(f(x) - wanted) / unit));
  }
  return most;
}
std::function<double(int)> uniformly(double low, double high) {
  return [=](int i) { return between(low, high, i); };
}
std::function<double(int)> over_decades(double low, double high) {
  return [=](int i) { return std::exp(between(low, high, i)); };
}

// Bounds as portable.h states them.
TEST(Portable, ExponentialAndLogarithmAreWithinOneUnitInTheLastPlace) {
  const auto exact_exp = [](long double x) { return std::exp(x); };
  EXPECT_LT(worst(uniformly(-745, 709), portable::exp, exact_exp), 1);
  EXPECT_LT(worst(uniformly(-1, 1), portable::exp, exact_exp), 1);
  const auto exact_log = [](long double x) { return std::log(x); };
  EXPECT_LT(worst(over_decades(-700, 700), portable::log, exact_log), 1);
  EXPECT_LT(worst(uniformly(0.5, 2), portable::log, exact_log), 1);
  const auto exact_expm1 = [](long double x) { return std::expm1(x); };
  EXPECT_LT(worst(uniformly(-3, 3), portable::expm1, exact_expm1), 4);
  EXPECT_LT(worst(uniformly(-1e-6, 1e-6), portable::expm1, exact_expm1), 1);
}

TEST(Portable, CircularFunctionsAndRootsToo) {
  EXPECT_LT(worst(uniformly(-20, 20), portable::sin, [](long double x) { return std::sin(x); }), 1);
  EXPECT_LT(worst(uniformly(-20, 20), portable::cos, [](long double x) { return std::cos(x); }), 1);
  EXPECT_LT(worst(over_decades(-700, 700), portable::cbrt, [](long double x) { return std::cbrt(x); }), 1);
  EXPECT_LT(worst(uniformly(-1, 1), portable::asin, [](long double x) { return std::asin(x); }), 4);
  EXPECT_LT(worst(uniformly(-1, 1), portable::acos, [](long double x) { return std::acos(x); }), 4);
  for (const double x : {0.7, -1.3, 1e-9, -40.0})
    EXPECT_LT(worst(uniformly(-3, 3), [=](double y) { return portable::atan2(y, x); },
                    [=](long double y) { return std::atan2(y, static_cast<long double>(x)); }), 4) << x;
}

TEST(Portable, PowersAreWithinTwoUnits) {
  for (const double y : {0.5, -0.3, 1.37, 3.0, 12.5, -2.0})
    EXPECT_LT(worst(over_decades(-4, 4), [=](double x) { return portable::pow(x, y); },
                    [=](long double x) { return std::pow(x, static_cast<long double>(y)); }), 2) << y;
}

TEST(Portable, AgreesWithTheStandardLibraryAtTheEndsOfItsRange) {
  const double inf = std::numeric_limits<double>::infinity(), tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(portable::exp(0), 1);
  EXPECT_EQ(portable::exp(710), inf);
  EXPECT_EQ(portable::exp(-746), 0);
  EXPECT_EQ(portable::exp(-inf), 0);
  EXPECT_EQ(portable::exp(-745.1), tiny);
  EXPECT_EQ(portable::log(1), 0);
  EXPECT_EQ(portable::log(0), -inf);
  EXPECT_EQ(portable::log(inf), inf);
  EXPECT_DOUBLE_EQ(portable::log(tiny), std::log(tiny));
  EXPECT_EQ(portable::pow(0, 2), 0);
  EXPECT_EQ(portable::pow(0, -2), inf);
  EXPECT_EQ(portable::pow(7, 0), 1);
  EXPECT_EQ(portable::pow(-2, 3), -8);
  EXPECT_EQ(portable::pow(-2, 2), 4);
  EXPECT_EQ(portable::pow(10, 400), inf);
  EXPECT_EQ(portable::pow(10, -400), 0);
  EXPECT_EQ(portable::cbrt(-27), -3);
  EXPECT_EQ(portable::cbrt(0), 0);
  EXPECT_DOUBLE_EQ(portable::cbrt(tiny), std::cbrt(tiny));
  EXPECT_EQ(portable::acos(1), 0);
  EXPECT_EQ(portable::acos(-1), pi);
  EXPECT_EQ(portable::acos(0), pi / 2);
  for (const double y : {0.0, -0.0, 2.0, -2.0, inf, -inf})
    for (const double x : {0.0, -0.0, 3.0, -3.0, inf, -inf})
      EXPECT_DOUBLE_EQ(portable::atan2(y, x), std::atan2(y, x)) << y << " " << x;
  for (const double bad : {std::nan(""), -inf, -1.0}) EXPECT_TRUE(std::isnan(portable::log(bad))) << bad;
  EXPECT_TRUE(std::isnan(portable::exp(std::nan(""))));
  EXPECT_TRUE(std::isnan(portable::pow(-2, 0.5)));
  EXPECT_TRUE(std::isnan(portable::acos(1.0000001)));
  EXPECT_TRUE(std::isnan(portable::sin(inf)));
}

// Taken once with g++ 12 for x86-64-v3; every other compiler and machine must give the same.
TEST(Portable, GivesTheSameBitsEverywhere) {
  std::uint64_t sum = 0;
  const auto add = [&](double value) { sum = mixed(sum ^ std::bit_cast<std::uint64_t>(value)); };
  for (int i = 0; i < 100000; ++i) {
    const double x = between(-30, 30, i), share = x / 30, size = std::abs(x) + 1e-9;
    for (const double value : {portable::exp(x), portable::expm1(x), portable::log(size), portable::pow(size, 1.37 * share),
                               portable::cbrt(x), portable::sin(x), portable::cos(x), portable::asin(share),
                               portable::acos(share), portable::atan2(x, 1.3), portable::atan2(x, -4), portable::hypot(x, 2)})
      add(value);
  }
  EXPECT_EQ(sum, 0xcfa5009fba9afd1bULL);
}

// What a run's state depends on calls none of the C library's functions that differ between machines.
TEST(Portable, IsWhatTheSimulationCalls) {
  const std::regex call(R"(std::(exp2?|expm1|log(1p|2|10)?|pow|sinh?|cosh?|tanh?|asin|acos|atan2?|cbrt|hypot|erfc?|fma|tgamma|lgamma)[fl]?\()");
  int files = 0;
  for (const char* module : {"core", "geometry", "liquid", "fabric", "wetting", "cloth", "coupling", "sim", "scene"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(IMBIBE_SOURCE_DIR) / "src" / "imbibe" / module)) {
      if (!entry.is_regular_file()) continue;
      ++files;
      std::ifstream in(entry.path());
      int number = 0;
      for (std::string line; std::getline(in, line);) {
        ++number;
        EXPECT_FALSE(std::regex_search(line, call))
            << entry.path().string() << ":" << number << ": use imbibe/core/portable.h instead\n" << line;
      }
    }
  }
  EXPECT_GT(files, 100);
}

}  // namespace
}  // namespace imbibe
