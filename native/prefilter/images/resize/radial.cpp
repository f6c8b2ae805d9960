// SPDX-License-Identifier: GPL-3.0-or-later

// Section 1.1, figure 1.6.
#include "prefilter/images/resize/radial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/base/vectors.h"
#include "prefilter/images/filters/windowed_jinc.h"

namespace prefilter {
namespace {

// WindowedJinc as a function of the squared distance, in which it is smooth: piecewise cubics that
// interpolate it at thirds of each piece, with an error of at most 1e-9.
class RadialTable {
 public:
  explicit RadialTable(int radius)
      : pieces_per_unit_(kPieces / static_cast<double>(radius * radius)) {
    const WindowedJinc filter(radius);
    for (int i = 0; i < kPieces; ++i) {
      std::array<double, 4> at;
      for (int k = 0; k < 4; ++k) at[k] = filter(std::sqrt((i + k / 3.0) / pieces_per_unit_));
      // Newton's forward differences, at steps of a third.
      const double first = at[1] - at[0];
      const double second = (at[2] - at[1] - first) / 2.0;
      const double third = (at[3] - 2.0 * at[2] + at[1] - 2.0 * second) / 6.0;
      pieces_[i] = {at[0], 3.0 * (first - second + 2.0 * third), 9.0 * (second - 3.0 * third),
                    27.0 * third};
    }
  }

  double operator()(double squared_distance) const {
    const double place = squared_distance * pieces_per_unit_;
    if (!(place < kPieces)) return 0.0;
    const auto piece = static_cast<int>(place);
    const double t = place - piece;
    const std::array<double, 4>& c = pieces_[piece];
    return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
  }

 private:
  static constexpr int kPieces = 256;
  double pieces_per_unit_;
  std::array<std::array<double, 4>, kPieces> pieces_;
};

// The source texels that a target texel reads along an axis. Target texels with the same position
// relative to source texels have the same phase.
class Axis {
 public:
  Axis(int source_size, int target_size, int radius)
      : source_(source_size),
        target_(target_size),
        phases_(target_size / std::gcd(source_size, target_size)),
        step_(source_size / std::gcd(source_size, target_size)),
        unit_(std::max(1.0, static_cast<double>(source_size) / target_size)),
        reach_(radius * unit_) {}

  int phases() const { return phases_; }
  int phase(int target) const { return target % phases_; }
  /// The first of taps() source texels.
  int first(int target) const { return first_of_phase(phase(target)) + target / phases_ * step_; }
  int taps() const { return static_cast<int>(std::floor(2.0 * reach_)) + 1; }
  /// Squared distance of tap `tap` of a phase from the center.
  double squared_distance(int phase, int tap) const {
    const double away = (first_of_phase(phase) + tap + 0.5 - center(phase)) / unit_;
    return away * away;
  }

 private:
  double center(int phase) const { return (phase + 0.5) * source_ / target_; }
  int first_of_phase(int phase) const {
    return static_cast<int>(std::ceil(center(phase) - reach_ - 0.5));
  }

  int source_;
  int target_;
  int phases_;
  int step_;
  double unit_;
  double reach_;
};

// Values summed side by side: some taps of a texel, channel by channel.
constexpr int lanes_of(int channels) { return channels == 3 ? 12 : 4; }

// Sums of some target texels in a row.
struct Sums {
  std::vector<double> values;   // weighted sums, texel by texel, in lanes
  std::vector<double> weights;  // sum of weights of each texel

  void add(const Sums& other) {
    std::transform(values.begin(), values.end(), other.values.begin(), values.begin(),
                   std::plus<>());
    std::transform(weights.begin(), weights.end(), other.weights.begin(), weights.begin(),
                   std::plus<>());
  }
};

// A part of the work: target texels [begin, end) of rows [y, end_y), and a range of their taps
// along y.
struct Part {
  int y;
  int end_y;
  int begin;
  int end;
  int first_tap;
  int end_tap;
};

// The weights of one row of taps for target texels [begin, end). Each weight is repeated per
// channel, to be multiplied with the values of a row side by side.
template <int C>
class RowWeights {
 public:
  static constexpr int kLanes = lanes_of(C);
  static constexpr int kTaps = kLanes / C;  // summed at once

  RowWeights(const Axis& axis, const RadialTable& table, int begin, int end)
      : axis_(axis), table_(table), begin_(begin), end_(end) {
    // Texels of the same phase have the same weights.
    shares_ = axis.phases() < end - begin;
    const auto slots = static_cast<std::size_t>(shares_ ? axis.phases() : end - begin);
    stride_ = (axis.taps() + kTaps) * C;
    for (int x = begin; x < end; ++x) {
      firsts_.push_back(axis.first(x));
      slots_.push_back(shares_ ? axis.phase(x) : x - begin);
    }
    slot_count_ = slots;
    weights_.resize(slots * static_cast<std::size_t>(stride_));
    distances_.resize(slots * static_cast<std::size_t>(axis.taps()));
    for (std::size_t s = 0; s < slots; ++s) {
      const int phase = shares_ ? static_cast<int>(s) : axis.phase(begin + static_cast<int>(s));
      for (int i = 0; i < axis.taps(); ++i) {
        distances_[s * axis.taps() + i] = axis.squared_distance(phase, i);
      }
    }
  }

  /// Number of distinct sets of weights.
  std::size_t slots() const { return slot_count_; }
  /// Index of a texel's set of weights, as in the sums of `move_to`.
  std::size_t slot(int x) const { return static_cast<std::size_t>(slots_[x - begin_]); }

  /// Computes the weights of the taps in a row at that squared distance, and adds them to `sums`
  /// per slot.
  void move_to(double y_distance, std::vector<double>* sums) {
    first_ = axis_.taps();
    int last = 0;
    for (std::size_t s = 0; s < slot_count_; ++s) {
      double* to = weights_.data() + s * stride_;
      double sum = 0.0;
      for (int i = 0; i < axis_.taps(); ++i, to += C) {
        const double weight = table_(distances_[s * axis_.taps() + i] + y_distance);
        std::fill_n(to, C, weight);
        sum += weight;
        if (weight == 0.0) continue;
        first_ = std::min(first_, i);
        last = std::max(last, i);
      }
      (*sums)[s] += sum;
    }
    groups_ = std::max(0, (last + kTaps - first_) / kTaps);
  }

  /// Adds a row to the values of the target texels. It starts at source texel `first` and is padded
  /// by kTaps texels beyond the last tap.
  void add_row(const double* row, int first, double* values) const {
    // Texels of one phase are summed together, so that the latencies of their sums overlap.
    constexpr int kTogether = C == 3 ? 2 : 4;
    const int step = axis_.phases();
    int x = begin_;
    if (shares_) {
      for (; x + kTogether * step <= end_; x += kTogether * step) {
        for (int k = 0; k < step; ++k) add_texels<kTogether>(row, first, x + k, step, values);
      }
    }
    for (; x < end_; ++x) add_texels<1>(row, first, x, step, values);
  }

 private:
  using Two = Vector<double, 2>;

  template <int kCount>
  void add_texels(const double* row, int first, int x, int step, double* values) const {
    constexpr int kVectors = kLanes / 2;
    Two sums[kCount][kVectors] = {};
    const double* from[kCount];
    for (int k = 0; k < kCount; ++k) {
      from[k] =
          row + static_cast<std::ptrdiff_t>(firsts_[x + k * step - begin_] + first_ - first) * C;
    }
    const double* weight = weights_.data() + slot(x) * stride_ + first_ * C;
    std::ptrdiff_t at = 0;
    for (int group = 0; group < groups_; ++group) {
      for (int v = 0; v < kVectors; ++v, at += 2) {
        Two weights;
        std::memcpy(&weights, weight + at, sizeof weights);
        for (int k = 0; k < kCount; ++k) {
          Two two;
          std::memcpy(&two, from[k] + at, sizeof two);
          sums[k][v] += weights * two;
        }
      }
    }
    for (int k = 0; k < kCount; ++k) {
      double* to = values + static_cast<std::ptrdiff_t>(x + k * step - begin_) * kLanes;
      for (int v = 0; v < kVectors; ++v, to += 2) {
        Two before;
        std::memcpy(&before, to, sizeof before);
        before += sums[k][v];
        std::memcpy(to, &before, sizeof before);
      }
    }
  }

  const Axis& axis_;
  const RadialTable& table_;
  int begin_;
  int end_;
  bool shares_ = false;
  int stride_ = 0;           // number of values per slot: weights, then zeros
  std::vector<int> firsts_;  // the first tap of each target texel
  std::vector<int> slots_;   // index of each target texel's weights
  std::size_t slot_count_ = 0;
  std::vector<double> weights_;
  std::vector<double> distances_;
  int first_ = 0;   // the first tap with a nonzero weight
  int groups_ = 0;  // number of groups from there on
};

class Filter {
 public:
  Filter(const ImageView& source, int width, int height, int radius, WrapModes wrap)
      : source_(source),
        x_axis_(source.width, width, radius),
        y_axis_(source.height, height, radius),
        table_(radius),
        wrap_(wrap) {}

  const Axis& x_axis() const { return x_axis_; }
  const Axis& y_axis() const { return y_axis_; }

  /// The sums of each row.
  std::vector<Sums> sums(const Part& part) const {
    switch (source_.channels) {
      case 1:
        return sums_of<1>(part);
      case 2:
        return sums_of<2>(part);
      case 3:
        return sums_of<3>(part);
      default:
        return sums_of<4>(part);
    }
  }

 private:
  // Reads each row of the source once for all rows of the part.
  template <int C>
  std::vector<Sums> sums_of(const Part& part) const {
    const auto count = static_cast<std::size_t>(part.end - part.begin);
    const int first = x_axis_.first(part.begin);
    const int width = x_axis_.first(part.end - 1) + x_axis_.taps() - first;
    RowWeights<C> weights(x_axis_, table_, part.begin, part.end);
    std::vector<double> row(static_cast<std::size_t>(width + RowWeights<C>::kTaps) * C);
    const auto rows = static_cast<std::size_t>(part.end_y - part.y);
    std::vector<Sums> sums(rows, {std::vector<double>(count * lanes_of(C)), {}});
    std::vector<std::vector<double>> weight_sums(rows, std::vector<double>(weights.slots()));
    const int first_row = y_axis_.first(part.y) + part.first_tap;
    const int end_row = y_axis_.first(part.end_y - 1) + part.end_tap;
    for (int from = first_row; from < end_row; ++from) {
      const int source_y = wrap_index(from, source_.height, wrap_.v);
      if (source_y >= 0) read_row<C>(source_y, first, width, row.data());
      for (int y = part.y; y < part.end_y; ++y) {
        const int tap = from - y_axis_.first(y);
        if (tap < part.first_tap || tap >= part.end_tap) continue;
        const auto k = static_cast<std::size_t>(y - part.y);
        weights.move_to(y_axis_.squared_distance(y_axis_.phase(y), tap), &weight_sums[k]);
        if (source_y >= 0) weights.add_row(row.data(), first, sums[k].values.data());
      }
    }
    for (std::size_t k = 0; k < rows; ++k) {
      for (int x = part.begin; x < part.end; ++x) {
        sums[k].weights.push_back(weight_sums[k][weights.slot(x)]);
      }
    }
    return sums;
  }

  template <int C>
  void read_row(int y, int first, int width, double* row) const {
    const auto copy_wrapped = [&](int begin, int end) {
      for (int x = begin; x < end; ++x) {
        const int from = wrap_index(x, source_.width, wrap_.u);
        for (int c = 0; c < C; ++c) {
          row[static_cast<std::ptrdiff_t>(x - first) * C + c] =
              from < 0 ? 0.0 : source_.texel(from, y)[c];
        }
      }
    };
    const int inner = std::clamp(0, first, first + width);
    const int inner_end = std::clamp(source_.width, inner, first + width);
    copy_wrapped(first, inner);
    if (inner < inner_end) {
      const float* const from = source_.texel(inner, y);
      std::copy(from, from + static_cast<std::ptrdiff_t>(inner_end - inner) * C,
                row + static_cast<std::ptrdiff_t>(inner - first) * C);
    }
    copy_wrapped(inner_end, first + width);
  }

  ImageView source_;
  Axis x_axis_;
  Axis y_axis_;
  RadialTable table_;
  WrapModes wrap_;
};

void write(const Sums& sums, int channels, float* texel) {
  const int lanes = lanes_of(channels);
  const double* values = sums.values.data();
  for (const double weight : sums.weights) {
    for (int c = 0; c < channels; ++c) {
      double sum = values[c];
      for (int i = c + channels; i < lanes; i += channels) sum += values[i];
      *texel++ = static_cast<float>(sum / weight);
    }
    values += lanes;
  }
}

}  // namespace

Image filter_radially(const ImageView& source, int width, int height, int radius, WrapModes wrap,
                      const Run& run) {
  const Filter filter(source, width, height, radius, wrap);
  // Parts are short enough for prompt cancellation: if necessary, even the taps of a single texel
  // are divided.
  constexpr double kMaxPartTerms = 1 << 22;
  constexpr int kMaxPartTexels = 512;
  constexpr int kMaxBand = 8;
  const int rows = filter.y_axis().taps();
  const double row_terms = filter.x_axis().taps();
  const int texels =
      static_cast<int>(std::clamp<double>(kMaxPartTerms / (row_terms * rows), 1, kMaxPartTexels));
  const int rows_together =
      static_cast<int>(std::clamp<double>(kMaxPartTerms / row_terms, 1, rows));
  const std::int64_t blocks = range_count(width, texels);
  const std::int64_t pieces = texels > 1 ? 1 : range_count(rows, rows_together);
  // Parts with the maximum of texels comprise several rows.
  const int band = texels == kMaxPartTexels ? kMaxBand : 1;
  const auto part_of = [&](std::int64_t block, std::int64_t piece) {
    Part part{};
    part.y = static_cast<int>(block / blocks) * band;
    part.end_y = std::min(part.y + band, height);
    part.begin = static_cast<int>(block % blocks) * texels;
    part.end = std::min(part.begin + texels, width);
    part.first_tap = static_cast<int>(piece) * rows_together;
    part.end_tap = pieces == 1 ? rows : std::min(part.first_tap + rows_together, rows);
    return part;
  };
  Image target(width, height, source.channels);
  const auto finish = [&](std::int64_t block, const std::vector<Sums>& sums) {
    const Part part = part_of(block, 0);
    for (int y = part.y; y < part.end_y; ++y) {
      write(sums[static_cast<std::size_t>(y - part.y)], source.channels,
            target.texel(part.begin, y));
    }
  };
  const std::int64_t count = range_count(height, band) * blocks;
  if (pieces == 1) {
    parallel_for(count, run,
                 [&](std::int64_t block) { finish(block, filter.sums(part_of(block, 0))); });
    return target;
  }
  std::vector<std::vector<Sums>> sums(static_cast<std::size_t>(count * pieces));
  parallel_for(count * pieces, run, [&](std::int64_t i) {
    sums[static_cast<std::size_t>(i)] = filter.sums(part_of(i / pieces, i % pieces));
  });
  for (std::int64_t block = 0; block < count; ++block) {
    std::vector<Sums>& sum = sums[static_cast<std::size_t>(block * pieces)];
    for (std::int64_t piece = 1; piece < pieces; ++piece) {
      sum.front().add(sums[static_cast<std::size_t>(block * pieces + piece)].front());
    }
    finish(block, sum);
  }
  return target;
}

}  // namespace prefilter
