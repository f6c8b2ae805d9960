#include "prefilter/sampling/sample_block.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "prefilter/sampling/texel_sums.h"

namespace prefilter {
namespace {

using Four [[gnu::vector_size(16)]] = std::int32_t;

/// Where samples are in their cells and where those are in memory, for all of a block.
struct CellPlaces {
  alignas(16) std::array<float, kBlockSamples> x;  // folded
  alignas(16) std::array<float, kBlockSamples> y;
  alignas(16) std::array<float, kBlockSamples> f;
  alignas(16) std::array<int, kBlockSamples> subdomains;
  alignas(16) std::array<int, kBlockSamples> tiles;                  // subdomain and symmetry
  std::array<std::array<std::uintptr_t, 4>, kBlockSamples> corners;  // by level below the cells'
};

void find_cells(const TexelPlan& plan, const SampleBlock& block, CellPlaces& places,
                SampleList& inside, SampleList& others) {
  for (int i = 0; i < block.count; ++i) {
    const PlannedCells& cells = plan.cells()[block.cell_levels[i]];
    const Pair uv = block.coordinates[i];
    const Pair at = uv * cells.sizes[0];
    const Pair cell = floor_pair(at);
    const Pair in_cell = at - cell;
    places.x[i] = static_cast<float>(in_cell[0]);
    places.y[i] = static_cast<float>(in_cell[1]);
    const bool is_inside = is_between(cells.low, cell, cells.high);
    inside.add(i, is_inside);
    others.add(i, !is_inside);
    for (int finer = 0; finer < 3; ++finer) {
      const double texels = 1 << finer;
      const Pair corner = cells.nests || finer == 0
                              ? cell * texels
                              : floor_pair(uv * cells.sizes[finer] - in_cell * texels + 0.5);
      places.corners[i][finer] = cells.texels[finer] + distance(corner, cells.pitches[finer]);
    }
  }
}

/// Folds x and y in place, and finds what the table has for them.
void find_subdomains(const TexelPlan& plan, const SampleBlock& block, CellPlaces& places) {
  const TableShape& shape = plan.shape();
  const Lanes grid = all_lanes(static_cast<float>(shape.grid));
  const Lanes slices = all_lanes(static_cast<float>(shape.slices));
  const std::int32_t last_column = shape.columns() - 1;
  const std::int32_t last_slice = shape.slices - 1;
  const std::int32_t per_slice = shape.subdomains_of_slice();
  const auto index = [](Lanes value, std::int32_t last) {
    const Four found = __builtin_convertvector(value, Four);
    const Four limit = {last, last, last, last};
    return found < limit ? found : limit;
  };
  for (int begin = 0; begin < block.count; begin += 4) {
    const Lanes x = load_lanes(&places.x[begin]);
    const Lanes y = load_lanes(&places.y[begin]);
    const Lanes f = load_lanes(&block.f[begin]);
    const Four mirror_x = x > 0.5F;
    const Four mirror_y = y > 0.5F;
    const Lanes along_x = lane_min(x, 1.0F - x);
    const Lanes along_y = lane_min(y, 1.0F - y);
    const Four swapped = along_y > along_x;
    const Lanes larger = lane_max(along_x, along_y);
    const Lanes smaller = lane_min(along_x, along_y);
    const Four i = index(larger * grid, last_column);
    const Four j = index(smaller * grid, last_column);
    const Four slice = index(f * slices, last_slice);
    const Four subdomain = slice * per_slice + ((i * (i + 1)) >> 1) + j;
    const Four tile = subdomain * kSymmetries - mirror_x - 2 * mirror_y - 4 * swapped;
    Four levels;
    std::memcpy(&levels, &block.cell_levels[begin], sizeof levels);
    const Lanes third = levels == 0 ? larger * smaller : f;
    std::memcpy(&places.x[begin], &larger, sizeof larger);
    std::memcpy(&places.y[begin], &smaller, sizeof smaller);
    std::memcpy(&places.f[begin], &third, sizeof third);
    std::memcpy(&places.subdomains[begin], &subdomain, sizeof subdomain);
    std::memcpy(&places.tiles[begin], &tile, sizeof tile);
  }
}

template <int kDegree>
inline Lanes weights_of_four(const float* c, int padded, Lanes x, Lanes y, Lanes f) {
  const auto term = [&](int t) { return load_lanes(c + t * padded); };
  Lanes sum = term(0) + term(1) * x + term(2) * y + term(3) * f;
  if constexpr (kDegree == 2) {
    sum += term(4) * (x * x) + term(5) * (y * y) + term(6) * (f * f) + term(7) * (x * y) +
           term(8) * (x * f) + term(9) * (y * f);
  }
  return sum;
}

/// What a sample sums up.
struct TexelSet {
  const std::uintptr_t* corners;
  const std::uint8_t* finer;
  const std::int32_t* offsets;

  template <typename Value>
  const Value* texel(int i) const {
    return reinterpret_cast<const Value*>(corners[finer[i]] +
                                          static_cast<std::uintptr_t>(std::int64_t{offsets[i]}));
  }
};

template <typename Value, int kTexels>
inline void sum_four_channels(const TexelSet& set, const Lanes* weights, int texels,
                              float* result) {
  Lanes sum{};
  if constexpr (kTexels > 0) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      ((sum += all_lanes(weights[i / 4][i % 4]) * load_lanes(set.texel<Value>(i))), ...);
    }
    (std::make_index_sequence<kTexels>());
  } else {
    for (int i = 0; i < texels; ++i) {
      sum += all_lanes(weights[i / 4][i % 4]) * load_lanes(set.texel<Value>(i));
    }
  }
  std::memcpy(result, &sum, sizeof sum);
}

template <typename Value>
inline void sum_channels(const TexelSet& set, const Lanes* weights, int texels, int channels,
                         float* result) {
  std::fill_n(result, channels, 0.0F);
  for (int i = 0; i < texels; ++i) {
    const float weight = weights[i / 4][i % 4];
    const Value* texel = set.texel<Value>(i);
    for (int c = 0; c < channels; ++c) result[c] += weight * static_cast<float>(texel[c]);
  }
}

/// kTexels is 0 where the number is not known ahead.
template <typename Value, int kTexels, int kDegree>
void sum_block(const TexelPlan& plan, int channels, const SampleBlock& block,
               const CellPlaces& places, const SampleList& inside, float* result) {
  const int texels = kTexels > 0 ? kTexels : plan.shape().texels;
  const int padded = (texels + 3) / 4 * 4;
  constexpr int kTerms = kDegree == 1 ? 4 : 10;
  for (int k = 0; k < inside.count; ++k) {
    const int i = inside.numbers[k];
    const PlannedCells& cells = plan.cells()[block.cell_levels[i]];
    const float* coefficients = cells.weights + places.subdomains[i] * (kTerms * padded);
    std::array<Lanes, kMostTexels / 4> weights;
    const Lanes x = all_lanes(places.x[i]);
    const Lanes y = all_lanes(places.y[i]);
    const Lanes f = all_lanes(places.f[i]);
    for (int four = 0; four < padded / 4; ++four) {
      weights[four] = weights_of_four<kDegree>(coefficients + 4 * four, padded, x, y, f);
    }
    const TexelSet set{places.corners[i].data(), cells.finer + places.subdomains[i] * padded,
                       cells.offsets + places.tiles[i] * padded};
    float* const values = result + static_cast<std::ptrdiff_t>(i) * channels;
    if (channels == 4) {
      sum_four_channels<Value, kTexels>(set, weights.data(), texels, values);
    } else {
      sum_channels<Value>(set, weights.data(), texels, channels, values);
    }
  }
}

template <typename Value>
void sum_texels(const TexelPlan& plan, int channels, const SampleBlock& block,
                const CellPlaces& places, const SampleList& inside, float* result) {
  const auto sum = [&](auto function) { function(plan, channels, block, places, inside, result); };
  if (plan.shape().degree == 2) {
    sum(sum_block<Value, 0, 2>);
  } else if (plan.shape().texels == 8) {
    sum(sum_block<Value, 8, 1>);
  } else if (plan.shape().texels == 6) {
    sum(sum_block<Value, 6, 1>);
  } else if (plan.shape().texels == 4) {
    sum(sum_block<Value, 4, 1>);
  } else {
    sum(sum_block<Value, 0, 1>);
  }
}

}  // namespace

void sample_block(const TexelPlan& plan, const Pyramid& pyramid, const SampleBlock& block,
                  float* result, SampleList& others) {
  CellPlaces places;
  SampleList inside;
  others.count = 0;
  find_cells(plan, block, places, inside, others);
  find_subdomains(plan, block, places);
  if (pyramid.bytes) {
    sum_texels<std::uint8_t>(plan, pyramid.channels, block, places, inside, result);
  } else {
    sum_texels<float>(plan, pyramid.channels, block, places, inside, result);
  }
}

}  // namespace prefilter
