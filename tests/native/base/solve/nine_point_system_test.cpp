// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/solve/nine_point_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace prefilter {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The same equations as a dense matrix, with a right side per channel.
struct Dense {
  int count = 0;
  std::vector<double> matrix;
  std::vector<std::array<double, kMaxChannels>> right;

  double& at(int i, int j) { return matrix[static_cast<std::size_t>(i) * count + j]; }

  // Gauss elimination; the matrix is positive definite.
  std::vector<std::array<double, kMaxChannels>> solution() const {
    Dense left = *this;
    for (int k = 0; k < count; ++k) {
      for (int i = k + 1; i < count; ++i) {
        const double factor = left.at(i, k) / left.at(k, k);
        for (int j = k; j < count; ++j) left.at(i, j) -= factor * left.at(k, j);
        for (int c = 0; c < kMaxChannels; ++c) left.right[i][c] -= factor * left.right[k][c];
      }
    }
    for (int k = count; k-- > 0;) {
      for (int c = 0; c < kMaxChannels; ++c) {
        for (int j = k + 1; j < count; ++j) left.right[k][c] -= left.at(k, j) * left.right[j][c];
        left.right[k][c] /= left.at(k, k);
      }
    }
    return left.right;
  }
};

struct Both {
  NinePointSystem<float> system;
  Dense dense;
};

// Weights at random places of every cell, with random values.
Both random_system(int width, int height, WrapModes wrap, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  Both both{NinePointSystem<float>(width, height, wrap), {width * height, {}, {}}};
  both.dense.matrix.resize(static_cast<std::size_t>(width * height) * width * height);
  both.dense.right.resize(static_cast<std::size_t>(width) * height);
  for (int row = -1; row < height; ++row) {
    for (int column = -1; column < width; ++column) {
      NinePointSystem<float>::TentProducts products{};
      NinePointSystem<float>::TentIntegrals right{};
      for (int point = 0; point < 3; ++point) {
        const float x = uniform(random);
        const float y = uniform(random);
        const float weight = uniform(random);
        std::array<float, kMaxChannels> values;
        for (float& value : values) value = uniform(random);
        const float in_x[2] = {1.0F - x, x};
        const float in_y[2] = {1.0F - y, y};
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i) {
            products[3 * j + i] +=
                weight * in_x[i / 2] * in_x[(i + 1) / 2] * in_y[j / 2] * in_y[(j + 1) / 2];
          }
        }
        int texels[4];
        for (int k = 0; k < 4; ++k) {
          for (int c = 0; c < kMaxChannels; ++c)
            right[k].v[c] += weight * in_x[k % 2] * in_y[k / 2] * values[c];
          const int i = wrap_index(column + k % 2, width, wrap.u);
          const int j = wrap_index(row + k / 2, height, wrap.v);
          texels[k] = i < 0 || j < 0 ? -1 : j * width + i;
        }
        for (int k = 0; k < 4; ++k) {
          if (texels[k] < 0) continue;
          const double own = static_cast<double>(weight) * in_x[k % 2] * in_y[k / 2];
          for (int c = 0; c < kMaxChannels; ++c) both.dense.right[texels[k]][c] += own * values[c];
          for (int l = 0; l < 4; ++l) {
            if (texels[l] >= 0)
              both.dense.at(texels[k], texels[l]) += own * in_x[l % 2] * in_y[l / 2];
          }
        }
      }
      both.system.add_cell(column, row, products, right);
    }
  }
  // Keeps it far from singular.
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      both.system.diagonal(both.system.at(x, y)) += 0.1F;
      both.dense.at(y * width + x, y * width + x) += 0.1;
    }
  }
  both.system.make_texels();
  return both;
}

SolveOptions exact() {
  SolveOptions options;
  for (ValueRange& range : options.ranges) range = {-kInfinity, kInfinity};
  options.tolerance = 1e-7;
  options.max_sweeps = 2000;
  return options;
}

const std::vector<std::pair<int, int>> kSizes = {{1, 1}, {2, 1}, {1, 3}, {2, 2},
                                                 {5, 4}, {4, 5}, {3, 7}};
const std::vector<WrapModes> kWraps = {
    {Wrap::kClamp, Wrap::kClamp}, {Wrap::kRepeat, Wrap::kRepeat}, {Wrap::kBorder, Wrap::kRepeat}};

TEST(NinePointSystem, SolvesWhatIsAssembled) {
  unsigned seed = 0;
  for (const WrapModes wrap : kWraps) {
    for (const auto& [width, height] : kSizes) {
      Both both = random_system(width, height, wrap, ++seed);
      const auto expected = both.dense.solution();
      both.system.invert_diagonal();
      both.system.solve(exact(), prefilter::Run());
      for (int i = 0; i < width * height; ++i) {
        const auto& texel = both.system.texel(both.system.at(i % width, i / width));
        for (int c = 0; c < kMaxChannels; ++c) {
          EXPECT_NEAR(texel.v[c], expected[i][c], 2e-5) << seed << ", " << i;
        }
      }
    }
  }
}

TEST(NinePointSystem, ProductsAndFormsAreThoseOfTheMatrix) {
  for (const WrapModes wrap : kWraps) {
    Both both = random_system(5, 4, wrap, 40);
    std::mt19937 random(9);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    std::vector<LaneValues> b(both.system.size());
    for (int i = 0; i < 20; ++i) {
      const std::ptrdiff_t at = both.system.at(i % 5, i / 5);
      for (int c = 0; c < kMaxChannels; ++c) {
        both.system.texel(at).v[c] = uniform(random);
        b[at].v[c] = uniform(random);
      }
    }
    const auto texel = [&](int i) { return both.system.texel(both.system.at(i % 5, i / 5)).v; };
    const std::vector<LaneValues> products = both.system.product();
    std::array<double, kMaxChannels> expected{};
    for (int i = 0; i < 20; ++i) {
      for (int c = 0; c < kMaxChannels; ++c) {
        double product = 0.0;
        for (int j = 0; j < 20; ++j) product += both.dense.at(i, j) * texel(j)[c];
        EXPECT_NEAR(products[both.system.at(i % 5, i / 5)].v[c], product, 1e-5);
        expected[c] += texel(i)[c] *
                       (product - 0.1 * texel(i)[c] - 2.0 * b[both.system.at(i % 5, i / 5)].v[c]);
      }
    }
    both.system.invert_diagonal();
    const auto form = both.system.form(b, 0.1F, 1);
    for (int c = 0; c < kMaxChannels; ++c) EXPECT_NEAR(form[c], expected[c], 2e-5);
  }
}

// A texel is at a limit of its range only if the form decreases beyond it (Karush, Kuhn, Tucker).
void expect_optimal(const Both& both, const SolveOptions& options, int width, int height) {
  Dense dense = both.dense;
  int at_ends = 0;
  for (int i = 0; i < width * height; ++i) {
    const Lanes own = both.system.texel(both.system.at(i % width, i / width)).v;
    for (int c = 0; c < kMaxChannels; ++c) {
      const float alpha = options.ranges_times_alpha && c < 3 ? own[3] : 1.0F;
      const auto& [low, high] = options.ranges[c];
      double slope = -dense.right[i][c];
      for (int j = 0; j < width * height; ++j) {
        slope += dense.at(i, j) * both.system.texel(both.system.at(j % width, j / width)).v[c];
      }
      EXPECT_GE(own[c], alpha * low - 1e-6F);
      EXPECT_LE(own[c], alpha * high + 1e-6F);
      const bool is_low = own[c] <= alpha * low + 1e-6F;
      const bool is_high = own[c] >= alpha * high - 1e-6F;
      if (!is_low) {
        EXPECT_LT(slope, 2e-5) << i << ", " << c;
      }
      if (!is_high) {
        EXPECT_GT(slope, -2e-5) << i << ", " << c;
      }
      at_ends += is_low || is_high ? 1 : 0;
    }
  }
  EXPECT_GT(at_ends, 3);
}

TEST(NinePointSystem, RespectsRanges) {
  for (const bool times_alpha : {false, true}) {
    Both both = random_system(6, 5, kWraps[1], times_alpha ? 7 : 8);
    SolveOptions options = exact();
    options.ranges = {{{0.3F, 0.5F}, {0.4F, 0.45F}, {0.0F, 0.5F}, {0.2F, 0.5F}}};
    options.ranges_times_alpha = times_alpha;
    both.system.invert_diagonal();
    both.system.solve(options, prefilter::Run());
    expect_optimal(both, options, 6, 5);
  }
}

TEST(NinePointSystem, LinksCountByTheirWeight) {
  for (const float weight : {0.5F, 4.0F}) {
    Both both = random_system(5, 4, kWraps[0], 11);
    TexelLink across;
    across.count = 3;
    across.texels = {both.system.at(0, 0), both.system.at(4, 3), both.system.at(2, 1)};
    across.shares = {1.0F, -0.75F, -0.25F};
    across.weight = 2.0F;
    const int texels[3] = {0, 19, 7};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        both.dense.at(texels[i], texels[j]) +=
            static_cast<double>(weight) * across.weight * across.shares[i] * across.shares[j];
      }
    }
    const auto expected = both.dense.solution();
    const LinkForm form(
        {across}, [](std::ptrdiff_t) { return true; }, prefilter::Run());
    both.system.invert_diagonal();
    // An earlier weight has no effect.
    both.system.weigh_links(&form, Lanes{} + 9.0F);
    both.system.weigh_links(&form, Lanes{} + weight);
    both.system.solve(exact(), prefilter::Run());
    for (int i = 0; i < 20; ++i) {
      const auto& texel = both.system.texel(both.system.at(i % 5, i / 5));
      for (int c = 0; c < kMaxChannels; ++c) EXPECT_NEAR(texel.v[c], expected[i][c], 3e-5) << i;
    }
  }
}

}  // namespace
}  // namespace prefilter
