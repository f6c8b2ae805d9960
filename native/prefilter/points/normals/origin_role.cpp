// SPDX-License-Identifier: GPL-3.0-or-later

// Distances from the origin are a function of direction where rays meet the surface once, as
// heights are one of x and y on a terrain: so the same test finds it, on the faces of a cube.
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
#include "prefilter/points/normals/some_points.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeastSeen = 100;
constexpr std::size_t kMostLookedAt = std::size_t{1} << 20;
// Of points that rays meet once.
constexpr double kLeastOnce = 0.7;
// Tangents of angles; a scene seen by a camera is wider.
constexpr double kLeastView = 0.05;
// Directions are counted in squares on the faces of a cube.
constexpr int kSquaresPerSide = 8;
constexpr std::size_t kFaces = 6;
// A camera sees less of the directions, and points that surround the origin take up more.
constexpr double kMostOfView = 0.25;

constexpr std::size_t kMostSampled = 4096;
constexpr std::size_t kNeighbors = 16;
// Of logarithms of densities, of which about 0.25 is due to chance: in a view, and in relation to
// that on the surface where points surround the origin.
constexpr double kEvenSpread = 0.6;
constexpr double kMoreEven = 0.8;
constexpr double kLeastCosine = 0.1;

// How far from the middle of a view a camera's axis may be, as a share of the view's width.
constexpr double kMostOffAxis = 0.4;
// Of a map, positions in a grid for each point, at the most.
constexpr std::size_t kGridPerPoint = 2;

struct Direction {
  std::size_t face = 0;
  Vector3 on_face{};  // on the face of the cube, from -1 to 1, and the logarithm of the distance
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

// Points whose farthest coordinate is 1, without those at the origin.
std::vector<Vector3> scaled_points(std::span<const Vector3> all) {
  std::vector<Vector3> points = some_points(all, kMostLookedAt);
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

// What is seen from the origin.
class View {
 public:
  explicit View(std::span<const Vector3> points) {
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

  // The share of all directions.
  double share() const {
    const auto seen = std::count(is_seen_.begin(), is_seen_.end(), true);
    return static_cast<double>(seen) / static_cast<double>(is_seen_.size());
  }

  // Whether the points are in a narrow bundle of directions.
  bool is_narrow(std::span<const Vector3> points) const {
    Vector3 mean{};
    for (const Vector3& p : points) mean = mean + 1.0 / plain_length(p) * p;
    const double size = plain_length(mean);
    if (!(size > 0.0)) return false;
    double least = 1.0;
    for (const Vector3& p : points) {
      least = std::min(least, dot(p, mean) / (size * plain_length(p)));
    }
    return least > 1.0 - 0.5 * kLeastView * kLeastView;
  }

  // Whether rays meet the surface once, but for a few.
  bool is_once(const Progress& progress) const {
    std::size_t all = 0;
    std::size_t once = 0;
    for (std::size_t f = 0; f < kFaces; ++f) {
      const auto part = static_cast<double>(f) / static_cast<double>(kFaces);
      const Progress own = progress.part(part, part + 1.0 / static_cast<double>(kFaces));
      all += faces_[f].size();
      if (faces_[f].size() < kLeastSeen) continue;
      once += is_height_field(faces_[f], own) ? faces_[f].size() : 0;
    }
    return static_cast<double>(once) >= kLeastOnce * static_cast<double>(all);
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

// Whether heights above x and y are those of a map rather than what a camera sees that looks along
// z: they are in a grid of x and y, or the camera would look beside them.
bool is_map(std::span<const Vector3> points, const Progress& progress) {
  Box view = kEmptyBox;
  for (const Vector3& p : points) {
    if (!(std::abs(p[2]) > 0.0)) return false;
    view.include(Vector3{p[0] / p[2], p[1] / p[2], p[2]});
  }
  if (view.low[2] < 0.0 && view.high[2] > 0.0) return false;
  const bool is_relief = view.size(2) > 0.0;
  const bool is_grid = is_relief && distinct_values(points, 0) * distinct_values(points, 1) <=
                                        kGridPerPoint * points.size();
  bool is_beside = false;
  for (int a = 0; a < 2; ++a) {
    is_beside |= std::abs(view.low[a] + view.high[a]) > 2.0 * kMostOffAxis * view.size(a);
  }
  return (is_grid || is_beside) && is_height_field(points, progress);
}

// How much logarithms of densities vary: as standard deviations do, but for their tails.
double spread(std::vector<double>* values) {
  std::sort(values->begin(), values->end());
  const std::size_t tail = values->size() / 10;
  constexpr double kDeviations = 2.56;  // between the first and the last tenth
  return ((*values)[values->size() - 1 - tail] - (*values)[tail]) / kDeviations;
}

struct Spreads {
  double directions = 0.0;
  double surface = 0.0;
};

Spreads find_spreads(std::span<const Vector3> points, const Progress& progress, int threads) {
  const NeighborSearch search(points, progress.part(0.0, 0.6), threads);
  const std::span<const Vector3> positions = search.positions();
  const std::size_t count = std::min(kMostSampled, positions.size());
  std::vector<double> areas(count);
  std::vector<double> angles(count);
  parallel_for(static_cast<std::int64_t>(count), threads, progress.part(0.6, 1.0),
               [&](std::int64_t i) {
                 const auto k = static_cast<std::size_t>(i);
                 const auto place = static_cast<std::uint32_t>(k * positions.size() / count);
                 Neighbors near;
                 search.find(place, kNeighbors + 1, &near);
                 const Vector3& p = positions[place];
                 const double squared = dot(p, p);
                 const Vector3 normal = least_eigenvector(covariance(positions, place, near));
                 const double cosine = std::abs(dot(normal, p)) / std::sqrt(squared);
                 const double area = std::max(near.squares().back(), 1e-200);
                 areas[k] = elementary::log(area);
                 angles[k] = elementary::log(area / squared * std::max(cosine, kLeastCosine));
               });
  return {spread(&angles), spread(&areas)};
}

}  // namespace

OriginRole origin_role(std::span<const Vector3> all, const Progress& progress, int threads) {
  const std::vector<Vector3> points = scaled_points(all);
  if (points.size() < kLeastSeen) return OriginRole::kNone;
  const View view(points);
  if (view.is_narrow(points) || !view.is_once(progress.part(0.0, 0.5))) return OriginRole::kNone;
  const bool is_view = view.share() < kMostOfView;
  if (is_view && is_map(points, progress.part(0.5, 0.7))) return OriginRole::kNone;
  const Spreads spreads = find_spreads(points, progress.part(0.7, 1.0), threads);
  const double ratio = spreads.directions / spreads.surface;
  if (is_view) {
    const bool is_even = spreads.directions < kEvenSpread || ratio < 1.0;
    return is_even ? OriginRole::kScanner : OriginRole::kNone;
  }
  if (ratio < kMoreEven) return OriginRole::kScanner;
  return ratio * kMoreEven < 1.0 ? OriginRole::kEither : OriginRole::kNone;
}

}  // namespace prefilter
