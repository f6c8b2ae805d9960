// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/blamed_loops.h"

#include <algorithm>
#include <queue>

namespace prefilter {

std::vector<std::size_t> fewest_loops(std::vector<BlamedLoop> blamed, std::size_t pair_count) {
  std::sort(blamed.begin(), blamed.end());
  std::vector<std::size_t> firsts;
  for (std::size_t i = 0; i < blamed.size(); ++i) {
    if (i == 0 || blamed[i].loop != blamed[i - 1].loop) firsts.push_back(i);
  }
  firsts.push_back(blamed.size());
  std::vector<std::uint8_t> is_settled(pair_count, 0);
  const auto open_of = [&](std::size_t f) {
    std::size_t open = 0;
    for (std::size_t i = firsts[f]; i < firsts[f + 1]; ++i) {
      open += is_settled[blamed[i].pair] == 0 ? 1U : 0U;
    }
    return open;
  };
  // Counts only decrease, so an entry at the top whose count is still correct is the maximum.
  struct Entry {
    std::size_t open;
    std::size_t first;

    bool operator<(const Entry& other) const {
      return open != other.open ? open < other.open : first > other.first;
    }
  };
  std::priority_queue<Entry> queue;
  for (std::size_t f = 0; f + 1 < firsts.size(); ++f) queue.push({open_of(f), f});
  std::vector<std::size_t> chosen;
  while (!queue.empty()) {
    const Entry top = queue.top();
    queue.pop();
    const std::size_t open = open_of(top.first);
    if (open == 0) continue;
    if (open < top.open) {
      queue.push({open, top.first});
      continue;
    }
    chosen.push_back(static_cast<std::size_t>(blamed[firsts[top.first]].loop));
    for (std::size_t i = firsts[top.first]; i < firsts[top.first + 1]; ++i) {
      is_settled[blamed[i].pair] = 1;
    }
  }
  return chosen;
}

}  // namespace prefilter
