// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/unit_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace prefilter {
namespace {

// Every byte, both of its limits, and values out of range, at every position of a vector.
TEST(UnitBytes, AreTheNearest) {
  std::vector<double> values = {-HUGE_VAL, -1.0, -0.0,
                                HUGE_VAL,  1.5,  std::numeric_limits<double>::quiet_NaN()};
  std::vector<int> expected = {0, 0, 0, 255, 255, 0};
  for (int byte = 0; byte < 256; ++byte) {
    for (const double off : {-0.4999, 0.0, 0.4999}) {
      values.push_back((byte + off) / 255.0);
      expected.push_back(byte);
    }
  }
  const std::vector<float> floats(values.begin(), values.end());
  for (std::size_t begin = 0; begin < 20; ++begin) {
    const std::size_t count = values.size() - begin;
    std::vector<std::uint8_t> bytes(count);
    std::vector<std::uint8_t> of_floats(count);
    unit_bytes(std::span<const double>(values).subspan(begin), bytes.data());
    unit_bytes(std::span<const float>(floats).subspan(begin), of_floats.data());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(bytes[i], expected[begin + i]) << values[begin + i];
      EXPECT_EQ(of_floats[i], expected[begin + i]) << values[begin + i];
    }
  }
}

}  // namespace
}  // namespace prefilter
