// SPDX-License-Identifier: GPL-3.0-or-later

// The sum of all winding numbers at a point is the number of outlines that contain it. A segment
// and its reverse cancel in this sum, so the remaining segments have the same winding numbers.
// Where these never exceed 1, no point is inside two outlines.
#include "prefilter/shapes/outline/shared_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "prefilter/shapes/outline/resolve_within_budget.h"

namespace prefilter {
namespace {

// A segment with its control points.
struct Edge {
  const Point2* points = nullptr;
  const Outline::Segment* segment = nullptr;

  std::int32_t degree() const { return segment->degree; }
  double weight() const { return segment->weight; }
  const Point2& begin() const { return points[0]; }
  const Point2& end() const { return points[degree()]; }
  bool is_reverse_of(const Edge& other) const {
    if (degree() != other.degree() || weight() != other.weight()) return false;
    for (std::int32_t i = 0; i <= degree(); ++i) {
      if (!(points[i] == other.points[degree() - i])) return false;
    }
    return true;
  }
};

constexpr Outline::Segment kLine;

std::uint64_t mix_bits(std::uint64_t hash) {
  hash ^= hash >> 32;
  hash *= 0x9e3779b97f4a7c15U;
  return hash ^ hash >> 29;
}

std::uint64_t hash_of(const Point2& point) {
  // Adding 0.0 makes -0.0 equal to 0.0.
  return mix_bits(std::bit_cast<std::uint64_t>(point.x + 0.0) +
                  mix_bits(std::bit_cast<std::uint64_t>(point.y + 0.0)));
}

class EdgeSet {
 public:
  // One allocation; growing in steps would write twice the memory.
  void reserve(std::size_t count) { edges_.reserve(count); }
  void add(const Outline& outline) {
    for (std::size_t c = 0; c < outline.contour_count(); ++c) {
      const auto segments = outline.contour(c);
      if (segments.empty()) continue;
      for (const Outline::Segment& segment : segments) {
        edges_.push_back({outline.controls(segment).data(), &segment});
      }
      const Point2& begin = outline.begin_of(c);
      if (edges_.back().end() == begin) continue;
      closing_.push_back({edges_.back().end(), begin});
      edges_.push_back({closing_.back().data(), &kLine});
    }
  }

  std::size_t size() const { return edges_.size(); }

  // Removes pairs of an edge and its reverse.
  void cancel() {
    const std::size_t size = std::bit_ceil(2 * edges_.size() + 1);
    std::vector<std::uint32_t> table(size, kFree);
    std::vector<std::uint8_t> is_cancelled(edges_.size(), 0);
    // Two outlines that share an edge mostly share the next one, too, which precedes it in the
    // other outline. Trying it first avoids a random access to the hash table.
    std::uint32_t expected = kFree;
    const auto cancels = [&](std::uint32_t i, std::uint32_t other) {
      if (is_cancelled[other] != 0 || !edges_[i].is_reverse_of(edges_[other])) return false;
      is_cancelled[other] = is_cancelled[i] = 1;
      expected = other > 0 ? other - 1 : kFree;
      return true;
    };
    for (std::uint32_t i = 0; i < edges_.size(); ++i) {
      if (expected != kFree && cancels(i, expected)) continue;
      expected = kFree;
      const Edge& edge = edges_[i];
      // The hash is symmetric in both ends.
      std::size_t place = mix_bits(hash_of(edge.begin()) + hash_of(edge.end())) & (size - 1);
      int probes = 0;
      for (; table[place] != kFree && probes < kMaxProbes; place = (place + 1) & (size - 1)) {
        ++probes;
        if (cancels(i, table[place])) break;
      }
      if (is_cancelled[i] == 0 && table[place] == kFree) table[place] = i;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (is_cancelled[i] == 0) edges_[kept++] = edges_[i];
    }
    edges_.resize(kept);
  }

  // Joins the edges to closed contours; nothing if they do not close.
  std::optional<Outline> joined_contours() {
    std::stable_sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
      return a.begin().x != b.begin().x ? a.begin().x < b.begin().x : a.begin().y < b.begin().y;
    });
    std::vector<std::uint8_t> is_used(edges_.size(), 0);
    Outline outline;
    for (std::size_t first = 0; first < edges_.size(); ++first) {
      if (is_used[first] != 0) continue;
      outline.move_to(edges_[first].begin());
      std::size_t at = first;
      while (true) {
        is_used[at] = 1;
        append(edges_[at], &outline);
        if (edges_[at].end() == edges_[first].begin()) break;
        at = unused_from(edges_[at].end(), is_used);
        if (at == edges_.size()) return std::nullopt;
      }
      outline.close();
    }
    return outline;
  }

 private:
  static constexpr std::uint32_t kFree = UINT32_MAX;
  // Tilings have few equal edges; more than these are not canceled.
  static constexpr int kMaxProbes = 64;

  static void append(const Edge& edge, Outline* outline) {
    if (edge.weight() > 0.0) {
      outline->conic_to(edge.points[1], edge.weight(), edge.points[2]);
    } else {
      outline->curve_to({edge.points + 1, static_cast<std::size_t>(edge.degree())});
    }
  }

  std::size_t unused_from(const Point2& point, const std::vector<std::uint8_t>& is_used) const {
    const auto first_edge =
        std::lower_bound(edges_.begin(), edges_.end(), point, [](const Edge& a, const Point2& b) {
          return a.begin().x != b.x ? a.begin().x < b.x : a.begin().y < b.y;
        });
    auto i = static_cast<std::size_t>(first_edge - edges_.begin());
    // Tilings have few edges at one point.
    constexpr std::size_t kMaxEdgesPerPoint = 32;
    const std::size_t end = std::min(edges_.size(), i + kMaxEdgesPerPoint);
    while (i < end && edges_[i].begin() == point && is_used[i] != 0) ++i;
    return i < end && edges_[i].begin() == point ? i : edges_.size();
  }

  std::vector<Edge> edges_;
  std::deque<std::array<Point2, 2>> closing_;
};

}  // namespace

bool have_disjoint_interiors(std::span<const Outline* const> outlines) {
  EdgeSet edges;
  std::size_t most = 0;
  for (const Outline* outline : outlines) {
    most += outline->segments().size() + outline->contour_count();
  }
  edges.reserve(most);
  for (const Outline* outline : outlines) edges.add(*outline);
  const std::size_t all = edges.size();
  edges.cancel();
  if (all == 0 || 4 * (all - edges.size()) < all) return false;
  const std::optional<Outline> left = edges.joined_contours();
  std::optional<Outline> changed;
  return left && resolve_within_budget(*left, FillRule::kNonzero, {}, &changed) && !changed;
}

}  // namespace prefilter
