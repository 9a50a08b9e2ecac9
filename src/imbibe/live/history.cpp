#include "imbibe/live/history.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace imbibe::live {

void History::add(const std::vector<double>& row) {
  if (!rows_.empty() && rows_.back().front() == row.front()) {  // the same instant, told anew
    rows_.back() = row;
    return;
  }
  if (++skipped_ < stride_) return;
  skipped_ = 0;
  rows_.push_back(row);
  if (rows_.size() < most_) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows_.size(); i += 2) std::swap(rows_[kept++], rows_[i]);
  rows_.resize(kept);
  stride_ *= 2;
}

std::string History::json() const {
  std::string out = "[";
  for (const auto& row : rows_) {
    out += out.size() > 1 ? ",[" : "[";
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out += ',';
      out += std::isfinite(row[i]) ? fmt::format("{:.7g}", row[i]) : "null";
    }
    out += ']';
  }
  return out + "]";
}

}  // namespace imbibe::live
