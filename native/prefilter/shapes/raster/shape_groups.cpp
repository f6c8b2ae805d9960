// SPDX-License-Identifier: GPL-3.0-or-later

// A sweep over y with disjoint intervals of x.
#include "prefilter/shapes/raster/shape_groups.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "prefilter/base/disjoint_sets.h"

namespace prefilter {
namespace {

// An interval of x from the map's key to `high`, occupied up to a height.
struct ShapeGroupsInterval {
  double high = 0.0;
  double top = 0.0;
  std::uint32_t group = 0;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> overlapping_groups(std::span<const Box2> boxes) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty()) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return boxes[a].low.y != boxes[b].low.y ? boxes[a].low.y < boxes[b].low.y : a < b;
  });
  DisjointSets<std::uint32_t> sets(boxes.size());
  std::map<double, ShapeGroupsInterval> passed;  // disjoint
  for (const std::uint32_t i : order) {
    double low = boxes[i].low.x;
    ShapeGroupsInterval interval{boxes[i].high.x, boxes[i].high.y, i};
    auto at = passed.upper_bound(low);
    if (at != passed.begin() && std::prev(at)->second.high >= low) --at;
    while (at != passed.end() && at->first <= interval.high) {
      const ShapeGroupsInterval& other = at->second;
      if (other.top >= boxes[i].low.y) {
        sets.join(other.group, i);
        low = std::min(low, at->first);
        interval.high = std::max(interval.high, other.high);
        interval.top = std::max(interval.top, other.top);
      }
      at = passed.erase(at);
    }
    passed.emplace(low, interval);
  }
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint32_t> group_of(boxes.size(), UINT32_MAX);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    std::uint32_t& group = group_of[sets.root(i)];
    if (group == UINT32_MAX) {
      group = static_cast<std::uint32_t>(groups.size());
      groups.emplace_back();
    }
    groups[group].push_back(i);
  }
  return groups;
}

}  // namespace prefilter
