#include "prefilter/base/finite.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "prefilter/base/parallel.h"

namespace prefilter {

bool all_finite(const ImageView& image, const Progress& progress, int threads) {
  const std::size_t row_values = image.value_count() / static_cast<std::size_t>(image.height);
  std::atomic<bool> finite{true};
  parallel_for(image.height, threads, progress, [&](std::int64_t y) {
    const float* row = image.texel(0, static_cast<int>(y));
    const auto is_finite = [](float value) { return std::isfinite(value); };
    if (!std::all_of(row, row + row_values, is_finite)) finite.store(false);
  });
  return finite.load();
}

}  // namespace prefilter
