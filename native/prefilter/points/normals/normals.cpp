// SPDX-License-Identifier: GPL-3.0-or-later

// Principal component analysis of neighborhoods, as Hoppe et al., Surface Reconstruction from
// Unorganized Points (1992).
#include "prefilter/points/normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/normals/local_plane.h"
#include "prefilter/points/normals/orientation.h"

namespace prefilter {
namespace {

constexpr std::int64_t kPlanesPerTask = 256;
constexpr std::int64_t kRowsPerTask = 1 << 15;
// More links hardly change orientations, and take time.
constexpr std::size_t kMaxLinks = 8;
// Flatness of neighbors along a line: standard deviations in the ratio 10 to 1.
constexpr double kMaxLineFlatness = 0.01;
// Largest factor by which the number of neighbors grows if they lie along a line.
constexpr std::size_t kMaxGrowth = 8;

Vector3 reversed(const Vector3& normal) { return Vector3{} - normal; }

void check_arguments(std::span<const Vector3> points, int neighbours,
                     std::span<const Vector3> viewpoints) {
  if (points.empty()) throw_invalid("points: none; at least one is needed");
  if (neighbours < kMinNormalNeighbors || neighbours > kMaxNormalNeighbors) {
    throw_invalid("neighbours: found " + std::to_string(neighbours) + "; a number from " +
                  std::to_string(kMinNormalNeighbors) + " to " +
                  std::to_string(kMaxNormalNeighbors) + " is needed");
  }
  if (viewpoints.size() > 1 && viewpoints.size() != points.size()) {
    throw_invalid("viewpoint: found " + std::to_string(viewpoints.size()) + " for " +
                  std::to_string(points.size()) + " points; one for all or one for each is needed");
  }
  check_points(viewpoints, "viewpoint: row", kLargestCoordinate);
}

// Estimates for each distinct position.
struct LocalPlanes {
  std::vector<Vector3> normals;
  std::vector<double> areas;
  std::size_t degree = 0;
  std::vector<std::uint32_t> links;  // `degree` neighbors of each
};

LocalPlanes fit_planes(const NeighborSearch& search, std::size_t neighbors, std::size_t degree,
                       const Run& run) {
  const std::span<const Vector3> positions = search.positions();
  LocalPlanes planes;
  planes.normals.resize(positions.size());
  planes.areas.resize(positions.size());
  planes.degree = degree;
  planes.links.resize(positions.size() * degree);
  const auto fit = [&](std::int64_t begin, std::int64_t end) {
    Neighbors near;
    for (auto place = static_cast<std::uint32_t>(begin); place < static_cast<std::uint32_t>(end);
         ++place) {
      search.find(place, neighbors, &near);
      planes.areas[place] = near.squares().back();
      for (std::size_t s = 0; s < degree; ++s) {
        const std::size_t link = std::min(s + 1, near.places().size() - 1);
        planes.links[place * degree + s] = near.places()[link];
      }
      SymmetricMatrix matrix = covariance(positions, place, near);
      Vector3 normal = least_eigenvector(matrix);
      for (std::size_t growth = 2;
           growth <= kMaxGrowth && flatness(matrix, normal) < kMaxLineFlatness; growth *= 2) {
        if (near.places().size() < neighbors) break;
        search.find(place, growth * neighbors, &near);
        matrix = covariance(positions, place, near);
        normal = least_eigenvector(matrix);
      }
      planes.normals[place] = normal;
    }
  };
  parallel_ranges(static_cast<std::int64_t>(positions.size()), kPlanesPerTask, run, fit);
  return planes;
}

}  // namespace

std::vector<Vector3> estimate_normals(std::span<const Vector3> points, int neighbours,
                                      std::span<const Vector3> viewpoints, NormalSide side,
                                      const Run& run) {
  check_arguments(points, neighbours, viewpoints);
  std::vector<Vector3> result(points.size());
  const Stages stages(run, {4, 12, 3, 1});
  const NeighborSearch search(points, stages[0]);
  const std::span<const Vector3> positions = search.positions();
  if (positions.size() < 3) return result;
  const auto neighbor_count = static_cast<std::size_t>(neighbours);
  const std::size_t degree = viewpoints.empty() ? std::min(neighbor_count - 1, kMaxLinks) : 0;
  LocalPlanes planes = fit_planes(search, neighbor_count, degree, stages[1]);
  if (viewpoints.empty()) {
    orient_normals({positions, planes.areas, planes.degree, planes.links}, side, stages[2],
                   &planes.normals);
  }
  const auto give_back = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const std::uint32_t place = search.places()[i];
      if (place == NeighborSearch::kNowhere) continue;
      result[i] = planes.normals[place];
      if (viewpoints.empty()) continue;
      const Vector3& viewpoint = viewpoints[viewpoints.size() == 1 ? 0 : i];
      if (dot(result[i], viewpoint - points[i]) < 0.0) result[i] = reversed(result[i]);
    }
  };
  parallel_ranges(static_cast<std::int64_t>(points.size()), kRowsPerTask, stages[3], give_back);
  return result;
}

}  // namespace prefilter
