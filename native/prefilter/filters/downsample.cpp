#include "prefilter/filters/downsample.h"

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

std::vector<Taps> all_taps(const Kernel& kernel, int source_size, int target_size) {
  const double scale = static_cast<double>(source_size) / target_size;
  std::vector<Taps> taps;
  for (int j = 0; j < target_size; ++j) taps.push_back(downsampling_taps(kernel, scale, j));
  return taps;
}

template <int C>
void filter_row(const float* padded, int before, const std::vector<Taps>& taps, float* target) {
  for (const Taps& texel : taps) {
    const float* source = padded + static_cast<std::ptrdiff_t>(before + texel.first) * C;
    double sum[C] = {};
    for (const double weight : texel.weights) {
      for (int c = 0; c < C; ++c) sum[c] += weight * source[c];
      source += C;
    }
    for (int c = 0; c < C; ++c) *target++ = static_cast<float>(sum[c]);
  }
}

Image filter_rows(const ImageView& source, int width, const Kernel& kernel, Wrap mode,
                  const Progress& progress, int threads) {
  const std::vector<Taps> taps = all_taps(kernel, source.width, width);
  const int taps_end = taps.back().first + static_cast<int>(taps.back().weights.size());
  const int before = std::max(0, -taps.front().first);
  const int after = std::max(0, taps_end - source.width);
  Image target(width, source.height, source.channels);
  constexpr int kRowsAtOnce = 16;
  parallel_ranges(source.height, kRowsAtOnce, threads, progress, [&](int begin, int end) {
    std::vector<float> padded;
    for (int y = begin; y < end; ++y) {
      pad_row(source.texel(0, y), source.width, source.channels, mode, before, after, &padded);
      float* row = target.texel(0, y);
      switch (source.channels) {
        case 1:
          filter_row<1>(padded.data(), before, taps, row);
          break;
        case 2:
          filter_row<2>(padded.data(), before, taps, row);
          break;
        case 3:
          filter_row<3>(padded.data(), before, taps, row);
          break;
        default:
          filter_row<4>(padded.data(), before, taps, row);
          break;
      }
    }
  });
  return target;
}

Image filter_columns(const ImageView& source, int height, const Kernel& kernel, Wrap mode,
                     const Progress& progress, int threads) {
  const std::vector<Taps> taps = all_taps(kernel, source.height, height);
  const std::ptrdiff_t row_values = static_cast<std::ptrdiff_t>(source.width) * source.channels;
  Image target(source.width, height, source.channels);
  parallel_for(height, threads, progress, [&](std::int64_t j) {
    std::vector<double> sums(static_cast<std::size_t>(row_values));
    int y = taps[j].first;
    for (const double weight : taps[j].weights) {
      const int row = wrap_index(y++, source.height, mode);
      if (row < 0) continue;
      const float* from = source.texel(0, row);
      for (std::ptrdiff_t i = 0; i < row_values; ++i) sums[i] += weight * from[i];
    }
    float* row = target.texel(0, static_cast<int>(j));
    std::transform(sums.begin(), sums.end(), row,
                   [](double sum) { return static_cast<float>(sum); });
  });
  return target;
}

}  // namespace

Image downsample(const ImageView& source, int width, int height, const Kernel& kernel,
                 WrapModes wrap, const Progress& progress, int threads) {
  assert(width <= source.width && height <= source.height);
  Image rows = width == source.width
                   ? Image(source)
                   : filter_rows(source, width, kernel, wrap.u, progress.part(0.0, 0.7), threads);
  if (height == source.height) return rows;
  return filter_columns(rows.view(), height, kernel, wrap.v, progress.part(0.7, 1.0), threads);
}

}  // namespace prefilter
