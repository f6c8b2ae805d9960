// SPDX-License-Identifier: GPL-3.0-or-later

// Mipmaps of normal maps, and the roughness that takes what averaging normals loses.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmap_filter.h"

namespace prefilter {

struct NormalMipmapOptions {
  // Of the normals. The means for the roughness are over a texel's surface for filters over the
  // surface, and else those of the box, with the filter's weighting where it has one.
  MipmapFilter filter = SurfaceFilter::kBilinear;
  WrapModes wrap;
  double footprint = 0.0;  // of the normals, as MipmapOptions has it
  bool encoded = true;  // whether a component c is stored as (c + 1) / 2, in the map and the levels
  int levels = 0;       // how many there are, with level 0; 0 = down to 1 x 1
  int threads = 0;      // 0 = all processors
  Progress progress;
};

/// Levels 1 and up.
struct NormalMipmaps {
  std::vector<Image> normals;    // of length 1
  std::vector<Image> roughness;  // none where none was given
};

/// Filters normals, of 3 channels, as vectors. Their lengths count for nothing; those shorter than
/// 0.02 have no direction, and are taken for (0, 0, 1). Levels point below the surface, z < 0, only
/// where some of the map that counts does.
///
/// A roughness, of one channel and the normals' size, takes what averaging loses: if L is the
/// length of the mean of the normals that a texel shows, its alpha^2 = roughness^4 becomes the mean
/// of alpha^2 plus 2 (1 - L), at most 1. Normals are taken for a von Mises-Fisher distribution,
/// whose concentration k is 1 / (1 - L) but for e^(-2 k), and which spreads as much as a lobe with
/// alpha^2 = 2 / k. Roughness counts clamped to [0, 1].
///
/// Throws Error where channels or sizes are wrong, and as `mipmaps` does: a texel that counts is
/// not finite, a filter lacks its surface, levels are out of range; and when cancelled.
NormalMipmaps normal_mipmaps(const ImageView& normals, const ImageView* roughness,
                             const std::vector<const Surface*>& surfaces,
                             const NormalMipmapOptions& options);

}  // namespace prefilter
