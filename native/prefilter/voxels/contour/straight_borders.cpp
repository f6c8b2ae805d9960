// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/straight_borders.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

namespace prefilter {
namespace {

constexpr int kBorderPasses = 2;  // more would shorten regions one quad wide from their ends
constexpr double kStraightBordersBorderReach = 2.0;

// The label of at least three of the four vertices around one, if it differs from the vertex's; -1:
// none.
std::int32_t label_around(std::size_t vertex, const DualLoops& loops,
                          const VertexSamples& samples) {
  std::array<std::int32_t, 4> labels;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto loop = loops.loop(static_cast<std::size_t>(loops.quads[vertex][k]));
    const auto at = std::find(loop.begin(), loop.end(), static_cast<std::int32_t>(vertex));
    const std::int32_t next = at + 1 == loop.end() ? loop.front() : *(at + 1);
    const SourcePoint* sample = samples.of(next);
    labels[k] = sample == nullptr ? -1 : sample->label;
  }
  const std::int32_t own = samples.of(static_cast<std::int32_t>(vertex))->label;
  for (const std::size_t k : {0, 1}) {
    if (labels[k] == own) continue;
    if (std::count(labels.begin(), labels.end(), labels[k]) >= 3) return labels[k];
  }
  return -1;
}
}  // namespace

void straighten_borders(const DualLoops& loops, const FeatureSurface& surface,
                        VertexSamples* samples, SurfaceVertices* vertices) {
  for (int pass = 0; pass < kBorderPasses; ++pass) {
    std::vector<std::pair<std::size_t, SourcePoint>> changed;
    for (std::size_t v = 0; v < samples->index.size(); ++v) {
      if (samples->index[v] < 0) continue;
      const std::int32_t label = label_around(v, loops, *samples);
      if (label < 0) continue;
      const std::optional<SourcePoint> there = surface.nearest(
          vertices->positions()[v], kStraightBordersBorderReach * surface.cell(), label);
      if (there) changed.emplace_back(v, *there);
    }
    if (changed.empty()) return;
    for (const auto& [v, there] : changed) {
      samples->samples[static_cast<std::size_t>(samples->index[v])] = there;
      vertices->move(v, there.position);
    }
  }
}

}  // namespace prefilter
