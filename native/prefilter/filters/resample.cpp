#include "prefilter/filters/resample.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// One row with `before` texels of wrapped ones ahead of it and `after` behind, so that taps need no
// test.
void pad_row(const float* row, int size, int channels, Wrap mode, int before, int after,
             std::vector<float>* padded) {
  padded->resize(static_cast<std::size_t>(before + size + after) * channels);
  float* out = padded->data();
  for (int i = -before; i < size + after; ++i, out += channels) {
    const int source = wrap_index(i, size, mode);
    for (int c = 0; c < channels; ++c) {
      out[c] = source < 0 ? 0.0F : row[static_cast<std::ptrdiff_t>(source) * channels + c];
    }
  }
}

template <int C>
void filter_row(const float* padded, int before, const Taps& taps, int factor, int target_size,
                float* target) {
  const auto count = static_cast<int>(taps.weights.size());
  for (int j = 0; j < target_size; ++j) {
    const float* source =
        padded + static_cast<std::ptrdiff_t>(before + taps.first + j * factor) * C;
    double sum[C] = {};
    for (int k = 0; k < count; ++k) {
      for (int c = 0; c < C; ++c) sum[c] += taps.weights[k] * source[k * C + c];
    }
    for (int c = 0; c < C; ++c) target[j * C + c] = static_cast<float>(sum[c]);
  }
}

Image filter_rows(const ImageView& source, int factor, Kernel kernel, Wrap mode,
                  const Progress& progress, int threads) {
  const Taps taps = downsampling_taps(kernel, factor);
  const int target_width = source.width / factor;
  const int before = std::max(0, -taps.first);
  const int end = taps.first + (target_width - 1) * factor + static_cast<int>(taps.weights.size());
  const int after = std::max(0, end - source.width);
  Image target(target_width, source.height, source.channels);
  constexpr int kRows = 16;
  parallel_for((source.height + kRows - 1) / kRows, threads, progress, [&](std::int64_t band) {
    std::vector<float> padded;
    const int y_end = std::min(source.height, static_cast<int>(band + 1) * kRows);
    for (int y = static_cast<int>(band) * kRows; y < y_end; ++y) {
      pad_row(source.texel(0, y), source.width, source.channels, mode, before, after, &padded);
      float* row = target.texel(0, y);
      switch (source.channels) {
        case 1:
          filter_row<1>(padded.data(), before, taps, factor, target_width, row);
          break;
        case 2:
          filter_row<2>(padded.data(), before, taps, factor, target_width, row);
          break;
        case 3:
          filter_row<3>(padded.data(), before, taps, factor, target_width, row);
          break;
        default:
          filter_row<4>(padded.data(), before, taps, factor, target_width, row);
          break;
      }
    }
  });
  return target;
}

Image filter_columns(const ImageView& source, int factor, Kernel kernel, Wrap mode,
                     const Progress& progress, int threads) {
  const Taps taps = downsampling_taps(kernel, factor);
  const int target_height = source.height / factor;
  const std::ptrdiff_t row_values = static_cast<std::ptrdiff_t>(source.width) * source.channels;
  Image target(source.width, target_height, source.channels);
  parallel_for(target_height, threads, progress, [&](std::int64_t j) {
    std::vector<double> sums(static_cast<std::size_t>(row_values));
    for (std::size_t k = 0; k < taps.weights.size(); ++k) {
      const int y = wrap_index(taps.first + static_cast<int>(j) * factor + static_cast<int>(k),
                               source.height, mode);
      if (y < 0) continue;
      const float* from = source.texel(0, y);
      const double weight = taps.weights[k];
      for (std::ptrdiff_t i = 0; i < row_values; ++i) sums[i] += weight * from[i];
    }
    float* row = target.texel(0, static_cast<int>(j));
    std::transform(sums.begin(), sums.end(), row,
                   [](double sum) { return static_cast<float>(sum); });
  });
  return target;
}

}  // namespace

Image downsample(const ImageView& source, int factor_x, int factor_y, Kernel kernel, WrapModes wrap,
                 const Progress& progress, int threads) {
  assert(source.width % factor_x == 0 && source.height % factor_y == 0);
  Image rows = factor_x == 1 ? Image(source)
                             : filter_rows(source, factor_x, kernel, wrap.u,
                                           progress.part(0.0, 0.7), threads);
  if (factor_y == 1) return rows;
  return filter_columns(rows.view(), factor_y, kernel, wrap.v, progress.part(0.7, 1.0), threads);
}

}  // namespace prefilter
