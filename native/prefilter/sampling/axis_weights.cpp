// SPDX-License-Identifier: GPL-3.0-or-later

// The exact filter that section 6.2 approximates, for images that end or repeat.
#include "prefilter/sampling/axis_weights.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

namespace prefilter {
namespace {

// Wider kernels give identical results: the image has at most 2^20 texels.
constexpr double kMaxKernelWidth = 0x1p60;

// Sums a kernel over points at constant steps. Each piece's polynomial p has a polynomial P with
// P(t + step) - P(t) = p(t), so the sum over a piece is the difference of two values of P.
class ProgressionSum {
 public:
  ProgressionSum(const Kernel& kernel, double width, double step)
      : kernel_(kernel), piece_width_(kernel.piece_width() * width), step_(step) {
    low_ = -kernel.radius() * width;
    for (const Kernel::Piece& piece : kernel.pieces()) {
      sums_.push_back(summed(piece, kernel.degree(), step / piece_width_));
    }
  }

  // Sum over x, x - step, x - 2 step, ... of the kernel times its width.
  double up_to(double x) const {
    double sum = 0.0;
    double begin = first_from(low_, x);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double low = low_ + static_cast<double>(i) * piece_width_;
      const double end = first_from(low_ + static_cast<double>(i + 1) * piece_width_, x);
      sum += value(i, (end - low) / piece_width_) - value(i, (begin - low) / piece_width_);
      begin = end;
    }
    return sum;
  }

  // Sum over all points at multiples of the step from x.
  double everywhere(double x) const { return up_to(x + std::ceil((-low_ - x) / step_) * step_); }

 private:
  using Polynomial = std::array<double, Kernel::kMostDegree + 2>;

  // P with P(t + step) - P(t) = p(t), computed from the highest power down.
  static Polynomial summed(const Kernel::Piece& piece, int degree, double step) {
    Polynomial sum{};
    for (int n = degree; n >= 0; --n) {
      double rest = piece[n];
      double binomial = n + 1.0;  // (m over n)
      double power = step;        // to m - n
      for (int m = n + 2; m <= degree + 1; ++m) {
        binomial = binomial * m / (m - n);
        power *= step;
        rest -= sum[m] * binomial * power;
      }
      sum[n + 1] = rest / ((n + 1) * step);
    }
    return sum;
  }

  // The first point at or above `limit`; if there is none up to x, the one after x.
  double first_from(double limit, double x) const {
    return x - std::max(std::floor((x - limit) / step_), -1.0) * step_;
  }

  double value(std::size_t piece, double t) const {
    const Polynomial& sum = sums_[piece];
    double value = 0.0;
    for (int power = kernel_.degree() + 1; power > 0; --power) value = (value + sum[power]) * t;
    return value;
  }

  const Kernel& kernel_;
  double piece_width_;
  double step_;
  double low_;
  std::vector<Polynomial> sums_;
};

// Length of the line up to x that is covered by a texel and its repetitions at distance `size`.
double repeated_cover(double x, int texel, int size) {
  const double periods = std::floor(x / size);
  return periods + std::clamp(x - periods * size - texel, 0.0, 1.0);
}

// Unnormalized weights of all texels of an axis, and of everything before and behind them.
struct DenseWeights {
  std::vector<double> weights;
  double before = 0.0;
  double behind = 0.0;
};

DenseWeights wide_box(double center, double width, int size, bool repeats) {
  const double low = center - 0.5 * width;
  const double high = center + 0.5 * width;
  DenseWeights dense;
  for (int i = 0; i < size; ++i) {
    dense.weights.push_back(
        repeats ? repeated_cover(high, i, size) - repeated_cover(low, i, size)
                : std::max(0.0, std::min<double>(high, i + 1) - std::max<double>(low, i)));
  }
  dense.before = std::max(0.0, std::min(high, 0.0) - low);
  dense.behind = std::max(0.0, high - std::max<double>(low, size));
  return dense;
}

DenseWeights wide_kernel(const Kernel& kernel, double center, double width, int size,
                         bool repeats) {
  const ProgressionSum sum(kernel, width, repeats ? size : 1.0);
  DenseWeights dense;
  for (int i = 0; i < size; ++i) {
    const double x = i + 0.5 - center;
    dense.weights.push_back(repeats ? sum.everywhere(x) : kernel.value(x / width));
  }
  if (!repeats) {
    dense.before = sum.up_to(-0.5 - center);
    dense.behind = sum.up_to(center - size - 0.5);  // kernels are even
  }
  return dense;
}

AxisWeights sparse(const DenseWeights& dense, Wrap mode) {
  double sum = std::accumulate(dense.weights.begin(), dense.weights.end(), 0.0);
  if (mode != Wrap::kRepeat) sum += dense.before + dense.behind;
  AxisWeights axis;
  for (std::size_t i = 0; i < dense.weights.size(); ++i) {
    double weight = dense.weights[i];
    if (mode == Wrap::kClamp && i == 0) weight += dense.before;
    if (mode == Wrap::kClamp && i + 1 == dense.weights.size()) weight += dense.behind;
    if (weight == 0.0) continue;
    axis.texels.push_back(static_cast<int>(i));
    axis.weights.push_back(weight / sum);
  }
  return axis;
}

AxisWeights wrapped(const Taps& taps, int size, Wrap mode) {
  AxisWeights axis;
  const int count = static_cast<int>(taps.weights.size());
  if (taps.first >= 0 && taps.first + count <= size) {
    axis.texels.resize(taps.weights.size());
    std::iota(axis.texels.begin(), axis.texels.end(), taps.first);
    axis.weights = taps.weights;
    return axis;
  }
  for (int k = 0; k < count; ++k) {
    const double weight = taps.weights[static_cast<std::size_t>(k)];
    const int texel = wrap_index(taps.first + k, size, mode);
    if (texel < 0) continue;
    if (mode == Wrap::kRepeat && k >= size) {
      axis.weights[static_cast<std::size_t>(k % size)] += weight;
    } else if (!axis.texels.empty() && axis.texels.back() == texel) {
      axis.weights.back() += weight;
    } else {
      axis.texels.push_back(texel);
      axis.weights.push_back(weight);
    }
  }
  return axis;
}

// An equivalent position near the axis: modulo the period, or just so far that only the edge is
// read.
double near_axis(double center, double reach, int size, Wrap mode) {
  if (mode == Wrap::kRepeat) return center - std::floor(center / size) * size;
  return std::clamp(center, -reach - 2.0, size + reach + 2.0);
}

}  // namespace

AxisWeights axis_weights(const Kernel& kernel, double center, double width, int size, Wrap mode) {
  assert(width >= 1.0 && std::isfinite(center));
  width = std::min(width, kMaxKernelWidth);
  const double reach = kernel.radius() * width;
  const double near = near_axis(center, reach, size, mode);
  // Taps one by one are faster if they are not much more numerous than the texels.
  constexpr double kMaxDirectTaps = 64.0;
  constexpr double kMaxDirectTapsPerTexel = 8.0;
  if (2.0 * reach <= std::max(kMaxDirectTaps, kMaxDirectTapsPerTexel * size)) {
    return wrapped(kernel_taps(kernel, near, width), size, mode);
  }
  const bool repeats = mode == Wrap::kRepeat;
  return sparse(kernel.degree() == 0 ? wide_box(near, width, size, repeats)
                                     : wide_kernel(kernel, near, width, size, repeats),
                mode);
}

}  // namespace prefilter
