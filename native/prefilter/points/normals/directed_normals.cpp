// SPDX-License-Identifier: GPL-3.0-or-later

// Orients given normals by orient_normals, with links to the nearest neighbors.
#include "prefilter/points/directed_normals.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/normals/local_plane.h"
#include "prefilter/points/normals/orientation.h"

namespace prefilter {
namespace {

constexpr std::int64_t kPointsPerTask = 256;
constexpr std::size_t kDirectionLinks = 8;  // the default of estimate_normals

}  // namespace

std::vector<Vector3> directed_normals(std::span<const Vector3> points,
                                      std::span<const Vector3> normals, const Run& run) {
  if (points.empty()) throw_invalid("points: none; at least one is needed");
  if (normals.size() != points.size()) {
    throw_invalid("normals: found " + std::to_string(normals.size()) + " for " +
                  std::to_string(points.size()) + " points; one for each is needed");
  }
  const Stages stages(run, {3, 3, 4});
  const NeighborSearch search(points, stages[0]);
  const std::span<const Vector3> positions = search.positions();
  std::vector<Vector3> result(points.size());
  if (positions.empty()) return result;
  std::vector<Vector3> at_places(positions.size());
  for (std::size_t i = points.size(); i-- > 0;) {
    result[i] = unit_or_zero(normals[i]);
    const std::uint32_t place = search.places()[i];
    if (place == NeighborSearch::kNowhere) {
      result[i] = {};
    } else if (result[i] != Vector3{}) {
      at_places[place] = result[i];  // the first of several coincident points wins
    }
  }
  std::vector<double> areas(positions.size());
  std::vector<std::uint32_t> links(positions.size() * kDirectionLinks);
  const auto link = [&](std::int64_t begin, std::int64_t end) {
    Neighbors near;
    for (auto place = static_cast<std::uint32_t>(begin); place < end; ++place) {
      search.find(place, 2 * kDirectionLinks, &near);
      areas[place] = near.squares().back();
      for (std::size_t s = 0; s < kDirectionLinks; ++s) {
        links[place * kDirectionLinks + s] =
            near.places()[std::min(s + 1, near.places().size() - 1)];
      }
    }
  };
  parallel_ranges(static_cast<std::int64_t>(positions.size()), kPointsPerTask, stages[1], link);
  std::vector<Vector3> directed = at_places;
  orient_normals({positions, areas, kDirectionLinks, links}, NormalSide::kOutward, stages[2],
                 &directed);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint32_t place = search.places()[i];
    if (place == NeighborSearch::kNowhere) continue;
    if (dot(result[i], directed[place]) < 0.0) result[i] = Vector3{} - result[i];
  }
  return result;
}

}  // namespace prefilter
