// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/filter_products.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/base/gauss_rule.h"

namespace prefilter {
namespace {

constexpr double kFirstDeviation = 1.0 / 16.0;  // of the finest scale's Gaussian, in cells
// Gaussians and their transforms are truncated at this many standard deviations.
constexpr double kTruncation = 7.0;

double deviation_of(int scale) { return std::ldexp(kFirstDeviation, scale); }

}  // namespace

FilterProducts::FilterProducts(const Kernel& texels, const Kernel& sample, int levels,
                               ImageSpectrum spectrum)
    : texels_(&texels), sample_(&sample), levels_(levels), spectrum_(spectrum) {
  if (spectrum == ImageSpectrum::kWhite) {
    of_texels_apart_ = {{1.0}};
    return;
  }
  // Upper bound of the distances and widths of all filters in use.
  const double widest = 2.0 * (texels.radius() + sample.radius()) +
                        2.0 * std::max(texels.radius(), sample.radius()) + 2.0;
  of_texels_apart_.resize(static_cast<std::size_t>(widest * levels) + 1);
  for (int scale = 0; scale < kMaxScales; ++scale) {
    const double deviation = deviation_of(scale);
    frequencies_[scale] = frequencies_of(deviation, widest);
    for (std::size_t i = 0; i < of_texels_apart_.size(); ++i) {
      const double distance = static_cast<double>(i) / levels / deviation;
      of_texels_apart_[i][scale] = elementary::exp(-0.5 * distance * distance);
    }
  }
}

double FilterProducts::width(double f) const {
  return levels_ == 1 ? 1.0 : elementary::exp2(f - 1.0);
}

FilterProducts::Filter FilterProducts::texel(int finer, int i) const {
  const double width = std::ldexp(1.0, -finer);
  return {texels_, (i + 0.5) * width, width};
}

FilterProducts::Products FilterProducts::of_texels(int finer_i, int i, int finer_j, int j) {
  return product(texel(finer_i, i), texel(finer_j, j));
}

FilterProducts::Products FilterProducts::with_sample(int finer, int i, double x, double f) {
  return product(texel(finer, i), sample(x, f));
}

FilterProducts::Products FilterProducts::of_sample(double x, double f) {
  return product(sample(x, f), sample(x, f));
}

FilterProducts::Texels FilterProducts::overlapping(int finer, double low, double high,
                                                   double width) const {
  const double texel_width = std::ldexp(1.0, -finer);
  const double reach = sample_->radius() * width + texels_->radius() * texel_width;
  // Excludes texels that only touch.
  constexpr double kTouching = 1e-9;
  return {static_cast<int>(std::floor((low - reach) / texel_width - 0.5 + kTouching)) + 1,
          static_cast<int>(std::ceil((high + reach) / texel_width - 0.5 - kTouching)) - 1};
}

FilterProducts::Products FilterProducts::product(const Filter& a, const Filter& b) {
  if (levels_ < 3) return sums(a, b);
  if (spectrum_ == ImageSpectrum::kWhite) return {integral(a, b)};
  return correlations(a, b);
}

double FilterProducts::integral(const Filter& a, const Filter& b) const {
  const auto low = [](const Filter& filter) {
    return filter.center - filter.kernel->radius() * filter.width;
  };
  const auto high = [](const Filter& filter) {
    return filter.center + filter.kernel->radius() * filter.width;
  };
  const double end = std::min(high(a), high(b));
  double begin = std::max(low(a), low(b));
  const auto next_piece = [&](const Filter& filter, double x) {
    const double width = filter.kernel->piece_width() * filter.width;
    const double origin = low(filter);
    constexpr double kOnEdge = 1e-9;
    return origin + (std::floor((x - origin) / width + kOnEdge) + 1.0) * width;
  };
  const auto& rule = gauss_rule<Kernel::kMostDegree + 1>();
  double sum = 0.0;
  while (begin < end - 1e-12) {
    const double stop = std::min({end, next_piece(a, begin), next_piece(b, begin)});
    double piece = 0.0;
    for (int k = 0; k <= Kernel::kMostDegree; ++k) {
      const double x = begin + (stop - begin) * rule.nodes[k];
      piece += rule.weights[k] * a.kernel->value((x - a.center) / a.width) *
               b.kernel->value((x - b.center) / b.width);
    }
    sum += piece * (stop - begin);
    begin = stop;
  }
  return sum / (a.width * b.width);
}

// The double integral of a(x) b(y) exp(-(x - y)^2 / 2 s^2) equals the integral over frequencies v
// of the three transforms: sqrt(2 pi) s A(v) B(v) exp(-2 (pi s v)^2) cos(2 pi v d), with d the
// distance of the centers. The trapezoidal rule adds only the overlap of filters that are an
// inverse step apart.
FilterProducts::Products FilterProducts::correlations(const Filter& a, const Filter& b) {
  const Transform& of_a = transform_of(a);
  const Transform& of_b = transform_of(b);
  const double distance = a.center - b.center;
  Products products{};
  for (int scale = 0; scale < kMaxScales; ++scale) {
    const Frequencies& frequencies = frequencies_[scale];
    const double angle = 2.0 * std::numbers::pi * frequencies.step * distance;
    const double step_x = elementary::cos(angle);
    const double step_y = elementary::sin(angle);
    double x = 1.0;
    double y = 0.0;
    for (std::size_t i = 0; i < frequencies.weights.size(); ++i) {
      products[scale] += frequencies.weights[i] * of_a[scale][i] * of_b[scale][i] * x;
      const double turned = x * step_x - y * step_y;
      y = x * step_y + y * step_x;
      x = turned;
    }
  }
  return products;
}

FilterProducts::Frequencies FilterProducts::frequencies_of(double deviation, double widest) {
  Frequencies frequencies{1.0 / (widest + kTruncation * deviation), {}};
  const double two_pi_deviation = 2.0 * std::numbers::pi * deviation;
  for (int i = 0; i * frequencies.step * two_pi_deviation <= kTruncation; ++i) {
    const double x = i * frequencies.step * two_pi_deviation;
    const double both_signs = i == 0 ? 1.0 : 2.0;
    frequencies.weights.push_back(both_signs * frequencies.step * deviation *
                                  std::sqrt(2.0 * std::numbers::pi) *
                                  elementary::exp(-0.5 * x * x));
  }
  return frequencies;
}

// Transform of an even filter around 0: twice the integral of h(x) cos(2 pi v x) over x > 0, by
// Gauss quadrature on parts of its pieces of at most half a wave.
const FilterProducts::Transform& FilterProducts::transform_of(const Filter& filter) {
  const auto [found, is_new] = transforms_.try_emplace({filter.kernel, filter.width});
  Transform& transform = found->second;
  if (!is_new) return transform;
  const Kernel& kernel = *filter.kernel;
  const auto& rule = gauss_rule<8>();
  for (int scale = 0; scale < kMaxScales; ++scale) {
    const Frequencies& frequencies = frequencies_[scale];
    const std::size_t count = frequencies.weights.size();
    const double highest = static_cast<double>(count) * frequencies.step * filter.width;
    const double piece = kernel.piece_width() / 2.0;  // pieces start at multiples of a half
    const int parts_of_piece = static_cast<int>(std::ceil(2.0 * highest * piece));
    const int parts = parts_of_piece * static_cast<int>(std::lround(kernel.radius() / piece));
    const double part = piece / parts_of_piece;
    transform[scale].assign(count, 0.0);
    for (int node = 0; node < parts * 8; ++node) {
      const double at = (node / 8 + rule.nodes[node % 8]) * part;
      const double value = 2.0 * rule.weights[node % 8] * part * kernel.value(at);
      const double angle = 2.0 * std::numbers::pi * frequencies.step * filter.width * at;
      const double step_x = elementary::cos(angle);
      const double step_y = elementary::sin(angle);
      double x = 1.0;
      double y = 0.0;
      for (double& sum : transform[scale]) {
        sum += value * x;
        const double turned = x * step_x - y * step_y;
        y = x * step_y + y * step_x;
        x = turned;
      }
    }
  }
  return transform;
}

FilterProducts::Products FilterProducts::sums(const Filter& a, const Filter& b) const {
  const double texels = levels_;  // texels of level 0 along a cell
  const Taps left = kernel_taps(*a.kernel, a.center * texels, a.width * texels);
  const Taps right = kernel_taps(*b.kernel, b.center * texels, b.width * texels);
  // Sums of the products of texels at each distance, starting at `first`.
  const int first = left.first - right.first - static_cast<int>(right.weights.size()) + 1;
  std::vector<double> common(left.weights.size() + right.weights.size() - 1);
  for (std::size_t i = 0; i < left.weights.size(); ++i) {
    for (std::size_t j = 0; j < right.weights.size(); ++j) {
      common[i + right.weights.size() - 1 - j] += left.weights[i] * right.weights[j];
    }
  }
  Products products{};
  for (std::size_t k = 0; k < common.size(); ++k) {
    const auto apart = static_cast<std::size_t>(std::abs(first + static_cast<int>(k)));
    if (apart >= of_texels_apart_.size()) continue;
    for (int scale = 0; scale < scales(); ++scale) {
      products[scale] += common[k] * of_texels_apart_[apart][scale];
    }
  }
  return products;
}

}  // namespace prefilter
