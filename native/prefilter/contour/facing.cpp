// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/facing.h"

#include <unordered_map>

namespace prefilter {
namespace {

constexpr double kLeastCosine = 0.05;
constexpr double kLeastArea = 1e-12;  // twice a triangle's, of a cell's face

}  // namespace

std::unordered_set<std::int32_t> turned_labels(const VertexSamples& samples) {
  std::unordered_map<std::int32_t, double> facing;
  for (std::size_t i = 0; i < samples.samples.size(); ++i) {
    facing[samples.samples[i].label] += static_cast<double>(samples.facing[i]);
  }
  std::unordered_set<std::int32_t> turned;
  for (const auto& [label, sum] : facing) {
    if (sum < 0.0) turned.insert(label);
  }
  return turned;
}

bool is_upside_down(const MeshView<std::int32_t>& mesh, std::size_t triangle, std::int32_t label,
                    const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned,
                    double cell) {
  const auto [a, b, c] = mesh.corners(triangle);
  const Vector3 normal = cross(b - a, c - a);
  if (length(normal) < kLeastArea * cell * cell) return true;
  bool is_any = false;
  for (const std::int32_t corner : mesh.triangles[triangle]) {
    if (static_cast<std::size_t>(corner) >= samples.index.size()) continue;
    const SourcePoint* sample = samples.of(corner);
    if (sample == nullptr || sample->label != label) return false;
    const double height = dot(normal, sample->normal);
    if ((turned.contains(sample->label) ? -height : height) >= kLeastCosine * length(normal)) {
      return false;
    }
    is_any = true;
  }
  return is_any;
}

}  // namespace prefilter
