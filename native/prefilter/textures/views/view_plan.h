// SPDX-License-Identifier: GPL-3.0-or-later

// Views of a model from all directions and distances.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// Two frames with square pixels, in orthographic projection.
struct View {
  const Surface* surface = nullptr;
  Vector3 center{};  // shown at the center of the frame
  Vector3 right{};   // unit vectors
  Vector3 up{};
  Vector3 toward{};       // to the viewer
  double pixel = 0.0;     // side of a pixel, in units of space
  int size = 0;           // side of the frame, in pixels
  int samples = 0;        // per side of a pixel, for its target color
  int sampled_level = 0;  // the level they read; their spacing is at least half a texel of it
  int octave = 0;         // most pixels look up levels `octave` and `octave` + 1
  double weight = 0.0;    // of each pixel
  std::array<double, 2> step{};  // from the first frame to the second, in pixels
};

/// Plans views of all surfaces in each octave between two levels. Directions are spread evenly over
/// the sphere, pixel sizes over the octave; all octaves have the same weight.
std::vector<View> plan_views(const std::vector<const Surface*>& surfaces, int width, int height,
                             int level_count, double effort);

}  // namespace prefilter
