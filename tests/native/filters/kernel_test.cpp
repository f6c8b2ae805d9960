#include "prefilter/filters/kernel.h"

#include <gtest/gtest.h>

#include <numeric>

namespace prefilter {
namespace {

constexpr Kernel kKernels[] = {Kernel::kBox, Kernel::kTent, Kernel::kLanczos3};

TEST(Kernels, AreEvenAndZeroPastTheirRadius) {
  for (const Kernel kernel : kKernels) {
    for (double x = 0.0; x < 4.0; x += 0.07) {
      EXPECT_DOUBLE_EQ(kernel_value(kernel, x), kernel_value(kernel, -x));
      if (x > kernel_radius(kernel)) {
        EXPECT_EQ(kernel_value(kernel, x), 0.0);
      }
    }
    EXPECT_EQ(kernel_value(kernel, 0.0), 1.0);
  }
}

TEST(DownsamplingTaps, SumToOneAndAreSymmetric) {
  for (const Kernel kernel : kKernels) {
    for (const int factor : {1, 2, 3, 4, 16, 64}) {
      const Taps taps = downsampling_taps(kernel, factor, 0);
      EXPECT_NEAR(std::accumulate(taps.weights.begin(), taps.weights.end(), 0.0), 1.0, 1e-14);
      for (std::size_t i = 0; i < taps.weights.size(); ++i) {
        EXPECT_NEAR(taps.weights[i], taps.weights[taps.weights.size() - 1 - i], 1e-15);
      }
      // Symmetric about the middle of the first target texel.
      EXPECT_EQ(2 * taps.first + static_cast<int>(taps.weights.size()), factor);
    }
  }
}

TEST(DownsamplingTaps, OfABoxAreItsTexels) {
  const Taps taps = downsampling_taps(Kernel::kBox, 4, 0);
  EXPECT_EQ(taps.first, 0);
  EXPECT_EQ(taps.weights, (std::vector<double>{0.25, 0.25, 0.25, 0.25}));
}

TEST(DownsamplingTaps, OfABoxAreWhatItCovers) {
  // 7 texels to 3: the middle one covers [7/3, 14/3].
  const Taps taps = downsampling_taps(Kernel::kBox, 7.0 / 3.0, 1);
  EXPECT_EQ(taps.first, 2);
  ASSERT_EQ(taps.weights.size(), 3U);
  EXPECT_NEAR(taps.weights[0], 2.0 / 7.0, 1e-14);
  EXPECT_NEAR(taps.weights[1], 3.0 / 7.0, 1e-14);
  EXPECT_NEAR(taps.weights[2], 2.0 / 7.0, 1e-14);
}

TEST(DownsamplingTaps, ShiftByWholeTexelsWhereTheScaleIsWhole) {
  for (const Kernel kernel : kKernels) {
    const Taps first = downsampling_taps(kernel, 3, 0);
    const Taps fifth = downsampling_taps(kernel, 3, 4);
    EXPECT_EQ(fifth.first, first.first + 12);
    ASSERT_EQ(fifth.weights.size(), first.weights.size());
    for (std::size_t i = 0; i < first.weights.size(); ++i) {
      EXPECT_NEAR(fifth.weights[i], first.weights[i], 1e-14);
    }
  }
}

}  // namespace
}  // namespace prefilter
