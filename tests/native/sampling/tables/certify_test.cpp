// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/tables/exchange_search.h"

namespace prefilter {
namespace {

SubdomainSystem system_of(const TableShape& shape, int levels, int index) {
  TableSection section;
  section.levels = levels;
  section.slices = levels == 1 ? 1 : shape.slices;
  return {shape, section, index};
}

// The first candidates, a set that no search would accept.
FittedSet poor_set(const SubdomainSystem& system, int texels) {
  std::vector<int> members(texels);
  std::iota(members.begin(), members.end(), 0);
  return fit_set(system, members);
}

double least_error_of_all_sets(const SubdomainSystem& system, int texels) {
  std::vector<int> members(texels);
  std::iota(members.begin(), members.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  while (true) {
    least = std::min(least, fit_set(system, members).error);
    int place = texels - 1;
    while (place >= 0 && members[place] == system.candidates() - texels + place) --place;
    if (place < 0) return least;
    ++members[place];
    std::iota(members.begin() + place + 1, members.end(), members[place] + 1);
  }
}

CertifyOptions enough() { return {1'000'000, prefilter::Run(2)}; }

void expect_least_of_all(const SubdomainSystem& system, int texels) {
  const double least = least_error_of_all_sets(system, texels);
  for (const FittedSet& start :
       {poor_set(system, texels), find_set(system, texels, prefilter::Run())}) {
    const CertifiedSet certified = certify_set(system, start, enough());
    EXPECT_EQ(certified.gap, 0.0);
    EXPECT_NEAR(certified.set.error, least, 1e-8 * least);
    EXPECT_EQ(certified.set.members.size(), start.members.size());
  }
}

TEST(CertifySet, FindsTheLeastErrorOfAllPairs) {
  for (int index = 0; index < 6; ++index) {
    expect_least_of_all(system_of({"tent", 2, 4, 2, 1}, 3, index), 2);
  }
}

TEST(CertifySet, FindsTheLeastErrorOfAllTriples) {
  expect_least_of_all(system_of({"tent", 3, 4, 2, 1}, 3, 2), 3);
}

// Random products and right sides. The filter's own square is large, so that all errors and bounds
// are about the same.
SubdomainSystem random_system(unsigned seed, int candidates) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  SubdomainSystem system = system_of({"tent", 2, 4, 2, 1}, 3, 0);
  const auto count = static_cast<std::size_t>(candidates);
  system.texels.resize(count);
  system.basis.count = 2;
  system.unit = 1.0;
  system.filter_square = 300.0;
  std::vector<double> factor(count * count);
  for (double& value : factor) value = uniform(random);
  system.products.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t k = 0; k < count; ++k) {
        system.products[i * count + j] += factor[i * count + k] * factor[j * count + k];
      }
    }
    system.products[i * count + i] += 1.0;
  }
  system.right_sides.resize(2 * count);
  for (double& value : system.right_sides) value = uniform(random);
  return system;
}

TEST(CertifySet, FindsTheLeastErrorWhereAllAreClose) {
  int improved = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const SubdomainSystem system = random_system(seed, 24);
    for (const int texels : {2, 4}) {
      const double least = least_error_of_all_sets(system, texels);
      const FittedSet start = poor_set(system, texels);
      ASSERT_LT(start.error, 1.03 * least);
      improved += start.error > (1.0 + 1e-6) * least ? 1 : 0;
      const CertifiedSet certified = certify_set(system, start, enough());
      EXPECT_EQ(certified.gap, 0.0);
      EXPECT_NEAR(certified.set.error, least, 1e-9 * least);
      // The remaining gap is valid, however few sets were visited.
      const CertifiedSet first = certify_set(system, start, {1, prefilter::Run(1)});
      EXPECT_LE(first.set.error * (1.0 - first.gap), least * (1.0 + 1e-9));
      // Starting from the best set, one task completes the proof, as the bounds are tight.
      EXPECT_EQ(certify_set(system, certified.set, {1, prefilter::Run(1)}).gap, 0.0);
    }
  }
  EXPECT_GT(improved, 10);
}

TEST(CertifySet, FindsTheLeastErrorOfAllSetsOfFewCandidates) {
  for (const Kernel& kernel : kernels()) {
    TableShape shape{"", 4, 2, 1, 2};
    shape.filter = kernel.name();
    const SubdomainSystem system = system_of(shape, 2, 1);
    expect_least_of_all(system, system.candidates() < 25 ? 4 : 2);
  }
  // A texel of the cell's level is the sum of four texels of the next finer level.
  expect_least_of_all(system_of({"box", 4, 4, 2, 1}, 3, 5), 4);
  expect_least_of_all(system_of({"box", 4, 1, 1, 2}, 3, 0), 3);
}

TEST(CertifySet, ProvesEverySubdomainOfTheTent) {
  for (const int texels : {4, 8}) {
    for (int index = 0; index < 6; ++index) {
      const SubdomainSystem system =
          system_of({"tent", texels, 4, 2, 1, 5.0, ImageSpectrum::kWhite}, 3, index);
      const FittedSet found = find_set(system, texels, prefilter::Run());
      const CertifiedSet certified = certify_set(system, found, enough());
      EXPECT_EQ(certified.gap, 0.0) << texels << " " << index;
      EXPECT_LE(certified.set.error, found.error);
    }
  }
}

TEST(CertifySet, LeavesAGapThatTheBestSetIsWithin) {
  const SubdomainSystem system = system_of({"gaussian", 5, 4, 2, 1}, 3, 4);
  const FittedSet start = poor_set(system, 5);
  const CertifiedSet best = certify_set(system, start, enough());
  ASSERT_EQ(best.gap, 0.0);
  double last_gap = 1.0;
  for (const int nodes : {1, 3000, 20000}) {
    const CertifiedSet certified = certify_set(system, start, {nodes, prefilter::Run(1)});
    EXPECT_GE(certified.set.error, best.set.error * (1.0 - 1e-8));
    EXPECT_LE(certified.set.error * (1.0 - certified.gap), best.set.error * (1.0 + 1e-8));
    EXPECT_LE(certified.gap, last_gap);
    last_gap = certified.gap;
  }
  EXPECT_LT(last_gap, 1.0);
}

TEST(CertifySet, IsTheSameOnAnyNumberOfThreads) {
  const SubdomainSystem system = system_of({"lanczos2", 6, 4, 2, 1}, 3, 1);
  const FittedSet start = poor_set(system, 6);
  const CertifiedSet one = certify_set(system, start, {8000, prefilter::Run(1)});
  EXPECT_GT(one.gap, 0.0);
  for (const int threads : {2, 5}) {
    const CertifiedSet other = certify_set(system, start, {8000, prefilter::Run(threads)});
    EXPECT_EQ(other.set.members, one.set.members);
    EXPECT_EQ(other.set.weights, one.set.weights);
    EXPECT_EQ(other.gap, one.gap);
  }
}

TEST(CertifySet, HasNothingToProveWhereAllCandidatesAreIn) {
  const SubdomainSystem system = system_of({"tent", 4, 4, 2, 1, 5.0, ImageSpectrum::kWhite}, 1, 0);
  ASSERT_EQ(system.candidates(), 4);
  const CertifiedSet certified = certify_set(system, poor_set(system, 4), enough());
  EXPECT_EQ(certified.gap, 0.0);
  EXPECT_EQ(certified.set.members, (std::vector<int>{0, 1, 2, 3}));
}

TEST(CertifySet, IsCancelled) {
  const SubdomainSystem system = system_of({"lanczos2", 8, 4, 2, 1}, 3, 1);
  int calls = 0;
  CertifyOptions options = enough();
  options.run = prefilter::Run([&](double) { return ++calls < 3; });
  EXPECT_THROW(certify_set(system, poor_set(system, 8), options), Error);
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace prefilter
