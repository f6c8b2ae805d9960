// SPDX-License-Identifier: GPL-3.0-or-later

// Section 1.1, figure 1.6.
#include "prefilter/resize/radial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/filters/windowed_jinc.h"

namespace prefilter {
namespace {

// WindowedJinc as a function of the squared distance, in which it is smooth: cubics that meet it at
// their thirds, off by 1e-9 at the most.
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

// Which source texels a target texel reads along an axis. Target texels whose centers lie alike
// between source texels are of the same phase.
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
  /// The first source texel, of taps() many.
  int first(int target) const { return first_of_phase(phase(target)) + target / phases_ * step_; }
  int taps() const { return static_cast<int>(std::floor(2.0 * reach_)) + 1; }
  /// The square of how far tap `tap` of a phase is from the center.
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

// What some target texels of one row are made of.
struct Sums {
  std::vector<double> values;   // weighted, texel by texel
  std::vector<double> weights;  // of each texel

  void add(const Sums& other) {
    std::transform(values.begin(), values.end(), other.values.begin(), values.begin(),
                   std::plus<>());
    std::transform(weights.begin(), weights.end(), other.weights.begin(), weights.begin(),
                   std::plus<>());
  }
};

// Part of the work: target texels [begin, end) of row y, and of their taps along y some.
struct Part {
  int y;
  int begin;
  int end;
  int first_tap;
  int end_tap;
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

  Sums sums(const Part& part) const {
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
  template <int C>
  Sums sums_of(const Part& part) const {
    const int taps = x_axis_.taps();
    const int count = part.end - part.begin;
    const int first = x_axis_.first(part.begin);
    const int width = x_axis_.first(part.end - 1) + taps - first;
    // Texels of the same phase have the same weights.
    const bool shared = x_axis_.phases() < count;
    const int slots = shared ? x_axis_.phases() : count;
    std::vector<double> x_distances(static_cast<std::size_t>(slots) * taps);
    for (int s = 0; s < slots; ++s) {
      const int phase = shared ? s : x_axis_.phase(part.begin + s);
      for (int i = 0; i < taps; ++i) {
        x_distances[static_cast<std::size_t>(s) * taps + i] = x_axis_.squared_distance(phase, i);
      }
    }
    std::vector<double> weights(x_distances.size());
    std::vector<double> weight_sums(static_cast<std::size_t>(slots));
    std::vector<double> row(static_cast<std::size_t>(width) * C);
    Sums sums{std::vector<double>(static_cast<std::size_t>(count) * C),
              std::vector<double>(static_cast<std::size_t>(count))};
    for (int j = part.first_tap; j < part.end_tap; ++j) {
      const double y_distance = y_axis_.squared_distance(y_axis_.phase(part.y), j);
      for (int s = 0; s < slots; ++s) {
        const std::size_t at = static_cast<std::size_t>(s) * taps;
        double sum = 0.0;
        for (int i = 0; i < taps; ++i) {
          weights[at + i] = table_(x_distances[at + i] + y_distance);
          sum += weights[at + i];
        }
        weight_sums[s] += sum;
      }
      const int source_y = wrap_index(y_axis_.first(part.y) + j, source_.height, wrap_.v);
      if (source_y < 0) continue;
      read_row<C>(source_y, first, width, row.data());
      double* to = sums.values.data();
      for (int x = part.begin; x < part.end; ++x) {
        const int slot = shared ? x_axis_.phase(x) : x - part.begin;
        const double* weight = weights.data() + static_cast<std::size_t>(slot) * taps;
        const double* from = row.data() + static_cast<std::ptrdiff_t>(x_axis_.first(x) - first) * C;
        double sum[C] = {};
        for (int i = 0; i < taps; ++i, from += C) {
          for (int c = 0; c < C; ++c) sum[c] += weight[i] * from[c];
        }
        for (int c = 0; c < C; ++c) *to++ += sum[c];
      }
    }
    for (int x = part.begin; x < part.end; ++x) {
      sums.weights[x - part.begin] = weight_sums[shared ? x_axis_.phase(x) : x - part.begin];
    }
    return sums;
  }

  template <int C>
  void read_row(int y, int first, int width, double* row) const {
    for (int x = first; x < first + width; ++x) {
      const int from = wrap_index(x, source_.width, wrap_.u);
      for (int c = 0; c < C; ++c) *row++ = from < 0 ? 0.0 : source_.texel(from, y)[c];
    }
  }

  ImageView source_;
  Axis x_axis_;
  Axis y_axis_;
  RadialTable table_;
  WrapModes wrap_;
};

void write(const Sums& sums, int channels, float* texel) {
  for (std::size_t i = 0; i < sums.values.size(); ++i) {
    texel[i] =
        static_cast<float>(sums.values[i] / sums.weights[i / static_cast<std::size_t>(channels)]);
  }
}

}  // namespace

Image filter_radially(const ImageView& source, int width, int height, int radius, WrapModes wrap,
                      const Progress& progress, int threads) {
  const Filter filter(source, width, height, radius, wrap);
  // No part takes so long that a cancel would wait for it: where a single texel does, its taps are
  // parted too.
  constexpr double kMostTerms = 1 << 22;
  constexpr int kMostTexels = 512;
  const int rows = filter.y_axis().taps();
  const double row_terms = filter.x_axis().taps();
  const int texels =
      static_cast<int>(std::clamp<double>(kMostTerms / (row_terms * rows), 1, kMostTexels));
  const int rows_together = static_cast<int>(std::clamp<double>(kMostTerms / row_terms, 1, rows));
  const std::int64_t blocks = range_count(width, texels);
  const std::int64_t pieces = texels > 1 ? 1 : range_count(rows, rows_together);
  const auto part_of = [&](std::int64_t block, std::int64_t piece) {
    Part part{};
    part.y = static_cast<int>(block / blocks);
    part.begin = static_cast<int>(block % blocks) * texels;
    part.end = std::min(part.begin + texels, width);
    part.first_tap = static_cast<int>(piece) * rows_together;
    part.end_tap = pieces == 1 ? rows : std::min(part.first_tap + rows_together, rows);
    return part;
  };
  Image target(width, height, source.channels);
  const auto finish = [&](std::int64_t block, const Sums& sums) {
    const Part part = part_of(block, 0);
    write(sums, source.channels, target.texel(part.begin, part.y));
  };
  if (pieces == 1) {
    parallel_for(height * blocks, threads, progress,
                 [&](std::int64_t block) { finish(block, filter.sums(part_of(block, 0))); });
    return target;
  }
  std::vector<Sums> sums(static_cast<std::size_t>(height * blocks * pieces));
  parallel_for(height * blocks * pieces, threads, progress, [&](std::int64_t i) {
    sums[static_cast<std::size_t>(i)] = filter.sums(part_of(i / pieces, i % pieces));
  });
  for (std::int64_t block = 0; block < height * blocks; ++block) {
    Sums& sum = sums[static_cast<std::size_t>(block * pieces)];
    for (std::int64_t piece = 1; piece < pieces; ++piece) {
      sum.add(sums[static_cast<std::size_t>(block * pieces + piece)]);
    }
    finish(block, sum);
  }
  return target;
}

}  // namespace prefilter
