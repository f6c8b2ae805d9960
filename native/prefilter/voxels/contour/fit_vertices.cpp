// SPDX-License-Identifier: GPL-3.0-or-later

// Reads the tree in bricks of cells of one depth, as dense arrays with a margin, so that neighbors
// are found by adding strides.
#include "prefilter/voxels/contour/fit_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/height_crossing.h"

namespace prefilter {
namespace {

constexpr int kBrickDepth = 4;
constexpr int kMargin = kHeightReach;
constexpr std::int64_t kBricksPerTask = 64;
// Columns with an edge or a thin part do not sum to a height. There the crossing differs by more
// than this, in cells, from the crossing of the two cells alone, which is accurate to 0.03 on
// planes; on smooth surfaces the difference may be larger.
constexpr double kMostApart = 0.1;

// The leaves of one depth below one cell.
struct Brick {
  CellNode cell;       // in cells of its depth
  CellCoordinates at;  // in cells of its depth
  int depth;           // depth of the leaves
};

// A block with leaves to process.
struct LeafBlock {
  std::size_t block;
  CellCoordinates at;  // of its cell
};

// A brick as a dense array, with a margin.
class BrickWindow {
 public:
  explicit BrickWindow(const ContourTree& tree) : tree_(tree) {}

  // Calls visit(block) for the blocks of the brick that is_wanted(level, block) selects, with the
  // window around them filled.
  template <typename IsWanted, typename Visit>
  void for_blocks_of(const Brick& brick, const IsWanted& is_wanted, const Visit& visit) {
    blocks_.clear();
    find_blocks(brick.cell, brick.at, brick.depth, is_wanted);
    if (blocks_.empty()) return;
    const int shift = brick.depth - brick.cell.depth;
    width_ = (1 << shift) + 2 * kMargin;
    for (int a = 0; a < 3; ++a) low_[a] = (brick.at[a] << shift) - kMargin;
    values_.assign(static_cast<std::size_t>(width_) * width_ * width_, 0.0F);
    fill(tree_.root(), {0, 0, 0}, brick.depth);
    for (const LeafBlock& block : blocks_) visit(block);
  }

  const float* cell(const CellCoordinates& at) const { return values_.data() + offset_of(at); }
  std::array<std::ptrdiff_t, 3> strides() const {
    return {static_cast<std::ptrdiff_t>(width_) * width_, width_, 1};
  }

 private:
  template <typename IsWanted>
  void find_blocks(const CellNode& cell, const CellCoordinates& at, int depth,
                   const IsWanted& is_wanted) {
    if (cell.depth + 1 == depth) {
      if (is_wanted(static_cast<std::size_t>(cell.depth), cell.octants)) {
        blocks_.push_back({cell.octants, at});
      }
      return;
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree_.octant(cell, o);
      if (octant.is_split) find_blocks(octant, octant_at(at, o), depth, is_wanted);
    }
  }

  std::ptrdiff_t offset_of(const CellCoordinates& at) const {
    return (static_cast<std::ptrdiff_t>(at[0] - low_[0]) * width_ + (at[1] - low_[1])) * width_ +
           (at[2] - low_[2]);
  }

  // Writes the part of a cell that is inside the window.
  void fill(const CellNode& cell, const CellCoordinates& at, int depth) {
    const int shift = depth - cell.depth;
    CellCoordinates low;
    CellCoordinates high;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::max(at[a] << shift, low_[a]);
      high[a] = std::min((at[a] + 1) << shift, low_[a] + width_);
      if (low[a] >= high[a]) return;
    }
    if (cell.is_split && shift > 0) {
      for (int o = 0; o < 8; ++o) fill(tree_.octant(cell, o), octant_at(at, o), depth);
      return;
    }
    const float value = tree_.value(cell);
    if (value == 0.0F) return;
    if (shift == 0) {
      values_[static_cast<std::size_t>(offset_of(at))] = value;
      return;
    }
    for (std::int32_t x = low[0]; x < high[0]; ++x) {
      for (std::int32_t y = low[1]; y < high[1]; ++y) {
        std::fill_n(values_.begin() + offset_of({x, y, low[2]}), high[2] - low[2], value);
      }
    }
  }

  const ContourTree& tree_;
  std::vector<LeafBlock> blocks_;
  // Cells of the brick and a margin of kMargin, starting at low_.
  CellCoordinates low_{};
  int width_ = 0;
  std::vector<float> values_;
};

void find_bricks(const ContourTree& tree, const CellNode& cell, const CellCoordinates& at,
                 std::vector<Brick>* bricks) {
  if (!cell.is_split) return;
  const int depth = tree.cells().depth();
  if (cell.depth == 0) {
    for (int d = 1; d <= std::min(kBrickDepth, depth); ++d) bricks->push_back({cell, at, d});
  } else if (cell.depth + kBrickDepth <= depth) {
    bricks->push_back({cell, at, cell.depth + kBrickDepth});
  } else {
    return;
  }
  for (int o = 0; o < 8; ++o) {
    find_bricks(tree, tree.octant(cell, o), octant_at(at, o), bricks);
  }
}

// Calls visit(brick, window) for all bricks; each window is used for one brick at a time.
template <typename Visit>
void for_bricks(const ContourTree& tree, const Run& run, const Visit& visit) {
  std::vector<Brick> bricks;
  find_bricks(tree, tree.root(), {0, 0, 0}, &bricks);
  parallel_ranges(static_cast<std::int64_t>(bricks.size()), kBricksPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    BrickWindow window(tree);
                    for (std::int64_t i = begin; i < end; ++i) {
                      visit(bricks[static_cast<std::size_t>(i)], &window);
                    }
                  });
}
}  // namespace

void settle_sides(const Run& run, ContourTree* tree) {
  const std::vector<TreeLevel>& levels = tree->cells().levels;
  const auto is_doubtful = [&](std::size_t level, std::size_t block, int o) {
    return std::abs(levels[level].blocks[block][static_cast<std::size_t>(o)] - 0.5F) < kDoubt &&
           !levels[level].is_split(block, o);
  };
  const auto has_doubtful = [&](std::size_t level, std::size_t block) {
    for (int o = 0; o < 8; ++o) {
      if (is_doubtful(level, block, o)) return true;
    }
    return false;
  };
  const Stages stages(run, {19, 1});
  for_bricks(*tree, stages[0], [&](const Brick& brick, BrickWindow* window) {
    const auto level = static_cast<std::size_t>(brick.depth - 1);
    window->for_blocks_of(brick, has_doubtful, [&](const LeafBlock& block) {
      for (int o = 0; o < 8; ++o) {
        if (!is_doubtful(level, block.block, o)) continue;
        const std::optional<float> height =
            height_over_center(window->cell(octant_at(block.at, o)), window->strides());
        if (height) tree->set_side(level, block.block, o, *height >= 0.0F ? kInside : kOutside);
      }
    });
  });
  tree->update_sides(stages[1]);
}

void fit_vertices(const ContourTree& tree, const RootFrame& frame, const Run& run,
                  SurfaceVertices* vertices) {
  const auto has_vertices = [&](std::size_t level, std::size_t block) {
    return vertices->cuts(level, block) != 0;
  };
  for_bricks(tree, run, [&](const Brick& brick, BrickWindow* window) {
    const auto level = static_cast<std::size_t>(brick.depth - 1);
    window->for_blocks_of(brick, has_vertices, [&](const LeafBlock& block) {
      std::size_t vertex = vertices->first(level, block.block);
      for (std::uint64_t cuts = vertices->cuts(level, block.block); cuts != 0; cuts &= cuts - 1) {
        const int bit = std::countr_zero(cuts);
        const int face = bit % 6;
        const CellCoordinates at = octant_at(block.at, bit / 6);
        const std::optional<float> t = height_crossing(window->cell(at), window->strides(), face);
        if (t) {
          const int axis = face / 2;
          Vector3 position = vertices->positions()[vertex];
          const double fitted =
              frame.crossing(face, at[axis] + 0.5, static_cast<double>(*t), 1.0, brick.depth);
          const bool is_near =
              std::abs(fitted - position[axis]) <= kMostApart * frame.cell(axis, brick.depth);
          position[axis] = fitted;
          if (is_near || is_smooth_at(window->cell(at), window->strides(), face)) {
            vertices->move(vertex, position);
          }
        }
        ++vertex;
      }
    });
  });
}

}  // namespace prefilter
