// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/build_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/tables/exchange_search.h"
#include "prefilter/sampling/tables/filter_products.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {
namespace {

TableSection section_of(const TableShape& shape, int levels) {
  TableSection section;
  section.levels = levels;
  section.slices = levels == 1 ? 1 : shape.slices;
  return section;
}

TEST(FilterProducts, AreIntegralsForThreeLevels) {
  for (const Kernel& kernel : kernels()) {
    FilterProducts products(kernel, kernel, 3, ImageSpectrum::kWhite);
    const double width = products.width(0.3);
    // The midpoint rule, fine enough for the box.
    constexpr int kParts = 200000;
    const double low = -8.0;
    const double step = 16.0 / kParts;
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i) {
      const double x = low + (i + 0.5) * step;
      sum += step * 2.0 * kernel.value((x - 0.75) * 2.0) * kernel.value((x - 0.2) / width) / width;
    }
    EXPECT_NEAR(products.with_sample(1, 1, 0.2, 0.3)[0], sum, 2.0 * 2.0 / width * step)
        << kernel.name();
  }
}

TEST(FilterProducts, AreSumsOverTheImageForFewerLevels) {
  // The tent centered between four texels of the image, two texels wide, and a texel of it.
  const Kernel& tent = *find_kernel("tent");
  FilterProducts products(tent, tent, 2, ImageSpectrum::kWhite);
  EXPECT_NEAR(products.with_sample(1, 0, 0.5, 1.0)[0], 0.375, 1e-15);
  EXPECT_NEAR(products.of_texels(0, 0, 0, 0)[0], 2 * 0.375 * 0.375 + 2 * 0.125 * 0.125, 1e-15);
  EXPECT_NEAR(products.of_texels(1, 0, 1, 1)[0], 0.0, 1e-15);
}

TEST(OrthonormalBasis, IsOrthonormal) {
  for (const int levels : {1, 3}) {
    const TableShape shape{"tent", 4, 3, 2, 2};
    const TableSection section = section_of(shape, levels);
    const int subdomains = section.slices * shape.subdomains_of_slice();
    for (int index = 0; index < subdomains; ++index) {
      const Subdomain subdomain(shape, section, index);
      const OrthonormalBasis basis = orthonormal_basis(subdomain, 2);
      ASSERT_EQ(basis.count, levels == 1 ? 9 : 10);
      std::vector<double> products(basis.count * basis.count);
      double volume = 0.0;
      for (const Subdomain::Node& node : subdomain.quadrature(2)) {
        volume += node.weight;
        const Terms terms = terms_at(node.x, node.y, node.f);
        std::vector<double> values(basis.count);
        for (int p = 0; p < basis.count; ++p) {
          for (int q = 0; q < kMaxTerms; ++q) values[p] += basis.coefficients[p][q] * terms[q];
        }
        for (int p = 0; p < basis.count; ++p) {
          for (int q = 0; q < basis.count; ++q) {
            products[p * basis.count + q] += node.weight * values[p] * values[q];
          }
        }
      }
      EXPECT_NEAR(volume, subdomain.volume(), 1e-14);
      for (int p = 0; p < basis.count; ++p) {
        for (int q = 0; q < basis.count; ++q) {
          EXPECT_NEAR(products[p * basis.count + q], p == q ? 1.0 : 0.0, 1e-8);
        }
      }
    }
  }
}

TEST(FindSet, LeavesNoExchangeThatHelps) {
  const TableShape shape{"tent", 4, 4, 2, 1};
  const TableSection section = section_of(shape, 3);
  for (const int index : {0, 4}) {
    const SubdomainSystem system(shape, section, index);
    const FittedSet found = find_set(system, 4, prefilter::Run());
    ASSERT_EQ(found.members.size(), 4U);
    for (std::size_t out = 0; out < found.members.size(); ++out) {
      for (int in = 0; in < system.candidates(); ++in) {
        std::vector<int> members = found.members;
        if (std::find(members.begin(), members.end(), in) != members.end()) continue;
        members[out] = in;
        EXPECT_GE(fit_set(system, members).error, found.error * (1.0 - 1e-9));
      }
    }
  }
}

TEST(FitSet, HasWeightsThatSumToOneAndNoBetterNeighbors) {
  const TableShape shape{"lanczos2", 4, 4, 2, 1};
  const SubdomainSystem system(shape, section_of(shape, 3), 2);
  const std::vector<int> members = {3, 40, 7, 100};
  const FittedSet set = fit_set(system, members);
  const int polynomials = system.polynomials();
  const auto error_of = [&](const std::vector<double>& weights) {
    double error = system.filter_square;
    for (std::size_t i = 0; i < set.members.size(); ++i) {
      for (int p = 0; p < polynomials; ++p) {
        const double weight = weights[i * polynomials + p];
        error -= 2.0 * weight * system.right_side_of(set.members[i])[p];
        for (std::size_t j = 0; j < set.members.size(); ++j) {
          error += weight * weights[j * polynomials + p] *
                   system.products_of(set.members[i])[set.members[j]];
        }
      }
    }
    return error;
  };
  EXPECT_NEAR(error_of(set.weights), set.error, 1e-12);
  for (int p = 0; p < polynomials; ++p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < set.members.size(); ++i) sum += set.weights[i * polynomials + p];
    EXPECT_NEAR(sum, system.weight_sum(p), 1e-12);
    for (std::size_t i = 1; i < set.members.size(); ++i) {
      std::vector<double> moved = set.weights;
      moved[p] += 1e-3;
      moved[i * polynomials + p] -= 1e-3;
      EXPECT_GT(error_of(moved), set.error);
    }
  }
}

TEST(FitSet, HasNoWeightsWhereATexelIsThereTwice) {
  const TableShape shape{"tent", 2, 1, 1, 1};
  const SubdomainSystem system(shape, section_of(shape, 3), 0);
  EXPECT_FALSE(std::isfinite(fit_set(system, std::vector<int>{5, 5}).error));
}

TEST(BuildSamplingTable, RefusesShapes) {
  for (const TableShape& shape :
       {TableShape{"cubic", 8, 4, 2, 1}, TableShape{"tent", 1, 4, 2, 1},
        TableShape{"tent", 17, 4, 2, 1}, TableShape{"tent", 8, 0, 2, 1},
        TableShape{"tent", 8, 4, 17, 1}, TableShape{"tent", 8, 4, 2, 3}}) {
    BuildTableOptions options;
    options.shape = shape;
    EXPECT_THROW(build_sampling_table(options), Error);
  }
}

}  // namespace
}  // namespace prefilter
