// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/vectors.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>

namespace prefilter {
namespace {

template <typename T, int kCount, typename Values>
std::array<T, kCount> numbers(const Values& values) {
  std::array<T, kCount> out{};
  for (int i = 0; i < kCount; ++i) out[i] = values[i];
  return out;
}

// Compiler vectors, if available, and plain vectors must agree with loops.
template <typename Floats, typename Integers, typename Words, typename Bytes>
void expect_arithmetic() {
  const Floats a{1.5F, -2.0F, 0.1F, 7.0F};
  const Floats b{0.5F, 3.0F, -0.3F, 7.0F};
  Floats sum = a + b;
  sum -= Floats{} + 1.0F;
  sum *= 3.0F;
  const auto results = numbers<float, 4>(sum / b - 2.0F * a + -b);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(results[i], (a[i] + b[i] - 1.0F) * 3.0F / b[i] - 2.0F * a[i] + -b[i]) << i;
  }
  const Integers masks[] = {a<b, a <= b, a> b, a >= b, a == b, a != b};
  for (int i = 0; i < 4; ++i) {
    const bool expected[] = {a[i]<b[i], a[i] <= b[i], a[i]> b[i], a[i] >= b[i], a[i] == b[i],
                             a[i] != b[i]};
    for (int k = 0; k < 6; ++k) EXPECT_EQ(masks[k][i], expected[k] ? -1 : 0) << i << k;
  }
  EXPECT_EQ((numbers<float, 4>(select(a < b, a, b))), (std::array{0.5F, -2.0F, -0.3F, 7.0F}));
  EXPECT_EQ((numbers<float, 4>(select(a > 1.0F, b, Floats{}))),
            (std::array{0.5F, 0.0F, 0.0F, 7.0F}));
  EXPECT_EQ((numbers<float, 4>(shuffle<0, 4, 3, 6>(a, b))), (std::array{1.5F, 0.5F, 7.0F, -0.3F}));
  EXPECT_EQ((numbers<std::int32_t, 4>(convert<Integers>(a * 10.0F))), (std::array{15, -20, 1, 70}));
  EXPECT_EQ((numbers<float, 4>(convert<Floats>(Integers{3, -1, 0, 1 << 20}))),
            (std::array{3.0F, -1.0F, 0.0F, 0x1p20F}));
  Words bits{0x80000001U, 2, 3, 4};
  bits ^= bits >> 1;
  bits = (bits * 0x9E3779B1U | 1U) & ~(bits << 4);
  for (int i = 0; i < 4; ++i) {
    std::uint32_t word = std::array{0x80000001U, 2U, 3U, 4U}[i];
    word ^= word >> 1U;
    word = (word * 0x9E3779B1U | 1U) & ~(word << 4U);
    EXPECT_EQ(bits[i], word) << i;
  }
  EXPECT_EQ((numbers<std::int32_t, 4>(Integers{-5, 5, 1 << 30, 0} >> 1)),
            (std::array{-3, 2, 1 << 29, 0}));
  const auto bytes = std::bit_cast<Bytes>(Words{0x04030201U, 0, 0, 0xFF000000U});
  const Bytes mixed = shuffle<3, 16, 0, 15, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1>(bytes, Bytes{});
  EXPECT_EQ(std::bit_cast<Words>(mixed)[0], 0xFF010004U);
  EXPECT_EQ(std::bit_cast<Words>(mixed)[3], 0x02010101U);
}

TEST(Vectors, DoWhatLoopsDo) {
  expect_arithmetic<Vector<float, 4>, Vector<std::int32_t, 4>, Vector<std::uint32_t, 4>,
                    Vector<std::uint8_t, 16>>();
}

TEST(Vectors, DoSoWithoutTheCompilers) {
  expect_arithmetic<PlainVector<float, 4>, PlainVector<std::int32_t, 4>,
                    PlainVector<std::uint32_t, 4>, PlainVector<std::uint8_t, 16>>();
}

}  // namespace
}  // namespace prefilter
