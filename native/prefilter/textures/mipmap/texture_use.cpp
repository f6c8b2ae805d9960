// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/texture_use.h"

#include <algorithm>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/geometry/texels/texel_triangles.h"
#include "prefilter/images/filters/push_pull.h"
#include "prefilter/textures/mipmap/argument_checks.h"

namespace prefilter {
namespace {

void check(const std::vector<const Surface*>& surfaces, int width, int height) {
  if (width < 1 || height < 1) {
    throw_invalid("width, height: " + std::to_string(width) + " x " + std::to_string(height) +
                  " texels; at least 1 x 1 is needed");
  }
  if (surfaces.empty()) throw_invalid("surface: none was given; at least one is needed");
  check_surface_area(surfaces);
}

}  // namespace

Image texel_weights(const std::vector<const Surface*>& surfaces, int width, int height,
                    WrapModes wrap, const Run& run) {
  check(surfaces, width, height);
  const Stages stages(run, {1, 4});
  const TexelTriangles triangles =
      map_to_texels(surfaces, width, height, wrap, MassOf::kArea, stages[0]);
  check_mapped(triangles);
  Image weights(width, height, 1);
  weights.data = texel_masses(triangles, stages[1]);
  return weights;
}

Image fill_unused(const ImageView& image, const std::vector<const Surface*>& surfaces,
                  WrapModes wrap, const Run& run) {
  check_channels(image);
  check(surfaces, image.width, image.height);
  const Stages stages(run, {3, 2});
  const std::vector<unsigned char> read =
      looked_up_texels(surfaces, image.width, image.height, wrap, stages[0]);
  if (std::find(read.begin(), read.end(), 1) == read.end()) throw_outside();
  const std::vector<float> weights(read.begin(), read.end());
  Image filled(image);
  fill_holes(weights, wrap, image.channels, stages[1], &filled);
  return filled;
}

Image fill_transparent(const ImageView& image, WrapModes wrap, const Run& run) {
  if (image.channels < 2 || image.channels > kMaxChannels) {
    throw_invalid("image: " + std::to_string(image.channels) +
                  " channels; 2 to 4 are allowed, the last one is alpha");
  }
  const int colors = image.channels - 1;
  Image filled(image);
  std::vector<float> weights(image.texel_count());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const float alpha = filled.data[i * image.channels + colors];
    // NaN counts as a weight of 0.
    weights[i] = alpha > 0.0F ? std::min(alpha, 1.0F) : 0.0F;
  }
  fill_holes(weights, wrap, colors, run, &filled);
  return filled;
}

}  // namespace prefilter
