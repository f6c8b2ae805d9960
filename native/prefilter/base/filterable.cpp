#include "prefilter/base/filterable.h"

#include <algorithm>
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

bool all_filterable(const ImageView& image, const Progress& progress, int threads) {
  const std::size_t row_values = image.value_count() / static_cast<std::size_t>(image.height);
  std::atomic<bool> result{true};
  parallel_for(image.height, threads, progress, [&](std::int64_t y) {
    const float* row = image.texel(0, static_cast<int>(y));
    if (!std::all_of(row, row + row_values, is_filterable)) result.store(false);
  });
  return result.load();
}

}  // namespace prefilter
