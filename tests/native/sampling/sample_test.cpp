// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/image.h"
#include "prefilter/sampling/mip_places.h"
#include "prefilter/sampling/weigh_texels.h"

namespace prefilter {
namespace {

using Coordinates = std::vector<std::array<double, 2>>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Levels with random values.
struct Levels {
  std::vector<Image> floats;
  std::vector<std::vector<std::uint8_t>> bytes;

  Levels(int width, int height, int channels) {
    std::mt19937 random(static_cast<unsigned>(width * height));
    for (;; width = std::max(1, width / 2), height = std::max(1, height / 2)) {
      Image& image = floats.emplace_back(width, height, channels);
      for (float& value : image.data) {
        bytes.resize(floats.size());
        bytes.back().push_back(static_cast<std::uint8_t>(random() & 255U));
        value = static_cast<float>(bytes.back().back()) / 255.0F;
      }
      if (width == 1 && height == 1) return;
    }
  }

  Pyramid view(bool of_bytes = false) const {
    std::vector<PyramidLevel> views;
    for (std::size_t i = 0; i < floats.size(); ++i) {
      const void* texels = of_bytes ? static_cast<const void*>(bytes[i].data())
                                    : static_cast<const void*>(floats[i].data.data());
      views.push_back({texels, floats[i].width, floats[i].height});
    }
    return {std::move(views), floats[0].channels, of_bytes};
  }
};

/// A table with arbitrary texels, and weights that sum to 1.
SamplingTable random_table(int texels, int grid, int slices, int degree) {
  std::mt19937 random(static_cast<unsigned>(texels));
  std::uniform_real_distribution<double> coefficient(-1.0, 1.0);
  SamplingTable table;
  table.shape = {"tent", texels, grid, slices, degree};
  for (int levels = 1; levels <= 3; ++levels) {
    TableSection& section = table.sections[3 - levels];
    section.levels = levels;
    section.slices = levels == 1 ? 1 : slices;
    const int terms = table.shape.terms();
    const int subdomains = section.slices * table.shape.subdomains_of_slice();
    section.errors.resize(static_cast<std::size_t>(subdomains));
    section.trilinear_errors.resize(section.errors.size());
    for (int k = 0; k < subdomains; ++k) {
      std::array<double, kMaxTerms> rest{1.0};
      for (int i = 0; i < texels; ++i) {
        const int finer = static_cast<int>(random() % static_cast<unsigned>(levels));
        // Equally far from the cell in all levels, so that each of them is the first to reach an
        // edge.
        const auto offset = [&] {
          return static_cast<int>(random() % (7U << finer)) - (3 << finer);
        };
        section.texels.push_back({finer, offset(), offset()});
        for (int term = 0; term < terms; ++term) {
          const double value = i + 1 == texels ? rest[term] : coefficient(random);
          section.coefficients.push_back(value);
          rest[term] -= value;
        }
      }
    }
  }
  return table;
}

Coordinates random_coordinates(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-0.7, 1.7);
  Coordinates found(count);
  for (auto& [u, v] : found) {
    u = coordinate(random);
    v = coordinate(random);
  }
  return found;
}

std::vector<double> random_scales(std::size_t count) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> mip_value(-1.0, 8.0);
  std::vector<double> found(count);
  for (double& scale : found) scale = std::exp2(mip_value(random));
  return found;
}

std::vector<float> sampled(const Pyramid& pyramid, const SamplingTable* table,
                           const Coordinates& coordinates, const std::vector<double>& scales,
                           WrapModes wrap, int threads = 1) {
  std::vector<float> result(coordinates.size() * static_cast<std::size_t>(pyramid.channels));
  SampleOptions options;
  options.wrap = wrap;
  options.run = prefilter::Run(threads);
  sample(pyramid, table, coordinates, scales, options, result);
  return result;
}

TEST(Sample, IsTheSameForAnyNumberOfThreads) {
  const Levels levels(37, 21, 3);
  const SamplingTable table = random_table(5, 3, 2, 1);
  const Coordinates coordinates = random_coordinates(20000);
  const std::vector<double> scales = random_scales(20000);
  for (const SamplingTable* one : {&table, static_cast<const SamplingTable*>(nullptr)}) {
    const WrapModes wrap{Wrap::kRepeat, Wrap::kClamp};
    EXPECT_EQ(sampled(levels.view(), one, coordinates, scales, wrap, 1),
              sampled(levels.view(), one, coordinates, scales, wrap, 4));
  }
}

/// The sums defined by weigh_texels.
std::vector<double> weighed(const Levels& levels, const SamplingTable* table, WrapModes wrap,
                            const std::array<double, 2>& place, double scale) {
  const WeightedTexels found = weigh_texels(levels.view(), table, wrap, place[0], place[1], scale);
  std::vector<double> sums(static_cast<std::size_t>(levels.floats[0].channels));
  for (int i = 0; i < found.count; ++i) {
    const auto& [level, x, y, weight] = found.texels[i];
    if (x < 0 || y < 0) continue;
    for (std::size_t c = 0; c < sums.size(); ++c) {
      sums[c] += weight * levels.floats[level].texel(x, y)[c];
    }
  }
  return sums;
}

TEST(Sample, IsTheWeightedSumOfItsTexels) {
  const std::array<SamplingTable, 4> tables{random_table(8, 4, 2, 1), random_table(6, 1, 1, 1),
                                            random_table(4, 2, 3, 2), random_table(13, 3, 1, 1)};
  std::vector<const SamplingTable*> all{nullptr};
  for (const SamplingTable& table : tables) all.push_back(&table);
  Coordinates coordinates = random_coordinates(1000);
  // Half of the samples where texels begin to lie beyond an edge, also in levels that do not nest.
  for (std::size_t i = 0; i < coordinates.size(); i += 2) {
    for (double& one : coordinates[i]) one = (one > 0.5 ? 0.8 : 0.2) + 0.3 * (one - 0.5);
  }
  const std::vector<double> scales = random_scales(1000);
  constexpr std::array<Wrap, 3> kModes{Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder};
  int seed = 0;
  for (const auto& [width, height] :
       {std::pair{64, 64}, {37, 53}, {255, 63}, {40, 3}, {1, 17}, {1, 1}}) {
    const Levels levels(width, height, 1 + seed % 5);
    for (const SamplingTable* table : all) {
      const WrapModes wrap{kModes[seed % 3], kModes[seed / 3 % 3]};
      ++seed;
      const auto found = sampled(levels.view(), table, coordinates, scales, wrap);
      std::size_t value = 0;
      for (std::size_t i = 0; i < coordinates.size(); ++i) {
        for (const double sum : weighed(levels, table, wrap, coordinates[i], scales[i])) {
          EXPECT_NEAR(found[value++], sum, 2e-6) << width << " x " << height << ", " << i;
        }
      }
    }
  }
}

TEST(Sample, LiesBetweenTheLevelsAroundItsScale) {
  std::vector<double> scales{0.0, -0.0, 0.5, 1.0, 1e-300, 1e300, std::nextafter(1.0F, 2.0F)};
  for (int i = -2; i < 12; ++i) scales.push_back(std::exp2(i));
  for (const double scale : random_scales(10000)) scales.push_back(static_cast<float>(scale));
  const int count = static_cast<int>(scales.size());
  std::vector<int> cells(scales.size());
  std::vector<float> f(scales.size());
  for (const int levels : {1, 2, 7, 21}) {
    place_between_levels(scales.data(), count, levels, cells.data(), f.data());
    for (int i = 0; i < count; ++i) {
      const MipPlace expected = place_between_levels(scales[i], levels);
      EXPECT_EQ(cells[i], expected.cell_level) << scales[i];
      EXPECT_NEAR(f[i], expected.f, 2e-7) << scales[i];
      if (std::exp2(std::round(std::log2(scales[i]))) == scales[i]) {
        EXPECT_EQ(f[i], expected.f) << scales[i];
      }
    }
  }
}

TEST(Sample, BytesMatchFloats) {
  const SamplingTable table = random_table(6, 4, 2, 1);
  const Coordinates coordinates = random_coordinates(3000);
  const std::vector<double> scales = random_scales(3000);
  for (int channels = 1; channels <= 5; ++channels) {
    const Levels levels(64, 64, channels);
    for (const SamplingTable* one : {&table, static_cast<const SamplingTable*>(nullptr)}) {
      const auto floats = sampled(levels.view(), one, coordinates, scales, {});
      const auto bytes = sampled(levels.view(true), one, coordinates, scales, {});
      for (std::size_t i = 0; i < floats.size(); ++i) EXPECT_NEAR(bytes[i], floats[i], 1e-6);
    }
  }
}

TEST(Sample, OneScaleAppliesToAll) {
  const Levels levels(32, 16, 2);
  const SamplingTable table = random_table(4, 2, 1, 1);
  const Coordinates coordinates = random_coordinates(500);
  for (const double scale : {0.0, 1.0, 1.5, 2.0, 7.0, 1e300}) {
    EXPECT_EQ(sampled(levels.view(), &table, coordinates, {scale}, {}),
              sampled(levels.view(), &table, coordinates, std::vector<double>(500, scale), {}));
  }
}

TEST(Sample, RefusesInvalidArguments) {
  const Levels levels(8, 8, 1);
  const Coordinates one{{0.5, 0.5}};
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_THROW(sampled(levels.view(), nullptr, {{bad, 0.0}}, {1.0}, {}), Error);
    EXPECT_THROW(sampled(levels.view(), nullptr, {{0.0, bad}}, {1.0}, {}), Error);
    EXPECT_THROW(sampled(levels.view(), nullptr, one, {bad}, {}), Error);
  }
  EXPECT_THROW(sampled(levels.view(), nullptr, one, {-1.0}, {}), Error);
  EXPECT_THROW(sampled(levels.view(), nullptr, one, {1.0, 2.0}, {}), Error);
  EXPECT_THROW((Pyramid{{}, 1, false}), Error);
  std::vector<PyramidLevel> wrong = levels.view().levels;
  wrong[1].width = 3;
  EXPECT_THROW((Pyramid{wrong, 1, false}), Error);
  SamplingTable no_table;
  EXPECT_THROW(sampled(levels.view(), &no_table, one, {1.0}, {}), Error);
  EXPECT_TRUE(sampled(levels.view(), nullptr, {}, {}, {}).empty());
}

}  // namespace
}  // namespace prefilter
