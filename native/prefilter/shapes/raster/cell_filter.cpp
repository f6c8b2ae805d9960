// SPDX-License-Identifier: GPL-3.0-or-later

// Kernels are piecewise polynomials already; radial filters are fitted cell by cell.
#include "prefilter/shapes/raster/cell_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/gauss_rule.h"
#include "prefilter/images/filters/windowed_jinc.h"
#include "prefilter/images/pixel_filter.h"
#include "prefilter/shapes/rasterize.h"

namespace prefilter {
namespace {

// Appends `scale` times a polynomial of t on [0, 1], expressed in t - 1/2.
void add_centered(const Kernel::Piece& piece, int degree, double scale, std::vector<double>* out) {
  for (int power = 0; power <= degree; ++power) {
    double sum = 0.0;
    double binomial = 1.0;  // k over power
    double half = 1.0;      // (1/2)^(k - power)
    for (int k = power; k <= degree; ++k) {
      sum += piece[k] * binomial * half;
      binomial = binomial * (k + 1) / (k + 1 - power);
      half *= 0.5;
    }
    out->push_back(scale * sum);
  }
}

}  // namespace

CellFilter cell_filter(const Kernel& kernel) {
  CellFilter filter;
  filter.cells_per_pixel = static_cast<int>(std::lround(1.0 / kernel.piece_width()));
  filter.taps = static_cast<int>(kernel.pieces().size());
  filter.degree = kernel.degree() <= 3 ? kernel.degree() : Kernel::kMostDegree;
  // The first cell of pixel i begins at i + 1/2 - radius.
  const double low = (0.5 - kernel.radius()) * filter.cells_per_pixel;
  filter.first = static_cast<int>(std::ceil(low));
  filter.shift = filter.first - low;
  for (const Kernel::Piece& piece : kernel.pieces()) {
    add_centered(piece, filter.degree, kernel.piece_width(), &filter.along);
  }
  return filter;
}

namespace {

// Coefficients of the Legendre polynomials of degree 0 to N - 1 on [-1/2, 1/2], normalized so that
// their squares integrate to 1.
template <int N>
std::array<std::array<double, N>, N> legendre_powers() {
  std::array<std::array<double, N>, N> powers{};
  powers[0][0] = 1.0;
  powers[1][1] = 2.0;
  for (int n = 2; n < N; ++n) {
    for (int k = 0; k < n; ++k) {
      powers[n][k + 1] += 2.0 * (2 * n - 1) * powers[n - 1][k] / n;
      powers[n][k] -= (n - 1.0) * powers[n - 2][k] / n;
    }
  }
  for (int n = 0; n < N; ++n) {
    for (double& power : powers[n]) power *= std::sqrt(2.0 * n + 1.0);
  }
  return powers;
}

// Fits a polynomial to the radial filter on each cell in the least-squares sense. Interpolation
// would change the integral of cells that the filter's bounding circle crosses.
CellFilter of_radial(double radius) {
  constexpr int kCount = Kernel::kMostDegree + 1;
  constexpr int kMaxTotalDegree = 8;
  constexpr int kParts = 8;  // per cell along each axis, with four points each
  const WindowedJinc jinc(radius);
  CellFilter filter;
  filter.is_separable = false;
  filter.taps = static_cast<int>(2.0 * radius);
  filter.degree = Kernel::kMostDegree;
  filter.shift = 0.5;
  filter.first = 1 - filter.taps / 2;
  const auto legendre = legendre_powers<kCount>();
  const GaussRule<4>& rule = gauss_rule<4>();
  std::array<double, 4 * kParts> points;
  std::array<double, 4 * kParts> weights;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = (static_cast<double>(i / 4) + rule.nodes[i % 4]) / kParts - 0.5;
    weights[i] = rule.weights[i % 4] / kParts;
  }
  std::array<std::array<double, 4 * kParts>, kCount> basis{};
  for (int n = 0; n < kCount; ++n) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int k = kCount - 1; k >= 0; --k) basis[n][i] = basis[n][i] * points[i] + legendre[n][k];
    }
  }
  filter.table.assign(static_cast<std::size_t>(filter.taps * filter.taps) * kCount * kCount, 0.0);
  double integral = 0.0;
  double* piece = filter.table.data();
  for (int oy = 0; oy < filter.taps; ++oy) {
    for (int ox = 0; ox < filter.taps; ++ox, piece += kCount * kCount) {
      // the filter's means with the basis, at [ny][nx]
      std::array<std::array<double, kCount>, kCount> means{};
      for (std::size_t j = 0; j < points.size(); ++j) {
        std::array<double, kCount> row{};
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double value = weights[i] * jinc(elementary::hypot(ox + 0.5 - radius + points[i],
                                                                   oy + 0.5 - radius + points[j]));
          for (int n = 0; n < kCount; ++n) row[n] += value * basis[n][i];
        }
        for (int ny = 0; ny < kCount; ++ny) {
          for (int nx = 0; nx < kCount; ++nx) means[ny][nx] += weights[j] * basis[ny][j] * row[nx];
        }
      }
      integral += means[0][0];
      for (int ny = 0; ny < kCount; ++ny) {
        for (int nx = 0; nx < kCount && nx + ny <= kMaxTotalDegree; ++nx) {
          for (int b = 0; b <= ny; ++b) {
            for (int a = 0; a <= nx; ++a) {
              piece[b * kCount + a] += means[ny][nx] * legendre[ny][b] * legendre[nx][a];
            }
          }
        }
      }
    }
  }
  for (double& coefficient : filter.table) coefficient /= integral;
  return filter;
}

}  // namespace

std::span<const std::string_view> raster_filters() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> raster_names;
    for (const PixelFilter& filter : filters_for(FilterUse::kRaster))
      raster_names.push_back(filter.name);
    return raster_names;
  }();
  return names;
}

const CellFilter* find_cell_filter(std::string_view name) {
  // Radial filters take a while, so each filter is built on first use.
  static std::mutex mutex;
  static std::map<std::string_view, CellFilter> filters;
  const std::lock_guard lock(mutex);
  if (const auto known = filters.find(name); known != filters.end()) return &known->second;
  for (const PixelFilter& filter : filters_for(FilterUse::kRaster)) {
    if (filter.name != name) continue;
    CellFilter cells = filter.is_radial ? of_radial(filter.radius) : cell_filter(*filter.kernel);
    return &filters.emplace(filter.name, std::move(cells)).first->second;
  }
  return nullptr;
}

}  // namespace prefilter
