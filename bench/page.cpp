#include "page.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "imbibe/core/error.h"

namespace imbibe::bench {
namespace {

struct PeerFigure {
  std::string name;  // our benchmark of the same scene
  double size = 0;
  int threads = 1;
  double ns_per_item = 0;
  std::string who, how;
};

std::vector<PeerFigure> read_peers(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError("cannot read " + file.string());
  std::vector<PeerFigure> peers;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::stringstream fields(line);
    std::string f[6];
    for (std::string& field : f) std::getline(fields, field, ',');
    if (!f[0].empty()) peers.push_back({f[0], std::stod(f[1]), std::stoi(f[2]), std::stod(f[3]), f[4], f[5]});
  }
  return peers;
}

const Row* find_row(const Table& table, const std::string& name, double size, int threads) {
  for (const Row& row : table.rows) {
    if (row.name == name && row.size == size && row.threads == threads) return &row;
  }
  return nullptr;
}

std::string per_item(double ns) {
  if (ns <= 0) return "";
  return ns >= 1e3 ? fmt::format("{:.3g} us", ns / 1e3) : fmt::format("{:.3g} ns", ns);
}

std::string per_pass(double ns_per_item, double size) {
  const double ms = 1e-6 * ns_per_item * size;
  return ms >= 1e3 ? fmt::format("{:.3g} s", ms / 1e3) : fmt::format("{:.3g} ms", ms);
}

std::string percent(double share) { return share > 0 ? fmt::format("{:.0f} %", 100 * share) : ""; }
std::string bytes(double value) { return value > 0 ? fmt::format("{:.0f}", value) : ""; }

constexpr const char* heading = R"(# Performance

This page is made from a committed table; nothing on it is typed by hand:

    ./imbibe bench --csv bench/results/MACHINE.csv         # measure (about half an hour; --largest 1e7 for the last sizes)
    ./imbibe bench page {0} > docs/performance.md
    ./imbibe bench compare bench/results/A.csv bench/results/B.csv

{1}
Each benchmark runs several times and the least wall time counts. `cpu` is the processor time of all threads: where it is
close to threads x wall time the machine was free. `exp` is the growth of processor time with size between neighbouring sizes (1 =
cost per item stays). `held` is the memory kept per item, from the allocator. `mem` and `flop` are shares of the triad's
bandwidth and of the arithmetic peak measured in the same run; bytes and operations are counted from the code
(bench/bench.h), so they are estimates.
)";

void add_peers(std::string& page, const Table& table, const std::vector<PeerFigure>& peers) {
  page += "\n## Against peers\n\n"
          "Peers were built and run on a machine of the same kind (2 cores, g++ 12, -O3 -march=native), medians. Their\n"
          "scenes are ours: the same number of particles, neighbours and density error. Differences under 20 % mean "
          "nothing.\n\n"
          "| benchmark | size | threads | Imbibe | peer | ratio | peer and how it was taken |\n|---|---|---|---|---|---|---|\n";
  for (const PeerFigure& p : peers) {
    const Row* row = find_row(table, p.name, p.size, p.threads);
    page += fmt::format("| {} | {:.0f} | {} | {} | {} | {} | {}: {} |\n", p.name, p.size, p.threads,
                        row ? per_pass(row->ns_per_item, p.size) : "not measured", per_pass(p.ns_per_item, p.size),
                        row ? fmt::format("{:.2g} x", p.ns_per_item / row->ns_per_item) : "", p.who, p.how);
  }
}

void add_all(std::string& page, const Table& table) {
  page += "\n## All figures\n\n"
          "| benchmark | size | threads | a pass | per item | cpu per item | held B | moved B | mem | flop | exp | |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& r : table.rows) {
    std::string extra = r.extra;
    for (std::size_t at = 0; (at = extra.find(';', at)) != std::string::npos;) extra.replace(at, 1, ", ");
    page += fmt::format("| {} | {:.0f} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", r.name, r.size, r.threads,
                        per_pass(r.ns_per_item, r.size), per_item(r.ns_per_item), per_item(r.cpu_ns_per_item),
                        bytes(r.held_bytes), bytes(r.moved_bytes), percent(r.bandwidth_share),
                        percent(r.arithmetic_share), r.exponent != 0 ? fmt::format("{:.2f}", r.exponent) : "", extra);
  }
}

}  // namespace

std::string performance_page(const Table& table, const std::filesystem::path& peers,
                             const std::filesystem::path& table_file) {
  std::string about;
  for (const auto& [key, value] : table.about) about += fmt::format("- {}: {}\n", key, value);
  std::string page = fmt::format(fmt::runtime(heading), table_file.string(), about);
  add_peers(page, table, read_peers(peers));
  add_all(page, table);
  return page;
}

}  // namespace imbibe::bench
