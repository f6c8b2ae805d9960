// SPDX-License-Identifier: GPL-3.0-or-later

// Half-edge collapses, those first that move the surface least by the quadric error of Garland and
// Heckbert. The quadrics only say in which order: what bounds the distance is that removed vertices
// are kept as points of the triangle that they are near to, and measured again whenever that
// triangle changes. Where the surface is so flat that a removal hardly moves it, a bound that adds
// up does instead of a point.
#include "prefilter/remesh/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <span>
#include <utility>

#include "prefilter/remesh/measured_triangle.h"
#include "prefilter/remesh/quadric.h"

namespace prefilter {
namespace {

// Shares of the tolerance: what may add up without points; what is too little for crossings of
// edges to become points.
constexpr double kAddedUp = 0.15;
constexpr double kCrossing = 0.1;
// Vertices with more neighbours than this stay.
constexpr std::size_t kMostNeighbours = 64;
constexpr int kMostTries = 4;
constexpr double kLeastCosine = 0.8660254037844386;  // 30 degrees
constexpr double kSliverLeastCosine = 0.5;           // 60 degrees
constexpr double kSliver = 0.1;                      // height over longest side
constexpr double kLeastHeight = 1.0;                 // of triangles, in tolerances
constexpr double kLargestCost = 16.0;                // squared distance from planes
constexpr double kLengthWeight = 1e-6;
constexpr double kBentCosine = 0.85;  // 32 degrees
// Of the angle between two triangles: how high the edge between them may rise over what lies
// between points as far apart as that.
constexpr double kRise = 0.0625;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Candidate {
  double cost;
  std::size_t spoke;
};

// The triangles around a vertex, counter-clockwise: triangle i has the neighbours i and i + 1.
struct Ring {
  std::size_t size = 0;
  std::array<std::int32_t, kMostNeighbours> vertices;
  std::array<std::int32_t, kMostNeighbours> triangles;
  std::array<std::uint8_t, kMostNeighbours> corners;  // of the triangles, where the vertex is
  std::array<bool, kMostNeighbours> is_crease;
  std::size_t crease_count = 0;

  std::size_t next(std::size_t i) const { return i + 1 == size ? 0 : i + 1; }
  std::size_t before(std::size_t i) const { return i == 0 ? size - 1 : i - 1; }
};

// What a collapse that may be made does to what is known of the surface given up.
struct Outcome {
  double error = 0.0;
  double deviation = 0.0;
  double crease_error = 0.0;
  double crease_moved = 0.0;
  bool adds_points = false;
};

class Decimator {
 public:
  explicit Decimator(Patch* patch) : patch_(*patch) {}

  void run() {
    link();
    sum_quadrics();
    const auto count = static_cast<std::int32_t>(patch_.positions.size());
    slots_.assign(patch_.positions.size(), 0);
    is_queued_.assign(patch_.positions.size(), 0);
    patch_.targets.assign(patch_.positions.size(), -1);
    for (std::int32_t v = 0; v < count; ++v) {
      if ((flag(v) & Patch::kWaiting) != 0) enqueue(v);
    }
    while (!queue_.empty()) {
      const Queued next = queue_.top();
      queue_.pop();
      is_queued_[index(next.vertex)] = 0;
      try_to_remove(next);
    }
  }

 private:
  struct Queued {
    float cost;
    std::int32_t vertex;
    bool operator<(const Queued& other) const {  // the cheapest on top
      if (cost != other.cost) return cost > other.cost;
      return vertex > other.vertex;
    }
  };

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  const Vector3& point(std::int32_t v) const { return patch_.positions[index(v)]; }
  std::uint8_t flag(std::int32_t v) const { return patch_.flags[index(v)]; }
  bool is_shared(std::int32_t v) const { return (flag(v) & Patch::kShared) != 0; }
  PatchTriangle& triangle(std::int32_t t) { return patch_.triangles[index(t)]; }
  const PatchTriangle& triangle(std::int32_t t) const { return patch_.triangles[index(t)]; }

  // The corners of each vertex, in circles.
  void link() {
    first_corners_.assign(patch_.positions.size(), -1);
    next_corners_.resize(3 * patch_.triangles.size());
    counts_.assign(patch_.positions.size(), 0);
    for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t v = index(patch_.triangles[t].corners[i]);
        const auto corner = static_cast<std::int32_t>(3 * t + i);
        std::int32_t& first = first_corners_[v];
        if (first < 0) {
          first = corner;
          next_corners_[index(corner)] = corner;
        } else {
          next_corners_[index(corner)] = next_corners_[index(first)];
          next_corners_[index(first)] = corner;
        }
        ++counts_[v];
      }
    }
  }

  template <typename Visit>
  void for_corners(std::int32_t v, const Visit& visit) const {
    const std::int32_t first = first_corners_[index(v)];
    std::int32_t corner = first;
    do {
      visit(corner / 3, corner % 3);
      corner = next_corners_[index(corner)];
    } while (corner != first);
  }

  void sum_quadrics() {
    quadrics_.assign(patch_.positions.size(), {});
    for (const PatchTriangle& t : patch_.triangles) {
      const Vector3& a = point(t.corners[0]);
      const Vector3 normal = cross(point(t.corners[1]) - a, point(t.corners[2]) - a);
      const double area = length(normal);
      if (!(area > 0.0)) continue;
      const Vector3 unit = (1.0 / area) * normal;
      const double offset = -dot(unit, a);
      for (const std::int32_t v : t.corners) quadrics_[index(v)].add_plane(unit, offset, area);
    }
  }

  bool find_ring(std::int32_t u, Ring* ring) {
    const auto count = static_cast<std::size_t>(counts_[index(u)]);
    if (count < 3 || count > kMostNeighbours) return false;
    std::array<std::int32_t, kMostNeighbours> triangles;
    std::array<std::uint8_t, kMostNeighbours> corners;
    std::size_t found = 0;
    for_corners(u, [&](std::int32_t t, std::int32_t corner) {
      triangles[found] = t;
      corners[found] = static_cast<std::uint8_t>(corner);
      slots_[index(triangle(t).corners[index((corner + 1) % 3)])] =
          static_cast<std::int32_t>(found);
      ++found;
    });
    std::size_t at = 0;
    ring->size = count;
    ring->crease_count = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const PatchTriangle& t = triangle(triangles[at]);
      const std::size_t corner = corners[at];
      ring->triangles[i] = triangles[at];
      ring->corners[i] = corners[at];
      ring->vertices[i] = t.corners[(corner + 1) % 3];
      ring->is_crease[i] = ((t.creases >> corner) & 1U) != 0;
      ring->crease_count += ring->is_crease[i] ? 1 : 0;
      at = index(slots_[index(t.corners[(corner + 2) % 3])]);
      if (at == 0) return i + 1 == count;  // otherwise there are several fans
    }
    return false;
  }

  // Infinite where there is no point in trying.
  double cost_of(std::int32_t u, std::int32_t v) const {
    const double cost = quadrics_[index(u)].mean_at(point(v));
    if (!(cost < kLargestCost)) return kInfinity;
    return cost + kLengthWeight * squared_length(point(v) - point(u));
  }

  static bool may_follow(const Ring& ring, std::size_t spoke) {
    if (ring.crease_count == 0) return true;
    return ring.crease_count <= 2 && ring.is_crease[spoke];
  }

  bool is_removable(std::int32_t v) const {
    return (flag(v) & (Patch::kShared | Patch::kKept)) == 0;
  }

  // Puts a vertex that is not in the queue there, where it may be removable.
  void enqueue(std::int32_t u) {
    if (!is_removable(u)) return;
    double least = kInfinity;
    for_corners(u, [&](std::int32_t t, std::int32_t corner) {
      least = std::min(least, cost_of(u, triangle(t).corners[index((corner + 1) % 3)]));
    });
    if (!(least < kInfinity)) return;
    queue_.push({static_cast<float>(least), u});
    is_queued_[index(u)] = 1;
  }

  void try_to_remove(const Queued& queued) {
    const std::int32_t u = queued.vertex;
    if (counts_[index(u)] == 0 || !find_ring(u, &ring_)) return;
    std::array<Candidate, kMostNeighbours> candidates;
    std::size_t count = 0;
    for (std::size_t i = 0; i < ring_.size; ++i) {
      if (!may_follow(ring_, i)) continue;
      const double cost = cost_of(u, ring_.vertices[i]);
      if (cost < kInfinity) candidates[count++] = {cost, i};
    }
    if (count == 0) return;
    const auto cheaper = [](const Candidate& a, const Candidate& b) {
      return a.cost != b.cost ? a.cost < b.cost : a.spoke < b.spoke;
    };
    const std::size_t tries = std::min<std::size_t>(count, kMostTries);
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(tries),
                      candidates.begin() + static_cast<std::ptrdiff_t>(count), cheaper);
    // Its surroundings have changed; others may come before it now.
    if (!queue_.empty() && candidates[0].cost > 1.5 * queued.cost + 1e-12 &&
        candidates[0].cost > queue_.top().cost) {
      queue_.push({static_cast<float>(candidates[0].cost), u});
      is_queued_[index(u)] = 1;
      return;
    }
    prepare(u);
    for (std::size_t i = 0; i < tries; ++i) {
      Outcome outcome;
      if (!may_collapse(u, candidates[i].spoke, &outcome)) continue;
      collapse(u, candidates[i].spoke, outcome);
      return;
    }
  }

  // What is the same for all candidates of a vertex.
  void prepare(std::int32_t u) {
    ring_error_ = 0.0;
    ring_deviation_ = 0.0;
    has_points_ = false;
    least_height_ = kLeastHeight * kLeastHeight;
    const Vector3& at = point(u);
    for (std::size_t i = 0; i < ring_.size; ++i) {
      const PatchTriangle& t = triangle(ring_.triangles[i]);
      ring_error_ = std::max(ring_error_, static_cast<double>(t.error));
      ring_deviation_ = std::max(ring_deviation_, static_cast<double>(t.deviation));
      has_points_ = has_points_ || t.first_point >= 0;
      const Vector3 p = point(ring_.vertices[i]) - at;
      const Vector3 q = point(ring_.vertices[ring_.next(i)]) - at;
      normals_[i] = cross(p, q);
      squared_normals_[i] = squared_length(normals_[i]);
      const double longest =
          std::max({squared_length(p), squared_length(q), squared_length(q - p)});
      is_sliver_[i] = !(squared_normals_[i] > kSliver * kSliver * longest * longest);
      least_height_ = std::min(least_height_, longest > 0.0 ? squared_normals_[i] / longest : 0.0);
    }
    // Sides of creases, with the normals of each.
    std::size_t start = 0;
    while (start < ring_.size && !ring_.is_crease[start]) ++start;
    if (start == ring_.size) start = 0;
    std::size_t sector = 0;
    sector_normals_[0] = sector_normals_[1] = {};
    for (std::size_t i = 0; i < ring_.size; ++i) {
      const std::size_t at_triangle = (start + i) % ring_.size;
      if (i > 0 && ring_.is_crease[at_triangle] && ring_.crease_count == 2) sector = 1;
      sectors_[at_triangle] = static_cast<std::uint8_t>(sector);
      sector_normals_[sector] = sector_normals_[sector] + normals_[at_triangle];
    }
    double low = 0.0;
    double high = 0.0;
    range_ = 0.0;
    is_bent_ = false;
    for (std::size_t s = 0; s < 2; ++s) {
      const double size = std::sqrt(squared_length(sector_normals_[s]));
      if (!(size > 0.0)) {
        sector_normals_[s] = {};
        is_bent_ = is_bent_ || s == 0 || ring_.crease_count == 2;
        continue;
      }
      sector_normals_[s] = (1.0 / size) * sector_normals_[s];
      low = high = 0.0;
      for (std::size_t i = 0; i < ring_.size; ++i) {
        if (sectors_[i] != s) continue;
        is_bent_ = is_bent_ || !(dot(sector_normals_[s], normals_[i]) >=
                                 kBentCosine * std::sqrt(squared_normals_[i]));
        for (const std::size_t j : {i, ring_.next(i)}) {
          const double height = dot(sector_normals_[s], point(ring_.vertices[j]) - at);
          low = std::min(low, height);
          high = std::max(high, height);
        }
      }
      range_ = std::max(range_, high - low);
    }
  }

  // Whether what comes out is a two-manifold again, whatever other patches do to the vertices that
  // they share with this one.
  bool is_sound(std::int32_t u, std::size_t spoke) {
    const std::int32_t v = ring_.vertices[spoke];
    const std::size_t after = ring_.next(spoke);
    const std::size_t before = ring_.before(spoke);
    if (!is_shared(v) && ring_.size + static_cast<std::size_t>(counts_[index(v)]) < 7) {
      return false;
    }
    for (const std::size_t i : {after, before}) {
      const std::int32_t w = ring_.vertices[i];
      if (counts_[index(w)] < (is_shared(w) ? 3 : 4)) return false;
      if (is_shared(v) && is_shared(w) && ring_.is_crease[i]) return false;
    }
    for (std::size_t i = 0; i < ring_.size; ++i) {
      if (i == spoke || i == after || i == before) continue;
      if (is_shared(v) && is_shared(ring_.vertices[i])) return false;
      slots_[index(ring_.vertices[i])] = -1 - u;
    }
    bool is_linked = false;
    for_corners(v, [&](std::int32_t t, std::int32_t corner) {
      const auto& corners = triangle(t).corners;
      for (const std::int32_t other :
           {corners[index((corner + 1) % 3)], corners[index((corner + 2) % 3)]}) {
        is_linked = is_linked || slots_[index(other)] == -1 - u;
      }
    });
    for (std::size_t i = 0; i < ring_.size; ++i) slots_[index(ring_.vertices[i])] = 0;
    return !is_linked;
  }

  bool side_is_crease(std::size_t ring_triangle, int offset) const {
    const PatchTriangle& t = triangle(ring_.triangles[ring_triangle]);
    return ((t.creases >> ((ring_.corners[ring_triangle] + offset) % 3)) & 1U) != 0;
  }

  bool keeps_creases(std::int32_t u, std::size_t spoke, Outcome* outcome) const {
    const std::size_t before = ring_.before(spoke);
    // Triangle `spoke` is (u, v, after), `before` is (u, before, v).
    if (side_is_crease(spoke, 1) && ring_.is_crease[ring_.next(spoke)]) return false;
    if (side_is_crease(before, 1) && ring_.is_crease[before]) return false;
    if (ring_.crease_count == 0) return true;
    const Vector3& at = point(u);
    const Vector3& to = point(ring_.vertices[spoke]);
    double largest = crease_error(spoke);
    double moved = length(to - at);
    for (std::size_t i = 0; i < ring_.size; ++i) {
      if (i == spoke || !ring_.is_crease[i]) continue;
      largest = std::max(largest, crease_error(i));
      const Vector3& from = point(ring_.vertices[i]);
      if (!(dot(to - at, at - from) > 0.0)) return false;
      moved = std::sqrt(squared_distance_to_segment(at, from, to));
    }
    outcome->crease_moved = moved;
    outcome->crease_error = largest + moved;
    return outcome->crease_error <= 1.0;
  }

  double crease_error(std::size_t spoke) const {
    const PatchTriangle& t = triangle(ring_.triangles[spoke]);
    return static_cast<double>(t.crease_errors[ring_.corners[spoke]]);
  }

  // The new triangles, in place of those of the ring; false where one turns or is too thin.
  bool make_triangles(std::size_t spoke) {
    const std::size_t before = ring_.before(spoke);
    const Vector3& to = point(ring_.vertices[spoke]);
    for (std::size_t i = 0; i < ring_.size; ++i) {
      if (i == spoke || i == before) continue;
      const Vector3& p = point(ring_.vertices[i]);
      const Vector3& q = point(ring_.vertices[ring_.next(i)]);
      MeasuredTriangle& made = made_[i];
      made = MeasuredTriangle(to, p, q);
      const double longest =
          std::max({squared_length(p - to), squared_length(q - to), squared_length(q - p)});
      if (!(made.squared_normal >= least_height_ * longest && made.squared_normal > 0.0)) {
        return false;
      }
      const bool is_free = is_sliver_[i];
      const double along = dot(made.normal, is_free ? sector_normals_[sectors_[i]] : normals_[i]);
      const double least = is_free ? kSliverLeastCosine * kSliverLeastCosine
                                   : kLeastCosine * kLeastCosine * squared_normals_[i];
      if (!(along > 0.0 && along * along >= least * made.squared_normal)) return false;
    }
    return true;
  }

  // The ring's triangle whose new one is nearest to a point, where that is near enough; -1 where
  // none is. The one that it was near to comes first.
  std::int32_t find_near(const Vector3& p, std::size_t hint, std::size_t spoke, double most) {
    const std::size_t before = ring_.before(spoke);
    const double accepted = 0.25 * most;
    double least = kInfinity;
    std::size_t best = hint;
    if (hint != spoke && hint != before) least = made_[hint].squared_distance(p);
    for (std::size_t i = 0; i < ring_.size && least > accepted; ++i) {
      if (i == spoke || i == before || i == hint) continue;
      const double squared = made_[i].squared_distance(p);
      if (squared < least) {
        least = squared;
        best = i;
      }
    }
    if (!(least <= most)) return -1;
    farthest_ = std::max(farthest_, least);
    return static_cast<std::int32_t>(best);
  }

  // How high edges of the new triangles may rise over what lies between points.
  double rise(std::size_t spoke) const {
    const std::size_t before = ring_.before(spoke);
    double least_cosine = 1.0;
    std::size_t last = spoke;
    for (std::size_t i = ring_.next(spoke); i != before; i = ring_.next(i)) {
      const double size = made_[i].squared_normal;
      const double turned =
          dot(made_[i].normal, normals_[i]) / std::sqrt(size * squared_normals_[i]);
      if (!is_sliver_[i]) least_cosine = std::min(least_cosine, turned);
      if (last != spoke && !ring_.is_crease[i]) {
        least_cosine = std::min(least_cosine, dot(made_[i].normal, made_[last].normal) /
                                                  std::sqrt(size * made_[last].squared_normal));
      }
      last = i;
    }
    return kRise * patch_.spacing * std::sqrt(std::max(0.0, 2.0 - 2.0 * least_cosine));
  }

  // The largest distance between old and new edges where they cross; -1 where it is above `most`.
  double measure_crossings(std::int32_t u, std::size_t spoke, double most) {
    crossings_.clear();
    const Vector3& from = point(u);
    const Vector3& to = point(ring_.vertices[spoke]);
    const std::size_t before = ring_.before(spoke);
    const std::size_t after = ring_.next(spoke);
    const Vector3 apart = to - from;
    double largest = 0.0;
    for (std::size_t i = 0; i < ring_.size; ++i) {
      if (i == spoke) continue;
      const Vector3 old_side = point(ring_.vertices[i]) - from;
      for (std::size_t j = 0; j < ring_.size; ++j) {
        if (j == spoke || j == before || j == after || j == i || !share_sector(i, j)) continue;
        const Vector3 new_side = point(ring_.vertices[j]) - to;
        const Vector3 normal = cross(old_side, new_side);
        const double size = squared_length(normal);
        if (!(size > 0.0)) continue;
        const double along_old = dot(cross(apart, new_side), normal);
        const double along_new = dot(cross(apart, old_side), normal);
        if (!(along_old > 0.0 && along_old < size && along_new > 0.0 && along_new < size)) continue;
        const double gap = std::abs(dot(apart, normal)) / std::sqrt(size);
        if (!(gap <= most)) return -1.0;
        largest = std::max(largest, gap);
        if (gap > kCrossing) crossings_.push_back(from + (along_old / size) * old_side);
      }
    }
    return largest;
  }

  // Where the ring has no direction from which it is seen as a whole, crossings are not all: the
  // largest distance of places on old triangles from new ones and of new ones from old ones; -1
  // where it is above `most`.
  double measure_places(std::int32_t u, std::size_t spoke, double most) {
    const std::size_t before = ring_.before(spoke);
    const Vector3& from = point(u);
    const Vector3& to = point(ring_.vertices[spoke]);
    for (std::size_t i = 0; i < ring_.size; ++i) {
      old_[i] =
          MeasuredTriangle(from, point(ring_.vertices[i]), point(ring_.vertices[ring_.next(i)]));
    }
    double largest = 0.0;
    const auto is_near = [&](const Vector3& p, bool is_old) {
      double least = kInfinity;
      for (std::size_t i = 0; i < ring_.size; ++i) {
        if (is_old && (i == spoke || i == before)) continue;
        least = std::min(least, (is_old ? made_ : old_)[i].squared_distance(p));
      }
      largest = std::max(largest, least);
      if (is_old && least > kCrossing * kCrossing) crossings_.push_back(p);
      return least <= most * most;
    };
    for (std::size_t i = 0; i < ring_.size; ++i) {
      const Vector3& p = point(ring_.vertices[i]);
      const Vector3& q = point(ring_.vertices[ring_.next(i)]);
      const bool is_made = i != spoke && i != before;
      const Vector3 side = p - from;
      const Vector3 other = p - to;
      for (const double along : {0.25, 0.5, 0.75}) {
        if (!is_near(from + along * side, true)) return -1.0;
        if (is_made && !is_near(to + along * other, false)) return -1.0;
      }
      if (!is_near((1.0 / 3.0) * (from + p + q), true)) return -1.0;
      if (is_made && !is_near((1.0 / 3.0) * (to + p + q), false)) return -1.0;
    }
    return std::sqrt(largest);
  }

  // Whether the edges to two neighbours are on one side of a crease.
  bool share_sector(std::size_t i, std::size_t j) const {
    if (ring_.crease_count < 2) return true;
    const std::uint8_t i_after = sectors_[i];
    const std::uint8_t i_before = sectors_[ring_.before(i)];
    const std::uint8_t j_after = sectors_[j];
    const std::uint8_t j_before = sectors_[ring_.before(j)];
    return i_after == j_after || i_after == j_before || i_before == j_after || i_before == j_before;
  }

  bool may_collapse(std::int32_t u, std::size_t spoke, Outcome* outcome) {
    if (!keeps_creases(u, spoke, outcome) || !make_triangles(spoke) || !is_sound(u, spoke)) {
      return false;
    }
    places_.clear();
    outcome->error = ring_error_;
    outcome->deviation = ring_deviation_;
    outcome->adds_points = false;
    const double bound = ring_error_ + range_ + outcome->crease_moved;
    if (!has_points_ && !is_bent_ && bound <= kAddedUp) {
      outcome->error = bound;
      return true;
    }
    const double most = 1.0 - ring_error_;
    const double squared_most = most * most;
    farthest_ = 0.0;
    const std::int32_t near = find_near(point(u), spoke, spoke, squared_most);
    if (near < 0) return false;
    double gap = measure_crossings(u, spoke, most);
    if (gap < 0.0) return false;
    if (is_bent_) {
      const double other = measure_places(u, spoke, most);
      if (other < 0.0) return false;
      gap = std::max(gap, other);
    }
    if (!has_points_) {
      const double moved = std::max(gap, std::sqrt(made_[index(near)].squared_distance(point(u))));
      if (ring_error_ + moved <= kAddedUp) {
        outcome->error = ring_error_ + moved;
        return true;
      }
    }
    for (const Vector3& p : crossings_) {
      const std::int32_t i = find_near(p, spoke, spoke, squared_most);
      if (i < 0) return false;
      places_.push_back({-1, i});
    }
    for (std::size_t i = 0; has_points_ && i < ring_.size; ++i) {
      for (std::int32_t p = triangle(ring_.triangles[i]).first_point; p >= 0;
           p = patch_.points[index(p)].next) {
        const std::int32_t place =
            find_near(patch_.points[index(p)].position, i, spoke, squared_most);
        if (place < 0) return false;
        places_.push_back({p, place});
      }
    }
    outcome->deviation = std::min(ring_deviation_ + gap, std::sqrt(farthest_) + rise(spoke));
    if (!(outcome->deviation <= most)) return false;
    places_.push_back({-1, near});
    outcome->adds_points = true;
    return true;
  }

  void place_points(std::int32_t u, const Outcome& outcome) {
    if (!outcome.adds_points) return;
    for (std::size_t i = 0; i < ring_.size; ++i) triangle(ring_.triangles[i]).first_point = -1;
    std::size_t crossing = 0;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      std::int32_t p = places_[k].point;
      if (p < 0) {
        const bool is_vertex = k + 1 == places_.size();
        p = static_cast<std::int32_t>(patch_.points.size());
        patch_.points.push_back({is_vertex ? point(u) : crossings_[crossing++], -1});
      }
      std::int32_t& first = triangle(ring_.triangles[index(places_[k].triangle)]).first_point;
      patch_.points[index(p)].next = first;
      first = p;
    }
  }

  // Where creases of the two sides that become one go: to both triangles beside it.
  void join_sides(std::int32_t v, std::size_t dead, std::size_t dead_side_u,
                  std::size_t dead_side_v, std::size_t beside, std::size_t beside_side,
                  std::int32_t w, const Outcome& outcome) {
    const PatchTriangle gone = triangle(ring_.triangles[dead]);
    PatchTriangle& kept = triangle(ring_.triangles[beside]);
    const bool from_u = ((gone.creases >> dead_side_u) & 1U) != 0;
    const bool from_v = ((gone.creases >> dead_side_v) & 1U) != 0;
    if (from_v) {
      kept.creases = static_cast<std::uint8_t>(kept.creases | (1U << beside_side));
      kept.crease_errors[beside_side] = gone.crease_errors[dead_side_v];
    }
    if (!from_u) return;
    for_corners(v, [&](std::int32_t t, std::int32_t corner) {
      PatchTriangle& other = triangle(t);
      if (t == ring_.triangles[dead]) return;
      for (const std::int32_t side : {corner, (corner + 2) % 3}) {
        const std::int32_t start = other.corners[index(side)];
        const std::int32_t end = other.corners[index((side + 1) % 3)];
        if ((start == v && end == w) || (start == w && end == v)) {
          other.creases = static_cast<std::uint8_t>(other.creases | (1U << side));
          other.crease_errors[index(side)] = static_cast<float>(outcome.crease_error);
        }
      }
    });
  }

  void collapse(std::int32_t u, std::size_t spoke, const Outcome& outcome) {
    const std::int32_t v = ring_.vertices[spoke];
    const std::size_t before = ring_.before(spoke);
    const std::size_t after = ring_.next(spoke);
    place_points(u, outcome);
    {
      const std::size_t c = ring_.corners[spoke];  // (u, v, after): beside it is triangle `after`
      join_sides(v, spoke, (c + 2) % 3, (c + 1) % 3, after, ring_.corners[after],
                 ring_.vertices[after], outcome);
    }
    {
      const std::size_t c = ring_.corners[before];  // (u, before, v): beside it is the one before
      const std::size_t beside = ring_.before(before);
      join_sides(v, before, c, (c + 1) % 3, beside, (ring_.corners[beside] + 2) % 3,
                 ring_.vertices[before], outcome);
    }
    for (std::size_t i = 0; i < ring_.size; ++i) {
      PatchTriangle& t = triangle(ring_.triangles[i]);
      t.error = static_cast<float>(outcome.error);
      t.deviation = static_cast<float>(outcome.deviation);
      t.is_new = true;
      if (ring_.crease_count > 0 && i != spoke && ring_.is_crease[i]) {
        t.crease_errors[ring_.corners[i]] = static_cast<float>(outcome.crease_error);
        const std::size_t other = ring_.before(i);
        triangle(ring_.triangles[other]).crease_errors[(ring_.corners[other] + 2U) % 3] =
            static_cast<float>(outcome.crease_error);
      }
      t.corners[ring_.corners[i]] = v;
    }
    patch_.targets[index(u)] = v;
    relink(u, v, spoke, before, after);
    quadrics_[index(v)].add(quadrics_[index(u)]);
    for (std::size_t i = 0; i < ring_.size; ++i) {
      const std::int32_t w = ring_.vertices[i];
      if (is_queued_[index(w)] == 0) enqueue(w);
    }
  }

  void drop_corner(std::int32_t v, std::int32_t t) {
    std::int32_t before = first_corners_[index(v)];
    while (next_corners_[index(before)] / 3 != t) before = next_corners_[index(before)];
    const std::int32_t corner = next_corners_[index(before)];
    next_corners_[index(before)] = next_corners_[index(corner)];
    first_corners_[index(v)] = before;
    --counts_[index(v)];
  }

  void relink(std::int32_t u, std::int32_t v, std::size_t spoke, std::size_t before,
              std::size_t after) {
    for (const std::size_t dead : {spoke, before}) {
      const std::int32_t t = ring_.triangles[dead];
      drop_corner(u, t);
      drop_corner(v, t);
      drop_corner(ring_.vertices[dead == spoke ? after : before], t);
      triangle(t).corners.fill(v);
      triangle(t).first_point = -1;
    }
    const std::int32_t of_u = first_corners_[index(u)];
    const std::int32_t of_v = first_corners_[index(v)];
    std::swap(next_corners_[index(of_u)], next_corners_[index(of_v)]);
    counts_[index(v)] += counts_[index(u)];
    counts_[index(u)] = 0;
    first_corners_[index(u)] = -1;
  }

  struct Place {
    std::int32_t point;
    std::int32_t triangle;
  };

  Patch& patch_;
  std::vector<std::int32_t> first_corners_;
  std::vector<std::int32_t> next_corners_;
  std::vector<std::int32_t> counts_;
  std::vector<Quadric> quadrics_;
  std::vector<std::int32_t> slots_;
  std::vector<std::uint8_t> is_queued_;
  std::priority_queue<Queued> queue_;

  // Of the vertex in hand.
  Ring ring_;
  std::array<Vector3, kMostNeighbours> normals_;
  std::array<double, kMostNeighbours> squared_normals_;
  std::array<bool, kMostNeighbours> is_sliver_;
  std::array<std::uint8_t, kMostNeighbours> sectors_;
  std::array<Vector3, 2> sector_normals_;
  std::array<MeasuredTriangle, kMostNeighbours> made_;
  std::array<MeasuredTriangle, kMostNeighbours> old_;
  double ring_error_ = 0.0;
  double ring_deviation_ = 0.0;
  double range_ = 0.0;
  bool is_bent_ = false;
  double least_height_ = 0.0;  // squared, and at most that of kLeastHeight
  bool has_points_ = false;
  double farthest_ = 0.0;  // of the points placed, squared
  std::vector<Place> places_;
  std::vector<Vector3> crossings_;
};

}  // namespace

void Patch::simplify() { Decimator(this).run(); }

}  // namespace prefilter
