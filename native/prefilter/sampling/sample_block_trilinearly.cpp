#include <algorithm>
#include <cstddef>
#include <cstring>

#include "prefilter/sampling/sample_block.h"
#include "prefilter/sampling/texel_sums.h"

namespace prefilter {
namespace {

/// The four texels of a level that a sample lies between.
struct Square {
  std::uintptr_t corner;  // the one that is lowest along x and y
  std::uintptr_t row;     // how far the next row is [bytes]
  float x;                // shares of the other ones along x and y
  float y;
};

/// Those of a sample; the coarser level's first. Where it magnifies both are those of level 0.
struct Squares {
  std::array<Square, 2> of_level;
};

/// Whether all texels are inside of the level.
inline bool find_square(const Pyramid& pyramid, int level, Pair uv, Square& square) {
  const PyramidLevel& texels = pyramid.levels[level];
  const Pair size{static_cast<double>(texels.width), static_cast<double>(texels.height)};
  const auto texel_size = static_cast<double>(pyramid.texel_size());
  const Pair at = uv * size - 0.5;
  const Pair low = floor_pair(at);
  const Pair share = at - low;
  square.row = pyramid.texel_size() * static_cast<std::size_t>(texels.width);
  square.corner = reinterpret_cast<std::uintptr_t>(texels.texels) +
                  distance(low, Pair{texel_size, texel_size * size[0]});
  square.x = static_cast<float>(share[0]);
  square.y = static_cast<float>(share[1]);
  return is_between(Pair{}, low, size - 2.0);
}

template <typename Value>
struct FourChannels {
  static constexpr std::size_t kPitch = 4 * sizeof(Value);

  static Lanes texel(std::uintptr_t address) {
    return load_lanes(reinterpret_cast<const Value*>(address));
  }
  static Lanes mix(Lanes a, Lanes b, float share) { return a + all_lanes(share) * (b - a); }
  static Lanes bilinear(const Square& square) {
    const std::uintptr_t next = square.corner + square.row;
    return mix(mix(texel(square.corner), texel(square.corner + kPitch), square.x),
               mix(texel(next), texel(next + kPitch), square.x), square.y);
  }
};

inline float mix(float a, float b, float share) { return a + share * (b - a); }

template <typename Value>
inline float bilinear(const Square& square, int channel, int channels) {
  const auto texel = [&](std::uintptr_t row, int x) {
    return static_cast<float>(reinterpret_cast<const Value*>(row)[x * channels + channel]);
  };
  const std::uintptr_t next = square.corner + square.row;
  return mix(mix(texel(square.corner, 0), texel(square.corner, 1), square.x),
             mix(texel(next, 0), texel(next, 1), square.x), square.y);
}

template <typename Value>
void mix_levels(int channels, const SampleBlock& block, const Squares* squares,
                const SampleList& inside, float* result) {
  constexpr float kUnit = sizeof(Value) == 1 ? 1.0F / 255.0F : 1.0F;
  for (int k = 0; k < inside.count; ++k) {
    const int i = inside.numbers[k];
    const auto& [coarse, fine] = squares[i].of_level;
    const bool magnifies = block.cell_levels[i] == 0;
    float* const values = result + static_cast<std::ptrdiff_t>(i) * channels;
    if (channels == 4) {
      using Four = FourChannels<Value>;
      Lanes value = Four::bilinear(fine);
      if (!magnifies) value = Four::mix(value, Four::bilinear(coarse), block.f[i]);
      value *= kUnit;
      std::memcpy(values, &value, sizeof value);
    } else {
      for (int c = 0; c < channels; ++c) {
        float value = bilinear<Value>(fine, c, channels);
        if (!magnifies) value = mix(value, bilinear<Value>(coarse, c, channels), block.f[i]);
        values[c] = value * kUnit;
      }
    }
  }
}

}  // namespace

void sample_block_trilinearly(const Pyramid& pyramid, const SampleBlock& block, float* result,
                              SampleList& others) {
  std::array<Squares, kBlockSamples> squares;
  SampleList inside;
  others.count = 0;
  for (int i = 0; i < block.count; ++i) {
    const int level = block.cell_levels[i];
    auto& [coarse, fine] = squares[i].of_level;
    bool is_inside = find_square(pyramid, level, block.coordinates[i], coarse);
    is_inside &= find_square(pyramid, std::max(level - 1, 0), block.coordinates[i], fine);
    inside.add(i, is_inside);
    others.add(i, !is_inside);
  }
  if (pyramid.bytes) {
    mix_levels<std::uint8_t>(pyramid.channels, block, squares.data(), inside, result);
  } else {
    mix_levels<float>(pyramid.channels, block, squares.data(), inside, result);
  }
}

}  // namespace prefilter
