// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes made ready: outlines that wind once round what they fill, colors that only have to be
// added.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/edge_list.h"
#include "prefilter/shapes/raster/layer_stack.h"
#include "prefilter/shapes/rasterize.h"

namespace prefilter {

/// Outlines of one paint. Constant ones of several shapes are summed up together: what they share
/// then cancels.
struct RasterLayer {
  EdgeList edges;
  Paint paint;  // constant or linear
};

inline bool is_constant(const RasterLayer& layer) {
  return layer.paint.kind == Paint::Kind::kConstant;
}

struct RasterLayers {
  std::vector<RasterLayer> layers;
  std::deque<LayerStack> stacks;  // to be added too
  ChannelValues background{};
  int channels = 1;
  std::deque<Outline> outlines;  // what the edges are of
};

/// How much of the time of rasterizing it takes to make the layers, as progress tells it.
inline constexpr double kLayersShare = 0.3;

/// The channels of the image: the shapes', or where there are none, the background's.
int channel_count(std::span<const Shape> shapes, const RasterOptions& options);

/// The sum of all layers and the background is the image. The shapes must outlive it.
RasterLayers make_layers(std::span<const Shape> shapes, const RasterOptions& options);

}  // namespace prefilter
