// SPDX-License-Identifier: GPL-3.0-or-later

// Pharr, Wronski, Salvi and Fajardo, "Filtering After Shading With Stochastic Texture Filtering",
// 2024: picks a single texel of the filter, also with negative weights.
#include "prefilter/sampling/stochastic.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/sampling/weigh_texels.h"

namespace prefilter {
namespace {

void check_numbers(std::span<const double> numbers, std::size_t samples) {
  if (numbers.size() != samples) {
    throw_invalid("numbers: " + std::to_string(numbers.size()) + " for " + std::to_string(samples) +
                  " samples; one for each is needed");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= 0.0 && numbers[i] < 1.0) continue;
    throw_invalid("numbers: found " + to_text(numbers[i]) + " at " + std::to_string(i) +
                  "; numbers from 0 to below 1 are needed");
  }
}

// Level `level` as the only one, stretched over the image as in the pyramid.
Pyramid one_level(const Pyramid& pyramid, int level) {
  const PyramidLevel& found = pyramid.levels[static_cast<std::size_t>(level)];
  Pyramid alone({found}, pyramid.channels, pyramid.bytes);
  alone.levels[0] = found;
  return alone;
}

WeightedTexel pick(const WeightedTexels& found, double number) {
  double sum = 0.0;
  for (int i = 0; i < found.count; ++i) sum += std::abs(found.texels[i].weight);
  double remaining = number * sum;
  const WeightedTexel* picked = nullptr;
  for (int i = 0; i < found.count; ++i) {
    const WeightedTexel& texel = found.texels[i];
    if (texel.weight == 0.0) continue;
    picked = &texel;
    remaining -= std::abs(texel.weight);
    if (remaining < 0.0) break;
  }
  WeightedTexel result = *picked;
  result.weight = std::copysign(sum, picked->weight);
  return result;
}

WeightedTexels weigh_bilinearly(const Pyramid& pyramid, const SamplePlaces& places,
                                std::size_t sample, WrapModes wrap) {
  const double mip_value = elementary::log2(std::max(1.0, places.scale(sample)));
  const int last = static_cast<int>(pyramid.levels.size()) - 1;
  const int level = std::min(static_cast<int>(std::lround(mip_value)), last);
  const TexturePlace& place = places.coordinates[sample];
  WeightedTexels found =
      weigh_texels(one_level(pyramid, level), nullptr, wrap, place[0], place[1], 1.0);
  for (int i = 0; i < found.count; ++i) found.texels[i].level = level;
  return found;
}

template <typename Value>
void store(const Pyramid& pyramid, const WeightedTexel& picked, double unit, float* result) {
  const PyramidLevel& level = pyramid.levels[static_cast<std::size_t>(picked.level)];
  const auto channels = static_cast<std::size_t>(pyramid.channels);
  const std::size_t at = (static_cast<std::size_t>(picked.y) * level.width + picked.x) * channels;
  for (std::size_t c = 0; c < channels; ++c) {
    result[c] =
        static_cast<float>(picked.weight * unit * static_cast<const Value*>(level.texels)[at + c]);
  }
}

}  // namespace

std::vector<WeightedTexel> pick_texels(const Pyramid& pyramid, const TexelChoice& choice,
                                       const SamplePlaces& places, std::span<const double> numbers,
                                       const SampleOptions& options) {
  const bool by_table = choice.kind == TexelChoice::Kind::kTable;
  if (by_table) check_table(*choice.table);
  check_places(places);
  check_numbers(numbers, places.coordinates.size());
  std::vector<WeightedTexel> picked(numbers.size());
  constexpr std::int64_t kSamplesAtOnce = 1 << 12;
  parallel_ranges(
      static_cast<std::int64_t>(numbers.size()), kSamplesAtOnce, options.run,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          const TexturePlace& place = places.coordinates[i];
          picked[i] = pick(choice.kind == TexelChoice::Kind::kBilinear
                               ? weigh_bilinearly(pyramid, places, i, options.wrap)
                               : weigh_texels(pyramid, by_table ? choice.table : nullptr,
                                              options.wrap, place[0], place[1], places.scale(i)),
                           numbers[i]);
        }
      });
  return picked;
}

void sample_stochastically(const Pyramid& pyramid, const TexelChoice& choice,
                           const SamplePlaces& places, std::span<const double> numbers,
                           const SampleOptions& options, std::span<float> result) {
  const std::vector<WeightedTexel> picked = pick_texels(pyramid, choice, places, numbers, options);
  float* values = result.data();
  for (const WeightedTexel& texel : picked) {
    if (texel.x < 0 || texel.y < 0) {
      std::fill_n(values, pyramid.channels, 0.0F);
    } else if (pyramid.bytes) {
      store<std::uint8_t>(pyramid, texel, 1.0 / 255.0, values);
    } else {
      store<float>(pyramid, texel, 1.0, values);
    }
    values += pyramid.channels;
  }
}

}  // namespace prefilter
