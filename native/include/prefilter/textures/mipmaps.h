// SPDX-License-Identifier: GPL-3.0-or-later

// Mipmaps of a texture on a surface (chapter 7).
#pragma once

#include <optional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmap_filter.h"
#include "prefilter/textures/reader.h"

namespace prefilter {

/// Lowest and highest value of a texel; either may be open.
struct Bounds {
  std::optional<float> low = 0.0F;
  std::optional<float> high = 1.0F;
};

struct MipmapOptions {
  MipmapFilter filter = SurfaceFilter::kBilinear;
  WrapModes wrap;
  Bounds bounds;
  // How many levels to return, with level 0; 0 = down to 1 x 1.
  int levels = 0;
  // False: the fourth of four channels is coverage, in [0, 1], and the others are not multiplied by
  // it yet. They are multiplied, filtered and divided again. True: every channel is filtered as it
  // stands.
  bool premultiplied = false;
  // Fitted to by SurfaceFilter::kBilinear; the levels of the other filters are the same for all
  // readers.
  Reader reader = Reader::kLinear;
  // By how much, as a share, the error over the surface of each level may rise for a lower contrast
  // across UV seams; 0 leaves seams alone. For the fitted filters.
  double seam_budget = 0.0;
  // Texels of a level that a pixel of the reader covers, 0 to 2, for the fitted filters and the
  // linear reader. 0: a level is fitted to the image itself, right where pixels are means of many
  // lookups. Else to the image averaged over that footprint, which is what a pixel of one lookup
  // ought to show.
  double footprint = 0.0;
  int threads = 0;  // 0 = all processors
  Progress progress;
  const char* image_name = "image";  // what errors call it
};

/// Levels of an image: 0 is the image itself, each other half as wide and high, rounded down, and
/// never less than 1.
///
/// A level of SurfaceFilter::kBilinear minimizes the integral over the surface of the squared
/// difference between the bilinear lookups of the level and of the image, subject to the bounds;
/// those of SurfaceFilter::kTrilinear the integral over all mip values too, of trilinear lookups,
/// with the mean over the surface as the last level. SurfaceFilter::kUnitSquare takes the unit
/// square in place of the surfaces. Levels of the other filters are clipped to the
/// bounds. Texels that the surface does not read have no influence; in the levels they are filled
/// by push-pull.
///
/// Throws Error where channels are not 1 to 4, levels or bounds are out of range, a filter that
/// needs a surface gets none or none that lies inside of the image, no triangle has an area, or a
/// texel that counts is not finite or beyond 1e30; and, from the progress callback, when cancelled.
std::vector<Image> mipmaps(const ImageView& image, const std::vector<const Surface*>& surfaces,
                           const MipmapOptions& options);

/// The same without level 0. Texels that are bytes are read as they are by the fits that can do so,
/// those for the linear reader where alpha plays no part; the other filters make floats of them
/// first.
std::vector<Image> coarser_levels(const TexelSource& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const MipmapOptions& options);

}  // namespace prefilter
