// Rows of figures: from benchmarks, to the screen and to CSV and back.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "machine_limits.h"

namespace imbibe::bench {

struct Row {
  std::string name;       // family, e.g. "liquid/dam_break", or of a stage "liquid/dam_break:lists"
  double size = 0;
  int threads = 1;
  double ns_per_item = 0;      // wall
  double cpu_ns_per_item = 0;  // processor time of all threads; of a stage: by its share of the wall time
  double items_per_s = 0;
  double held_bytes = 0, moved_bytes = 0, flops = 0;  // per item; 0: not known
  double bandwidth_share = 0, arithmetic_share = 0;   // of what measure_limits found for so many threads
  double exponent = 0;         // of processor time over items, from the next smaller size of the family; 0: first
  std::string extra;           // name=value;name=value
};

struct Table {
  std::map<std::string, std::string> about;  // machine, compiler, date, how it was taken
  std::vector<Row> rows;
};

// Fills shares and exponents.
void finish(Table& table, const std::map<int, MachineLimits>& limits);

std::string csv_text(const Table& table);
Table read_table(const std::filesystem::path& csv);  // throws InputError

void print_header();
void print_row(const Row& row);

// Both tables side by side, ratio B/A of the time per item; returns the number of rows that they share.
int print_comparison(const Table& a, const Table& b);

}  // namespace imbibe::bench
