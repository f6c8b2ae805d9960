// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/filterable.h"

#include <atomic>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"

namespace prefilter {

void check_channels(const ImageView& image, const char* name) {
  if (image.channels < 1 || image.channels > kMaxChannels) {
    throw_invalid(std::string(name) + ": " + std::to_string(image.channels) +
                  " channels; 1 to 4 are allowed");
  }
}

bool all_filterable(const ImageView& image, const Run& run) {
  const std::size_t row_values = image.value_count() / static_cast<std::size_t>(image.height);
  std::atomic<bool> result{true};
  parallel_for(image.height, run, [&](std::int64_t y) {
    const float* row = image.texel(0, static_cast<int>(y));
    // Without an early exit, so that it can be vectorized.
    int invalid = 0;
    for (std::size_t i = 0; i < row_values; ++i) invalid |= is_filterable(row[i]) ? 0 : 1;
    if (invalid != 0) result.store(false);
  });
  return result.load();
}

}  // namespace prefilter
