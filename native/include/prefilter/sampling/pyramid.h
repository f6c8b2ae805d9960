// SPDX-License-Identifier: GPL-3.0-or-later

// A view of the levels of an image, for sampling.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/base/wrap.h"

namespace prefilter {

/// A level: interleaved rows without padding, of floats or bytes.
struct PyramidLevel {
  const void* texels = nullptr;
  int width = 0;   // texels
  int height = 0;  // texels

  // Width and height of the image in texels of this level, see Pyramid.
  double columns = 0.0;
  double rows = 0.0;

  /// The index in the level of texel x, or y, of the plane that the wrap mode tiles or extends; -1
  /// for the border. In a nested level of a repeating image, the period is not a whole number of
  /// texels, and the nearest texel is returned.
  int column_of(int x, Wrap mode) const { return wrapped(x, width, columns, mode); }
  int row_of(int y, Wrap mode) const { return wrapped(y, height, rows, mode); }

 private:
  static int wrapped(int i, int size, double extent, Wrap mode);
};

/// A view of the levels of an image, level 0 first, with any number of channels.
///
/// If the sides of all levels are rounded up, the levels nest, like those of `sampling_levels`:
/// texels of level k are 2^k texels of level 0 wide, and the last ones may extend beyond the image.
/// If they are rounded down, like those of mipmaps, a level's texels are stretched over the image.
struct Pyramid {
  /// Computes `columns` and `rows`. Throws Error unless there are levels, their sides are 1 to 2^20
  /// texels, each level is half the previous one, rounded either way but at least 1, and there are
  /// channels.
  Pyramid(std::vector<PyramidLevel> levels_of_image, int channel_count, bool of_bytes);

  std::size_t texel_size() const {  // [bytes]
    return static_cast<std::size_t>(channels) * (bytes ? 1 : sizeof(float));
  }

  std::vector<PyramidLevel> levels;
  int channels;
  bool bytes;  // whether texels are bytes, in units of 1/255, or floats
};

/// A texel of a pyramid, and its weight in a sample.
struct WeightedTexel {
  int level;
  int x;  // texels; -1 outside the level with Wrap::kBorder, where the value is zero
  int y;
  double weight;
};

}  // namespace prefilter
