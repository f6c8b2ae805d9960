// SPDX-License-Identifier: GPL-3.0-or-later

// Mipmaps of normal maps, with the variance lost by averaging moved into the roughness.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmap_filter.h"

namespace prefilter {

struct NormalMipmapOptions {
  // Filter for the normals. Filters over the surface average the roughness over the surface in a
  // texel; all others use the box filter for it, with their own weighting.
  MipmapFilter filter = SurfaceFilter::kBilinear;
  WrapModes wrap;
  double footprint = 0.0;  // MipmapOptions::footprint, for the normals
  bool encoded = true;     // components c are stored as (c + 1) / 2, in the input and the result
  int levels = 0;          // number of levels, including level 0; 0 = down to 1 x 1
  Run run;
};

/// Levels 1 and up.
struct NormalMipmaps {
  std::vector<Image> normals;    // unit vectors
  std::vector<Image> roughness;  // empty without an input roughness
};

/// Filters normals of 3 channels as vectors. Their lengths are ignored; normals shorter than 0.02
/// have no direction and are read as (0, 0, 1). Results point below the surface, z < 0, only if
/// some input that counts does.
///
/// The roughness (one channel, same size as the normals) absorbs the spread of the normals: if L is
/// the length of the mean normal in a texel, alpha^2 = roughness^4 becomes the mean of alpha^2 plus
/// 2 (1 - L), at most 1. This models the normals by a von Mises-Fisher distribution, whose
/// concentration k is 1 / (1 - L) up to e^(-2 k) and which spreads like a lobe with alpha^2 = 2 /
/// k. Input roughness is clamped to [0, 1].
///
/// Throws Error if channel counts or sizes are wrong, and as `mipmaps` does: if a texel that counts
/// is not finite, a filter lacks its surface, levels are out of range, or when cancelled.
NormalMipmaps normal_mipmaps(const ImageView& normals, const ImageView* roughness,
                             const std::vector<const Surface*>& surfaces,
                             const NormalMipmapOptions& options);

}  // namespace prefilter
