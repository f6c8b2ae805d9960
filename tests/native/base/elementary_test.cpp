// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/elementary.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace prefilter {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The number of doubles between two numbers of the same sign, clamped.
double steps_between(double a, double b) {
  if (a == b) return 0.0;
  const double step = std::nextafter(std::abs(b), kInfinity) - std::abs(b);
  return std::abs(a - b) / step;
}

// The C library's error is larger than ours.
double exact_cbrt(double x) { return static_cast<double>(std::cbrt(static_cast<long double>(x))); }

TEST(Elementary, MatchTheSystemLibrary) {
  std::mt19937_64 bits(7);
  const auto random = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 20000; ++i) {
    const double x = random(-40.0, 40.0);
    const double y = random(-3.0, 3.0);
    const double positive = std::exp(x);
    EXPECT_LE(steps_between(elementary::sin(x), std::sin(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::cos(x), std::cos(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::tan(x), std::tan(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::exp(x), positive), 2.0) << x;
    EXPECT_LE(steps_between(elementary::exp2(x), std::exp2(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::expm1(y), std::expm1(y)), 2.0) << y;
    EXPECT_LE(steps_between(elementary::log(positive), std::log(positive)), 2.0) << positive;
    EXPECT_LE(steps_between(elementary::log2(positive), std::log2(positive)), 2.0) << positive;
    EXPECT_LE(steps_between(elementary::pow(positive, y), std::pow(positive, y)), 2.0) << x << y;
    EXPECT_LE(steps_between(elementary::cbrt(x), exact_cbrt(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::acos(y / 3.0), std::acos(y / 3.0)), 2.0) << y;
    EXPECT_LE(steps_between(elementary::atan2(x, y), std::atan2(x, y)), 2.0) << x << y;
    EXPECT_LE(steps_between(elementary::hypot(x, y), std::hypot(x, y)), 2.0) << x << y;
    EXPECT_LE(steps_between(elementary::hypot(x, y, 1.0), std::hypot(x, y, 1.0)), 2.0) << x << y;
    const auto root = static_cast<float>(random(0.0, 4.0));
    EXPECT_NEAR(elementary::pow(root, 2.4F), std::pow(root, 2.4F), 1e-5F) << root;
  }
}

TEST(Elementary, LargeAnglesAreReduced) {
  for (const double x : {1e5, 1e10, 1e300, -3e77}) {
    EXPECT_LE(steps_between(elementary::sin(x), std::sin(x)), 2.0) << x;
    EXPECT_LE(steps_between(elementary::cos(x), std::cos(x)), 2.0) << x;
  }
}

TEST(Elementary, LengthsNeitherOverflowNorUnderflow) {
  for (const double scale : {1e-320, 1e-200, 1e-140, 1.0, 1e140, 1e200, 1e307}) {
    EXPECT_NEAR(elementary::hypot(3.0 * scale, -4.0 * scale) / (5.0 * scale), 1.0, 1e-3) << scale;
    EXPECT_NEAR(elementary::hypot(2.0 * scale, 3.0 * scale, 6.0 * scale) / 7.0, scale,
                1e-3 * scale);
  }
  EXPECT_EQ(elementary::hypot(0.0, 0.0), 0.0);
  EXPECT_EQ(elementary::hypot(-kInfinity, 1.0), kInfinity);
  EXPECT_TRUE(std::isnan(elementary::hypot(std::nan(""), 1.0)));
  EXPECT_TRUE(std::isnan(elementary::hypot(0.0, std::nan(""))));
}

// The hash of the builds for x86-64 and arm64; all other systems must have the same.
TEST(Elementary, AreTheSameEverywhere) {
  std::uint64_t hash = 0;
  std::uint64_t state = 1;
  const auto add = [&](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 29U;
  };
  for (int i = 0; i < 50000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double x = static_cast<double>(state >> 11U) * 0x1p-47 - 32.0;
    add(elementary::sin(x));
    add(elementary::cos(x));
    add(elementary::tan(x));
    add(elementary::exp(x));
    add(elementary::exp2(x));
    add(elementary::expm1(x));
    add(elementary::log(x * x));
    add(elementary::log2(x * x));
    add(elementary::pow(x * x, 0.3));
    add(static_cast<double>(elementary::pow(static_cast<float>(x * x), 2.4F)));
    add(elementary::cbrt(x));
    add(elementary::acos(x / 32.0));
    add(elementary::atan2(x, 1.0 + x * x));
    add(elementary::hypot(x, 1.0, x * x));
  }
  EXPECT_EQ(hash, 0x1EFFE35ACDFF55B3U);
}

}  // namespace
}  // namespace prefilter
