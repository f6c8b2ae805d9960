// Levels as they are sampled.
#pragma once

#include <cstddef>
#include <vector>

namespace prefilter {

/// A level: interleaved rows without gaps, floats or bytes.
struct PyramidLevel {
  const void* texels = nullptr;
  int width = 0;   // texels
  int height = 0;  // texels
};

/// A view of the levels of an image, level 0 first, of any number of channels.
struct Pyramid {
  std::vector<PyramidLevel> levels;
  int channels = 0;
  bool bytes = false;  // whether texels are bytes, which stand for a 255th each, and not floats

  std::size_t texel_size() const {  // [bytes]
    return static_cast<std::size_t>(channels) * (bytes ? 1 : sizeof(float));
  }
};

/// Throws Error unless there are levels, their sides are 1 to 2^20 texels, each level's half of
/// those of the one before, rounded either way but never to less than 1, and there are channels.
void check_pyramid(const Pyramid& pyramid);

}  // namespace prefilter
