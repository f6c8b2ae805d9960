// SPDX-License-Identifier: GPL-3.0-or-later

// Splits layers that cover each other into disjoint pieces whose colors only need to be added.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/base/run.h"
#include "prefilter/shapes/outline/arrangement.h"

namespace prefilter {

/// A shape that covers the shapes before it, as far as it is opaque.
struct CoveringLayer {
  const Outline* outline = nullptr;
  FillRule fill_rule = FillRule::kNonzero;
  bool is_opaque = true;
};

/// A region in which a layer shows through a fixed set of overlays.
struct VisiblePiece {
  std::size_t layer = 0;
  /// Translucent layers above it, from the lowest to the highest.
  std::vector<std::uint32_t> overlays;
  Outline outline;  // in the form that `resolve` returns
};

/// The visible pieces of all layers, in the order of the layers. Drawing the layers over one
/// another shows at each point the sum, over the pieces that contain the point, of the layer's
/// premultiplied color times the product of 1 - alpha over its overlays. Adjacent pieces share
/// their curves bit for bit, so that no seam appears.
///
/// Nothing if rounding makes the intersections ambiguous, or if the work exceeds `effort`.
std::optional<std::vector<VisiblePiece>> visible_pieces(std::span<const CoveringLayer> layers,
                                                        ArrangementEffort effort,
                                                        const Run& run = {});

}  // namespace prefilter
