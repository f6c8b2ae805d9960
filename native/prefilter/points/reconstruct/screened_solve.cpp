// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/screened_solve.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace prefilter {
namespace {

// Weight of the samples against the differences, per squared cell side of surface in a cell.
constexpr float kScreening = 2.0F;
// Conjugate gradient iterations per depth; the initial values are nearly right.
constexpr int kSolveIterations = 8;

constexpr std::int32_t kNoBlock = -1;

// The cell or leaf beyond a face of a block.
struct BlockSide {
  std::int32_t block = kNoBlock;  // block of the same depth; kNoBlock: outside; less: a leaf
  float value = 0.0F;             // value of the leaf

  // A larger leaf that contains no surface.
  static BlockSide leaf(int depth, float value) { return {kNoBlock - 1 - depth, value}; }
  bool is_leaf() const { return block < kNoBlock; }
  int depth() const { return kNoBlock - 1 - block; }
};

using BlockSides = std::array<BlockSide, 6>;  // per face: low and high along each axis

// Condition at a sample: weight * (sum of shares * values - target)^2.
struct Screen {
  std::array<std::uint32_t, 4> cells;
  std::array<float, 4> shares;
  float weight;
};

// The linear system for the octants of all blocks of a level.
class LevelSystem {
 public:
  LevelSystem(const TreeLevel& level, const std::vector<BlockSource>& sources,
              const std::vector<BlockSides>& neighbors, int depth, float target)
      : sources_(sources), neighbors_(neighbors), depth_(depth), target_(target) {
    const std::size_t count = 8 * level.size();
    right_.resize(count);
    diagonal_.resize(count);
    leaf_weight_.resize(count);
    screens_.reserve(count_samples());
    for (std::size_t b = 0; b < level.size(); ++b) {
      for (int o = 0; o < 8; ++o) add_faces(b, o);
    }
    for (std::size_t b = 0; b < level.size(); ++b) {
      for (int o = 0; o < 8; ++o) add_screen(b, o);
    }
  }

  // Runs conjugate gradient iterations with diagonal preconditioning; call once.
  void improve(int steps, std::vector<OctantValues>* blocks) {
    const std::size_t count = right_.size();
    if (count == 0) return;
    float* const values = blocks->data()->data();
    std::vector<float> image(count);
    apply(values, image.data());
    std::vector<float>& residual = right_;
    for (std::size_t i = 0; i < count; ++i) residual[i] -= image[i];
    std::vector<float> direction(count);
    double before = 0.0;
    for (int step = 0; step < steps; ++step) {
      double now = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        now += static_cast<double>(residual[i]) * static_cast<double>(residual[i] / diagonal_[i]);
      }
      if (!(now > 0.0)) return;
      const auto share = static_cast<float>(step == 0 ? 0.0 : now / before);
      for (std::size_t i = 0; i < count; ++i) {
        direction[i] = residual[i] / diagonal_[i] + share * direction[i];
      }
      apply(direction.data(), image.data());
      double curvature = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        curvature += static_cast<double>(direction[i]) * static_cast<double>(image[i]);
      }
      if (!(curvature > 0.0)) return;
      const auto length = static_cast<float>(now / curvature);
      for (std::size_t i = 0; i < count; ++i) {
        values[i] += length * direction[i];
        residual[i] -= length * image[i];
      }
      before = now;
    }
  }

 private:
  const OctantFlux* flux(std::size_t block, int octant) const {
    const BlockSource& source = sources_[block];
    return source.level->flux(source.block, octant);
  }

  std::size_t count_samples() const {
    std::size_t count = 0;
    for (std::size_t b = 0; b < sources_.size(); ++b) {
      for (int o = 0; o < 8; ++o) {
        const OctantFlux* own = flux(b, o);
        if (own != nullptr && own->sampled.area > 0.0F) ++count;
      }
    }
    return count;
  }

  // The octant beyond a face of an octant; below 0: none.
  std::int32_t neighbor(std::size_t block, int octant, int face) const {
    const int bit = 1 << (face / 2);
    const bool is_within = ((octant & bit) != 0) != ((face & 1) != 0);
    const std::int32_t next = is_within ? static_cast<std::int32_t>(block)
                                        : neighbors_[block][static_cast<std::size_t>(face)].block;
    return next < 0 ? kNoBlock : 8 * next + (octant ^ bit);
  }

  void add_faces(std::size_t block, int octant) {
    const std::size_t cell = 8 * block + static_cast<std::size_t>(octant);
    const OctantFlux* own = flux(block, octant);
    float diagonal = 0.0F;
    float right = 0.0F;
    for (int face = 0; face < 6; ++face) {
      const auto axis = static_cast<std::size_t>(face / 2);
      const int bit = 1 << axis;
      const bool is_high = (face & 1) != 0;
      std::size_t next_block = block;
      const bool is_within = ((octant & bit) != 0) != is_high;
      const BlockSide& side = neighbors_[block][static_cast<std::size_t>(face)];
      if (!is_within && side.block >= 0) next_block = static_cast<std::size_t>(side.block);
      // Decrease of the function toward the face, from the cell's own samples.
      float fall = 0.0F;
      if (own != nullptr) {
        fall = is_high ? own->moment[axis] : own->moment[axis] - own->area[axis];
      }
      if (is_within || side.block >= 0) {
        const OctantFlux* other = flux(next_block, octant ^ bit);
        if (other != nullptr) {
          fall += is_high ? other->area[axis] - other->moment[axis] : -other->moment[axis];
        }
        diagonal += 1.0F;
        right += fall;
      } else if (side.is_leaf()) {
        const float weight = 2.0F / (1.0F + static_cast<float>(1 << (depth_ - side.depth())));
        diagonal += weight;
        right += weight * (side.value + fall);
      }
    }
    diagonal_[cell] = std::max(diagonal, 1e-6F);
    leaf_weight_[cell] = diagonal;
    right_[cell] = right;
  }

  void add_screen(std::size_t block, int octant) {
    const OctantFlux* own = flux(block, octant);
    if (own == nullptr || !(own->sampled.area > 0.0F)) return;
    const std::size_t cell = 8 * block + static_cast<std::size_t>(octant);
    Screen screen;
    screen.cells.fill(static_cast<std::uint32_t>(cell));
    screen.shares = {1.0F, 0.0F, 0.0F, 0.0F};
    float squared = 0.0F;
    for (std::size_t a = 0; a < 3; ++a) {
      squared += own->area[a] * own->area[a];
      const float off = own->sampled.moment[a] / own->sampled.area - 0.5F;
      const int face = 2 * static_cast<int>(a) + (off > 0.0F ? 1 : 0);
      const std::int32_t next = neighbor(block, octant, face);
      if (next < 0) continue;
      screen.cells[a + 1] = static_cast<std::uint32_t>(next);
      screen.shares[a + 1] = std::abs(off);
      screen.shares[0] -= std::abs(off);
    }
    // Where normals cancel each other, the mean sample lies on no surface.
    const float coherence = squared / (own->sampled.area * own->sampled.area);
    screen.weight = kScreening * own->sampled.area * std::min(coherence, 1.0F);
    for (std::size_t i = 0; i < 4; ++i) {
      diagonal_[screen.cells[i]] += screen.weight * screen.shares[i] * screen.shares[i];
      right_[screen.cells[i]] += screen.weight * screen.shares[i] * target_;
    }
    screens_.push_back(screen);
  }

  void apply(const float* values, float* image) const {
    static constexpr OctantValues kNothing{};
    for (std::size_t b = 0; b < neighbors_.size(); ++b) {
      const float* const own = values + 8 * b;
      std::array<const float*, 6> beyond;
      for (std::size_t face = 0; face < 6; ++face) {
        const std::int32_t next = neighbors_[b][face].block;
        beyond[face] = next < 0 ? kNothing.data() : values + 8 * static_cast<std::size_t>(next);
      }
      for (std::size_t o = 0; o < 8; ++o) {
        float sum = leaf_weight_[8 * b + o] * own[o];
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t bit = std::size_t{1} << a;
          const bool is_high = (o & bit) != 0;
          sum -= (is_high ? own : beyond[2 * a])[o ^ bit];
          sum -= (is_high ? beyond[2 * a + 1] : own)[o ^ bit];
        }
        image[8 * b + o] = sum;
      }
    }
    for (const Screen& screen : screens_) {
      float at_samples = 0.0F;
      for (std::size_t i = 0; i < 4; ++i) at_samples += screen.shares[i] * values[screen.cells[i]];
      at_samples *= screen.weight;
      for (std::size_t i = 0; i < 4; ++i) {
        image[screen.cells[i]] += screen.shares[i] * at_samples;
      }
    }
  }

  const std::vector<BlockSource>& sources_;
  const std::vector<BlockSides>& neighbors_;
  int depth_;
  float target_;
  std::vector<float> right_;  // becomes the residual
  std::vector<float> diagonal_;
  std::vector<float> leaf_weight_;  // from faces alone
  std::vector<Screen> screens_;
};

// The neighbors of the next level's blocks; `depth` is that of the present octants.
std::vector<BlockSides> neighbors_of_next_level(const TreeLevel& level,
                                                const std::vector<BlockSource>& sources,
                                                const std::vector<BlockSides>& neighbors,
                                                int depth) {
  std::vector<BlockSides> result;
  std::size_t count = 0;
  for (const std::uint8_t split : level.split)
    count += static_cast<std::size_t>(std::popcount(split));
  result.reserve(count);
  for (std::size_t b = 0; b < level.size(); ++b) {
    for (int o = 0; o < 8; ++o) {
      if (!level.is_split(b, o)) continue;
      BlockSides next;
      for (int face = 0; face < 6; ++face) {
        const int bit = 1 << (face / 2);
        const bool is_within = ((o & bit) != 0) != ((face & 1) != 0);
        const BlockSide& side = neighbors[b][static_cast<std::size_t>(face)];
        BlockSide& next_side = next[static_cast<std::size_t>(face)];
        if (!is_within && side.block < 0) {
          next_side = side;
          continue;
        }
        const std::size_t other = is_within ? b : static_cast<std::size_t>(side.block);
        if (level.is_split(other, o ^ bit)) {
          next_side.block = static_cast<std::int32_t>(level.child(other, o ^ bit));
        } else if (sources[other].level->flux(sources[other].block, o ^ bit) == nullptr) {
          // Leaves that the surface crosses are ignored: their mean differs from the value at the
          // face.
          next_side =
              BlockSide::leaf(depth, level.blocks[other][static_cast<std::size_t>(o ^ bit)]);
        }
      }
      result.push_back(next);
    }
  }
  return result;
}

}  // namespace

void solve_screened(const BlockSources& sources, int first, float target, CellTree* tree) {
  std::vector<BlockSides> neighbors(1);
  std::vector<float> changes;  // changes of the parent cells by the previous solve
  for (std::size_t k = 0; k < tree->levels.size(); ++k) {
    TreeLevel& level = tree->levels[k];
    const int depth = static_cast<int>(k) + 1;
    std::vector<float> next_changes;
    const auto for_split = [&](const auto& visit) {
      for (std::size_t b = 0; b < level.size(); ++b) {
        for (int o = 0; o < 8; ++o) {
          if (level.is_split(b, o)) visit(level.blocks[b][static_cast<std::size_t>(o)]);
        }
      }
    };
    for_split([&](float value) { next_changes.push_back(value); });
    if (static_cast<int>(k) >= first) {
      for (std::size_t b = 0; b < level.size() && !changes.empty(); ++b) {
        for (float& value : level.blocks[b]) value += changes[b];
      }
      LevelSystem(level, sources[k], neighbors, depth, target)
          .improve(kSolveIterations, &level.blocks);
    }
    std::size_t next = 0;
    for_split([&](float value) {
      next_changes[next] = value - next_changes[next];
      ++next;
    });
    if (k + 1 == tree->levels.size()) break;
    changes = std::move(next_changes);
    neighbors = neighbors_of_next_level(level, sources[k], neighbors, depth);
  }
}

}  // namespace prefilter
