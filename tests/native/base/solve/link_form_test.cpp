// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/solve/link_form.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace prefilter {
namespace {

constexpr int kTexels = 12;

std::vector<TexelLink> random_links(std::mt19937* random, int count) {
  std::uniform_real_distribution<float> share(-1.0F, 1.0F);
  std::vector<TexelLink> links(static_cast<std::size_t>(count));
  for (TexelLink& link : links) {
    link.count = 1 + static_cast<int>((*random)() % TexelLink::kMaxLinkTexels);
    for (int k = 0; k < link.count; ++k) {  // a texel may occur twice
      link.texels[k] = static_cast<std::ptrdiff_t>((*random)() % kTexels);
      link.shares[k] = share(*random);
    }
    link.weight = std::abs(share(*random));
  }
  links[1].weight = 0.0F;
  return links;
}

bool is_part(std::ptrdiff_t at) { return at != 5; }

// The sum of the weights times the outer products of the shares.
std::vector<double> dense(const std::vector<TexelLink>& links) {
  std::vector<double> matrix(kTexels * kTexels, 0.0);
  for (const TexelLink& link : links) {
    if (std::find(link.texels.begin(), link.texels.begin() + link.count, 5) !=
        link.texels.begin() + link.count) {
      continue;
    }
    for (int i = 0; i < link.count; ++i) {
      for (int j = 0; j < link.count; ++j) {
        matrix[link.texels[i] * kTexels + link.texels[j]] +=
            static_cast<double>(link.weight) * link.shares[i] * link.shares[j];
      }
    }
  }
  return matrix;
}

TEST(LinkForm, IsTheMatrixOfTheSumOfSquares) {
  std::mt19937 random(3);
  for (const int count : {2, 5, 40}) {
    const std::vector<TexelLink> links = random_links(&random, count);
    const LinkForm form(links, is_part, prefilter::Run());
    std::vector<double> expected = dense(links);
    std::vector<double> found(kTexels * kTexels, 0.0);
    ASSERT_FALSE(form.texels().empty());
    for (std::size_t k = 0; k + 1 < form.texels().size(); ++k) {
      const LinkForm::Texel& texel = form.texels()[k];
      EXPECT_LT(texel.at, form.texels()[k + 1].at);
      found[texel.at * kTexels + texel.at] = texel.own;
      for (const LinkForm::Entry* entry = form.begin(k); entry != form.end(k); ++entry) {
        EXPECT_NE(entry->at, texel.at);
        EXPECT_EQ(found[texel.at * kTexels + entry->at], 0.0);
        found[texel.at * kTexels + entry->at] = entry->value;
      }
    }
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-5);

    std::vector<LaneValues> values(kTexels);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    for (LaneValues& value : values) {
      for (int c = 0; c < kMaxChannels; ++c) value.v[c] = uniform(random);
    }
    const auto sums =
        form.value([&](std::ptrdiff_t at) -> const LaneValues& { return values[at]; });
    for (int c = 0; c < kMaxChannels; ++c) {
      double sum = 0.0;
      for (int i = 0; i < kTexels; ++i) {
        for (int j = 0; j < kTexels; ++j) {
          sum += expected[i * kTexels + j] * values[i].v[c] * values[j].v[c];
        }
      }
      EXPECT_NEAR(sums[c], sum, 1e-4);
    }
  }
}

TEST(LinkForm, IsEmptyWithoutLinks) {
  EXPECT_TRUE(LinkForm().empty());
  TexelLink link;
  link.count = 1;
  link.texels[0] = 5;
  link.shares[0] = 1.0F;
  link.weight = 1.0F;
  EXPECT_TRUE(LinkForm({link}, is_part, prefilter::Run()).empty());
}

}  // namespace
}  // namespace prefilter
