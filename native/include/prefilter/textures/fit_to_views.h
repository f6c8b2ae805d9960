// SPDX-License-Identifier: GPL-3.0-or-later

// Fits mipmap levels to renderings of a model from views all around it.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter {

/// The texture lookups of a rendered pixel.
enum class Lookups {
  kTrilinear,    // one trilinear lookup; the mip level follows from the longer axis of the pixel's
                 // footprint
  kAnisotropic,  // up to 16 trilinear lookups along that axis, as Vulkan and OpenGL describe
  kBoth,         // equal weights for both, for players who can choose
};

inline constexpr Named<Lookups> kLookups[] = {{"trilinear", Lookups::kTrilinear},
                                              {"anisotropic", Lookups::kAnisotropic},
                                              {"both", Lookups::kBoth}};

struct ViewFitOptions {
  WrapModes wrap;
  Bounds bounds;
  // See MipmapOptions::premultiplied.
  bool premultiplied = false;
  Lookups lookups = Lookups::kBoth;
  // Weight of flicker beside the error of single frames, 0 and up. Flicker is a change from one
  // frame to the next that the image itself does not show.
  double steadiness = 0.5;
  // Factor on the number of views, and so on the time; above 0, up to 100.
  double effort = 1.0;
  Run run;
};

/// Fits levels 1 and up to the colors that pixels should show, on average over views from all
/// directions and at all distances. The target of a pixel is the mean, over its visible surface, of
/// bilinear lookups of level 0, or of a level two octaves finer than the pixel where pixels are
/// large. Pixels on silhouettes and chart borders count too: they show several parts of the
/// texture, but their lookup reads only one.
///
/// `levels` is the starting point of the search: level 0 first, each level half as wide and high as
/// the one before. Texels that hardly any view reads stay near their starting values. Each surface
/// is rendered alone, from outside and inside, and only pixels that it covers fully count.
///
/// Returns levels 1 and up. Throws Error if there are no levels or no surfaces, if sizes do not
/// match a mipmap, if channel counts differ or are not 1 to 4, if an option is out of range, if a
/// texel is not finite or beyond 1e30, or if the progress callback cancels.
std::vector<Image> fit_to_views(const std::vector<ImageView>& levels,
                                const std::vector<const Surface*>& surfaces,
                                const ViewFitOptions& options);

}  // namespace prefilter
