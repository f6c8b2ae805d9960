// SPDX-License-Identifier: GPL-3.0-or-later

// From where a model is looked at, and how near.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// Two frames of square pixels, seen along parallel rays.
struct View {
  const Surface* surface = nullptr;
  Vector3 center{};  // at the middle of the frame
  Vector3 right{};   // these three have a length of 1
  Vector3 up{};
  Vector3 toward{};              // the viewer
  double pixel = 0.0;            // its side, in units of space
  int size = 0;                  // pixels along each side of the frame
  int samples = 0;               // along each side of a pixel, of what it should show
  int sampled_level = 0;         // whose texels are at most twice the steps between them
  int octave = 0;                // levels 0 and 1, 1 and 2, ... are what most of its pixels look up
  double weight = 0.0;           // of each pixel
  std::array<double, 2> step{};  // to the second frame, in pixels
};

/// The views of all surfaces, of as many octaves as there are levels but one. Directions are spread
/// over the sphere, and sizes of pixels over each octave; an octave counts as much as another.
std::vector<View> plan_views(const std::vector<const Surface*>& surfaces, int width, int height,
                             int level_count, double effort);

}  // namespace prefilter
