// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/pyramid_sampler.h"

#include <algorithm>
#include <cstddef>
#include <memory>

#include "prefilter/sampling/mip_places.h"
#include "prefilter/sampling/sample_block.h"
#include "prefilter/sampling/weigh_texels.h"

namespace prefilter {

PyramidSampler::PyramidSampler(const Pyramid& pyramid, const SamplingTable* table,
                               const WrapModes& wrap)
    : pyramid_(pyramid, wrap) {
  if (table == nullptr) return;
  check_table(*table);
  plan_ = std::make_unique<const TexelPlan>(pyramid, *table);
}

PyramidSampler::~PyramidSampler() = default;

void PyramidSampler::sample(std::span<const std::array<double, 2>> coordinates,
                            std::span<const double> scales, float* result) const {
  const bool is_constant = scales.size() == 1;
  const int levels = static_cast<int>(pyramid_.pyramid.levels.size());
  SampleBlock block;
  for (std::size_t begin = 0; begin < coordinates.size(); begin += kBlockSamples) {
    block.count =
        static_cast<int>(std::min<std::size_t>(coordinates.size() - begin, kBlockSamples));
    for (int i = 0; i < block.count; ++i) {
      block.coordinates[i] = Pair{wrap_coordinate(coordinates[begin + i][0], pyramid_.wrap.u),
                                  wrap_coordinate(coordinates[begin + i][1], pyramid_.wrap.v)};
    }
    if (!is_constant) {
      place_between_levels(&scales[begin], block.count, levels, block.cell_levels.data(),
                           block.f.data());
    } else if (begin == 0) {
      place_between_levels(scales.data(), 1, levels, block.cell_levels.data(), block.f.data());
      block.cell_levels.fill(block.cell_levels[0]);
      block.f.fill(block.f[0]);
    }
    float* const values = result + begin * static_cast<std::size_t>(pyramid_.pyramid.channels);
    if (plan_ != nullptr) {
      sample_block(*plan_, pyramid_, block, values);
    } else {
      sample_block_trilinearly(pyramid_, block, values);
    }
  }
}

}  // namespace prefilter
