// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes that cover each other, as pieces that only have to be added.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"
#include "prefilter/shapes/outline/arrangement.h"

namespace prefilter {

/// A shape that covers those before it, as far as it is opaque.
struct CoveringLayer {
  const Outline* outline = nullptr;
  FillRule fill_rule = FillRule::kNonzero;
  bool is_opaque = true;
};

/// Where a layer is seen through the same layers.
struct VisiblePiece {
  std::size_t layer = 0;
  /// The layers over it that are not opaque, from the lowest to the highest.
  std::vector<std::uint32_t> veils;
  Outline outline;  // as `resolve` would have it
};

/// The pieces of all layers that are seen, in the order of the layers. So the sum, over the pieces
/// that hold a point, of the layer's color times 1 - alpha of each veil is what the layers, drawn
/// one over the other, show there; colors are premultiplied. Pieces beside each other share their
/// curves, bit for bit, so that no seam is left.
///
/// Nothing where rounding leaves unclear what crosses what, or where that takes more than an effort
/// allows.
std::optional<std::vector<VisiblePiece>> visible_pieces(std::span<const CoveringLayer> layers,
                                                        ArrangementEffort effort, int threads = 0,
                                                        const Progress& progress = {});

}  // namespace prefilter
