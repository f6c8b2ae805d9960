// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/trim_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/points/array_sink.h"
#include "prefilter/points/reconstruct/surface_cutter.h"

namespace prefilter {
namespace {

void check_options(const TrimOptions& options) {
  constexpr double kMost = 1e30;
  const auto check = [](double value, const char* name) {
    if (value >= 0.0 && value <= kMost) return;
    throw_invalid(std::string(name) + ": " + to_text(value) +
                  "; a number from 0 up to 1e30 is needed");
  };
  check(options.distance, "limit");
  check(options.hole, "hole");
  check(options.island, "island");
}

void check_mesh(std::size_t count, std::span<const std::array<std::int32_t, 3>> triangles,
                std::span<const float> attributes, std::size_t width) {
  for (const auto& triangle : triangles) {
    for (const std::int32_t v : triangle) {
      if (v < 0 || static_cast<std::size_t>(v) >= count) {
        throw_invalid("triangles: vertex " + std::to_string(v) + " of " + std::to_string(count));
      }
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    const float* const support = attributes.data() + (v + 1) * width - kSupportAttributes;
    for (std::size_t i = 0; i < kSupportAttributes; ++i) {
      if (support[i] >= 0.0F && std::isfinite(support[i])) continue;
      throw_invalid(std::string(i == 0 ? "distance" : "density") + ": " +
                    to_text(static_cast<double>(support[i])) + " at vertex " + std::to_string(v) +
                    "; finite numbers from 0 on are needed");
    }
  }
}

// The vertices on boundary edges.
std::vector<std::int64_t> border_vertices(std::span<const std::array<std::int32_t, 3>> triangles) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges.emplace_back(std::minmax({triangle[i], triangle[(i + 1) % 3]}));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::int64_t> vertices;
  for (auto first = edges.begin(); first != edges.end();) {
    const auto end = std::find_if(first, edges.end(), [&](const auto& e) { return e != *first; });
    if (end - first == 1) vertices.insert(vertices.end(), {first->first, first->second});
    first = end;
  }
  return vertices;
}

}  // namespace

TrimReport trim_surface(std::span<const Vector3> positions,
                        std::span<const std::array<std::int32_t, 3>> triangles,
                        std::span<const float> attributes, std::size_t width,
                        const TrimOptions& options, const Run& run, TrimmedMesh* result) {
  check_options(options);
  check_mesh(positions.size(), triangles, attributes, width);
  SurfaceCutter cutter(options, width, 0.0, true, std::numeric_limits<std::uint64_t>::max(), "");
  cutter.add_vertices({positions.begin(), positions.end()}, {attributes.begin(), attributes.end()});
  std::vector<std::array<std::int64_t, 3>> wide;
  wide.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) wide.push_back({a, b, c});
  cutter.add_triangles(std::move(wide));
  // Regions that reach a boundary of the mesh fill no hole.
  cutter.request_cut(border_vertices(triangles));
  run.report(0.2);
  cutter.end_part({});
  ArraySink sink;
  const TrimReport report = cutter.finish(run.part(0.6, 1.0), &sink);
  *result = {sink.take_positions(), sink.take_triangles(), sink.take_attributes()};
  return report;
}

}  // namespace prefilter
