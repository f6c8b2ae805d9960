// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/kernel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "prefilter/base/elementary.h"
#include "prefilter/base/names.h"
#include "prefilter/images/pixel_filter.h"

namespace prefilter {
namespace {

double sinc(double x) {
  if (std::abs(x) < 1e-9) return 1.0;
  const double angle = std::numbers::pi * x;
  return elementary::sin(angle) / angle;
}

// Mitchell and Netravali, "Reconstruction Filters in Computer Graphics", 1988, equation 8.
double mitchell(double x) {
  if (x < 1.0) return ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0;
  return (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0;
}

double gaussian(double x) { return elementary::exp(-std::numbers::pi * x * x); }

double bspline2(double x) { return x < 0.5 ? 0.75 - x * x : 0.5 * (1.5 - x) * (1.5 - x); }

template <int kLobes>
double lanczos(double x) {
  return sinc(x) * sinc(x / kLobes);
}

using enum FilterUse;
constexpr FilterUse kEverything[] = {kRaster, kResize, kMipmap, kSampling};
constexpr FilterUse kImages[] = {kRaster, kResize};
constexpr FilterUse kSizes[] = {kResize};

struct Row {
  std::string_view name;
  std::string_view label;
  double radius;
  std::span<const FilterUse> uses;
  bool is_radial = false;
  // For kernels: width and degree of the pieces, and the function from 0 to the radius.
  double piece_width = 0.0;
  int degree = 0;
  double (*function)(double) = nullptr;
};

// Interpolation errors of the kernels that are not piecewise polynomials: lanczos2 at most 6e-6,
// lanczos3 2e-6, and gaussian, which ends with a step of 3.5e-6, 1e-6.
constexpr Row kKernelRows[] = {
    {"box", "Box", 0.5, kEverything, false, 1.0, 0, [](double) { return 1.0; }},
    {"tent", "Tent", 1.0, kEverything, false, 1.0, 1, [](double x) { return 1.0 - x; }},
    {"bspline2", "B-Spline 2", 1.5, kEverything, false, 1.0, 2, bspline2},
    {"mitchell", "Mitchell", 2.0, kEverything, false, 1.0, 3, mitchell},
    {"lanczos2", "Lanczos 2", 2.0, kEverything, false, 1.0, 7, lanczos<2>},
    {"lanczos3", "Lanczos 3", 3.0, kEverything, false, 1.0, 7, lanczos<3>},
    {"gaussian", "Gaussian", 2.0, kEverything, false, 0.5, 7, gaussian},
    {"radial2", "Radial 2", 2.0, kImages, true},
    {"radial3", "Radial 3", 3.0, kImages, true},
    {"least-squares", "Least Squares", 1.0, kSizes},
};

const std::vector<Kernel>& all_kernels() {
  static const std::vector<Kernel> kernels = [] {
    std::vector<Kernel> made;
    for (const Row& row : kKernelRows) {
      if (row.function == nullptr) continue;
      made.emplace_back(row.name, row.radius, row.piece_width, row.degree, row.function);
    }
    return made;
  }();
  return kernels;
}

// The interpolation nodes.
double node(int k, int degree) {
  if (degree == 0) return 0.5;
  return 0.5 - 0.5 * elementary::cos(std::numbers::pi * k / degree);
}

// The polynomial with these values at the nodes, by Newton's divided differences.
Kernel::Piece interpolated(Kernel::Piece values, int degree) {
  for (int order = 1; order <= degree; ++order) {
    for (int k = degree; k >= order; --k) {
      values[k] = (values[k] - values[k - 1]) / (node(k, degree) - node(k - order, degree));
    }
  }
  Kernel::Piece sum{};
  for (int k = degree; k >= 0; --k) {  // sum = sum (t - node k) + difference k
    for (int power = degree; power > 0; --power) {
      sum[power] = sum[power - 1] - node(k, degree) * sum[power];
    }
    sum[0] = values[k] - node(k, degree) * sum[0];
  }
  return sum;
}

double polynomial(const Kernel::Piece& piece, int degree, double t) {
  double value = piece[degree];
  for (int k = degree - 1; k >= 0; --k) value = value * t + piece[k];
  return value;
}

// Integral from 0 to t, for a piece of width 1.
double polynomial_integral(const Kernel::Piece& piece, int degree, double t) {
  double value = piece[degree] / (degree + 1);
  for (int k = degree - 1; k >= 0; --k) value = value * t + piece[k] / (k + 1);
  return value * t;
}

}  // namespace

Kernel::Kernel(std::string_view name, double radius, double piece_width, int degree,
               double (*function)(double))
    : name_(name), radius_(radius), piece_width_(piece_width), degree_(degree) {
  assert(degree >= 0 && degree <= kMostDegree);
  const auto count = static_cast<int>(std::lround(2.0 * radius / piece_width));
  assert(count * piece_width == 2.0 * radius);
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    Piece values{};
    for (int k = 0; k <= degree; ++k) {
      values[k] =
          function(std::min(std::abs((i + node(k, degree)) * piece_width - radius), radius));
    }
    pieces_.push_back(interpolated(values, degree));
    sum += polynomial_integral(pieces_.back(), degree, 1.0) * piece_width;
  }
  double before = 0.0;
  for (Piece& piece : pieces_) {
    for (double& coefficient : piece) coefficient /= sum;
    integrals_.push_back(before);
    before += polynomial_integral(piece, degree, 1.0) * piece_width;
  }
}

std::size_t Kernel::piece_at(double x, double* t) const {
  const double from_begin = (x + radius_) / piece_width_;
  const std::size_t piece = std::min(static_cast<std::size_t>(from_begin), pieces_.size() - 1);
  *t = from_begin - static_cast<double>(piece);
  return piece;
}

double Kernel::value(double x) const {
  // Evaluates the same half for both signs, so that values are even to the last bit.
  const double distance = std::abs(x);
  if (!(distance <= radius_)) return 0.0;
  double t = 0.0;
  const std::size_t piece = piece_at(distance, &t);
  return polynomial(pieces_[piece], degree_, t);
}

double Kernel::integral(double x) const {
  if (x <= -radius_) return 0.0;
  if (x >= radius_) return 1.0;
  double t = 0.0;
  const std::size_t piece = piece_at(x, &t);
  return integrals_[piece] + polynomial_integral(pieces_[piece], degree_, t) * piece_width_;
}

std::span<const Kernel> kernels() { return all_kernels(); }

const Kernel* find_kernel(std::string_view name) {
  for (const Kernel& kernel : kernels()) {
    if (kernel.name() == name) return &kernel;
  }
  return nullptr;
}

const Kernel& kernel_named(std::string_view name) {
  return element_named("filter", name, kernels(), &Kernel::name);
}

bool PixelFilter::is_for(FilterUse use) const {
  return std::find(uses.begin(), uses.end(), use) != uses.end();
}

std::span<const PixelFilter> pixel_filters() {
  static const std::vector<PixelFilter> filters = [] {
    std::vector<PixelFilter> made;
    for (const Row& row : kKernelRows) {
      made.push_back(
          {row.name, row.label, row.radius, find_kernel(row.name), row.is_radial, row.uses});
    }
    return made;
  }();
  return filters;
}

std::vector<PixelFilter> filters_for(FilterUse use) {
  std::vector<PixelFilter> found;
  for (const PixelFilter& filter : pixel_filters()) {
    if (filter.is_for(use)) found.push_back(filter);
  }
  return found;
}

const Kernel& box_kernel() {
  static const Kernel& box = *find_kernel("box");
  return box;
}

Taps kernel_taps(const Kernel& kernel, double center, double width) {
  const double scale = kernel.degree() == 0 ? width : std::max(1.0, width);
  const double reach = kernel.radius() * scale;
  std::vector<double> values;
  Taps taps;
  if (kernel.degree() == 0) {
    // Scales are ratios of integers, so edges this close to a texel's edge coincide with it.
    constexpr double kOnEdge = 1e-9;
    taps.first = static_cast<int>(std::floor(center - reach + kOnEdge));
    const int end = static_cast<int>(std::ceil(center + reach - kOnEdge));
    for (int i = taps.first; i < end; ++i) {
      values.push_back(kernel.integral((i + 1.0 - center) / scale) -
                       kernel.integral((i - center) / scale));
    }
  } else {
    taps.first = static_cast<int>(std::ceil(center - reach - 0.5));
    const int last = static_cast<int>(std::floor(center + reach - 0.5));
    for (int i = taps.first; i <= last; ++i) {
      values.push_back(kernel.value((i + 0.5 - center) / scale));
    }
  }
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  for (const double value : values) taps.weights.push_back(value / sum);
  return taps;
}

Taps resampling_taps(const Kernel& kernel, double ratio, int target) {
  return kernel_taps(kernel, (target + 0.5) * ratio, ratio);
}

}  // namespace prefilter
