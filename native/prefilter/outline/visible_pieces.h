// Shapes that cover each other, as pieces that only have to be added.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"
#include "prefilter/outline/resolve.h"

namespace prefilter {

/// A shape that covers those before it, as far as it is opaque.
struct CoveringLayer {
  const Outline* outline = nullptr;
  FillRule fill_rule = FillRule::kNonzero;
  double opacity = 1.0;  // in [0, 1]
};

/// Where a layer is seen, through layers that let the share `weight` of it pass.
struct VisiblePiece {
  std::size_t layer = 0;
  double weight = 1.0;  // in (0, 1]
  Outline outline;      // as `resolve` would have it
};

/// The pieces of all layers that are seen, in the order of the layers, each piece's weight being
/// the product of 1 - opacity of the layers over it. So the sum of weight times color over the
/// pieces that hold a point is what the layers, drawn one over the other, show there; colors are
/// premultiplied. Pieces beside each other share their curves, bit for bit, so that no seam is
/// left.
///
/// Only layers that rounding leaves unclear become lines, off by `tolerance` at the most.
std::vector<VisiblePiece> visible_pieces(std::span<const CoveringLayer> layers, int threads = 0,
                                         const Progress& progress = {},
                                         double tolerance = kOutlineTolerance);

}  // namespace prefilter
