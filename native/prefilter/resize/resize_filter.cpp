// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/resize/resize_filter.h"

#include "prefilter/base/error.h"

namespace prefilter {

std::vector<ResizeFilter> resize_filters() {
  std::vector<ResizeFilter> filters;
  for (const Kernel& kernel : kernels()) filters.emplace_back(&kernel);
  filters.emplace_back(RadialFilter{2});
  filters.emplace_back(RadialFilter{3});
  filters.emplace_back(BilinearFit{});
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
  std::string names;
  for (const ResizeFilter& filter : resize_filters()) {
    const std::string own = name_of(filter);
    if (name == own) return filter;
    names += (names.empty() ? "" : ", ") + own;
  }
  throw_invalid("filter: '" + name + "' is not one of " + names);
}

}  // namespace prefilter
