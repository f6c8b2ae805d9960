// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace prefilter {
namespace {

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

// The definition of each kernel, up to a factor, from 0 to its radius; the allowed error; and the
// allowed variation of its sum over the texels.
struct Definition {
  double radius;
  double (*value)(double);
  double error;
  double ripple;
};

const std::map<std::string, Definition>& definitions() {
  static const std::map<std::string, Definition> all = {
      {"box", {0.5, [](double) { return 1.0; }, 0.0, 0.0}},
      {"tent", {1.0, [](double x) { return 1.0 - x; }, 1e-15, 1e-15}},
      // Three boxes convolved: second differences of half squares, clipped at 0.
      {"bspline2",
       {1.5,
        [](double x) {
          const auto square = [](double y) { return y > 0.0 ? 0.5 * y * y : 0.0; };
          return square(x + 1.5) - 3.0 * square(x + 0.5) + 3.0 * square(x - 0.5);
        },
        1e-14, 1e-14}},
      // A third of the cubic B-spline, and two thirds of the Catmull-Rom spline.
      {"mitchell",
       {2.0,
        [](double x) {
          const double far = 2.0 - x;
          if (x < 1.0) {
            const double spline = 2.0 / 3.0 - x * x + 0.5 * x * x * x;
            return spline / 3.0 + 2.0 / 3.0 * (1.0 - 2.5 * x * x + 1.5 * x * x * x);
          }
          return far * far * far / 18.0 + 2.0 / 3.0 * 0.5 * (1.0 - x) * far * far;
        },
        1e-14, 1e-14}},
      {"lanczos2", {2.0, [](double x) { return sinc(x) * sinc(x / 2.0); }, 6e-6, 0.0098}},
      {"lanczos3", {3.0, [](double x) { return sinc(x) * sinc(x / 3.0); }, 2e-6, 0.003}},
      {"gaussian", {2.0, [](double x) { return std::exp(-std::numbers::pi * x * x); }, 2e-6, 0.09}},
  };
  return all;
}

// Simpson's rule between multiples of 1/2, where kernels may have a kink.
template <typename Function>
double quadrature(double from, double to, const Function& function) {
  constexpr int kParts = 64;
  double sum = 0.0;
  for (double at = from; at < to; at += 0.5) {
    const double h = 0.5 / kParts;
    for (int i = 0; i < kParts; ++i) {
      const double x = at + i * h;
      sum += h / 6.0 * (function(x) + 4.0 * function(x + 0.5 * h) + function(x + h));
    }
  }
  return sum;
}

TEST(Kernels, MatchTheirDefinitions) {
  for (const Kernel& kernel : kernels()) {
    const std::string name(kernel.name());
    ASSERT_TRUE(definitions().contains(name)) << "nothing to compare '" << name << "' with";
    const Definition& definition = definitions().at(name);
    EXPECT_EQ(kernel.radius(), definition.radius) << name;
    const double scale = 1.0 / (2.0 * quadrature(0.0, definition.radius, definition.value));
    double error = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const double x = definition.radius * i / 1000.0;
      error = std::max(error, std::abs(kernel.value(x) - scale * definition.value(x)));
    }
    EXPECT_LE(error, definition.error) << name;
  }
}

TEST(Kernels, AreEvenAndZeroPastTheirRadius) {
  for (const Kernel& kernel : kernels()) {
    for (double x = 0.0; x < 4.0; x += 0.07) {
      EXPECT_EQ(kernel.value(x), kernel.value(-x)) << kernel.name();
      EXPECT_NEAR(kernel.integral(x) + kernel.integral(-x), 1.0, 1e-14) << kernel.name();
    }
    const double outside = std::nextafter(kernel.radius(), 10.0);
    EXPECT_EQ(kernel.value(outside), 0.0) << kernel.name();
    EXPECT_EQ(kernel.value(NAN), 0.0) << kernel.name();
    EXPECT_EQ(kernel.integral(-outside), 0.0) << kernel.name();
    EXPECT_EQ(kernel.integral(outside), 1.0) << kernel.name();
  }
}

TEST(Kernels, IntegrateToOne) {
  for (const Kernel& kernel : kernels()) {
    const auto value = [&](double x) { return kernel.value(x); };
    EXPECT_NEAR(quadrature(-kernel.radius(), kernel.radius(), value), 1.0, 1e-8) << kernel.name();
    for (const double x : {-1.5, -1.0, -0.5, 0.0, 0.5, 1.0}) {
      EXPECT_NEAR(kernel.integral(x), quadrature(-4.0, x, value),
                  kernel.degree() == 0 ? 0.01 : 1e-8)
          << kernel.name() << " up to " << x;
    }
  }
}

TEST(Kernels, SumToOneOverTexels) {
  for (const Kernel& kernel : kernels()) {
    for (const double x : {0.01, 0.1, 0.25, 0.37, 0.49, 0.51, 0.75, 0.99}) {
      double sum = 0.0;
      for (int k = -4; k <= 4; ++k) sum += kernel.value(x + k);
      EXPECT_NEAR(sum, 1.0, definitions().at(std::string(kernel.name())).ripple)
          << kernel.name() << " at " << x;
    }
  }
}

TEST(Kernels, AreContinuousUnlessOfDegreeZero) {
  for (const Kernel& kernel : kernels()) {
    if (kernel.degree() == 0) continue;
    for (double x = 0.0; x < kernel.radius(); x += 0.5) {
      EXPECT_NEAR(kernel.value(x - 1e-9), kernel.value(x + 1e-9), 2e-8) << kernel.name();
    }
    // The Gaussian is truncated there.
    const double end = kernel.name() == "gaussian" ? std::exp(-4.0 * std::numbers::pi) : 0.0;
    EXPECT_NEAR(kernel.value(kernel.radius()), end, 1e-14 + 1e-5 * end) << kernel.name();
  }
}

TEST(Kernels, AreTheSumOfTheirPieces) {
  for (const Kernel& kernel : kernels()) {
    EXPECT_EQ(static_cast<double>(kernel.pieces().size()) * kernel.piece_width(),
              2.0 * kernel.radius());
    EXPECT_TRUE(kernel.piece_width() == 1.0 || kernel.piece_width() == 0.5) << kernel.name();
    double begin = -kernel.radius();
    for (const Kernel::Piece& piece : kernel.pieces()) {
      for (const double t : {0.1, 0.5, 0.8}) {
        double value = 0.0;
        for (int k = 0; k <= Kernel::kMostDegree; ++k) value += piece[k] * std::pow(t, k);
        EXPECT_NEAR(kernel.value(begin + t * kernel.piece_width()), value, 1e-13) << kernel.name();
      }
      begin += kernel.piece_width();
    }
  }
}

TEST(Kernels, HaveNames) {
  for (const Kernel& kernel : kernels()) EXPECT_EQ(find_kernel(kernel.name()), &kernel);
  EXPECT_EQ(box_kernel().name(), "box");
  EXPECT_EQ(find_kernel("sinc"), nullptr);
}

TEST(ResamplingTaps, AreTheKernelAndSymmetric) {
  for (const Kernel& kernel : kernels()) {
    for (const int factor : {1, 2, 3, 4, 16, 64}) {
      const Taps taps = resampling_taps(kernel, factor, 0);
      const std::size_t count = taps.weights.size();
      // Symmetric about the center of the first target texel.
      EXPECT_EQ(2 * taps.first + static_cast<int>(count), factor);
      double sum = 0.0;
      for (int i = -300; i < 300; ++i) sum += kernel.value((i + 0.5) / factor - 0.5);
      for (std::size_t i = 0; i < count; ++i) {
        const double at = (taps.first + static_cast<int>(i) + 0.5) / factor - 0.5;
        EXPECT_NEAR(taps.weights[i], kernel.value(at) / sum, 1e-14) << kernel.name();
        EXPECT_NEAR(taps.weights[i], taps.weights[count - 1 - i], 1e-15) << kernel.name();
      }
    }
  }
}

TEST(ResamplingTaps, BoxTapsAreItsTexels) {
  const Taps taps = resampling_taps(box_kernel(), 4, 0);
  EXPECT_EQ(taps.first, 0);
  EXPECT_EQ(taps.weights, (std::vector<double>{0.25, 0.25, 0.25, 0.25}));
}

TEST(ResamplingTaps, BoxTapsAreItsCoverage) {
  // From 7 texels to 3: the middle one covers [7/3, 14/3].
  const Taps taps = resampling_taps(box_kernel(), 7.0 / 3.0, 1);
  EXPECT_EQ(taps.first, 2);
  ASSERT_EQ(taps.weights.size(), 3U);
  EXPECT_NEAR(taps.weights[0], 2.0 / 7.0, 1e-14);
  EXPECT_NEAR(taps.weights[1], 3.0 / 7.0, 1e-14);
  EXPECT_NEAR(taps.weights[2], 2.0 / 7.0, 1e-14);
}

TEST(ResamplingTaps, ShiftByWholeTexelsWhereTheScaleIsWhole) {
  for (const Kernel& kernel : kernels()) {
    const Taps first = resampling_taps(kernel, 3, 0);
    const Taps fifth = resampling_taps(kernel, 3, 4);
    EXPECT_EQ(fifth.first, first.first + 12);
    ASSERT_EQ(fifth.weights.size(), first.weights.size());
    for (std::size_t i = 0; i < first.weights.size(); ++i) {
      EXPECT_NEAR(fifth.weights[i], first.weights[i], 1e-14);
    }
  }
}

}  // namespace
}  // namespace prefilter
