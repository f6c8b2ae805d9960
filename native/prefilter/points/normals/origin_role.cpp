// SPDX-License-Identifier: GPL-3.0-or-later

// If rays from the origin meet the surface once, the distance is a function of direction, as
// terrain heights are a function of x and y. So the test for height fields is applied to the faces
// of a cube around the origin.
#include "prefilter/points/origin_role.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/height_field.h"
#include "prefilter/points/normals/local_plane.h"
#include "prefilter/points/normals/sampled_positions.h"

namespace prefilter {
namespace {

constexpr std::size_t kMinViewPoints = 100;
constexpr std::size_t kMaxRolePoints = std::size_t{1} << 20;
// Smallest fraction of points on rays that meet the surface once.
constexpr double kMinOnceShare = 0.7;
// Smallest width of a view, as the tangent of its angle; a camera's view is wider.
constexpr double kMinViewTangent = 0.05;
// Directions are counted in squares on the faces of a cube.
constexpr int kSquaresPerSide = 8;
constexpr std::size_t kFaces = 6;
// Fraction of directions that separates a camera's view from points that surround the origin.
constexpr double kMaxViewShare = 0.25;

constexpr std::size_t kMaxSpreadSamples = 4096;
constexpr std::size_t kSpreadNeighbors = 16;
// Largest spread of log densities over directions in a view, of which about 0.25 is random, and
// largest ratio of that spread to the spread over the surface, if points surround the origin.
constexpr double kMaxEvenSpread = 0.6;
constexpr double kMaxSpreadRatio = 0.8;
constexpr double kMinCosine = 0.1;

// Largest offset of a camera's axis from the middle of a view, in widths of the view.
constexpr double kMaxAxisOffset = 0.4;
// Largest number of grid positions per point in a map.
constexpr std::size_t kMaxGridPerPoint = 2;

struct Direction {
  std::size_t face = 0;
  // position on the cube's face, from -1 to 1, and the logarithm of the distance
  Vector3 on_face{};
};

Direction direction_of(const Vector3& point) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(point[a]) > std::abs(point[axis])) axis = a;
  }
  const double along = std::abs(point[axis]);
  return {2 * axis + (point[axis] < 0.0 ? 1 : 0),
          {point[(axis + 1) % 3] / along, point[(axis + 2) % 3] / along,
           elementary::log(plain_length(point))}};
}

// Points scaled so that the largest coordinate is 1, without points at the origin.
std::vector<Vector3> scaled_points(std::span<const Vector3> all) {
  std::vector<Vector3> points = sample_positions(all, kMaxRolePoints);
  double largest = 0.0;
  for (const Vector3& p : points) {
    for (const double x : p) largest = std::max(largest, std::abs(x));
  }
  if (!(largest > 0.0)) return {};
  for (Vector3& p : points) {
    for (double& x : p) x /= largest;
  }
  std::erase_if(points, [](const Vector3& p) { return !(dot(p, p) > 1e-200); });
  return points;
}

// The points as seen from the origin.
class CubeView {
 public:
  explicit CubeView(std::span<const Vector3> points) {
    for (const Vector3& point : points) {
      const Direction direction = direction_of(point);
      faces_[direction.face].push_back(direction.on_face);
      const auto square = [](double x) {
        const int i = static_cast<int>(std::floor(0.5 * (x + 1.0) * kSquaresPerSide));
        return static_cast<std::size_t>(std::clamp(i, 0, kSquaresPerSide - 1));
      };
      is_seen_[(direction.face * kSquaresPerSide + square(direction.on_face[1])) * kSquaresPerSide +
               square(direction.on_face[0])] = true;
    }
  }

  // Fraction of all directions.
  double share() const {
    const auto seen = std::count(is_seen_.begin(), is_seen_.end(), true);
    return static_cast<double>(seen) / static_cast<double>(is_seen_.size());
  }

  // Whether all points are within a narrow cone.
  bool is_narrow(std::span<const Vector3> points) const {
    Vector3 mean{};
    for (const Vector3& p : points) mean = mean + 1.0 / plain_length(p) * p;
    const double size = plain_length(mean);
    if (!(size > 0.0)) return false;
    double least = 1.0;
    for (const Vector3& p : points) {
      least = std::min(least, dot(p, mean) / (size * plain_length(p)));
    }
    return least > 1.0 - 0.5 * kMinViewTangent * kMinViewTangent;
  }

  // Whether almost all rays meet the surface once.
  bool is_once(const Run& run) const {
    std::size_t all = 0;
    std::size_t once = 0;
    for (std::size_t f = 0; f < kFaces; ++f) {
      const auto part = static_cast<double>(f) / static_cast<double>(kFaces);
      const Run own = run.part(part, part + 1.0 / static_cast<double>(kFaces));
      all += faces_[f].size();
      if (faces_[f].size() < kMinViewPoints) continue;
      once += is_height_field(faces_[f], own) ? faces_[f].size() : 0;
    }
    return static_cast<double>(once) >= kMinOnceShare * static_cast<double>(all);
  }

 private:
  std::array<std::vector<Vector3>, kFaces> faces_;
  std::array<bool, kFaces * kSquaresPerSide * kSquaresPerSide> is_seen_{};
};

std::size_t distinct_values(std::span<const Vector3> points, std::size_t axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3& p : points) values.push_back(p[axis]);
  std::sort(values.begin(), values.end());
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

// Whether heights over x and y are a map, rather than the view of a camera that looks along z: x
// and y form a grid, or the camera's axis would miss the points.
bool is_map(std::span<const Vector3> points, const Run& run) {
  Box view = kEmptyBox;
  for (const Vector3& p : points) {
    if (!(std::abs(p[2]) > 0.0)) return false;
    view.include(Vector3{p[0] / p[2], p[1] / p[2], p[2]});
  }
  if (view.low[2] < 0.0 && view.high[2] > 0.0) return false;
  const bool is_relief = view.size(2) > 0.0;
  const bool is_grid = is_relief && distinct_values(points, 0) * distinct_values(points, 1) <=
                                        kMaxGridPerPoint * points.size();
  bool is_beside = false;
  for (int a = 0; a < 2; ++a) {
    is_beside |= std::abs(view.low[a] + view.high[a]) > 2.0 * kMaxAxisOffset * view.size(a);
  }
  return (is_grid || is_beside) && is_height_field(points, run);
}

// Robust standard deviation of values, from the first and last decile.
double spread(std::vector<double>* values) {
  std::sort(values->begin(), values->end());
  const std::size_t tail = values->size() / 10;
  // distance of these deciles of a normal distribution, in standard deviations
  constexpr double kDeviations = 2.56;
  return ((*values)[values->size() - 1 - tail] - (*values)[tail]) / kDeviations;
}

struct Spreads {
  double directions = 0.0;
  double surface = 0.0;
};

Spreads find_spreads(std::span<const Vector3> points, const Run& run) {
  const Stages stages(run, {3, 2});
  const NeighborSearch search(points, stages[0]);
  const std::span<const Vector3> positions = search.positions();
  const std::size_t count = std::min(kMaxSpreadSamples, positions.size());
  std::vector<double> areas(count);
  std::vector<double> angles(count);
  parallel_for(static_cast<std::int64_t>(count), stages[1], [&](std::int64_t i) {
    const auto k = static_cast<std::size_t>(i);
    const auto place = static_cast<std::uint32_t>(k * positions.size() / count);
    Neighbors near;
    search.find(place, kSpreadNeighbors + 1, &near);
    const Vector3& p = positions[place];
    const double squared = dot(p, p);
    const Vector3 normal = least_eigenvector(covariance(positions, place, near));
    const double cosine = std::abs(dot(normal, p)) / std::sqrt(squared);
    const double area = std::max(near.squares().back(), 1e-200);
    areas[k] = elementary::log(area);
    angles[k] = elementary::log(area / squared * std::max(cosine, kMinCosine));
  });
  return {spread(&angles), spread(&areas)};
}

}  // namespace

OriginRole origin_role(std::span<const Vector3> all, const Run& run) {
  const std::vector<Vector3> points = scaled_points(all);
  if (points.size() < kMinViewPoints) return OriginRole::kNone;
  const CubeView view(points);
  const Stages stages(run, {5, 2, 3});
  if (view.is_narrow(points) || !view.is_once(stages[0])) return OriginRole::kNone;
  const bool is_view = view.share() < kMaxViewShare;
  if (is_view && is_map(points, stages[1])) return OriginRole::kNone;
  const Spreads spreads = find_spreads(points, stages[2]);
  const double ratio = spreads.directions / spreads.surface;
  if (is_view) {
    const bool is_even = spreads.directions < kMaxEvenSpread || ratio < 1.0;
    return is_even ? OriginRole::kScanner : OriginRole::kNone;
  }
  if (ratio < kMaxSpreadRatio) return OriginRole::kScanner;
  return ratio * kMaxSpreadRatio < 1.0 ? OriginRole::kEither : OriginRole::kNone;
}

}  // namespace prefilter
