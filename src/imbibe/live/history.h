// The rows so far, thinned so that a page that comes late gets the whole curves in a bounded message: when there are
// too many, every second one is dropped, and from then on only every second one is taken.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace imbibe::live {

class History {
 public:
  explicit History(std::size_t most = 2000) : most_(most) {}
  void add(const std::vector<double>& row);
  void clear() { rows_.clear(), stride_ = 1, skipped_ = 0; }
  std::string json() const;  // [[...], ...]
  std::size_t size() const { return rows_.size(); }

 private:
  std::size_t most_, stride_ = 1, skipped_ = 0;
  std::vector<std::vector<double>> rows_;
};

}  // namespace imbibe::live
