// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/image.h"

#include "prefilter/base/parallel.h"

namespace prefilter {

Image to_floats(const TexelSource& bytes, int threads) {
  Image result(bytes.width, bytes.height, bytes.channels);
  parallel_for(bytes.height, Run(threads), [&](std::int64_t y) {
    const std::uint8_t* byte = bytes.byte_texel(0, static_cast<int>(y));
    float* value = result.texel(0, static_cast<int>(y));
    for (int x = 0; x < bytes.width; ++x) {
      for (int c = 0; c < bytes.channels; ++c) *value++ = bytes.value(*byte++, c);
    }
  });
  return result;
}

}  // namespace prefilter
