// SPDX-License-Identifier: GPL-3.0-or-later

// Filters for resizing images, and their names.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// "radial2" and "radial3": a WindowedJinc of that radius.
struct RadialFilter {
  int radius;
  bool operator==(const RadialFilter&) const = default;
};

/// "least-squares": the texels that come closest to the image once they are enlarged bilinearly.
struct BilinearFit {
  bool operator==(const BilinearFit&) const = default;
};

/// A kernel along each axis, or one of these.
using ResizeFilter = std::variant<const Kernel*, RadialFilter, BilinearFit>;

/// Whether values may go beyond those of the old texels around.
enum class Ringing {
  kAuto,   // of least squares they may not, of others they may
  kLimit,  // they may not
  kAllow,
};

inline constexpr Named<Ringing> kRingings[] = {
    {"auto", Ringing::kAuto}, {"limit", Ringing::kLimit}, {"allow", Ringing::kAllow}};

/// All there are: every kernel, and the others.
std::vector<ResizeFilter> resize_filters();

/// The public name, such as "lanczos3".
std::string name_of(const ResizeFilter& filter);

/// The filter of a public name. Throws Error for any other, naming all.
ResizeFilter resize_filter(const std::string& name);

}  // namespace prefilter
