// SPDX-License-Identifier: GPL-3.0-or-later

// Section 6.2. Each step processes all samples of a block, so that the processor overlaps their
// latencies: first their locations in memory, then the subdomains of four samples at a time, then
// the weights of four texels at a time and the sum of the texels. The only data-dependent branch is
// whether a sample reads beyond an edge, so hardly any branch is mispredicted.
#include "prefilter/sampling/sample_block.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "prefilter/sampling/texel_sums.h"

namespace prefilter {
namespace {

using FourSamples = Vector<std::int32_t, 4>;

// Number of samples to prefetch texels ahead, for images that exceed the caches.
constexpr int kPrefetchedSamples = 8;
constexpr std::size_t kCachedBytes = std::size_t{8} << 20;

/// For each sample of a block: its position in the cell, and the cell's location in memory.
struct CellPlaces {
  alignas(16) std::array<float, kBlockSamples> x;  // folded
  alignas(16) std::array<float, kBlockSamples> y;
  alignas(16) std::array<float, kBlockSamples> f;
  alignas(16) std::array<int, kBlockSamples> subdomains;
  alignas(16) std::array<int, kBlockSamples> tiles;  // subdomain and symmetry
  std::array<std::array<std::uintptr_t, 4>, kBlockSamples>
      corners;  // by level relative to the cell's
};

/// The samples of a block whose texels all lie inside their levels, and the others.
struct Sides {
  SampleList inside;
  SampleList outside;
};

void find_cells(const TexelPlan& plan, const SampleBlock& block, CellPlaces& places, Sides& sides) {
  for (int i = 0; i < block.count; ++i) {
    const PlannedCells& cells = plan.cells()[block.cell_levels[i]];
    const Pair uv = block.coordinates[i];
    const Pair at = uv * cells.extents[0];
    const Pair cell = floor_pair(at);
    const Pair in_cell = at - cell;
    places.x[i] = static_cast<float>(in_cell[0]);
    places.y[i] = static_cast<float>(in_cell[1]);
    const bool is_inside = is_between(cells.low, cell, cells.high);
    sides.inside.add(i, is_inside);
    sides.outside.add(i, !is_inside);
    for (int finer = 0; finer < 3; ++finer) {
      const Pair corner = cells.corner(finer, uv, cell, in_cell);
      places.corners[i][finer] = cells.texels[finer] + texel_offset(corner, cells.pitches[finer]);
    }
  }
}

/// Folds x and y in place, and determines the subdomains.
void find_subdomains(const TexelPlan& plan, const SampleBlock& block, CellPlaces& places) {
  const TableShape& shape = plan.shape();
  const Lanes grid = all_lanes(static_cast<float>(shape.grid));
  const Lanes slices = all_lanes(static_cast<float>(shape.slices));
  const std::int32_t last_column = shape.columns() - 1;
  const std::int32_t last_slice = shape.slices - 1;
  const std::int32_t per_slice = shape.subdomains_of_slice();
  const auto index = [](Lanes value, std::int32_t last) {
    const FourSamples indices = convert<FourSamples>(value);
    const FourSamples limit = {last, last, last, last};
    return select(indices < limit, indices, limit);
  };
  for (int begin = 0; begin < block.count; begin += 4) {
    const Lanes x = load_lanes(&places.x[begin]);
    const Lanes y = load_lanes(&places.y[begin]);
    const Lanes f = load_lanes(&block.f[begin]);
    const FourSamples mirror_x = x > 0.5F;
    const FourSamples mirror_y = y > 0.5F;
    const Lanes along_x = lane_min(x, 1.0F - x);
    const Lanes along_y = lane_min(y, 1.0F - y);
    const FourSamples swapped = along_y > along_x;
    const Lanes larger = lane_max(along_x, along_y);
    const Lanes smaller = lane_min(along_x, along_y);
    const FourSamples i = index(larger * grid, last_column);
    const FourSamples j = index(smaller * grid, last_column);
    const FourSamples slice = index(f * slices, last_slice);
    const FourSamples subdomain = slice * per_slice + ((i * (i + 1)) >> 1) + j;
    const FourSamples tile = subdomain * kSymmetries - mirror_x - 2 * mirror_y - 4 * swapped;
    FourSamples levels;
    std::memcpy(&levels, &block.cell_levels[begin], sizeof levels);
    const Lanes third = select(levels == 0, larger * smaller, f);
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

/// The texels of a sample, all inside their levels.
struct TexelSet {
  const std::uintptr_t* corners;
  const std::uint8_t* finer;
  const std::int32_t* distances;

  TexelSet(const PlannedCells& cells, const CellPlaces& places, int padded, int sample)
      : corners(places.corners[sample].data()),
        finer(cells.finer + places.subdomains[sample] * padded),
        distances(cells.distances + places.tiles[sample] * padded) {}

  template <typename Value>
  const Value* texel(int i) const {
    return reinterpret_cast<const Value*>(corners[finer[i]] +
                                          static_cast<std::uintptr_t>(std::int64_t{distances[i]}));
  }
};

/// Texels at arbitrary addresses.
struct TexelList {
  std::array<const void*, kMaxTexels> texels;

  template <typename Value>
  const Value* texel(int i) const {
    return static_cast<const Value*>(texels[i]);
  }
};

/// Sums the channels from `channel` on, as many as Sum holds.
template <typename Value, int kTexels, typename Sum, typename Set>
inline void sum_channels(const Set& set, const Lanes* weights, int texels, int channel,
                         float* result) {
  const auto weighted = [&](int i) {
    return Sum::load(set.template texel<Value>(i) + channel) * weights[i / 4][i % 4];
  };
  Sum sum{};
  if constexpr (kTexels > 0) {
    [&]<std::size_t... i>(std::index_sequence<i...>) { ((sum += weighted(i)), ...); }
    (std::make_index_sequence<kTexels>());
  } else {
    for (int i = 0; i < texels; ++i) sum += weighted(i);
  }
  sum.store(result + channel);
}

/// Weighted sums over a block. kTexels is 0 if the number of texels is not known at compile time.
template <typename Value, int kTexels, int kDegree>
struct BlockSums {
  const TexelPlan& plan;
  int channels;
  const SampleBlock& block;
  const CellPlaces& places;
  float* result;

  int texels() const { return kTexels > 0 ? kTexels : plan.shape().texels; }
  int padded() const { return (texels() + 3) / 4 * 4; }
  const PlannedCells& cells(int sample) const { return plan.cells()[block.cell_levels[sample]]; }

  template <typename Set>
  void sum(int sample, const Set& set) const {
    constexpr int kTerms = kDegree == 1 ? 4 : 10;
    const float* coefficients =
        cells(sample).weights + places.subdomains[sample] * (kTerms * padded());
    std::array<Lanes, kMaxTexels / 4> weights;
    const Lanes x = all_lanes(places.x[sample]);
    const Lanes y = all_lanes(places.y[sample]);
    const Lanes f = all_lanes(places.f[sample]);
    for (int four = 0; four < padded() / 4; ++four) {
      weights[four] = weights_of_four<kDegree>(coefficients + 4 * four, padded(), x, y, f);
    }
    float* const values = result + static_cast<std::ptrdiff_t>(sample) * channels;
    for_channels(channels, [&]<typename Sum>(int channel) {
      sum_channels<Value, kTexels, Sum>(set, weights.data(), texels(), channel, values);
    });
  }

  template <bool kPrefetches>
  void sum_inside(const SampleList& samples) const {
    for (int k = 0; k < samples.count; ++k) {
      if (kPrefetches && k + kPrefetchedSamples < samples.count) {
        const int ahead = samples.numbers[k + kPrefetchedSamples];
        const TexelSet set(cells(ahead), places, padded(), ahead);
        for (int i = 0; i < texels(); ++i) __builtin_prefetch(set.texel<Value>(i));
      }
      const int sample = samples.numbers[k];
      sum(sample, TexelSet(cells(sample), places, padded(), sample));
    }
  }
};

/// The texels of a sample, read according to the wrap modes.
TexelList wrapped_texels(const TexelPlan& plan, const WrappedPyramid& pyramid,
                         const SampleBlock& block, int tile, int sample) {
  const int cell_level = block.cell_levels[sample];
  const PlannedCells& cells = plan.cells()[cell_level];
  const Pair uv = block.coordinates[sample];
  const Pair at = uv * cells.extents[0];
  const Pair cell = floor_pair(at);
  std::array<std::array<int, 2>, 3> corners;
  for (int finer = 0; finer < cells.available; ++finer) {
    const Pair corner = cells.corner(finer, uv, cell, at - cell);
    corners[finer] = {static_cast<int>(corner[0]), static_cast<int>(corner[1])};
  }
  const TexelOffset* const offsets = cells.unfolded + tile * plan.padded_texels();
  TexelList list;
  for (int i = 0; i < plan.shape().texels; ++i) {
    const auto& [finer, x, y] = offsets[i];
    list.texels[i] =
        pyramid.texel(cell_level - finer, corners[finer][0] + x, corners[finer][1] + y);
  }
  return list;
}

template <typename Value, int kTexels, int kDegree>
void sum_block(const TexelPlan& plan, const WrappedPyramid& pyramid, const SampleBlock& block,
               const CellPlaces& places, const Sides& sides, float* result) {
  const BlockSums<Value, kTexels, kDegree> sums{plan, pyramid.pyramid.channels, block, places,
                                                result};
  if (plan.bytes() > kCachedBytes) {
    sums.template sum_inside<true>(sides.inside);
  } else {
    sums.template sum_inside<false>(sides.inside);
  }
  for (int k = 0; k < sides.outside.count; ++k) {
    const int sample = sides.outside.numbers[k];
    sums.sum(sample, wrapped_texels(plan, pyramid, block, places.tiles[sample], sample));
  }
}

template <typename Value>
auto block_function(const TableShape& shape) {
  if (shape.degree == 2) return &sum_block<Value, 0, 2>;
  switch (shape.texels) {
    case 4:
      return &sum_block<Value, 4, 1>;
    case 6:
      return &sum_block<Value, 6, 1>;
    case 8:
      return &sum_block<Value, 8, 1>;
    default:
      return &sum_block<Value, 0, 1>;
  }
}

}  // namespace

void sample_block(const TexelPlan& plan, const WrappedPyramid& pyramid, const SampleBlock& block,
                  float* result) {
  CellPlaces places;
  Sides sides;
  find_cells(plan, block, places, sides);
  find_subdomains(plan, block, places);
  const auto sum = pyramid.pyramid.bytes ? block_function<std::uint8_t>(plan.shape())
                                         : block_function<float>(plan.shape());
  sum(plan, pyramid, block, places, sides, result);
}

}  // namespace prefilter
