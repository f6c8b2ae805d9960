#include "prefilter/raster/cell_filter.h"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include "prefilter/filters/windowed_jinc.h"

namespace prefilter {
namespace {

// A polynomial of t on [0, 1] times `scale`, in the coordinate t - 1/2 instead.
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

CellFilter of_kernel(const Kernel& kernel) {
  CellFilter filter;
  filter.cells_per_pixel = static_cast<int>(std::lround(1.0 / kernel.piece_width()));
  filter.taps = static_cast<int>(kernel.pieces().size());
  filter.degree = kernel.degree();
  // Pixel i's first cell begins at i + 1/2 - radius.
  const double low = (0.5 - kernel.radius()) * filter.cells_per_pixel;
  filter.first = static_cast<int>(std::ceil(low));
  filter.shift = filter.first - low;
  for (const Kernel::Piece& piece : kernel.pieces()) {
    add_centered(piece, kernel.degree(), kernel.piece_width(), &filter.along);
  }
  return filter;
}

// The pieces interpolate at Chebyshev's extreme points along both axes, so that neighbours agree
// along the edge they share; the whole is scaled to an integral of 1.
CellFilter of_radial(double radius) {
  constexpr int kDegree = Kernel::kMostDegree;
  constexpr int kCount = kDegree + 1;
  CellFilter filter;
  filter.is_separable = false;
  filter.taps = static_cast<int>(2.0 * radius);
  filter.degree = kDegree;
  filter.shift = 0.5;
  filter.first = 1 - filter.taps / 2;
  // The powers' coefficients of the polynomials that are 1 at one node and 0 at all others.
  std::array<double, kCount> nodes;
  for (int k = 0; k < kCount; ++k) {
    nodes[k] = -0.5 * std::cos(std::numbers::pi * k / kDegree);
  }
  std::array<std::array<double, kCount>, kCount> basis{};
  for (int k = 0; k < kCount; ++k) {
    basis[k][0] = 1.0;
    int degree = 0;
    for (int other = 0; other < kCount; ++other) {
      if (other == k) continue;
      ++degree;
      const double scale = 1.0 / (nodes[k] - nodes[other]);
      for (int power = degree; power >= 0; --power) {
        const double below = power > 0 ? basis[k][power - 1] : 0.0;
        basis[k][power] = scale * (below - nodes[other] * basis[k][power]);
      }
    }
  }
  const WindowedJinc jinc(radius);
  filter.table.assign(static_cast<std::size_t>(filter.taps * filter.taps) * kCount * kCount, 0.0);
  double integral = 0.0;
  double* piece = filter.table.data();
  for (int oy = 0; oy < filter.taps; ++oy) {
    for (int ox = 0; ox < filter.taps; ++ox, piece += kCount * kCount) {
      for (int ky = 0; ky < kCount; ++ky) {
        for (int kx = 0; kx < kCount; ++kx) {
          const double x = ox + 0.5 - radius + nodes[kx];
          const double y = oy + 0.5 - radius + nodes[ky];
          const double value = jinc(std::hypot(x, y));
          for (int b = 0; b < kCount; ++b) {
            for (int a = 0; a < kCount; ++a) {
              piece[b * kCount + a] += value * basis[kx][a] * basis[ky][b];
            }
          }
        }
      }
      for (int b = 0; b < kCount; b += 2) {
        for (int a = 0; a < kCount; a += 2) {
          integral += piece[b * kCount + a] * std::pow(0.5, a + b) / ((a + 1) * (b + 1));
        }
      }
    }
  }
  for (double& coefficient : filter.table) coefficient /= integral;
  return filter;
}

struct Named {
  std::string_view name;
  CellFilter filter;
};

const std::array<Named, 9>& all_filters() {
  static const std::array<Named, 9> filters = [] {
    std::array<Named, 9> all{};
    std::size_t count = 0;
    for (const std::string_view name :
         {"box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3", "gaussian"}) {
      all[count++] = {name, of_kernel(*find_kernel(name))};
    }
    all[count++] = {"radial2", of_radial(2.0)};
    all[count++] = {"radial3", of_radial(3.0)};
    assert(count == all.size());
    return all;
  }();
  return filters;
}

}  // namespace

std::span<const std::string_view> raster_filters() {
  static const auto names = [] {
    std::vector<std::string_view> all;
    for (const Named& named : all_filters()) all.push_back(named.name);
    return all;
  }();
  return names;
}

const CellFilter* find_cell_filter(std::string_view name) {
  for (const Named& named : all_filters()) {
    if (named.name == name) return &named.filter;
  }
  return nullptr;
}

}  // namespace prefilter
