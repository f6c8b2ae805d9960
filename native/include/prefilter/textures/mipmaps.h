// SPDX-License-Identifier: GPL-3.0-or-later

// Mipmaps of a texture on a surface (chapter 7).
#pragma once

#include <optional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmap_filter.h"
#include "prefilter/textures/reader.h"

namespace prefilter {

/// Lowest and highest texel value; an empty one means no limit.
struct Bounds {
  std::optional<float> low = 0.0F;
  std::optional<float> high = 1.0F;
};

struct MipmapOptions {
  MipmapFilter filter = SurfaceFilter::kBilinear;
  WrapModes wrap;
  Bounds bounds;
  // Number of levels to return, including level 0; 0 = down to 1 x 1.
  int levels = 0;
  // False: the fourth of four channels is coverage in [0, 1]. Colors are multiplied by it, filtered
  // and divided again. True: every channel is filtered independently.
  bool premultiplied = false;
  // The reader that SurfaceFilter::kBilinear fits to. Levels of the other filters are the same for
  // all readers.
  Reader reader = Reader::kLinear;
  // For the fitted filters: the relative increase of each level's error that may be spent on a
  // lower contrast across UV seams; 0 ignores seams.
  double seam_budget = 0.0;
  // For the fitted filters and the linear reader: side of a pixel's footprint in texels of the
  // level, 0 to 2. 0 fits each level to the image itself, which is right if pixels average many
  // lookups. Otherwise levels are fitted to the image averaged over the footprint, the ideal color
  // of a pixel with one lookup.
  double footprint = 0.0;
  Run run;
  const char* image_name = "image";  // its name in error messages
};

/// The levels of an image: level 0 is the image itself, each other level is half as wide and high
/// as the one before, rounded down, and at least 1.
///
/// A level of SurfaceFilter::kBilinear minimizes, within the bounds, the integral over the surface
/// of the squared difference between bilinear lookups of the level and of the image.
/// SurfaceFilter::kTrilinear minimizes the integral over all mip values too, for trilinear lookups;
/// its last level is the mean over the surface. SurfaceFilter::kUnitSquare replaces the surfaces by
/// the unit square. Levels of the other filters are clipped to the bounds. Texels that the surface
/// does not read have no influence; in the results they are filled by push-pull.
///
/// Throws Error if the channel count is not 1 to 4, if levels or bounds are out of range, if a
/// filter that needs a surface has none inside the image, if no triangle has an area, if a texel
/// that counts is not finite or beyond 1e30, or if the progress callback cancels.
std::vector<Image> mipmaps(const ImageView& image, const std::vector<const Surface*>& surfaces,
                           const MipmapOptions& options);

/// The same without level 0. Fits for the linear reader that do not involve alpha read byte texels
/// directly; all other filters convert them to floats first.
std::vector<Image> coarser_levels(const TexelSource& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const MipmapOptions& options);

}  // namespace prefilter
