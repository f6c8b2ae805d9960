#include "prefilter/spatial/nearest_neighbours.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/spatial/curve_order.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeafPoints = 8;
constexpr std::int64_t kPointsPerTask = 1024;
constexpr double kLargest = 1e150;

bool is_usable(const Vector3& point) {
  return std::abs(point[0]) <= kLargest && std::abs(point[1]) <= kLargest &&
         std::abs(point[2]) <= kLargest;
}

// The nearest ones that were found so far, from near to far.
class Nearest {
 public:
  explicit Nearest(std::size_t count) : places_(count), squares_(count) {}

  void clear() {
    found_ = 0;
    worst_ = std::numeric_limits<double>::infinity();
  }
  double worst() const { return worst_; }
  std::span<const std::uint32_t> places() const { return {places_.data(), found_}; }
  std::span<const double> squares() const { return {squares_.data(), found_}; }

  void add(std::uint32_t place, double square) {
    if (found_ < places_.size()) ++found_;
    std::size_t at = found_ - 1;
    while (at > 0 && squares_[at - 1] > square) {
      squares_[at] = squares_[at - 1];
      places_[at] = places_[at - 1];
      --at;
    }
    squares_[at] = square;
    places_[at] = place;
    if (found_ == places_.size()) worst_ = squares_[found_ - 1];
  }

 private:
  std::vector<std::uint32_t> places_;
  std::vector<double> squares_;
  std::size_t found_ = 0;
  double worst_ = 0.0;
};

// Identical points, which have the same key, next to each other.
void sort_by_position(std::span<const Vector3> points, std::vector<CurvePlace>* order,
                      const Progress& progress, int threads) {
  const auto is_before = [&](const CurvePlace& a, const CurvePlace& b) {
    const Vector3& p = points[a.index];
    const Vector3& q = points[b.index];
    return p != q ? p < q : a.index < b.index;
  };
  constexpr std::size_t kMany = 1U << 15;
  std::vector<CurvePlace> copies;
  for (std::size_t begin = 0, end = 0; begin < order->size(); begin = end) {
    while (end < order->size() && (*order)[end].key == (*order)[begin].key) ++end;
    if (end == begin + 1) continue;
    const auto first = order->begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order->begin() + static_cast<std::ptrdiff_t>(end);
    if (end - begin < kMany) {
      std::sort(first, last, is_before);
    } else {
      copies.assign(first, last);
      sort_in_parallel(&copies, progress, threads, is_before);
      std::copy(copies.begin(), copies.end(), first);
    }
  }
}

}  // namespace

NeighbourSearch::NeighbourSearch(std::span<const Vector3> points, const Progress& progress,
                                 int threads) {
  if (points.size() >= kNowhere) throw_invalid("points: too many; 2^32 - 1 are the most");
  std::vector<std::uint32_t> usable;
  usable.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_usable(points[i])) usable.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<CurvePlace> order = along_curve(
      usable.size(), [&](std::size_t i) { return points[usable[i]]; }, progress.part(0.0, 0.7),
      threads);
  for (CurvePlace& place : order) place.index = usable[place.index];
  sort_by_position(points, &order, progress.part(0.7, 0.8), threads);
  places_.assign(points.size(), kNowhere);
  positions_.reserve(order.size());
  std::vector<std::uint64_t> keys;
  keys.reserve(order.size());
  for (const CurvePlace& place : order) {
    const Vector3& point = points[place.index];
    if (positions_.empty() || positions_.back() != point) {
      positions_.push_back(point);
      keys.push_back(place.key);
    }
    places_[place.index] = static_cast<std::uint32_t>(positions_.size() - 1);
  }
  const auto box_of = [&](std::size_t i) { return Box{positions_[i], positions_[i]}; };
  tree_ = BoxTree(keys, kLeafPoints, box_of, progress.part(0.8, 1.0));
}

void NeighbourSearch::find(std::size_t count, const Visit& visit, const Progress& progress,
                           int threads) const {
  const auto find_some = [&](std::int64_t begin, std::int64_t end) {
    Nearest nearest(std::min(count, positions_.size()));
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Vector3 point = positions_[i];
      nearest.clear();
      tree_.search(
          point, [&](double squared, std::size_t) { return squared < nearest.worst(); },
          [&](std::size_t node) {
            for (std::uint32_t place = tree_.nodes()[node].begin; place < tree_.nodes()[node].end;
                 ++place) {
              const Vector3 offset = positions_[place] - point;
              const double square = dot(offset, offset);
              if (square < nearest.worst()) nearest.add(static_cast<std::uint32_t>(place), square);
            }
          });
      visit(static_cast<std::uint32_t>(i), nearest.places(), nearest.squares());
    }
  };
  parallel_ranges(static_cast<std::int64_t>(positions_.size()), kPointsPerTask, threads, progress,
                  find_some);
}

}  // namespace prefilter
