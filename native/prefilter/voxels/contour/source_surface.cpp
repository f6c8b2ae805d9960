// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/source_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/curve_order.h"
#include "prefilter/geometry/spatial/triangle_pieces.h"
#include "prefilter/geometry/spatial/triangle_point.h"

namespace prefilter {
namespace {

constexpr double kBrickCells = 4.0;
constexpr double kSourceSurfaceReachCells = 2.5;  // radius of the vicinity of edges
constexpr double kContactCells = 1.0;             // radius in which parts may meet
constexpr double kSearchCells = 6.0;              // search radius around that vicinity
constexpr std::size_t kLeafItems = 4;
constexpr int kBrickBits = 21;
// Maximum length of borders in a brick, in cells; with more, or with very many parts, edges cannot
// be distinguished.
constexpr double kMostBorderCells = 64.0;
constexpr double kMostBricks = 64.0;  // in a triangle's box; with more, all bricks count

std::uint64_t brick_key(const std::array<std::int64_t, 3>& brick) {
  constexpr std::int64_t kBias = std::int64_t{1} << (kBrickBits - 1);
  std::uint64_t key = 0;
  for (const std::int64_t b : brick) {
    const std::int64_t kept = std::clamp(b + kBias, std::int64_t{0}, 2 * kBias - 1);
    key = (key << static_cast<unsigned>(kBrickBits)) | static_cast<std::uint64_t>(kept);
  }
  return key;
}

// The bricks that a box overlaps, clamped to the vicinity of the unit cube.
struct BrickRange {
  std::array<std::int64_t, 3> low;
  std::array<std::int64_t, 3> high;
  double count = 1.0;

  BrickRange(const Box& box, double margin, double brick) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = static_cast<std::int64_t>(
          std::floor(std::clamp((box.low[a] - margin), -1.0, 2.0) / brick));
      high[a] = static_cast<std::int64_t>(
          std::floor(std::clamp((box.high[a] + margin), -1.0, 2.0) / brick));
      count *= static_cast<double>(high[a] - low[a] + 1);
    }
  }

  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) visit(brick_key({x, y, z}));
      }
    }
  }
};

Box box_of(const Vector3& a, const Vector3& b) {
  Box box = kEmptyBox;
  box.include(a);
  box.include(b);
  return box;
}

Vector3 middle_of(const Box& box) { return 0.5 * (box.low + box.high); }

// Intersection of the segment from a to b with a triangle, as a share of the segment.
std::optional<double> meeting(const Vector3& a, const Vector3& b,
                              const std::array<Vector3, 3>& corners) {
  const Vector3 d = b - a;
  const Vector3 u = corners[1] - corners[0];
  const Vector3 v = corners[2] - corners[0];
  const Vector3 p = cross(d, v);
  const double det = dot(u, p);
  if (det == 0.0) return std::nullopt;
  const Vector3 s = a - corners[0];
  // Tolerance that keeps segments from passing between two triangles.
  constexpr double kSlack = 1e-9;
  const double x = dot(s, p) / det;
  if (!(x >= -kSlack && x <= 1.0 + kSlack)) return std::nullopt;
  const Vector3 q = cross(s, u);
  const double y = dot(d, q) / det;
  if (!(y >= -kSlack && x + y <= 1.0 + kSlack)) return std::nullopt;
  const double t = dot(v, q) / det;
  if (!(t >= 0.0 && t <= 1.0)) return std::nullopt;
  return t;
}

// The nearest point on a triangle.
Vector3 nearest_on(const std::array<Vector3, 3>& corners, const Vector3& point) {
  const Vector3 weights = nearest_weights(point, corners[0], corners[1], corners[2]);
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}
}  // namespace

SourceSurface::SourceSurface(std::span<const SourceMesh> sources, const RootFrame& frame,
                             double cell, const Run& run)
    : regions_(find_regions(sources, frame, cell, run.part(0.0, 0.6))),
      cell_(cell),
      brick_(kBrickCells * cell) {
  mark_borders(run.part(0.6, 0.65));
  if (regions_.part_count > 1) mark_meetings(run.part(0.65, 0.8));
  build_trees(run.part(0.8, 0.95));
  if (has_meetings()) find_rim_corners(run.part(0.95, 1.0));
}

void SourceSurface::mark_around(const Box& box) {
  BrickRange(box, kSourceSurfaceReachCells * cell_, brick_).for_each([&](std::uint64_t key) {
    near_bricks_.insert(key);
  });
}

void SourceSurface::mark_borders(const Run& run) {
  CancelCheck cancel_check(run);
  const auto& positions = regions_.positions;
  std::unordered_map<std::uint64_t, double> lengths;
  for (const RegionBorder& border : regions_.borders) {
    cancel_check.step();
    const Vector3 a = positions[static_cast<std::size_t>(border.ends[0])];
    const Vector3 d = positions[static_cast<std::size_t>(border.ends[1])] - a;
    const int steps = 1 + static_cast<int>(std::min(length(d) / brick_, 1e5));
    for (int i = 0; i < steps; ++i) {
      const Vector3 from = a + (static_cast<double>(i) / steps) * d;
      const Vector3 to = a + (static_cast<double>(i + 1) / steps) * d;
      mark_around(box_of(from, to));
      lengths[brick_of(0.5 * (from + to))] += length(to - from);
    }
  }
  for (const RegionCorner& corner : regions_.corners) {
    const Vector3& p = positions[static_cast<std::size_t>(corner.vertex)];
    mark_around(box_of(p, p));
  }
  for (const auto& [key, sum] : lengths) {
    if (sum > kMostBorderCells * cell_) near_bricks_.erase(key);
  }
}

void SourceSurface::Meeting::add(std::int32_t part) {
  const auto end = parts.begin() + static_cast<std::ptrdiff_t>(std::min(count, kMostMeeting));
  if (count > kMostMeeting || std::find(parts.begin(), end, part) != end) return;
  if (count < kMostMeeting) parts[count] = part;
  ++count;
}

void SourceSurface::mark_meetings(const Run& run) {
  CancelCheck cancel_check(run);
  for (std::size_t t = 0; t < regions_.triangles.size(); ++t) {
    cancel_check.step();
    if (regions_.labels[t] < 0) continue;
    const std::int32_t part = regions_.parts[t];
    const auto add = [&](const std::array<Vector3, 3>& piece) {
      BrickRange(triangle_box(piece), kContactCells * cell_, brick_)
          .for_each([&](std::uint64_t key) { meetings_[key].add(part); });
    };
    for_pieces(
        regions_.corners_of(t), brick_, [](const auto&) { return true; }, add);
  }
  for (auto brick = meetings_.begin(); brick != meetings_.end();) {
    if (brick->second.count < 2) {
      brick = meetings_.erase(brick);
      continue;
    }
    const std::size_t count = std::min(brick->second.count, kMostMeeting);
    std::sort(brick->second.parts.begin(),
              brick->second.parts.begin() + static_cast<std::ptrdiff_t>(count));
    if (brick->second.count > kMostMeeting) {
      near_bricks_.erase(brick->first);
    } else {
      near_bricks_.insert(brick->first);
    }
    ++brick;
  }
}

std::uint64_t SourceSurface::brick_of(const Vector3& point) const {
  std::array<std::int64_t, 3> brick;
  for (std::size_t a = 0; a < 3; ++a) {
    brick[a] = static_cast<std::int64_t>(std::floor(std::clamp(point[a], -1.0, 2.0) / brick_));
  }
  return brick_key(brick);
}

Vector3 SourceSurface::low_of_brick(std::uint64_t key) const {
  constexpr std::int64_t kBias = std::int64_t{1} << (kBrickBits - 1);
  Vector3 low;
  for (int a = 2; a >= 0; --a) {
    const auto kept = static_cast<std::int64_t>(key & ((std::uint64_t{1} << kBrickBits) - 1));
    low[a] = static_cast<double>(kept - kBias) * brick_;
    key >>= static_cast<unsigned>(kBrickBits);
  }
  return low;
}

bool SourceSurface::is_near(const Vector3& point) const {
  return near_bricks_.contains(brick_of(point));
}

std::span<const std::int32_t> SourceSurface::meeting_parts(const Vector3& point) const {
  const auto found = meetings_.find(brick_of(point));
  if (found == meetings_.end() || found->second.count > kMostMeeting) return {};
  return {found->second.parts.data(), found->second.count};
}

void SourceSurface::build_trees(const Run& run) {
  const auto box_of_triangle = [&](std::int32_t triangle) {
    return triangle_box(regions_.corners_of(static_cast<std::size_t>(triangle)));
  };
  std::vector<std::int32_t> near;
  for (std::size_t t = 0; t < regions_.triangles.size(); ++t) {
    if (regions_.labels[t] < 0) continue;
    const auto triangle = static_cast<std::int32_t>(t);
    const BrickRange range(box_of_triangle(triangle), kSearchCells * cell_, brick_);
    bool is_near = range.count > kMostBricks;
    if (!is_near) {
      range.for_each([&](std::uint64_t key) { is_near = is_near || near_bricks_.contains(key); });
    }
    if (is_near) near.push_back(triangle);
  }
  const auto arrange = [&](std::vector<std::int32_t> items, const auto& box_of_item,
                           const Run& part, std::vector<std::int32_t>* ordered) {
    const Stages stages(part, {3, 2});
    const std::vector<CurvePlace> places = along_curve(
        items.size(), [&](std::size_t i) { return middle_of(box_of_item(items[i])); }, stages[0]);
    std::vector<std::uint64_t> keys;
    ordered->clear();
    for (const CurvePlace& place : places) {
      keys.push_back(place.key);
      ordered->push_back(items[place.index]);
    }
    return BoxTree(
        keys, kLeafItems, [&](std::size_t i) { return box_of_item((*ordered)[i]); }, stages[1]);
  };
  const Stages run_stages(run, {7, 3});
  triangle_tree_ = arrange(std::move(near), box_of_triangle, run_stages[0], &triangles_);
  std::vector<std::int32_t> borders(regions_.borders.size());
  for (std::size_t i = 0; i < borders.size(); ++i) borders[i] = static_cast<std::int32_t>(i);
  border_tree_ = arrange(
      std::move(borders),
      [&](std::int32_t i) {
        const auto& ends = regions_.borders[static_cast<std::size_t>(i)].ends;
        return box_of(regions_.positions[static_cast<std::size_t>(ends[0])],
                      regions_.positions[static_cast<std::size_t>(ends[1])]);
      },
      run_stages[1], &borders_);
}

template <typename Visit>
void SourceSurface::for_triangles(std::size_t node, const Visit& visit) const {
  const auto& items = triangle_tree_.nodes()[node];
  for (std::size_t i = items.begin; i < items.end; ++i) visit(triangles_[i]);
}

template <typename Visit>
void SourceSurface::for_met(const Vector3& a, const Vector3& b, const Visit& visit) const {
  triangle_tree_.for_overlapping(box_of(a, b), [&](std::size_t node) {
    for_triangles(node, [&](std::int32_t triangle) {
      const auto share = meeting(a, b, regions_.corners_of(static_cast<std::size_t>(triangle)));
      if (share) visit(triangle, *share);
    });
  });
}

SourcePoint SourceSurface::point_on(std::int32_t triangle, const Vector3& position) const {
  const auto t = static_cast<std::size_t>(triangle);
  const Vector3 a = regions_.corner(t, 0);
  const Vector3 twice = cross(regions_.corner(t, 1) - a, regions_.corner(t, 2) - a);
  return {position, (1.0 / length(twice)) * twice, triangle, regions_.labels[t]};
}

std::vector<std::int64_t> SourceSurface::first_triangles() const {
  std::vector<std::int64_t> firsts;
  for (std::size_t t = regions_.labels.size(); t-- > 0;) {
    const std::int32_t label = regions_.labels[t];
    if (label < 0) continue;
    if (static_cast<std::size_t>(label) >= firsts.size()) {
      firsts.resize(static_cast<std::size_t>(label) + 1, 0);
    }
    firsts[static_cast<std::size_t>(label)] = static_cast<std::int64_t>(t);
  }
  return firsts;
}

std::int64_t SourceSurface::nearest_of_all(const Vector3& point) const {
  std::int64_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < regions_.triangles.size(); ++t) {
    const Vector3 offset = nearest_on(regions_.corners_of(t), point) - point;
    if (dot(offset, offset) >= least) continue;
    least = dot(offset, offset);
    best = static_cast<std::int64_t>(t);
  }
  return best;
}

std::vector<SourceCrossing> SourceSurface::crossings(const Vector3& a, const Vector3& b) const {
  std::vector<SourceCrossing> found;
  for_met(a, b, [&](std::int32_t triangle, double share) { found.push_back({share, triangle}); });
  std::sort(found.begin(), found.end(), [](const SourceCrossing& x, const SourceCrossing& y) {
    return x.share != y.share ? x.share < y.share : x.triangle < y.triangle;
  });
  constexpr double kSame = 1e-9;
  std::vector<SourceCrossing> single;
  for (const SourceCrossing& hit : found) {
    const bool is_again =
        std::any_of(single.begin(), single.end(), [&](const SourceCrossing& other) {
          return hit.share - other.share < kSame &&
                 regions_.parts[static_cast<std::size_t>(hit.triangle)] ==
                     regions_.parts[static_cast<std::size_t>(other.triangle)];
        });
    if (!is_again) single.push_back(hit);
  }
  return single;
}

std::optional<SourcePoint> SourceSurface::nearest_plane(const Vector3& point, double reach,
                                                        std::int32_t part) const {
  if (triangle_tree_.is_empty()) return std::nullopt;
  // At an edge or a corner the side follows from the triangle that faces the point most.
  constexpr double kTie = 1e-9;
  double least = reach * reach;
  double facing = 0.0;
  std::optional<SourcePoint> found;
  triangle_tree_.search(
      point, [&](double squared, std::size_t) { return squared <= least * (1.0 + kTie); },
      [&](std::size_t node) {
        for_triangles(node, [&](std::int32_t triangle) {
          const auto t = static_cast<std::size_t>(triangle);
          if (regions_.parts[t] != part) return;
          const Vector3 at = nearest_on(regions_.corners_of(t), point);
          const Vector3 offset = point - at;
          const double squared = dot(offset, offset);
          if (squared > least * (1.0 + kTie)) return;
          const SourcePoint candidate = point_on(triangle, at);
          const double height = std::abs(dot(candidate.normal, offset));
          const bool is_nearer = squared < least * (1.0 - kTie);
          if (!found || is_nearer || height > facing ||
              (height == facing && triangle < found->triangle)) {
            found = candidate;
            facing = height;
          }
          least = is_nearer ? squared : std::min(least, squared);
        });
      });
  return found;
}

std::optional<SourcePoint> SourceSurface::crossing(const Vector3& a, const Vector3& b,
                                                   const Vector3& expected) const {
  std::int32_t best = -1;
  double least = std::numeric_limits<double>::infinity();
  Vector3 found{};
  for_met(a, b, [&](std::int32_t triangle, double share) {
    const Vector3 position = a + share * (b - a);
    const double distance = length(position - expected);
    if (distance < least || (distance == least && triangle < best)) {
      least = distance;
      best = triangle;
      found = position;
    }
  });
  if (best < 0) return std::nullopt;
  return point_on(best, found);
}

std::optional<SourcePoint> SourceSurface::nearest(const Vector3& point, double reach,
                                                  std::int32_t label) const {
  if (triangle_tree_.is_empty()) return std::nullopt;
  std::int32_t best = -1;
  double least = reach * reach;
  Vector3 found{};
  triangle_tree_.search(
      point, [&](double squared, std::size_t) { return squared <= least; },
      [&](std::size_t node) {
        for_triangles(node, [&](std::int32_t triangle) {
          const auto t = static_cast<std::size_t>(triangle);
          if (label >= 0 && regions_.labels[t] != label) return;
          const Vector3 at = nearest_on(regions_.corners_of(t), point);
          const Vector3 offset = at - point;
          const double squared = dot(offset, offset);
          if (squared < least || (squared == least && (best < 0 || triangle < best))) {
            least = squared;
            best = triangle;
            found = at;
          }
        });
      });
  if (best < 0) return std::nullopt;
  return point_on(best, found);
}

std::optional<Vector3> SourceSurface::nearest_border(const Vector3& point, double reach,
                                                     std::int32_t label, std::int32_t other) const {
  if (border_tree_.is_empty()) return std::nullopt;
  std::int32_t best = -1;
  double least = reach * reach;
  Vector3 found{};
  border_tree_.search(
      point, [&](double squared, std::size_t) { return squared <= least; },
      [&](std::size_t node) {
        for (std::size_t i = border_tree_.nodes()[node].begin; i < border_tree_.nodes()[node].end;
             ++i) {
          const RegionBorder& border = regions_.borders[static_cast<std::size_t>(borders_[i])];
          if (std::minmax(border.labels[0], border.labels[1]) != std::minmax(label, other)) {
            continue;
          }
          const Vector3& a = regions_.positions[static_cast<std::size_t>(border.ends[0])];
          const Vector3& b = regions_.positions[static_cast<std::size_t>(border.ends[1])];
          const Vector3 along = b - a;
          const double size = dot(along, along);
          const double t = size > 0.0 ? std::clamp(dot(point - a, along) / size, 0.0, 1.0) : 0.0;
          const Vector3 at = a + t * along;
          const Vector3 offset = at - point;
          const double squared = dot(offset, offset);
          if (squared < least || (squared == least && (best < 0 || borders_[i] < best))) {
            least = squared;
            best = borders_[i];
            found = at;
          }
        }
      });
  if (best < 0) return std::nullopt;
  return found;
}

void SourceSurface::find_rim_corners(const Run& run) {
  CancelCheck cancel_check(run);
  for (const RegionBorder& border : regions_.borders) {
    cancel_check.step();
    const std::int32_t part = regions_.parts[static_cast<std::size_t>(border.triangles[0])];
    const Vector3 a = regions_.positions[static_cast<std::size_t>(border.ends[0])];
    const Vector3 d = regions_.positions[static_cast<std::size_t>(border.ends[1])] - a;
    const int steps = 1 + static_cast<int>(std::min(2.0 * length(d) / brick_, 1e5));
    for (int i = 0; i < steps; ++i) {
      const Vector3 from = a + (static_cast<double>(i) / steps) * d;
      const Vector3 to = a + (static_cast<double>(i + 1) / steps) * d;
      if (meeting_parts(from).empty() && meeting_parts(to).empty()) continue;
      for_met(from, to, [&](std::int32_t triangle, double share) {
        const auto t = static_cast<std::size_t>(triangle);
        if (regions_.parts[t] == part) return;
        std::vector<std::int32_t> labels = {border.labels[0], border.labels[1], regions_.labels[t]};
        std::sort(labels.begin(), labels.end());
        labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
        rim_corners_.push_back({from + share * (to - from), std::move(labels)});
      });
    }
  }
}

FeatureCorner SourceSurface::corner(std::size_t index) const {
  if (index >= regions_.corners.size()) {
    const RimCorner& rim = rim_corners_[index - regions_.corners.size()];
    return {rim.position, rim.labels};
  }
  const RegionCorner& corner = regions_.corners[index];
  return {regions_.positions[static_cast<std::size_t>(corner.vertex)], corner.labels};
}

}  // namespace prefilter
