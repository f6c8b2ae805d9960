// SPDX-License-Identifier: GPL-3.0-or-later

// Fits planes to neighbors, and grows the region of known normals in rounds.
#include "prefilter/points/completed_normals.h"

#include <cstdint>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/normals/local_plane.h"
#include "prefilter/points/normals/orientation.h"

namespace prefilter {
namespace {

constexpr std::int64_t kMissingPerTask = 256;

// The fitted normal, oriented by the known normals around it; zero if there are none.
Vector3 oriented_normal(const NeighborSearch& search, std::uint32_t place, std::size_t neighbors,
                        std::span<const Vector3> known, Neighbors* near) {
  const std::span<const Vector3> positions = search.positions();
  search.find(place, neighbors, near);
  bool is_reached = false;
  for (const std::uint32_t each : near->places()) is_reached |= known[each] != Vector3{};
  if (!is_reached) return {};
  const Vector3 normal = least_eigenvector(covariance(positions, place, *near));
  double votes = 0.0;
  for (const std::uint32_t each : near->places()) {
    votes += agreement(normal, known[each], positions[each] - positions[place]);
  }
  return votes < 0.0 ? Vector3{} - normal : normal;
}

}  // namespace

std::vector<Vector3> completed_normals(std::span<const Vector3> points,
                                       std::span<const Vector3> normals, int neighbours,
                                       const Run& run) {
  if (points.empty()) throw_invalid("points: none; at least one is needed");
  if (normals.size() != points.size()) {
    throw_invalid("normals: found " + std::to_string(normals.size()) + " for " +
                  std::to_string(points.size()) + " points; one for each is needed");
  }
  const NeighborSearch search(points, run.part(0.0, 0.3));
  std::vector<Vector3> known(search.positions().size());
  for (std::size_t i = points.size(); i-- > 0;) {
    const std::uint32_t place = search.places()[i];
    if (place == NeighborSearch::kNowhere) continue;
    const Vector3 normal = unit_or_zero(normals[i]);
    if (normal != Vector3{}) known[place] = normal;  // the first of several coincident points wins
  }
  std::vector<std::uint32_t> missing;
  for (std::uint32_t place = 0; place < known.size(); ++place) {
    if (known[place] == Vector3{}) missing.push_back(place);
  }
  const auto whole = static_cast<double>(missing.size());
  double done = 0.3;
  // Each round uses only the normals known before it, so that the order does not matter.
  while (!missing.empty()) {
    std::vector<Vector3> estimates(missing.size());
    const double end = done + 0.7 * (1.0 - done) * static_cast<double>(missing.size()) / whole;
    parallel_ranges(static_cast<std::int64_t>(missing.size()), kMissingPerTask, run.part(done, end),
                    [&](std::int64_t first, std::int64_t last) {
                      Neighbors near;
                      for (auto i = static_cast<std::size_t>(first);
                           i < static_cast<std::size_t>(last); ++i) {
                        estimates[i] = oriented_normal(
                            search, missing[i], static_cast<std::size_t>(neighbours), known, &near);
                      }
                    });
    done = end;
    std::vector<std::uint32_t> left;
    for (std::size_t i = 0; i < missing.size(); ++i) {
      known[missing[i]] = estimates[i];
      if (estimates[i] == Vector3{}) left.push_back(missing[i]);
    }
    if (left.size() == missing.size()) break;
    missing = std::move(left);
  }
  std::vector<Vector3> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t place = search.places()[i];
    if (place == NeighborSearch::kNowhere) continue;
    result[i] = unit_or_zero(normals[i]);
    if (result[i] == Vector3{}) result[i] = known[place];
  }
  return result;
}

}  // namespace prefilter
