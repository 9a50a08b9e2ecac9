// ./imbibe bench [FILTER]          measure, print a table
// ./imbibe bench compare A B       two committed or fresh tables
// ./imbibe bench page TABLE        docs/performance.md of a table
#include <benchmark/benchmark.h>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>

#include "bench.h"
#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/io/machine.h"
#include "machine_limits.h"
#include "page.h"
#include "table.h"

namespace {

using namespace imbibe;
using namespace imbibe::bench;

// Takes the least time over the repetitions of each benchmark and splits off its stages.
class TableReporter : public benchmark::BenchmarkReporter {
 public:
  explicit TableReporter(std::map<int, MachineLimits> limits) : limits_(std::move(limits)) { print_header(); }
  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Row> rows;
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      if (run.error_occurred) {
        std::printf("%s: %s\n", run.benchmark_name().c_str(), run.error_message.c_str());
        continue;
      }
      add(run, rows);
    }
    for (Row& row : rows) table_.rows.push_back(row);
    finish(table_, limits_);
    for (std::size_t k = table_.rows.size() - rows.size(); k < table_.rows.size(); ++k) print_row(table_.rows[k]);
  }

  Table& table() { return table_; }

 private:
  static void keep_least(std::vector<Row>& rows, const Row& row) {
    const auto same = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == row.name; });
    if (same == rows.end()) rows.push_back(row);
    else if (row.ns_per_item < same->ns_per_item) {
      const double cpu = std::min(same->cpu_ns_per_item, row.cpu_ns_per_item);
      *same = row;
      same->cpu_ns_per_item = cpu;
    } else same->cpu_ns_per_item = std::min(same->cpu_ns_per_item, row.cpu_ns_per_item);
  }

  void add(const Run& run, std::vector<Row>& rows) {
    const std::string& full = run.run_name.function_name;  // name/size/threads:n
    const std::size_t at = full.rfind("/threads:"), before = full.rfind('/', at - 1);
    Row row;
    row.name = full.substr(0, before);
    row.size = std::stod(full.substr(before + 1, at - before - 1));
    row.threads = std::stoi(full.substr(at + 9));
    const auto counter = [&](const char* name) {
      const auto found = run.counters.find(name);
      return found == run.counters.end() ? 0.0 : static_cast<double>(found->second);
    };
    const double items = counter("items"), passes = static_cast<double>(run.iterations);
    row.ns_per_item = 1e9 * run.real_accumulated_time / passes / items;
    row.cpu_ns_per_item = 1e9 * run.cpu_accumulated_time / passes / items;
    row.items_per_s = 1e9 / row.ns_per_item;
    row.held_bytes = counter("held"), row.moved_bytes = counter("moved"), row.flops = counter("flops");
    for (const auto& [name, value] : run.counters) {
      if (name.starts_with("extra ")) {
        row.extra += fmt::format("{}{}={:.4g}", row.extra.empty() ? "" : ";", name.substr(6), double(value));
      }
    }
    keep_least(rows, row);
    for (const auto& [name, value] : run.counters) {
      if (!name.starts_with("stage ")) continue;
      Row stage{.name = row.name + ":" + name.substr(6), .size = row.size, .threads = row.threads, .extra = {}};
      stage.ns_per_item = 1e9 * double(value) / items;
      stage.cpu_ns_per_item = stage.ns_per_item / row.ns_per_item * row.cpu_ns_per_item;  // its share
      stage.items_per_s = stage.ns_per_item > 0 ? 1e9 / stage.ns_per_item : 0;
      if (stage.ns_per_item > 0) keep_least(rows, stage);
    }
  }

  std::map<int, MachineLimits> limits_;
  Table table_;
};

void register_all(const BenchOptions& options) {
  add_neighbour_benchmarks(options);
  add_liquid_benchmarks(options);
  add_network_benchmarks(options);
  add_contact_benchmarks(options);
  add_cloth_benchmarks(options);
  add_output_benchmarks(options);
  add_scene_benchmarks(options);
}

int measure(const BenchOptions& options, const std::string& filter, const std::string& csv) {
  std::map<int, MachineLimits> limits;
  for (const int threads : options.threads) limits[threads] = measure_limits(threads);
  std::string program = "imbibe_bench";
  char* arguments[] = {program.data(), nullptr};
  int count = 1;
  benchmark::Initialize(&count, arguments);
  register_all(options);
  TableReporter reporter(limits);
  const std::size_t run = benchmark::RunSpecifiedBenchmarks(&reporter, filter.empty() ? "." : filter);
  if (run == 0) return 2;
  Table& table = reporter.table();
  const Machine machine = this_machine();
  table.about["machine"] = machine.processor;
  table.about["cores"] = std::to_string(machine.cores);
  table.about["memory"] = fmt::format("{:.3g} GB", static_cast<double>(machine.memory_bytes) / 1e9);
  table.about["compiler"] = machine.compiler;
  table.about["version"] = IMBIBE_VERSION;
  table.about["date"] = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  table.about["taken"] = fmt::format("least of {} repetitions", options.repeat);
  for (const auto& [threads, limit] : limits) {
    table.about[fmt::format("limits {}", threads)] =
        fmt::format("{:.3g} GB/s triad; {:.3g} Gflop/s single precision", limit.bandwidth / 1e9, limit.arithmetic / 1e9);
    std::printf("%d thread%s: %s\n", threads, threads > 1 ? "s" : "",
                table.about[fmt::format("limits {}", threads)].c_str());
  }
  if (!csv.empty()) {
    write_whole_file(csv, csv_text(table));
    std::printf("table written to %s\n", csv.c_str());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("imbibe bench: what each part costs");
  std::string filter, csv, first, second, shown;
  BenchOptions options;
  app.add_option("filter", filter, "regular expression over the names; default: all");
  app.add_option("--csv", csv, "write the table to this file");
  app.add_option("--largest", options.largest, "greatest size; 1e6 by default, up to 1e7")->check(CLI::PositiveNumber);
  app.add_option("--least", options.least, "smallest size");
  app.add_option("--threads", options.threads, "numbers of threads; default 1 2")->check(CLI::Range(1, 1024));
  app.add_option("--repeat", options.repeat, "repetitions of which the least time counts")->check(CLI::Range(1, 1000));
  CLI::App* compare = app.add_subcommand("compare", "two tables, row by row");
  compare->add_option("A", first)->required();
  compare->add_option("B", second)->required();
  CLI::App* page = app.add_subcommand("page", "the performance page of a table, in Markdown");
  page->add_option("table", shown)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    if (*compare) return print_comparison(read_table(first), read_table(second)) > 0 ? 0 : 1;
    if (*page) {
      std::fputs(performance_page(read_table(shown), std::string(IMBIBE_BENCH_DIR) + "/peers.csv", shown).c_str(), stdout);
      return 0;
    }
    return measure(options, filter, csv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
