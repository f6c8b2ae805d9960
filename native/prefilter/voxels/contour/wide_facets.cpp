// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/wide_facets.h"

#include <cstddef>

namespace prefilter {
namespace {

// length of the mean normal of a facet that counts as planar, up to 1/4 degree
constexpr double kPlane = 1.0 - 1e-5;

struct Facet {
  Vector3 sum{};  // of normals with length twice the areas
  Box box = kEmptyBox;
};
}  // namespace

std::vector<double> wide_facets(const WeldedMeshes& welded, std::span<const std::int32_t> facets,
                                int facet_count, double least) {
  // A facet's width is at most the square root of its area, which excludes most facets.
  std::vector<double> areas(static_cast<std::size_t>(facet_count), 0.0);
  for (std::size_t t = 0; t < facets.size(); ++t) {
    areas[static_cast<std::size_t>(facets[t])] += 0.5 * length(welded.normal(t));
  }
  std::vector<std::int32_t> numbers(areas.size(), -1);
  std::int32_t count = 0;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    if (areas[f] >= least * least) numbers[f] = count++;
  }
  if (count == 0) return {};
  std::vector<Facet> large(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < facets.size(); ++t) {
    const std::int32_t number = numbers[static_cast<std::size_t>(facets[t])];
    if (number < 0) continue;
    Facet& facet = large[static_cast<std::size_t>(number)];
    facet.sum = facet.sum + welded.normal(t);
    for (const std::int32_t vertex : welded.triangle(t)) facet.box.include(welded.position(vertex));
  }
  std::vector<double> widths(facets.size(), 0.0);
  bool is_any = false;
  for (std::size_t t = 0; t < facets.size(); ++t) {
    const auto f = static_cast<std::size_t>(facets[t]);
    if (numbers[f] < 0) continue;
    const Facet& facet = large[static_cast<std::size_t>(numbers[f])];
    if (0.5 * length(facet.sum) < kPlane * areas[f]) continue;
    const double width = areas[f] / length(facet.box.high - facet.box.low);
    if (!(width >= least)) continue;
    widths[t] = width;
    is_any = true;
  }
  return is_any ? widths : std::vector<double>();
}

}  // namespace prefilter
