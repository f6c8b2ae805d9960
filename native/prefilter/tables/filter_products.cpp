// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/tables/filter_products.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/elementary.h"
#include "prefilter/base/gauss_rule.h"

namespace prefilter {

double FilterProducts::width(double f) const {
  return levels_ == 1 ? 1.0 : elementary::exp2(f - 1.0);
}

FilterProducts::Filter FilterProducts::texel(int finer, int i) {
  const double width = std::ldexp(1.0, -finer);
  return {(i + 0.5) * width, width};
}

double FilterProducts::of_texels(int finer_i, int i, int finer_j, int j) const {
  return product(texel(finer_i, i), texel(finer_j, j));
}

double FilterProducts::with_sample(int finer, int i, double x, double f) const {
  return product(texel(finer, i), {x, width(f)});
}

double FilterProducts::of_sample(double x, double f) const {
  return product({x, width(f)}, {x, width(f)});
}

FilterProducts::Texels FilterProducts::overlapping(int finer, double low, double high,
                                                   double width) const {
  const double texel_width = std::ldexp(1.0, -finer);
  const double reach = kernel_.radius() * (width + texel_width);
  // Those that only touch do not overlap.
  constexpr double kTouching = 1e-9;
  return {static_cast<int>(std::floor((low - reach) / texel_width - 0.5 + kTouching)) + 1,
          static_cast<int>(std::ceil((high + reach) / texel_width - 0.5 - kTouching)) - 1};
}

double FilterProducts::product(const Filter& a, const Filter& b) const {
  return levels_ == 3 ? integral(a, b) : sum(a, b);
}

double FilterProducts::integral(const Filter& a, const Filter& b) const {
  const double radius = kernel_.radius();
  const double end = std::min(a.center + radius * a.width, b.center + radius * b.width);
  double begin = std::max(a.center - radius * a.width, b.center - radius * b.width);
  const auto next_piece = [&](const Filter& filter, double x) {
    const double width = kernel_.piece_width() * filter.width;
    const double origin = filter.center - radius * filter.width;
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
      piece += rule.weights[k] * kernel_.value((x - a.center) / a.width) *
               kernel_.value((x - b.center) / b.width);
    }
    sum += piece * (stop - begin);
    begin = stop;
  }
  return sum / (a.width * b.width);
}

double FilterProducts::sum(const Filter& a, const Filter& b) const {
  const double texels = levels_;  // of level 0 along a cell
  const Taps left = kernel_taps(kernel_, a.center * texels, a.width * texels);
  const Taps right = kernel_taps(kernel_, b.center * texels, b.width * texels);
  const int begin = std::max(left.first, right.first);
  const int end = std::min(left.first + static_cast<int>(left.weights.size()),
                           right.first + static_cast<int>(right.weights.size()));
  double sum = 0.0;
  for (int i = begin; i < end; ++i) {
    sum += left.weights[i - left.first] * right.weights[i - right.first];
  }
  return sum;
}

}  // namespace prefilter
