// SPDX-License-Identifier: GPL-3.0-or-later

// All filters of pixels that users choose from: what makes images, or levels, asks this table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

enum class FilterUse : std::uint8_t {
  kRaster,    // images of shapes
  kResize,    // images of other sizes
  kMipmap,    // levels in texture space
  kSampling,  // samples, and the tables and levels that approximate them
};

inline constexpr Named<FilterUse> kFilterUses[] = {{"raster", FilterUse::kRaster},
                                                   {"resize", FilterUse::kResize},
                                                   {"mipmap", FilterUse::kMipmap},
                                                   {"sampling", FilterUse::kSampling}};

struct PixelFilter {
  std::string_view name;   // "lanczos3"
  std::string_view label;  // as users see it, "Lanczos 3"
  double radius;           // half the width of its support, in pixels
  const Kernel* kernel;    // along each axis; null for others
  bool is_radial;          // a WindowedJinc of that radius
  std::span<const FilterUse> uses;

  bool is_for(FilterUse use) const;
};

/// All filters, by a table in kernel.cpp.
std::span<const PixelFilter> pixel_filters();

/// Those that may be used so, in the same order.
std::vector<PixelFilter> filters_for(FilterUse use);

}  // namespace prefilter
