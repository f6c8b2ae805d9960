// SPDX-License-Identifier: GPL-3.0-or-later

// Filters for resizing images, and their names.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// "radial2" and "radial3": a WindowedJinc with this radius.
struct RadialFilter {
  int radius;
  bool operator==(const RadialFilter&) const = default;
};

/// "least-squares": the texels whose bilinear enlargement is closest to the image.
struct BilinearFit {
  bool operator==(const BilinearFit&) const = default;
};

/// A kernel for both axes, or one of the above.
using ResizeFilter = std::variant<const Kernel*, RadialFilter, BilinearFit>;

/// Whether values may exceed the range of nearby source texels.
enum class Ringing {
  kAuto,  // limited for least squares, allowed for all other filters
  kLimit,
  kAllow,
};

inline constexpr Named<Ringing> kRingings[] = {
    {"auto", Ringing::kAuto}, {"limit", Ringing::kLimit}, {"allow", Ringing::kAllow}};

/// All resize filters: every kernel, and the others.
std::vector<ResizeFilter> resize_filters();

/// The public name, such as "lanczos3".
std::string name_of(const ResizeFilter& filter);

/// The filter with a public name. Throws Error for any other name and lists the valid ones.
ResizeFilter resize_filter(const std::string& name);

}  // namespace prefilter
