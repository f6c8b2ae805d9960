// SPDX-License-Identifier: GPL-3.0-or-later

// Section 1.1, the equation before figure 1.8, with the bilinear basis as in section 7.3. The basis
// functions, and so the integrals over them, are products of tents along x and y.
#include "prefilter/images/resize/bilinear_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "prefilter/base/lanes.h"
#include "prefilter/base/parallel.h"
#include "prefilter/images/filters/separable.h"

namespace prefilter {
namespace {

using LineProducts = std::array<double, 3>;

// Integrals of tents along one axis, in target texels.
class TentAxis {
 public:
  TentAxis(int source_size, int target_size, Wrap wrap) : repeat_(wrap == Wrap::kRepeat) {
    for (int i = 0; i < target_size; ++i) {
      taps_.push_back(taps(i, source_size, target_size, wrap));
      std::vector<double>& weights = taps_.back().weights;
      const double mass = std::accumulate(weights.begin(), weights.end(), 0.0);
      for (double& weight : weights) weight /= mass;
      masses_.push_back(mass);
    }
  }

  int size() const { return static_cast<int>(taps_.size()); }
  /// Taps of the mean over the source under each tent.
  const AxisTaps& mean_taps() const { return taps_; }
  /// Integral of a target texel's tent.
  double mass(int i) const { return masses_[static_cast<std::size_t>(i)]; }
  /// Cell k lies between the centers of target texels k and k + 1.
  int first_cell() const { return repeat_ ? 0 : -1; }
  int last_cell() const { return size() - 1; }
  /// Integrals of the products of a cell's two tents (low x low, low x high and high x high) over
  /// its part inside the image.
  LineProducts products(int cell) const {
    const double from = !repeat_ && cell == -1 ? 0.5 : 0.0;
    const double to = !repeat_ && cell == last_cell() ? 0.5 : 1.0;
    const auto integral = [](double t) {
      return LineProducts{t * (1.0 - t * (1.0 - t / 3.0)), t * t * (0.5 - t / 3.0),
                          t * t * t / 3.0};
    };
    const LineProducts high = integral(to);
    const LineProducts low = integral(from);
    return {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  }

 private:
  // Integrals over source texels of the basis function of target texel i.
  static Taps taps(int i, int source_size, int target_size, Wrap wrap) {
    static const Kernel& tent = *find_kernel("tent");
    const double ratio = static_cast<double>(source_size) / target_size;
    // At a clamped edge the last texel also has the tent of its virtual neighbor.
    const int first = wrap == Wrap::kClamp && i == 0 ? -1 : i;
    const int last = wrap == Wrap::kClamp && i == target_size - 1 ? target_size : i;
    Taps taps;
    taps.first = static_cast<int>(std::floor((i - 0.5) * ratio));
    int end = static_cast<int>(std::ceil((i + 1.5) * ratio));
    if (wrap != Wrap::kRepeat) {
      taps.first = std::max(taps.first, 0);
      end = std::min(end, source_size);
    }
    for (int texel = taps.first; texel < end; ++texel) {
      double sum = 0.0;
      for (int k = first; k <= last; ++k) {
        const auto place = [&](double x) { return x / ratio - (k + 0.5); };
        sum += tent.integral(place(texel + 1.0)) - tent.integral(place(texel));
      }
      taps.weights.push_back(sum);
    }
    return taps;
  }

  bool repeat_;
  AxisTaps taps_;
  std::vector<double> masses_;
};

// Cells of equal parity share no texels. The last cell of an odd ring is added separately.
void add_cells(const TentAxis& x_axis, const TentAxis& y_axis, const Run& run,
               NinePointSystem<float>* system) {
  const auto add_row = [&](int row) {
    const LineProducts along_y = y_axis.products(row);
    for (int column = x_axis.first_cell(); column <= x_axis.last_cell(); ++column) {
      const LineProducts along_x = x_axis.products(column);
      NinePointSystem<float>::TentProducts products;
      for (int b = 0; b < 3; ++b) {
        for (int a = 0; a < 3; ++a) {
          products[3 * b + a] = static_cast<float>(along_y[b] * along_x[a]);
        }
      }
      system->add_cell(column, row, products, {});
    }
  };
  const int first = y_axis.first_cell();
  const int last = y_axis.last_cell();
  for (const int parity : {0, 1}) {
    const int count = (last - first - parity + 1) / 2;
    parallel_for(count, run.part(0.5 * parity, 0.5 + 0.5 * parity),
                 [&](std::int64_t i) { add_row(first + parity + 2 * static_cast<int>(i)); });
  }
  if (first <= last) add_row(last);
}

// Maps channels of an image to lanes of a system, whose last lane is alpha if it is constrained.
class LanesOfChannels {
 public:
  LanesOfChannels(int channels, const SolveOptions& solve)
      : channels_(channels), has_alpha_(solve.ranges_times_alpha) {}
  int operator()(int channel) const {
    return has_alpha_ && channel == channels_ - 1 ? kMaxChannels - 1 : channel;
  }

 private:
  int channels_;
  bool has_alpha_;
};

// Ranges of the system's texels: the intersection of both ranges, minus the offset.
TexelRanges lane_ranges(const RangesAround& around, const SolveOptions& solve,
                        const LanesOfChannels& lane, Lanes offset,
                        const NinePointSystem<float>& system, const Run& run) {
  TexelRanges ranges{std::vector<LaneValues>(system.size()),
                     std::vector<LaneValues>(system.size())};
  parallel_for(system.height(), run, [&](std::int64_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < system.width(); ++x) {
      const std::ptrdiff_t at = system.at(x, y);
      for (int c = 0; c < around.low.channels; ++c) {
        const ValueRange& both = solve.ranges[c];
        const int to = lane(c);
        ranges.low[at].v[to] =
            std::clamp(around.low.texel(x, y)[c], both.low, both.high) - offset[to];
        ranges.high[at].v[to] =
            std::clamp(around.high.texel(x, y)[c], both.low, both.high) - offset[to];
      }
    }
  });
  return ranges;
}

}  // namespace

Image fit_bilinearly(const ImageView& source, int width, int height, WrapModes wrap,
                     const SolveOptions& solve, const RangesAround* around, const Run& run) {
  const TentAxis x_axis(source.width, width, wrap.u);
  const TentAxis y_axis(source.height, height, wrap.v);
  const Stages stages(run, {6, 2, 1, 10, 1});
  Image level = filter_separably(source, x_axis.mean_taps(), y_axis.mean_taps(), wrap, stages[0]);
  NinePointSystem<float> system(width, height, wrap);
  add_cells(x_axis, y_axis, stages[1], &system);
  system.make_texels();

  const LanesOfChannels lane(level.channels, solve);
  SolveOptions by_lanes = solve;
  // Solves for differences from the first texel if that is equivalent, so that constant images stay
  // exactly constant.
  Lanes offset{};
  const bool ends_at_zero = wrap.u == Wrap::kBorder || wrap.v == Wrap::kBorder;
  for (int c = 0; c < level.channels; ++c) {
    if (!solve.ranges_times_alpha && !ends_at_zero) offset[c] = level.data[c];
    const float from = offset[lane(c)];
    by_lanes.ranges[lane(c)] = {solve.ranges[c].low - from, solve.ranges[c].high - from};
  }
  parallel_for(height, stages[2], [&](std::int64_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const auto mass = static_cast<float>(x_axis.mass(x) * y_axis.mass(y));
      LaneValues mean;
      for (int c = 0; c < level.channels; ++c) mean.v[lane(c)] = level.texel(x, y)[c];
      mean.v -= offset;
      system.texel(system.at(x, y)) = mean;
      system.right_side(system.at(x, y)).v = mass * mean.v;
    }
  });
  TexelRanges ranges;
  if (around != nullptr) {
    ranges = lane_ranges(*around, solve, lane, offset, system, Run(run.threads()));
    by_lanes.texel_ranges = &ranges;
  }
  system.invert_diagonal();
  system.solve(by_lanes, stages[3]);
  parallel_for(height, stages[4], [&](std::int64_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const Lanes solved = system.texel(system.at(x, y)).v + offset;
      for (int c = 0; c < level.channels; ++c) {
        level.texel(x, y)[c] =
            std::clamp(solved[lane(c)], solve.ranges[c].low, solve.ranges[c].high);
      }
    }
  });
  return level;
}

}  // namespace prefilter
