// SPDX-License-Identifier: GPL-3.0-or-later

// The table of all pixel filters that users can choose, for images and for levels.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

enum class FilterUse : std::uint8_t {
  kRaster,    // rasterized shapes
  kResize,    // resized images
  kMipmap,    // mipmap levels filtered in texture space
  kSampling,  // samples, and the tables and levels for them
};

inline constexpr Named<FilterUse> kFilterUses[] = {{"raster", FilterUse::kRaster},
                                                   {"resize", FilterUse::kResize},
                                                   {"mipmap", FilterUse::kMipmap},
                                                   {"sampling", FilterUse::kSampling}};

struct PixelFilter {
  std::string_view name;   // "lanczos3"
  std::string_view label;  // in the user interface, "Lanczos 3"
  double radius;           // half the width of its support, in pixels
  const Kernel* kernel;    // along each axis; null if not separable
  bool is_radial;          // a WindowedJinc with this radius
  std::span<const FilterUse> uses;

  bool is_for(FilterUse use) const;
};

/// All filters, from a table in kernel.cpp.
std::span<const PixelFilter> pixel_filters();

/// The filters for a use, in the same order.
std::vector<PixelFilter> filters_for(FilterUse use);

}  // namespace prefilter
