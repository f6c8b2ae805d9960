// SPDX-License-Identifier: GPL-3.0-or-later

// Filters for the levels of mipmaps, and their names.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "prefilter/images/kernel.h"

namespace prefilter {

/// The texels that a filter in texture space uses.
enum class Weighting {
  kAll,      // all texels; the surface is ignored
  kCovered,  // texels that a triangle touches
};

/// A filter in texture space, "tent" or "tent-covered".
struct TextureSpaceFilter {
  const Kernel* kernel;
  Weighting weighting;
  bool operator==(const TextureSpaceFilter&) const = default;
};

/// Filters over the surface: texels are weighted by the surface area in them.
enum class SurfaceFilter {
  kBox,         // "pam-box": means over the surface, equation 7.1 with a box
  kBilinear,    // "pam-bilinear": least squares for bilinear lookups, level by level (section 7.3)
  kUnitSquare,  // "ls-bilinear": the same over the unit square instead of a surface
  kTrilinear,   // "pam-trilinear": least squares for trilinear lookups, all levels together
};

using MipmapFilter = std::variant<TextureSpaceFilter, SurfaceFilter>;

/// All filters: every kernel with every weighting, and the surface filters.
std::vector<MipmapFilter> mipmap_filters();

/// The public name, such as "lanczos3-covered".
std::string name_of(const MipmapFilter& filter);

/// The filter with a public name. Throws Error for any other name and lists the valid ones.
MipmapFilter mipmap_filter(const std::string& name);

/// Whether the filter depends on the surface.
bool needs_surface(const MipmapFilter& filter);

/// Whether the filter is a least-squares fit to lookups. Such fits can include seams.
bool is_fit(const MipmapFilter& filter);

}  // namespace prefilter
