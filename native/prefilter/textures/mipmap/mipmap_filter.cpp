// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap_filter.h"

#include "prefilter/base/names.h"
#include "prefilter/images/pixel_filter.h"

namespace prefilter {

std::vector<MipmapFilter> mipmap_filters() {
  std::vector<MipmapFilter> filters;
  for (const Weighting weighting : {Weighting::kAll, Weighting::kCovered}) {
    for (const PixelFilter& filter : filters_for(FilterUse::kMipmap)) {
      filters.emplace_back(TextureSpaceFilter{filter.kernel, weighting});
    }
  }
  for (const SurfaceFilter filter : {SurfaceFilter::kUnitSquare, SurfaceFilter::kBox,
                                     SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear}) {
    filters.emplace_back(filter);
  }
  return filters;
}

std::string name_of(const MipmapFilter& filter) {
  if (const auto* in_texture = std::get_if<TextureSpaceFilter>(&filter)) {
    const std::string kernel(in_texture->kernel->name());
    return in_texture->weighting == Weighting::kAll ? kernel : kernel + "-covered";
  }
  switch (std::get<SurfaceFilter>(filter)) {
    case SurfaceFilter::kBox:
      return "pam-box";
    case SurfaceFilter::kBilinear:
      return "pam-bilinear";
    case SurfaceFilter::kTrilinear:
      return "pam-trilinear";
    case SurfaceFilter::kUnitSquare:
      return "ls-bilinear";
  }
  return {};
}

MipmapFilter mipmap_filter(const std::string& name) {
  return element_named("filter", name, mipmap_filters(), name_of);
}

bool needs_surface(const MipmapFilter& filter) {
  if (const auto* in_texture = std::get_if<TextureSpaceFilter>(&filter)) {
    return in_texture->weighting != Weighting::kAll;
  }
  return std::get<SurfaceFilter>(filter) != SurfaceFilter::kUnitSquare;
}

bool is_fit(const MipmapFilter& filter) {
  const auto* over_surface = std::get_if<SurfaceFilter>(&filter);
  return over_surface != nullptr && *over_surface != SurfaceFilter::kBox;
}

}  // namespace prefilter
