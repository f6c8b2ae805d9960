// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/solve/sparse_factors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prefilter {
namespace {

// The entries as a dense matrix.
std::vector<std::vector<double>> dense(std::size_t size, const std::vector<SparseEntry>& lower) {
  std::vector<std::vector<double>> matrix(size, std::vector<double>(size, 0.0));
  for (const SparseEntry& entry : lower) {
    matrix[entry.row][entry.column] += entry.value;
    if (entry.row != entry.column) matrix[entry.column][entry.row] += entry.value;
  }
  return matrix;
}

TEST(SparseFactors, SolveRandomSystems) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const std::uint32_t size : {1U, 2U, 30U, 150U}) {
    std::vector<Vector3> places(size);
    std::vector<Vector3> expected(size);
    for (std::uint32_t i = 0; i < size; ++i) {
      places[i] = {uniform(random), uniform(random), 0.0};
      expected[i] = {uniform(random), uniform(random), uniform(random)};
    }
    std::vector<SparseEntry> lower;
    for (std::uint32_t row = 0; row < size; ++row) {
      lower.push_back({row, row, 3.0});
      lower.push_back({row, row, 5.0});
      for (int k = 0; k < 5 && row > 0; ++k) {
        lower.push_back({row, static_cast<std::uint32_t>(random() % row), 0.3 * uniform(random)});
      }
    }
    const auto matrix = dense(size, lower);
    std::vector<Vector3> values(size);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        for (std::size_t a = 0; a < 3; ++a) values[i][a] += matrix[i][j] * expected[j][a];
      }
    }
    const SparseFactors factors(lower, places, prefilter::Run());
    ASSERT_TRUE(factors.is_definite());
    factors.solve(values);
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(length(values[i] - expected[i]), 0.0, 1e-12);
    }
  }
}

TEST(SparseFactors, SolveALaplacian) {
  // Its inverse is known in the basis of sines.
  constexpr std::uint32_t kSide = 120;
  std::vector<Vector3> places;
  std::vector<SparseEntry> lower;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t at = y * kSide + x;
      places.push_back({static_cast<double>(x), static_cast<double>(y), 0.0});
      lower.push_back({at, at, 4.0});
      if (x > 0) lower.push_back({at, at - 1, -1.0});
      if (y > 0) lower.push_back({at, at - kSide, -1.0});
    }
  }
  const SparseFactors factors(lower, places, prefilter::Run());
  ASSERT_TRUE(factors.is_definite());
  const double step = std::acos(-1.0) / (kSide + 1);
  std::vector<Vector3> values;
  for (const Vector3& p : places) {
    values.push_back({std::sin(step * (p[0] + 1.0)) * std::sin(step * (p[1] + 1.0)), 0.0, 1.0});
  }
  std::vector<Vector3> solution = values;
  factors.solve(solution);
  const double eigenvalue = 4.0 - 4.0 * std::cos(step);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(solution[i][0], values[i][0] / eigenvalue, 1e-9 / eigenvalue);
    EXPECT_EQ(solution[i][1], 0.0);
  }
}

TEST(SparseFactors, DetectIndefiniteMatrices) {
  const std::vector<Vector3> places(2);
  EXPECT_FALSE(SparseFactors({{0, 0, 1.0}, {1, 0, 1.0}, {1, 1, 1.0}}, places, {}).is_definite());
  EXPECT_FALSE(SparseFactors({{0, 0, 1.0}, {1, 1, -1.0}}, places, {}).is_definite());
  EXPECT_FALSE(SparseFactors({{0, 0, 1.0}}, places, {}).is_definite());
  // The remainder of the second row is e, compared with the row's own size.
  const auto is_definite = [&](double e, double size) {
    return SparseFactors({{0, 0, size}, {1, 0, size}, {1, 1, size + e * size}}, places, {})
        .is_definite();
  };
  for (const double size : {1e-20, 1.0, 1e20}) {
    EXPECT_FALSE(is_definite(0x1p-44, size));  // 5.7e-14: indistinguishable from rounding
    EXPECT_TRUE(is_definite(0x1p-42, size));
  }
}

}  // namespace
}  // namespace prefilter
