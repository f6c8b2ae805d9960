// SPDX-License-Identifier: GPL-3.0-or-later

// A view of the levels of an image, for sampling.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/base/wrap.h"

namespace prefilter {

/// A level: interleaved rows without gaps, floats or bytes.
struct PyramidLevel {
  const void* texels = nullptr;
  int width = 0;   // texels
  int height = 0;  // texels

  // How many of its texels the image is wide and high, see Pyramid.
  double columns = 0.0;
  double rows = 0.0;

  /// What texel x, or y, of the plane that the wrap mode makes of the image is in the level, or -1
  /// for the border. Where the level nests and the image repeats, a period is no whole number of
  /// texels, and it is the nearest one.
  int column_of(int x, Wrap mode) const { return wrapped(x, width, columns, mode); }
  int row_of(int y, Wrap mode) const { return wrapped(y, height, rows, mode); }

 private:
  static int wrapped(int i, int size, double extent, Wrap mode);
};

/// A view of the levels of an image, level 0 first, of any number of channels.
///
/// Where all sides of levels are rounded up they nest: texels of level k are 2^k of level 0 wide,
/// and the last ones may reach beyond the image, as those of `sampling_levels` do. Rounded down, as
/// those of mipmaps, a level's texels are spread over the image.
struct Pyramid {
  /// Finds `columns` and `rows`. Throws Error unless there are levels, their sides are 1 to 2^20
  /// texels, each level's half of those of the one before, rounded either way but never to less
  /// than 1, and there are channels.
  Pyramid(std::vector<PyramidLevel> levels_of_image, int channel_count, bool of_bytes);

  std::size_t texel_size() const {  // [bytes]
    return static_cast<std::size_t>(channels) * (bytes ? 1 : sizeof(float));
  }

  std::vector<PyramidLevel> levels;
  int channels;
  bool bytes;  // whether texels are bytes, which stand for a 255th each, and not floats
};

/// A texel of a pyramid, and how much it counts in a sample.
struct WeightedTexel {
  int level;
  int x;  // texels; -1 outside of the level, with Wrap::kBorder: its value is zero
  int y;
  double weight;
};

}  // namespace prefilter
