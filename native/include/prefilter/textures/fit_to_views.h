// SPDX-License-Identifier: GPL-3.0-or-later

// Levels fitted to what pixels show of a model from all around.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter {

/// How pixels look levels up.
enum class Lookups {
  kTrilinear,    // one trilinear lookup, by the longer axis of the pixel's footprint
  kAnisotropic,  // a row of up to 16 along that axis, as Vulkan and OpenGL describe it
  kBoth,         // half of the time each: players choose
};

inline constexpr Named<Lookups> kLookups[] = {{"trilinear", Lookups::kTrilinear},
                                              {"anisotropic", Lookups::kAnisotropic},
                                              {"both", Lookups::kBoth}};

struct ViewFitOptions {
  WrapModes wrap;
  Bounds bounds;
  // As MipmapOptions::premultiplied.
  bool premultiplied = false;
  Lookups lookups = Lookups::kBoth;
  // How much changes from one frame to the next count that the image itself does not show, beside
  // the errors of single frames; 0 and up.
  double steadiness = 0.5;
  // How many more views there are, and how much longer it takes; above 0, up to 100.
  double effort = 1.0;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// Levels that come nearest to what pixels should show, on average over views from all around and
/// over distances: the mean of level 0, looked up bilinearly, over what is visible in each pixel;
/// of a finer level than the pixel's in place of level 0 where pixels are large. Edges of the model
/// and borders between charts are part of it, as pixels there show several places of the texture
/// and lookups only one. `levels` are where the search starts, level 0 first and each half as wide
/// and high as the one before; texels that hardly any view reads stay near them.
///
/// Each surface is seen by itself, from outside and inside, with pixels that it covers fully.
/// Returns levels 1 and up. Throws Error where there are no levels or no surface, sizes are not
/// those of a mipmap, channels differ or are not 1 to 4, an option is out of range, or a texel is
/// not finite or beyond 1e30; and, from the progress callback, when cancelled.
std::vector<Image> fit_to_views(const std::vector<ImageView>& levels,
                                const std::vector<const Surface*>& surfaces,
                                const ViewFitOptions& options);

}  // namespace prefilter
