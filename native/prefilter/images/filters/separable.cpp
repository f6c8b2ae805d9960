// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/separable.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// Sums are doubles, added in the order of the taps, so that constant images stay exactly constant
// and results do not depend on the number of threads.

// Several rows are filtered side by side, so that the latencies of their sums overlap. Compilers
// keep this many sums, a multiple of 1 to 4, in registers.
constexpr int kInterleavedValues = 12;
constexpr int rows_at_once(int channels) { return kInterleavedValues / channels; }

int first_source(const AxisTaps& taps) {
  const auto first = std::min_element(
      taps.begin(), taps.end(), [](const Taps& a, const Taps& b) { return a.first < b.first; });
  return first->first;
}

int end_source(const AxisTaps& taps) {
  int end = 0;
  for (const Taps& texel : taps) {
    end = std::max(end, texel.first + static_cast<int>(texel.weights.size()));
  }
  return end;
}

// Copies rows from `y` on, interleaved texel by texel, with wrapped texels before and behind, so
// that taps need no bounds check. Rows past the end repeat the last one.
template <int C>
void pad_rows(const ImageView& source, int y, Wrap mode, int before, int after,
              std::vector<double>* padded) {
  constexpr int kRows = rows_at_once(C);
  padded->resize(static_cast<std::size_t>(before + source.width + after) * kRows * C);
  const float* rows[kRows];
  for (int r = 0; r < kRows; ++r) rows[r] = source.texel(0, std::min(y + r, source.height - 1));
  double* out = padded->data();
  const auto copy = [&](int begin, int end) {
    for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(begin) * C; i < end * C; i += C) {
      for (int r = 0; r < kRows; ++r) {
        for (int c = 0; c < C; ++c) *out++ = rows[r][i + c];
      }
    }
  };
  const auto copy_wrapped = [&](int i) {
    const int from = wrap_index(i, source.width, mode);
    if (from >= 0) {
      copy(from, from + 1);
    } else {
      out = std::fill_n(out, kRows * C, 0.0);
    }
  };
  for (int i = -before; i < 0; ++i) copy_wrapped(i);
  copy(0, source.width);
  for (int i = source.width; i < source.width + after; ++i) copy_wrapped(i);
}

template <int C>
void filter_rows(const ImageView& source, const AxisTaps& taps, Wrap mode, const Run& run,
                 Image* target) {
  constexpr int kRows = rows_at_once(C);
  constexpr int kValues = kRows * C;
  const int before = std::max(0, -first_source(taps));
  const int after = std::max(0, end_source(taps) - source.width);
  parallel_ranges(source.height, kRows, run, [&](int begin, int end) {
    std::vector<double> padded;
    pad_rows<C>(source, begin, mode, before, after, &padded);
    for (int x = 0; x < target->width; ++x) {
      const Taps& texel = taps[static_cast<std::size_t>(x)];
      const double* from =
          padded.data() + static_cast<std::ptrdiff_t>(before + texel.first) * kValues;
      double sums[kValues] = {};
      for (const double weight : texel.weights) {
        for (int i = 0; i < kValues; ++i) sums[i] += weight * from[i];
        from += kValues;
      }
      for (int y = begin; y < end; ++y) {
        float* to = target->texel(x, y);
        for (int c = 0; c < C; ++c) to[c] = static_cast<float>(sums[(y - begin) * C + c]);
      }
    }
  });
}

Image filter_rows(const ImageView& source, const AxisTaps& taps, Wrap mode, const Run& run) {
  Image target(static_cast<int>(taps.size()), source.height, source.channels);
  switch (source.channels) {
    case 1:
      filter_rows<1>(source, taps, mode, run, &target);
      break;
    case 2:
      filter_rows<2>(source, taps, mode, run, &target);
      break;
    case 3:
      filter_rows<3>(source, taps, mode, run, &target);
      break;
    default:
      filter_rows<4>(source, taps, mode, run, &target);
      break;
  }
  return target;
}

// A row of the source, and its weight.
struct WeightedRow {
  double weight;
  const float* values;
};

template <int kRows>
void add_rows(const WeightedRow* rows, std::ptrdiff_t begin, std::ptrdiff_t count, double* sums) {
  const float* values[kRows];
  double weights[kRows];
  for (int k = 0; k < kRows; ++k) {
    values[k] = rows[k].values + begin;
    weights[k] = rows[k].weight;
  }
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = sums[i];
    for (int k = 0; k < kRows; ++k) sum += weights[k] * values[k][i];
    sums[i] = sum;
  }
}

Image filter_columns(const ImageView& source, const AxisTaps& taps, Wrap mode, const Run& run) {
  Image target(source.width, static_cast<int>(taps.size()), source.channels);
  std::size_t most_taps = 1;
  for (const Taps& texel : taps) most_taps = std::max(most_taps, texel.weights.size());
  // Sums stay in the first-level cache, and blocks are short enough for prompt cancellation.
  constexpr std::size_t kMaxBlockValues = 1024;
  constexpr std::size_t kMaxBlockTerms = 1 << 22;
  const auto block_values = static_cast<std::ptrdiff_t>(
      std::clamp<std::size_t>(kMaxBlockTerms / most_taps, 16, kMaxBlockValues));
  const std::ptrdiff_t row_values = static_cast<std::ptrdiff_t>(source.width) * source.channels;
  const std::int64_t blocks = range_count(row_values, block_values);
  parallel_for(target.height * blocks, run, [&](std::int64_t item) {
    const auto y = static_cast<int>(item / blocks);
    const std::ptrdiff_t begin = item % blocks * block_values;
    const std::ptrdiff_t count = std::min(block_values, row_values - begin);
    std::vector<WeightedRow> rows;
    int source_y = taps[static_cast<std::size_t>(y)].first;
    for (const double weight : taps[static_cast<std::size_t>(y)].weights) {
      const int row = wrap_index(source_y++, source.height, mode);
      if (row >= 0) rows.push_back({weight, source.texel(0, row)});
    }
    std::vector<double> sums(static_cast<std::size_t>(count));
    constexpr std::size_t kTogether = 4;
    std::size_t k = 0;
    for (; k + kTogether <= rows.size(); k += kTogether) {
      add_rows<kTogether>(rows.data() + k, begin, count, sums.data());
    }
    for (; k < rows.size(); ++k) add_rows<1>(rows.data() + k, begin, count, sums.data());
    std::transform(sums.begin(), sums.end(), target.texel(0, y) + begin,
                   [](double sum) { return static_cast<float>(sum); });
  });
  return target;
}

}  // namespace

AxisTaps resampling_taps(const Kernel& kernel, int source_size, int target_size) {
  AxisTaps taps;
  if (source_size == target_size) return taps;
  const double ratio = static_cast<double>(source_size) / target_size;
  for (int j = 0; j < target_size; ++j) taps.push_back(resampling_taps(kernel, ratio, j));
  return taps;
}

Image filter_separably(const ImageView& source, const AxisTaps& along_x, const AxisTaps& along_y,
                       WrapModes wrap, const Run& run) {
  if (along_x.empty() && along_y.empty()) return Image(source);
  if (along_y.empty()) return filter_rows(source, along_x, wrap.u, run);
  if (along_x.empty()) return filter_columns(source, along_y, wrap.v, run);
  // If only the rows grow, columns come first: the intermediate image is then no larger than both
  // the source and the target.
  if (std::cmp_greater(along_x.size(), source.width) &&
      std::cmp_less(along_y.size(), source.height)) {
    const Image columns = filter_columns(source, along_y, wrap.v, run.part(0.0, 0.5));
    return filter_rows(columns.view(), along_x, wrap.u, run.part(0.5, 1.0));
  }
  const Image rows = filter_rows(source, along_x, wrap.u, run.part(0.0, 0.7));
  return filter_columns(rows.view(), along_y, wrap.v, run.part(0.7, 1.0));
}

Image filter_separably(const ImageView& source, int width, int height, const Kernel& kernel,
                       WrapModes wrap, const Run& run) {
  return filter_separably(source, resampling_taps(kernel, source.width, width),
                          resampling_taps(kernel, source.height, height), wrap, run);
}

}  // namespace prefilter
