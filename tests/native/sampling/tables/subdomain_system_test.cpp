// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/subdomain_system.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "prefilter/sampling/tables/bordered_rows.h"
#include "prefilter/sampling/tables/filter_products.h"

namespace prefilter {
namespace {

// Calls visit(x, y, f, weight) for the centers of small cells of a box-shaped subdomain.
template <typename Visit>
void for_middles(const Subdomain& subdomain, int steps, const Visit& visit) {
  const auto at = [steps](double low, double high, int i) {
    return low + (high - low) * (i + 0.5) / steps;
  };
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      for (int k = 0; k < steps; ++k) {
        visit(at(subdomain.x_low(), subdomain.x_high(), i),
              at(subdomain.y_low(), subdomain.y_high(), j),
              at(subdomain.f_low(), subdomain.f_high(), k),
              subdomain.volume() / steps / steps / steps);
      }
    }
  }
}

double polynomial(const OrthonormalBasis& basis, int p, double x, double y, double f) {
  const Terms terms = terms_at(x, y, f);
  double value = 0.0;
  for (int q = 0; q < kMaxTerms; ++q) value += basis.coefficients[p][q] * terms[q];
  return value;
}

double over_plane(const FilterProducts::Products& x, const FilterProducts::Products& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
}

// Subdomain 1 is off the diagonal of the folded square, so it is a box.
void expect_equation_six_four(const TableShape& shape) {
  TableSection section;
  section.levels = 3;
  section.slices = 2;
  const Kernel& kernel = *find_kernel(shape.filter);
  const SubdomainSystem system(shape, section, 1);
  const Subdomain subdomain(shape, section, 1);
  FilterProducts filters(kernel, *find_kernel(shape.sample_filter()), 3, shape.spectrum);
  ASSERT_EQ(system.polynomials(), 10);
  ASSERT_GT(system.candidates(), 20);
  std::map<std::tuple<int, int, double, double>, FilterProducts::Products> found;
  const auto with_sample = [&](int finer, int i, double x, double f) {
    const auto [place, is_new] = found.try_emplace({finer, i, x, f});
    if (is_new) place->second = filters.with_sample(finer, i, x, f);
    return place->second;
  };
  double filter_square = 0.0;
  std::vector<double> sides(static_cast<std::size_t>(system.candidates()) * 10);
  for_middles(subdomain, 16, [&](double x, double y, double f, double weight) {
    filter_square += weight * over_plane(filters.of_sample(x, f), filters.of_sample(y, f));
    std::array<double, 10> polynomials;
    for (int p = 0; p < 10; ++p) polynomials[p] = polynomial(system.basis, p, x, y, f);
    for (int i = 0; i < system.candidates(); ++i) {
      const TexelOffset& texel = system.texels[i];
      const double product = weight * over_plane(with_sample(texel.finer, texel.x, x, f),
                                                 with_sample(texel.finer, texel.y, y, f));
      for (int p = 0; p < 10; ++p) sides[i * 10 + p] += product * polynomials[p];
    }
  });
  EXPECT_NEAR(system.filter_square, filter_square, 5e-3 * filter_square);
  double largest = 0.0;
  for (const double side : sides) largest = std::max(largest, std::abs(side));
  for (int i = 0; i < system.candidates(); ++i) {
    for (int p = 0; p < 10; ++p) {
      EXPECT_NEAR(system.right_side_of(i)[p], sides[i * 10 + p], 5e-3 * largest) << i << ", " << p;
    }
    for (int j = 0; j < system.candidates(); ++j) {
      const TexelOffset& a = system.texels[i];
      const TexelOffset& b = system.texels[j];
      EXPECT_NEAR(system.products_of(i)[j],
                  over_plane(filters.of_texels(a.finer, a.x, b.finer, b.x),
                             filters.of_texels(a.finer, a.y, b.finer, b.y)),
                  1e-12);
    }
  }
}

TEST(SubdomainSystem, IsEquationSixFourByTheMiddlesOfSmallCells) {
  expect_equation_six_four({"tent", 4, 4, 2, 2, 0.0, ImageSpectrum::kWhite});
  expect_equation_six_four({"lanczos2", 4, 4, 2, 2, 0.0, ImageSpectrum::kWhite});
  expect_equation_six_four({"tent", 4, 4, 2, 2, 0.0, ImageSpectrum::kNatural, "mitchell"});
}

// The ramp term is the squared distance between a sample and the weighted center of its texels.
TEST(SubdomainSystem, RampsAddTheDistanceFromTheWeightedCenter) {
  TableShape shape{"tent", 3, 4, 2, 2, 0.0};
  TableSection section;
  section.levels = 3;
  section.slices = 2;
  const SubdomainSystem plain(shape, section, 1);
  shape.ramp_weight = 3.0;
  const SubdomainSystem ramped(shape, section, 1);
  const Subdomain subdomain(shape, section, 1);
  const std::vector<int> members = {2, 7, 11};
  const FittedSet set = fit_set(ramped, members);
  double distance = 0.0;
  for_middles(subdomain, 16, [&](double x, double y, double f, double weight) {
    double off_x = x;
    double off_y = y;
    for (std::size_t m = 0; m < set.members.size(); ++m) {
      const TexelOffset& texel = ramped.texels[set.members[m]];
      double value = 0.0;
      for (int p = 0; p < 10; ++p)
        value += set.weights[m * 10 + p] * polynomial(ramped.basis, p, x, y, f);
      off_x -= value * std::ldexp(texel.x + 0.5, -texel.finer);
      off_y -= value * std::ldexp(texel.y + 0.5, -texel.finer);
    }
    distance += weight * (off_x * off_x + off_y * off_y);
  });
  EXPECT_NEAR(set.error - ramped.filter_error(set), 3.0 * distance, 2e-2 * 3.0 * distance + 1e-9);
  // Without ramps the objective is equation 6.4 alone, and no other weights are better.
  const FittedSet best = fit_set(plain, members);
  EXPECT_NEAR(plain.filter_error(best), best.error, 1e-12);
  EXPECT_LE(best.error, ramped.filter_error(set) + 1e-12);
}

// Pivoting ignores signs; without it, this matrix would lose all digits.
TEST(BorderedRows, ArePivotedByTheLargest) {
  TableSection section;
  section.levels = 3;
  section.slices = 2;
  const SubdomainSystem system({"tent", 3, 4, 2, 1, 0.0}, section, 1);
  const std::vector<int> members = {0};
  BorderedRows rows(system, members, 1);
  ASSERT_EQ(rows.rows, 2U);
  EXPECT_EQ(rows.at(0, 0), system.products_of(0)[0]);
  EXPECT_EQ(rows.at(0, 1), 1.0);
  EXPECT_EQ(rows.at(1, 0), 1.0);
  EXPECT_EQ(rows.at(1, 1), 0.0);
  const double values[2][3] = {{1e-20, 1.0, 1.0}, {-1.0, 1.0, 0.0}};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 3; ++j) rows.at(i, j) = values[i][j];
  }
  ASSERT_TRUE(rows.eliminate(0.0));
  EXPECT_NEAR(rows.side(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(rows.side(1, 0), 1.0, 1e-12);
}

}  // namespace
}  // namespace prefilter
