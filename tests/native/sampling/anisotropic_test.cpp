// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/anisotropic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "prefilter/sampling/probes.h"

namespace prefilter {
namespace {

constexpr double kPi = std::numbers::pi;

struct Probe {
  double place;
  double weight;
};

// A Gaussian with integral 1.
double gaussian(double x, double width) { return std::exp(-kPi * x * x / (width * width)) / width; }

// Integral of the product of two Gaussians at this distance.
double product(double distance, double a, double b) {
  return gaussian(distance, std::sqrt(a * a + b * b));
}

// Norm of the difference between a row of circular Gaussians and the elliptical one with widths
// `ratio` and 1, relative to the norm of the latter. Gaussians are separable, and across the row
// all are equal.
double error(std::vector<Probe> probes, double width, double ratio) {
  double sum = 0.0;
  for (const Probe& probe : probes) sum += probe.weight;
  for (Probe& probe : probes) probe.weight /= sum;
  const double own = product(0.0, ratio, ratio) * product(0.0, 1.0, 1.0);
  double both = 0.0;
  double all = 0.0;
  for (const Probe& a : probes) {
    both += a.weight * product(a.place, ratio, width) * product(0.0, 1.0, width);
    for (const Probe& b : probes) {
      all += a.weight * b.weight * product(a.place - b.place, width, width) *
             product(0.0, width, width);
    }
  }
  return std::sqrt(std::max(0.0, (own - 2.0 * both + all) / own));
}

std::vector<Probe> probes_of(const ProbeRow& row) {
  std::vector<Probe> probes;
  for (int k = 0; k < row.count; ++k) {
    const double place = (k - 0.5 * (row.count - 1)) * row.spacing;
    probes.push_back({place, std::exp(-row.falloff * place * place)});
  }
  return probes;
}

// Section 3.2 of the article, with this library's Gaussian widths as radii.
std::vector<Probe> probes_as_printed(double ratio) {
  const int count = std::max(1, static_cast<int>(std::floor(2.0 * ratio + 0.5)) - 1);
  std::vector<Probe> probes;
  for (int k = 0; k < count; ++k) {
    const double place = (ratio - 1.0) * (count > 1 ? 2.0 * k / (count - 1) - 1.0 : 0.0);
    probes.push_back({place, std::exp(-2.0 * place * place / (ratio * ratio))});
  }
  return probes;
}

Footprint ellipse(double major, double minor) { return {major, minor, 1.0, 0.0}; }

constexpr double kLargestRatio = 32.0;

TEST(ProbeRow, SumsUpToTheEllipse) {
  double mean = 0.0;
  double printed_mean = 0.0;
  double largest = 0.0;
  double probes = 0.0;
  double printed_probes = 0.0;
  int count = 0;
  for (double ratio = 1.0; ratio <= kLargestRatio; ratio += 1.0 / 64.0, ++count) {
    const ProbeRow row = probe_row(ellipse(ratio, 1.0), kMaxProbes);
    const double own = error(probes_of(row), row.width, ratio);
    mean += own;
    largest = std::max(largest, own);
    probes += row.count;
    const std::vector<Probe> printed = probes_as_printed(ratio);
    printed_mean += error(printed, 1.0, ratio);
    printed_probes += static_cast<double>(printed.size());
  }
  std::printf("mean error %.4f, largest %.4f, %.1f probes; as printed %.4f, %.1f probes\n",
              mean / count, largest, probes / count, printed_mean / count, printed_probes / count);
  EXPECT_LT(largest, 0.086);
  EXPECT_LT(mean / count, 0.055);
  EXPECT_LT(3.0 * mean, printed_mean);
  EXPECT_LT(probes, 1.04 * printed_probes);
}

// No other spacing of as many probes is much better.
TEST(ProbeRow, DistancesAreNearlyTheBest) {
  for (double ratio = 1.15; ratio <= kLargestRatio; ratio *= 1.07) {
    const ProbeRow row = probe_row(ellipse(ratio, 1.0), kMaxProbes);
    ASSERT_GT(row.count, 1);
    const double own = error(probes_of(row), row.width, ratio);
    for (double factor = 0.8; factor < 1.2; factor += 0.01) {
      ProbeRow other = row;
      other.spacing *= factor;
      EXPECT_LT(own, 1.06 * error(probes_of(other), other.width, ratio)) << ratio << " " << factor;
    }
  }
}

TEST(ProbeRow, HasNoMoreProbesThanAskedFor) {
  for (int most = 1; most <= 24; ++most) {
    for (double ratio = 1.0; ratio < 1e6; ratio *= 1.3) {
      const ProbeRow row = probe_row(ellipse(5.0 * ratio, 5.0), most);
      EXPECT_GE(row.count, 1);
      EXPECT_LE(row.count, most);
      EXPECT_GE(row.width, 5.0 * (1.0 - 1e-12));
      EXPECT_GE(row.width, 5.0 * ratio * 2.0 / (most + 1) * (1.0 - 1e-12));
      if (most == 1) {
        EXPECT_DOUBLE_EQ(row.width, 5.0 * ratio);
      }
    }
  }
}

TEST(ProbeRow, IsAsWideAsTheEllipse) {
  const ProbeRow small = probe_row(ellipse(5.0, 2.0), 16);
  const ProbeRow large = probe_row(ellipse(50.0, 20.0), 16);
  EXPECT_EQ(small.count, large.count);
  EXPECT_DOUBLE_EQ(10.0 * small.width, large.width);
  EXPECT_DOUBLE_EQ(10.0 * small.spacing, large.spacing);
  EXPECT_DOUBLE_EQ(0.01 * small.falloff, large.falloff);
}

TEST(Footprint, HasTheSingularValues) {
  const double angle = 0.7;
  for (const double spin : {0.0, 1.0, 2.5}) {
    for (const double minor : {0.0, 1e-9, 2.0, 8.0}) {
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      const double a = 8.0 * std::cos(spin);
      const double b = -8.0 * std::sin(spin);
      const double d = minor * std::sin(spin);
      const double e = minor * std::cos(spin);
      const Footprint found =
          singular_values({c * a - s * d, c * b - s * e, s * a + c * d, s * b + c * e});
      EXPECT_NEAR(found.major, 8.0, 1e-12);
      EXPECT_NEAR(found.minor, minor, 1e-12);
      if (minor < 8.0) {
        EXPECT_NEAR(std::abs(found.direction_x * c + found.direction_y * s), 1, 1e-12);
      }
      EXPECT_NEAR(std::hypot(found.direction_x, found.direction_y), 1.0, 1e-15);
      // The same for the mirrored image.
      const Footprint mirrored =
          singular_values({-c * a + s * d, c * b - s * e, -s * a - c * d, s * b + c * e});
      EXPECT_NEAR(mirrored.major, 8.0, 1e-12);
      EXPECT_NEAR(mirrored.minor, minor, 1e-12);
    }
  }
}

TEST(Footprint, IsNeitherNarrowerThanATexelNorWiderThanTheCoarsest) {
  const Footprint wide = footprint_of({1e300, 0.0, 0.0, 1e-300}, 5);
  EXPECT_EQ(wide.major, 32.0);
  EXPECT_EQ(wide.minor, 1.0);
  const Footprint none = footprint_of({0.0, 0.0, 0.0, 0.0}, 5);
  EXPECT_EQ(none.major, 1.0);
  EXPECT_EQ(none.minor, 1.0);
  EXPECT_DOUBLE_EQ(singular_values({1e300, -1e300, 1e300, 1e300}).minor, 1e300 * std::sqrt(2.0));
  EXPECT_EQ(footprint_of({100.0, 0.0, 0.0, 50.0}, 3).minor, 8.0);
}

}  // namespace
}  // namespace prefilter
