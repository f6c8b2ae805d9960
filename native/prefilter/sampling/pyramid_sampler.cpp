#include "prefilter/sampling/pyramid_sampler.h"

#include <algorithm>
#include <cstdint>

#include "prefilter/sampling/mip_places.h"
#include "prefilter/sampling/sample_block.h"
#include "prefilter/sampling/weigh_texels.h"

namespace prefilter {

namespace {

template <typename Value>
void sum_weighted(const Pyramid& pyramid, const WeightedTexels& found, float* result) {
  const auto channels = static_cast<std::size_t>(pyramid.channels);
  const double unit = pyramid.bytes ? 1.0 / 255.0 : 1.0;
  for (std::size_t c = 0; c < channels; ++c) {
    double sum = 0.0;
    for (int i = 0; i < found.count; ++i) {
      const auto& [level, x, y, weight] = found.texels[i];
      if (x < 0 || y < 0) continue;
      const PyramidLevel& texels = pyramid.levels[level];
      sum += weight *
             static_cast<const Value*>(
                 texels.texels)[(static_cast<std::size_t>(y) * texels.width + x) * channels + c];
    }
    result[c] = static_cast<float>(sum * unit);
  }
}

}  // namespace

PyramidSampler::PyramidSampler(const Pyramid& pyramid, const SamplingTable* table,
                               const WrapModes& wrap)
    : pyramid_(pyramid), table_(table), wrap_(wrap) {
  check_pyramid(pyramid);
  if (table == nullptr) return;
  check_table(*table);
  plan_ = std::make_unique<const TexelPlan>(pyramid, *table);
}

PyramidSampler::~PyramidSampler() = default;

void PyramidSampler::sample(std::span<const std::array<double, 2>> coordinates,
                            std::span<const double> scales, float* result) const {
  const bool is_constant = scales.size() == 1;
  const int levels = static_cast<int>(pyramid_.levels.size());
  SampleBlock block;
  SampleList others;
  for (std::size_t begin = 0; begin < coordinates.size(); begin += kBlockSamples) {
    block.count =
        static_cast<int>(std::min<std::size_t>(coordinates.size() - begin, kBlockSamples));
    for (int i = 0; i < block.count; ++i) {
      block.coordinates[i] = Pair{wrap_coordinate(coordinates[begin + i][0], wrap_.u),
                                  wrap_coordinate(coordinates[begin + i][1], wrap_.v)};
    }
    if (!is_constant) {
      place_between_levels(&scales[begin], block.count, levels, block.cell_levels.data(),
                           block.f.data());
    } else if (begin == 0) {
      place_between_levels(scales.data(), 1, levels, block.cell_levels.data(), block.f.data());
      block.cell_levels.fill(block.cell_levels[0]);
      block.f.fill(block.f[0]);
    }
    float* const values = result + begin * pyramid_.channels;
    if (plan_ != nullptr) {
      sample_block(*plan_, pyramid_, block, values, others);
    } else {
      sample_block_trilinearly(pyramid_, block, values, others);
    }
    for (int k = 0; k < others.count; ++k) {
      const int i = others.numbers[k];
      const WeightedTexels found =
          weigh_texels(pyramid_, table_, wrap_, block.coordinates[i][0], block.coordinates[i][1],
                       scales[is_constant ? 0 : begin + i]);
      float* const value = values + static_cast<std::ptrdiff_t>(i) * pyramid_.channels;
      if (pyramid_.bytes) {
        sum_weighted<std::uint8_t>(pyramid_, found, value);
      } else {
        sum_weighted<float>(pyramid_, found, value);
      }
    }
  }
}

}  // namespace prefilter
