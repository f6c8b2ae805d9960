// SPDX-License-Identifier: GPL-3.0-or-later

// Prepares shapes for rasterization: outlines that wind once around their filled part, with colors
// that only need to be added.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/edge_list.h"
#include "prefilter/shapes/raster/layer_stack.h"
#include "prefilter/shapes/rasterize.h"

namespace prefilter {

/// Outlines with one paint. Shapes of equal constant colors share a layer, so that common edges
/// cancel.
struct RasterLayer {
  EdgeList edges;
  Paint paint;  // constant or linear
};

inline bool is_constant(const RasterLayer& layer) {
  return layer.paint.kind == Paint::Kind::kConstant;
}

struct RasterLayers {
  std::vector<RasterLayer> layers;
  std::deque<LayerStack> stacks;  // added to the image, too
  ChannelValues background{};
  int channels = 1;
  std::deque<Outline> outlines;  // storage for the edges' outlines
};

/// Share of the progress of rasterizing that preparing the layers takes.
inline constexpr double kLayersProgressShare = 0.3;

/// Number of channels of the image: of the shapes, or of the background if there are none.
int channel_count(std::span<const Shape> shapes, const RasterOptions& options);

/// Layers whose sum with the background is the image. The shapes must outlive it.
RasterLayers make_layers(std::span<const Shape> shapes, const RasterOptions& options);

}  // namespace prefilter
