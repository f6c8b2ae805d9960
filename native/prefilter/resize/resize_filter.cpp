// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/resize/resize_filter.h"

#include "prefilter/base/names.h"

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
  return element_named("filter", name, resize_filters(), name_of);
}

}  // namespace prefilter
