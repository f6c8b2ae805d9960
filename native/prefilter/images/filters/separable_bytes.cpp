// SPDX-License-Identifier: GPL-3.0-or-later

// Columns are filtered first, as this accesses whole rows; one band of rows of the result at a
// time, in strips whose source rows stay in the processor's cache. The order of summation depends
// only on the channel count.
#include "prefilter/images/filters/separable_bytes.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/base/vectors.h"

namespace prefilter {
namespace {

using Four = Vector<float, 4>;
constexpr int kFour = 4;

Four load(const float* from) {
  Four values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

void store(Four values, float* to) { std::memcpy(to, &values, sizeof values); }

Four all(float value) { return Four{value, value, value, value}; }

// Values summed at once along columns. Rows are padded to a multiple of it.
constexpr int kColumnLanes = 32;

struct WeightedTexels {
  float weight;
  const float* values;
};

void add_columns(const std::vector<WeightedTexels>& rows, std::ptrdiff_t count, float* sums) {
  constexpr int kVectors = kColumnLanes / kFour;
  for (std::ptrdiff_t i = 0; i < count; i += kColumnLanes) {
    Four sum[kVectors] = {};
    for (const WeightedTexels& row : rows) {
      const Four weight = all(row.weight);
      const float* const values = row.values + i;
      for (int k = 0; k < kVectors; ++k) sum[k] += weight * load(values + kFour * k);
    }
    for (int k = 0; k < kVectors; ++k) store(sum[k], sums + i + kFour * k);
  }
}

AxisTaps taps_or_itself(const Kernel& kernel, int source_size, int target_size) {
  AxisTaps taps = resampling_taps(kernel, source_size, target_size);
  for (int i = 0; taps.size() < static_cast<std::size_t>(target_size); ++i) {
    taps.push_back({i, {1.0}});
  }
  return taps;
}

std::size_t most_taps(const AxisTaps& taps) {
  return std::max_element(
             taps.begin(), taps.end(),
             [](const Taps& a, const Taps& b) { return a.weights.size() < b.weights.size(); })
      ->weights.size();
}

// Taps along rows, in the layout of multiplication: each weight is repeated per channel, and padded
// with zeros to whole groups of lanes.
template <int C>
class RowTaps {
 public:
  static constexpr int kLanes = C == 3 ? 12 : 4;
  static constexpr int kVectors = kLanes / kFour;
  static constexpr int kTexels = kLanes / C;  // per group

  RowTaps(const AxisTaps& taps, int source_size)
      : groups_(static_cast<int>((most_taps(taps) + kTexels - 1) / kTexels)),
        weights_(taps.size() * static_cast<std::size_t>(groups_) * kLanes) {
    int first = 0;
    int end = source_size;
    float* to = weights_.data();
    for (const Taps& texel : taps) {
      first = std::min(first, texel.first);
      end = std::max(end, texel.first + groups_ * kTexels);
      for (std::size_t i = 0; i < texel.weights.size(); ++i) {
        std::fill_n(to + i * C, C, static_cast<float>(texel.weights[i]));
      }
      to += static_cast<std::ptrdiff_t>(groups_) * kLanes;
    }
    before_ = -first;
    after_ = end - source_size;
    for (const Taps& texel : taps) starts_.push_back((texel.first + before_) * C);
  }

  int size() const { return static_cast<int>(starts_.size()); }
  int groups() const { return groups_; }
  /// Number of padding texels before the row's source texels, and behind.
  int before() const { return before_; }
  int after() const { return after_; }
  /// Start of the taps of a target texel in a padded row.
  std::ptrdiff_t start(int target) const { return starts_[static_cast<std::size_t>(target)]; }
  const float* weights(int target) const {
    return weights_.data() + static_cast<std::ptrdiff_t>(target) * groups_ * kLanes;
  }

  static void fold(const Four* sums, float* texel) {
    float lanes[kLanes];
    for (int k = 0; k < kVectors; ++k) store(sums[k], lanes + kFour * k);
    if constexpr (C == 4) {
      std::copy_n(lanes, 4, texel);
    } else if constexpr (C == 3) {
      for (int c = 0; c < C; ++c) {
        texel[c] = (lanes[c] + lanes[c + C]) + (lanes[c + 2 * C] + lanes[c + 3 * C]);
      }
    } else if constexpr (C == 2) {
      for (int c = 0; c < C; ++c) texel[c] = lanes[c] + lanes[c + C];
    } else {
      texel[0] = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    }
  }

 private:
  int groups_;
  std::vector<float> weights_;
  std::vector<std::ptrdiff_t> starts_;
  int before_ = 0;
  int after_ = 0;
};

template <int C>
class ByteFilter {
 public:
  ByteFilter(const FilteredImage& source, const AxisTaps& along_x, const AxisTaps& along_y,
             WrapModes wrap)
      : source_(source),
        along_x_(along_x, source.width()),
        along_y_(along_y),
        wrap_(wrap),
        stride_(static_cast<std::ptrdiff_t>(along_x_.before() + source.width() + along_x_.after()) *
                    C +
                kColumnLanes) {}

  /// Computes rows [begin, end) of the result.
  void make(int begin, int end, Image* target) const {
    const auto band =
        std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>((end - begin) * stride_));
    add_columns_of(begin, end, band.get());
    for (int y = begin; y < end; ++y) pad(band.get() + (y - begin) * stride_);
    for (int y = begin; y < end; y += kRows) {
      const float* rows[kRows];
      for (int r = 0; r < kRows; ++r) {
        rows[r] = band.get() + (std::min(y + r, end - 1) - begin) * stride_;
      }
      add_along(rows, y, std::min(y + kRows, end), target);
    }
  }

 private:
  using Along = RowTaps<C>;
  // Rows filtered side by side, so that sums stay in registers and their latencies overlap.
  static constexpr int kRows = C == 3 ? 4 : 8;
  // Width of a strip. The part of it that a row of the result reads fits in the first-level cache.
  static constexpr int kStripTexels = 256 / C;

  // A row of a strip, and its weight in a row of the result.
  struct Tap {
    std::ptrdiff_t place;
    float weight;
  };

  void add_columns_of(int begin, int end, float* band) const {
    std::vector<int> read;
    const std::vector<std::vector<Tap>> taps = taps_of(begin, end, &read);
    constexpr std::ptrdiff_t kStride = kStripTexels * C + kColumnLanes;
    const auto strip = std::make_unique_for_overwrite<float[]>(read.size() * kStride);
    std::vector<WeightedTexels> rows;
    for (int x = 0; x < source_.width(); x += kStripTexels) {
      const int strip_end = std::min(x + kStripTexels, source_.width());
      for (std::size_t i = 0; i < read.size(); ++i) {
        source_.read(read[i], x, strip_end, strip.get() + i * kStride);
      }
      for (int y = begin; y < end; ++y) {
        rows.clear();
        for (const Tap& tap : taps[static_cast<std::size_t>(y - begin)]) {
          rows.push_back({tap.weight, strip.get() + tap.place * kStride});
        }
        add_columns(
            rows, static_cast<std::ptrdiff_t>(strip_end - x) * C,
            band + (y - begin) * stride_ + static_cast<std::ptrdiff_t>(along_x_.before() + x) * C);
      }
    }
  }

  // The taps of rows [begin, end), and the source rows that they read, in increasing order.
  std::vector<std::vector<Tap>> taps_of(int begin, int end, std::vector<int>* read) const {
    const auto each = [&](const auto& visit) {
      for (int y = begin; y < end; ++y) {
        int row = along_y_[static_cast<std::size_t>(y)].first;
        for (const double weight : along_y_[static_cast<std::size_t>(y)].weights) {
          const int from = wrap_index(row++, source_.height(), wrap_.v);
          if (from >= 0) visit(y, from, static_cast<float>(weight));
        }
      }
    };
    each([&](int, int row, float) { read->push_back(row); });
    std::sort(read->begin(), read->end());
    read->erase(std::unique(read->begin(), read->end()), read->end());
    std::vector<std::vector<Tap>> taps(static_cast<std::size_t>(end - begin));
    each([&](int y, int row, float weight) {
      const auto place = std::lower_bound(read->begin(), read->end(), row) - read->begin();
      taps[static_cast<std::size_t>(y - begin)].push_back({place, weight});
    });
    return taps;
  }

  // Copies the wrapped texels beside the row.
  void pad(float* row) const {
    const auto copy = [&](int x) {
      const int from = wrap_index(x, source_.width(), wrap_.u);
      float* const to = row + static_cast<std::ptrdiff_t>(along_x_.before() + x) * C;
      for (int c = 0; c < C; ++c) {
        to[c] =
            from < 0 ? 0.0F : row[static_cast<std::ptrdiff_t>(along_x_.before() + from) * C + c];
      }
    };
    for (int x = -along_x_.before(); x < 0; ++x) copy(x);
    for (int x = 0; x < along_x_.after(); ++x) copy(source_.width() + x);
  }

  void add_along(const float* const* rows, int begin, int end, Image* target) const {
    for (int x = 0; x < along_x_.size(); ++x) {
      Four sums[kRows][Along::kVectors] = {};
      const float* weight = along_x_.weights(x);
      std::ptrdiff_t at = along_x_.start(x);
      for (int group = 0; group < along_x_.groups(); ++group) {
        for (int k = 0; k < Along::kVectors; ++k, at += kFour, weight += kFour) {
          const Four weights = load(weight);
          for (int r = 0; r < kRows; ++r) sums[r][k] += weights * load(rows[r] + at);
        }
      }
      for (int y = begin; y < end; ++y) Along::fold(sums[y - begin], target->texel(x, y));
    }
  }

  const FilteredImage& source_;
  Along along_x_;
  const AxisTaps& along_y_;
  WrapModes wrap_;
  std::ptrdiff_t stride_;  // of a padded row, in values
};

// Number of source rows per row of the result, and per additional row.
struct RowsRead {
  RowsRead(int source_size, int target_size, const Kernel& kernel)
      : by_each(std::max(1.0, static_cast<double>(source_size) / target_size)),
        of_one(2.0 * kernel.radius() * by_each + 2.0) {}
  double by_each;
  double of_one;
};

constexpr double kMaxValuesRead = 1 << 23;  // per band
constexpr double kMaxBandRows = 64;

double row_values(int source_width, int width, int channels) {
  return static_cast<double>(std::max(source_width, width)) * channels;
}

template <int C>
Image filtered(const FilteredImage& source, const AxisTaps& along_x, const AxisTaps& along_y,
               int rows_at_once, WrapModes wrap, const Run& run) {
  const ByteFilter<C> filter(source, along_x, along_y, wrap);
  Image target(static_cast<int>(along_x.size()), static_cast<int>(along_y.size()), C);
  parallel_ranges(target.height, rows_at_once, run, [&](std::int64_t begin, std::int64_t end) {
    filter.make(static_cast<int>(begin), static_cast<int>(end), &target);
  });
  return target;
}

}  // namespace

bool reads_few_rows(const TexelSource& image, int width, int height, const Kernel& kernel) {
  const double rows = RowsRead(image.height, height, kernel).of_one;
  return rows * row_values(image.width, width, image.channels) <= kMaxValuesRead;
}

Image filter_bytes_separably(const FilteredImage& bytes, int width, int height,
                             const Kernel& kernel, WrapModes wrap, const Run& run) {
  const AxisTaps along_x = taps_or_itself(kernel, bytes.width(), width);
  const AxisTaps along_y = taps_or_itself(kernel, bytes.height(), height);
  const RowsRead read(bytes.height(), height, kernel);
  const double most = kMaxValuesRead / row_values(bytes.width(), width, bytes.channels());
  // Enough bands for all threads; the first source rows of each are read for the previous band too.
  const double share = static_cast<double>(height) / (2 * resolve_threads(run.threads()));
  const auto rows = static_cast<int>(
      std::clamp(std::min(share, (most - read.of_one) / read.by_each), 1.0, kMaxBandRows));
  switch (bytes.channels()) {
    case 1:
      return filtered<1>(bytes, along_x, along_y, rows, wrap, run);
    case 2:
      return filtered<2>(bytes, along_x, along_y, rows, wrap, run);
    case 3:
      return filtered<3>(bytes, along_x, along_y, rows, wrap, run);
    default:
      return filtered<4>(bytes, along_x, along_y, rows, wrap, run);
  }
}

}  // namespace prefilter
