// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/resize_filter.h"

#include "prefilter/base/names.h"
#include "prefilter/images/pixel_filter.h"

namespace prefilter {

std::vector<ResizeFilter> resize_filters() {
  std::vector<ResizeFilter> filters;
  for (const PixelFilter& filter : filters_for(FilterUse::kResize)) {
    if (filter.kernel != nullptr) {
      filters.emplace_back(filter.kernel);
    } else if (filter.is_radial) {
      filters.emplace_back(RadialFilter{static_cast<int>(filter.radius)});
    } else {
      filters.emplace_back(BilinearFit{});
    }
  }
  return filters;
}

std::string name_of(const ResizeFilter& filter) {
  if (const auto* kernel = std::get_if<const Kernel*>(&filter)) {
    return std::string((*kernel)->name());
  }
  if (const auto* radial = std::get_if<RadialFilter>(&filter)) {
    return "radial" + std::to_string(radial->radius);
  }
  return "least-squares";
}

ResizeFilter resize_filter(const std::string& name) {
  return element_named("filter", name, resize_filters(), name_of);
}

}  // namespace prefilter
