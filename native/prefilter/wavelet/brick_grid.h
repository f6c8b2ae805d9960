// SPDX-License-Identifier: GPL-3.0-or-later

// Sparse grids for functions that are nonzero only near a surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace prefilter {

/// Coordinates b of a brick, which contains the 4 x 4 x 4 points 4 b to 4 b + 3 along each axis.
using BrickPosition = std::array<std::int32_t, 3>;

/// kChannels values per point. Bricks are divided into shards by z; different threads may modify
/// different shards.
template <std::size_t kChannels>
class BrickGrid {
 public:
  static constexpr std::size_t kPoints = 64;
  /// [channel][z][y][x]
  using Brick = std::array<float, kChannels * kPoints>;

  /// Shards are 2^shard_bits bricks high; points are from -2^7 to 2^depth + 2^7.
  BrickGrid(int depth, int shard_bits)
      : shard_bits_(shard_bits),
        shards_(static_cast<std::size_t>((1 << depth >> 2 >> shard_bits) + 3)) {}

  static std::uint64_t key(const BrickPosition& b) {
    constexpr std::int32_t kOffset = 64;
    std::uint64_t code = 0;
    for (std::size_t a = 3; a-- > 0;) {
      code = code << 20U | static_cast<std::uint64_t>(b[a] + kOffset);
    }
    return code;
  }
  static BrickPosition position(std::uint64_t key) {
    constexpr std::uint64_t kMask = (1U << 20U) - 1;
    return {static_cast<std::int32_t>(key & kMask) - 64,
            static_cast<std::int32_t>(key >> 20U & kMask) - 64,
            static_cast<std::int32_t>(key >> 40U) - 64};
  }

  const Brick* find(const BrickPosition& b) const {
    const Shard& shard = shards_[shard_of_z(b[2])];
    const auto found = shard.places.find(key(b));
    return found == shard.places.end() ? nullptr : &shard.bricks[found->second];
  }
  Brick& make(const BrickPosition& b) {
    Shard& shard = shards_[shard_of_z(b[2])];
    const auto [found, is_new] =
        shard.places.emplace(key(b), static_cast<std::uint32_t>(shard.bricks.size()));
    if (is_new) {
      shard.bricks.emplace_back();
      shard.keys.push_back(key(b));
    }
    return shard.bricks[found->second];
  }

  /// The positions of all bricks, in an order independent of insertion.
  std::vector<BrickPosition> positions() const {
    std::vector<std::uint64_t> keys;
    for (const Shard& shard : shards_) {
      keys.insert(keys.end(), shard.keys.begin(), shard.keys.end());
    }
    std::sort(keys.begin(), keys.end());
    std::vector<BrickPosition> result;
    result.reserve(keys.size());
    for (const std::uint64_t k : keys) result.push_back(position(k));
    return result;
  }

  /// Copies a cube of kSide points along each axis, starting at `low`, for all channels; zero where
  /// no brick is.
  template <std::size_t kSide>
  void window(const BrickPosition& low,
              std::array<float, kChannels * kSide * kSide * kSide>* values) const {
    values->fill(0.0F);
    const auto side = static_cast<std::int32_t>(kSide);
    const auto first = [](std::int32_t p) { return p >> 2; };
    for (std::int32_t bz = first(low[2]); bz <= first(low[2] + side - 1); ++bz) {
      for (std::int32_t by = first(low[1]); by <= first(low[1] + side - 1); ++by) {
        for (std::int32_t bx = first(low[0]); bx <= first(low[0] + side - 1); ++bx) {
          const Brick* brick = find({bx, by, bz});
          if (brick != nullptr) copy<kSide>(*brick, {bx, by, bz}, low, values);
        }
      }
    }
  }

 private:
  struct Shard {
    std::unordered_map<std::uint64_t, std::uint32_t> places;
    std::deque<Brick> bricks;  // references remain valid
    std::vector<std::uint64_t> keys;
  };

  // Bricks outside the root belong to the outermost shards.
  std::size_t shard_of_z(std::int32_t z) const {
    const std::int32_t last = static_cast<std::int32_t>(shards_.size()) - 1;
    return static_cast<std::size_t>(std::clamp((z >> shard_bits_) + 1, 0, last));
  }

  template <std::size_t kSide>
  static void copy(const Brick& brick, const BrickPosition& at, const BrickPosition& low,
                   std::array<float, kChannels * kSide * kSide * kSide>* values) {
    std::array<std::int32_t, 3> begin;
    std::array<std::int32_t, 3> end;
    for (std::size_t a = 0; a < 3; ++a) {
      begin[a] = std::max(0, low[a] - 4 * at[a]);
      end[a] = std::min(4, low[a] + static_cast<std::int32_t>(kSide) - 4 * at[a]);
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      for (std::int32_t z = begin[2]; z < end[2]; ++z) {
        for (std::int32_t y = begin[1]; y < end[1]; ++y) {
          const auto row = ((c * kSide + static_cast<std::size_t>(4 * at[2] + z - low[2])) * kSide +
                            static_cast<std::size_t>(4 * at[1] + y - low[1])) *
                               kSide +
                           static_cast<std::size_t>(4 * at[0] + begin[0] - low[0]);
          const auto from = c * kPoints + static_cast<std::size_t>((z * 4 + y) * 4 + begin[0]);
          std::copy_n(brick.begin() + static_cast<std::ptrdiff_t>(from), end[0] - begin[0],
                      values->begin() + static_cast<std::ptrdiff_t>(row));
        }
      }
    }
  }

  int shard_bits_;
  std::vector<Shard> shards_;
};

}  // namespace prefilter
