// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/filter_products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "prefilter/images/kernel.h"

namespace prefilter {
namespace {

double deviation_of(int scale) { return std::ldexp(1.0, scale - 4); }

struct Masses {
  std::vector<double> places;
  std::vector<double> masses;
};

// The integrals of a filter over small intervals.
Masses of_line(const Kernel& kernel, double center, double width) {
  constexpr int kPartsOfUnit = 120;
  Masses filter;
  const int parts = static_cast<int>(2.0 * kernel.radius() * kPartsOfUnit);
  for (int i = 0; i < parts; ++i) {
    const double low = static_cast<double>(i) / kPartsOfUnit - kernel.radius();
    filter.places.push_back(center + (low + 0.5 / kPartsOfUnit) * width);
    filter.masses.push_back(kernel.integral(low + 1.0 / kPartsOfUnit) - kernel.integral(low));
  }
  return filter;
}

Masses of_texels(const Kernel& kernel, double center, double width, int levels) {
  const Taps taps = kernel_taps(kernel, center * levels, width * levels);
  Masses filter;
  for (std::size_t i = 0; i < taps.weights.size(); ++i) {
    filter.places.push_back((taps.first + static_cast<double>(i) + 0.5) / levels);
    filter.masses.push_back(taps.weights[i]);
  }
  return filter;
}

double correlation(const Masses& a, const Masses& b, double deviation) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.places.size(); ++i) {
    for (std::size_t j = 0; j < b.places.size(); ++j) {
      const double distance = (a.places[i] - b.places[j]) / deviation;
      sum += a.masses[i] * b.masses[j] * std::exp(-0.5 * distance * distance);
    }
  }
  return sum;
}

TEST(FilterProducts, NaturalImagesUseDoubleIntegralsOfGaussians) {
  for (const Kernel& texels : kernels()) {
    for (const char* name : {"box", "lanczos3"}) {
      const Kernel& sample = *find_kernel(name);
      FilterProducts products(texels, sample, 3, ImageSpectrum::kNatural);
      ASSERT_EQ(products.scales(), 9);
      const double width = products.width(0.3);
      // From adjacent to the largest distance at which a sample's filter overlaps both.
      const int farthest = static_cast<int>(texels.radius() + sample.radius());
      const auto with_sample = products.with_sample(1, 1, 0.2, 0.3);
      const auto apart = products.of_texels(0, -farthest, 2, 4 * farthest);
      const auto itself = products.of_sample(0.2, 0.3);
      const Masses of_sample = of_line(sample, 0.2, width);
      const Masses texel = of_line(texels, 0.75, 0.5);
      const Masses left = of_line(texels, 0.5 - farthest, 1.0);
      const Masses right = of_line(texels, (4 * farthest + 0.5) / 4.0, 0.25);
      for (const int scale : {0, 3, 8}) {
        const double deviation = deviation_of(scale);
        const auto where = [&] {
          return std::string(texels.name()) + name + std::to_string(scale);
        };
        EXPECT_NEAR(with_sample[scale], correlation(texel, of_sample, deviation), 2e-4) << where();
        EXPECT_NEAR(apart[scale], correlation(left, right, deviation), 2e-4) << where();
        EXPECT_NEAR(itself[scale], correlation(of_sample, of_sample, deviation), 2e-4) << where();
      }
    }
  }
}

TEST(FilterProducts, NaturalImagesUseDoubleSumsForFewerLevels) {
  const Kernel& sample = *find_kernel("box");
  for (const Kernel& texels : kernels()) {
    for (const int levels : {1, 2}) {
      FilterProducts products(texels, sample, levels, ImageSpectrum::kNatural);
      const auto with_sample = products.with_sample(levels - 1, 1, 0.3, 0.7);
      const double texel_width = 1.0 / levels;
      const Masses a = of_texels(texels, 1.5 * texel_width, texel_width, levels);
      const Masses b = of_texels(sample, 0.3, products.width(0.7), levels);
      const auto of_two = products.of_texels(levels - 1, 1, 0, -2);
      const Masses c = of_texels(texels, -1.5, 1.0, levels);
      for (int scale = 0; scale < 9; ++scale) {
        const double deviation = deviation_of(scale);
        EXPECT_NEAR(with_sample[scale], correlation(a, b, deviation), 1e-12) << texels.name();
        EXPECT_NEAR(of_two[scale], correlation(a, c, deviation), 1e-12) << texels.name();
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
