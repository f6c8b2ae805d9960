// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/axis_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace prefilter {
namespace {

constexpr Wrap kWraps[] = {Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder};

std::vector<double> dense(const AxisWeights& axis, int size) {
  std::vector<double> weights(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < axis.texels.size(); ++i) {
    weights[static_cast<std::size_t>(axis.texels[i])] += axis.weights[i];
  }
  return weights;
}

std::vector<double> of_all_taps(const Kernel& kernel, double center, double width, int size,
                                Wrap mode) {
  std::vector<double> weights(static_cast<std::size_t>(size));
  const Taps taps = kernel_taps(kernel, center, width);
  for (std::size_t k = 0; k < taps.weights.size(); ++k) {
    const int texel = wrap_index(taps.first + static_cast<int>(k), size, mode);
    if (texel >= 0) weights[static_cast<std::size_t>(texel)] += taps.weights[k];
  }
  return weights;
}

// Wide kernels are not summed tap by tap, but give the same result.
TEST(AxisWeights, AreAllTapsWrapped) {
  for (const Kernel& kernel : kernels()) {
    for (const Wrap mode : kWraps) {
      for (const int size : {1, 2, 7, 60}) {
        for (const double width : {1.0, 1.5, 13.25, 40.0, 177.7, 2048.0}) {
          // The last centers put taps exactly at borders between pieces of kernels.
          for (const double center : {0.5, 0.3 * size, -2.0 * size - 0.1, 5.0 * size, 0.0, 3.5}) {
            const AxisWeights found = axis_weights(kernel, center, width, size, mode);
            EXPECT_LE(found.texels.size(), static_cast<std::size_t>(size));
            const std::vector<double> weights = dense(found, size);
            // A tap exactly at a discontinuous end of a kernel may count or not.
            const double step = kernel.degree() == 0 ? 0.0 : kernel.value(kernel.radius());
            const std::vector<double> expected = of_all_taps(kernel, center, width, size, mode);
            for (int i = 0; i < size; ++i) {
              ASSERT_NEAR(weights[static_cast<std::size_t>(i)],
                          expected[static_cast<std::size_t>(i)], 1e-10 + 2.0 * step / width)
                  << kernel.name() << ", wrap " << static_cast<int>(mode) << ", size " << size
                  << ", width " << width << ", center " << center << ", texel " << i;
            }
          }
        }
      }
    }
  }
}

TEST(AxisWeights, AreFiniteHoweverWideAndFar) {
  for (const Kernel& kernel : kernels()) {
    for (const Wrap mode : kWraps) {
      for (const int size : {1, 3, 1000}) {
        for (const double width : {1.0, 1e7, 1e18, 1e300}) {
          for (const double center : {0.0, 1e7, -1e18, 1e300}) {
            const AxisWeights found = axis_weights(kernel, center, width, size, mode);
            const double sum = std::accumulate(found.weights.begin(), found.weights.end(), 0.0);
            if (mode == Wrap::kBorder) {
              EXPECT_LE(std::abs(sum), 1.3);
            } else {
              EXPECT_NEAR(sum, 1.0, 1e-9) << kernel.name() << " " << width << " " << center;
            }
            EXPECT_TRUE(std::all_of(found.texels.begin(), found.texels.end(),
                                    [&](int i) { return i >= 0 && i < size; }));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
