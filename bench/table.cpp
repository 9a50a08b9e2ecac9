#include "table.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "imbibe/core/error.h"

namespace imbibe::bench {
namespace {

constexpr const char* columns =
    "name,size,threads,ns_per_item,cpu_ns_per_item,items_per_s,held_bytes_per_item,moved_bytes_per_item,"
    "flops_per_item,bandwidth_share,arithmetic_share,exponent,extra";

std::string or_dash(double value, const char* format) {
  return value > 0 ? fmt::format(fmt::runtime(format), value) : "-";
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::stringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

}  // namespace

void finish(Table& table, const std::map<int, MachineLimits>& limits) {
  for (Row& row : table.rows) {
    const auto limit = limits.find(row.threads);
    if (limit != limits.end() && row.ns_per_item > 0) {
      row.bandwidth_share = row.moved_bytes / (1e-9 * row.ns_per_item) / limit->second.bandwidth;
      row.arithmetic_share = row.flops / (1e-9 * row.ns_per_item) / limit->second.arithmetic;
    }
    const Row* smaller = nullptr;
    for (const Row& other : table.rows) {
      if (other.name == row.name && other.threads == row.threads && other.size < row.size &&
          (!smaller || other.size > smaller->size)) {
        smaller = &other;
      }
    }
    if (smaller && smaller->cpu_ns_per_item > 0) {
      row.exponent = 1 + std::log(row.cpu_ns_per_item / smaller->cpu_ns_per_item) / std::log(row.size / smaller->size);
    }
  }
}

std::string csv_text(const Table& table) {
  std::string text;
  for (const auto& [key, value] : table.about) text += fmt::format("# {}: {}\n", key, value);
  text += fmt::format("{}\n", columns);
  for (const Row& r : table.rows) {
    text += fmt::format("{},{:.0f},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.3g},{:.3g},{:.3g},{}\n", r.name, r.size,
                        r.threads, r.ns_per_item, r.cpu_ns_per_item, r.items_per_s, r.held_bytes, r.moved_bytes,
                        r.flops, r.bandwidth_share, r.arithmetic_share, r.exponent, r.extra);
  }
  return text;
}

Table read_table(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  if (!in) throw InputError("cannot read " + csv.string());
  Table table;
  int number = 0;
  bool header = false;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with("# ")) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) table.about[line.substr(2, colon - 2)] = line.substr(colon + 2);
      continue;
    }
    if (!header) {
      if (line != columns) throw InputError(fmt::format("{}:{}: not a table of imbibe bench", csv.string(), number));
      header = true;
      continue;
    }
    const std::vector<std::string> f = fields_of(line);
    if (f.size() < 12) throw InputError(fmt::format("{}:{}: {} fields in place of 13", csv.string(), number, f.size()));
    try {
      table.rows.push_back({f[0], std::stod(f[1]), std::stoi(f[2]), std::stod(f[3]), std::stod(f[4]), std::stod(f[5]),
                            std::stod(f[6]), std::stod(f[7]), std::stod(f[8]), std::stod(f[9]), std::stod(f[10]),
                            std::stod(f[11]), f.size() > 12 ? f[12] : ""});
    } catch (const std::exception&) {
      throw InputError(fmt::format("{}:{}: a field is not a number", csv.string(), number));
    }
  }
  return table;
}

void print_header() {
  std::printf("%-44s %9s %2s %11s %11s %10s %8s %8s %6s %6s %5s  %s\n", "benchmark", "size", "t", "ns/item", "cpu ns/item",
              "items/s", "held B", "moved B", "mem %", "flop %", "exp", "");
}

void print_row(const Row& r) {
  std::printf("%-44s %9.0f %2d %11.4g %11s %10.3g %8s %8s %6s %6s %5s  %s\n", r.name.c_str(), r.size, r.threads,
              r.ns_per_item, or_dash(r.cpu_ns_per_item, "{:.4g}").c_str(), r.items_per_s,
              or_dash(r.held_bytes, "{:.0f}").c_str(), or_dash(r.moved_bytes, "{:.0f}").c_str(),
              or_dash(100 * r.bandwidth_share, "{:.0f}").c_str(), or_dash(100 * r.arithmetic_share, "{:.0f}").c_str(),
              r.exponent != 0 ? fmt::format("{:.2f}", r.exponent).c_str() : "-", r.extra.c_str());
  std::fflush(stdout);
}

int print_comparison(const Table& a, const Table& b) {
  std::printf("%-44s %9s %2s %12s %12s %7s %7s\n", "benchmark", "size", "t", "A ns/item", "B ns/item", "B/A", "cpu B/A");
  int shared = 0;
  double logarithms = 0;
  for (const Row& x : a.rows) {
    for (const Row& y : b.rows) {
      if (x.name != y.name || x.size != y.size || x.threads != y.threads || x.ns_per_item <= 0) continue;
      const double ratio = y.ns_per_item / x.ns_per_item;
      std::printf("%-44s %9.0f %2d %12.4g %12.4g %7.3f %7s\n", x.name.c_str(), x.size, x.threads, x.ns_per_item,
                  y.ns_per_item, ratio,
                  x.cpu_ns_per_item > 0 ? fmt::format("{:.3f}", y.cpu_ns_per_item / x.cpu_ns_per_item).c_str() : "-");
      logarithms += std::log(ratio);
      ++shared;
    }
  }
  if (shared > 0) std::printf("%d rows in both; geometric mean of B/A %.3f\n", shared, std::exp(logarithms / shared));
  return shared;
}

}  // namespace imbibe::bench
