// SPDX-License-Identifier: GPL-3.0-or-later

// Branch and bound on the bounding box tree.
#include "prefilter/geometry/spatial/nearest_neighbors.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/spatial/curve_order.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeafPoints = 16;
constexpr double kLargestNeighbor = 1e150;

bool is_usable(const Vector3& point) {
  return std::abs(point[0]) <= kLargestNeighbor && std::abs(point[1]) <= kLargestNeighbor &&
         std::abs(point[2]) <= kLargestNeighbor;
}

// Sorts identical points, which have the same key, next to each other.
void sort_by_position(std::span<const Vector3> points, std::vector<CurvePlace>* order,
                      const Run& run) {
  const auto is_before = [&](const CurvePlace& a, const CurvePlace& b) {
    const Vector3& p = points[a.index];
    const Vector3& q = points[b.index];
    return p != q ? p < q : a.index < b.index;
  };
  constexpr std::size_t kMany = 1U << 15;
  std::vector<CurvePlace> copies;
  CancelCheck cancel_check(run);
  for (std::size_t begin = 0, end = 0; begin < order->size(); begin = end) {
    cancel_check.step();
    while (end < order->size() && (*order)[end].key == (*order)[begin].key) ++end;
    if (end == begin + 1) continue;
    const auto first = order->begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order->begin() + static_cast<std::ptrdiff_t>(end);
    if (end - begin < kMany) {
      std::sort(first, last, is_before);
    } else {
      copies.assign(first, last);
      sort_in_parallel(&copies, run, is_before);
      std::copy(copies.begin(), copies.end(), first);
    }
  }
}

}  // namespace

void Neighbors::clear(std::size_t most) {
  most_ = most;
  worst_ = std::numeric_limits<double>::infinity();
  places_.clear();
  squares_.clear();
}

void Neighbors::add(std::uint32_t place, double square) {
  if (places_.size() < most_) {
    places_.push_back(place);
    squares_.push_back(square);
  }
  std::size_t at = places_.size() - 1;
  for (; at > 0 && squares_[at - 1] > square; --at) {
    squares_[at] = squares_[at - 1];
    places_[at] = places_[at - 1];
  }
  squares_[at] = square;
  places_[at] = place;
  if (places_.size() == most_) worst_ = squares_.back();
}

NeighborSearch::NeighborSearch(std::span<const Vector3> points, const Run& run) {
  constexpr std::size_t kMaxPoints = std::numeric_limits<std::int32_t>::max();
  if (points.size() > kMaxPoints) {
    throw_invalid("points: found " + std::to_string(points.size()) + "; " +
                  std::to_string(kMaxPoints) + " are the most");
  }
  std::vector<std::uint32_t> usable;
  usable.reserve(points.size());
  CancelCheck cancel_check(run);
  for (std::size_t i = 0; i < points.size(); ++i) {
    cancel_check.step();
    if (is_usable(points[i])) usable.push_back(static_cast<std::uint32_t>(i));
  }
  const Stages stages(run, {7, 1, 2});
  std::vector<CurvePlace> order = along_curve(
      usable.size(), [&](std::size_t i) { return points[usable[i]]; }, stages[0]);
  for (CurvePlace& place : order) place.index = usable[place.index];
  sort_by_position(points, &order, stages[1]);
  places_.assign(points.size(), kNowhere);
  positions_.reserve(order.size());
  std::vector<std::uint64_t> keys;
  keys.reserve(order.size());
  for (const CurvePlace& place : order) {
    cancel_check.step();
    const Vector3& point = points[place.index];
    if (positions_.empty() || positions_.back() != point) {
      positions_.push_back(point);
      keys.push_back(place.key);
    }
    places_[place.index] = static_cast<std::uint32_t>(positions_.size() - 1);
  }
  const auto box_of = [&](std::size_t i) { return Box{positions_[i], positions_[i]}; };
  tree_ = BoxTree(keys, kLeafPoints, box_of, stages[2]);
}

void NeighborSearch::find(std::uint32_t place, std::size_t count, Neighbors* found) const {
  const Vector3 point = positions_[place];
  found->clear(count);
  const auto may_be = [&](double squared, std::size_t) { return squared < found->worst_; };
  tree_.search(point, may_be, [&](std::size_t leaf) {
    const BoxTree::Node& node = tree_.nodes()[leaf];
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Vector3 offset = positions_[i] - point;
      const double square = dot(offset, offset);
      if (square < found->worst_) found->add(i, square);
    }
  });
}

std::uint32_t NeighborSearch::nearest(const Vector3& point, double squared) const {
  std::uint32_t found = kNowhere;
  if (tree_.is_empty()) return found;
  double least = squared;
  const auto may_be = [&](double square, std::size_t) { return square < least; };
  tree_.search(point, may_be, [&](std::size_t leaf) {
    const BoxTree::Node& node = tree_.nodes()[leaf];
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Vector3 offset = positions_[i] - point;
      const double square = dot(offset, offset);
      if (square < least) {
        least = square;
        found = i;
      }
    }
  });
  return found;
}

}  // namespace prefilter
