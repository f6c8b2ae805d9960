// SPDX-License-Identifier: GPL-3.0-or-later

// Filters for the levels of mipmaps, and their names.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "prefilter/images/kernel.h"

namespace prefilter {

/// Which texels a filter in texture space weighs by its kernel.
enum class Weighting {
  kAll,      // every one; the surface is not looked at
  kCovered,  // those that some triangle touches
};

/// A filter in texture space, "tent" or "tent-covered".
struct TextureSpaceFilter {
  const Kernel* kernel;
  Weighting weighting;
  bool operator==(const TextureSpaceFilter&) const = default;
};

/// A filter over the surface: texels count by its area.
enum class SurfaceFilter {
  kBox,         // "pam-box", means over the surface: equation 7.1 with a box
  kBilinear,    // "pam-bilinear", least squares for bilinear lookups, each level by itself:
                // section 7.3
  kUnitSquare,  // "ls-bilinear", the same over the unit square in place of a surface
  kTrilinear,   // "pam-trilinear", least squares for trilinear lookups, all levels together
};

using MipmapFilter = std::variant<TextureSpaceFilter, SurfaceFilter>;

/// The filters there are: every kernel with every weighting, and those over the surface.
std::vector<MipmapFilter> mipmap_filters();

/// The public name, such as "lanczos3-covered".
std::string name_of(const MipmapFilter& filter);

/// The filter of a public name. Throws Error for any other, naming all.
MipmapFilter mipmap_filter(const std::string& name);

/// Whether it is over the surface, or over the texels that the surface touches.
bool needs_surface(const MipmapFilter& filter);

/// Whether it is a fit to what is looked up, which can count seams too.
bool is_fit(const MipmapFilter& filter);

}  // namespace prefilter
