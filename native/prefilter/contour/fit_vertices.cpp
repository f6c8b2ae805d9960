// The tree is read in bricks of cells of one depth, made dense with what is around them, so that
// neighbours are found by adding strides.
#include "prefilter/contour/fit_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/contour/height_crossing.h"

namespace prefilter {
namespace {

constexpr int kBrickDepth = 4;
constexpr int kMargin = kHeightReach;
constexpr std::size_t kBricksPerTask = 64;

using CellCoordinates = std::array<std::int32_t, 3>;

// Vertices of one depth below one cell.
struct Brick {
  CellNode cell;
  CellCoordinates at;  // in cells of its depth
  int depth;           // of the leaves
};

// A block of leaves with vertices.
struct LeafBlock {
  std::size_t block;
  CellCoordinates at;  // of its cell
};

class BrickFitter {
 public:
  BrickFitter(const ContourTree& tree, const RootFrame& frame, SurfaceVertices* vertices)
      : tree_(tree), frame_(frame), vertices_(*vertices) {}

  void fit(const Brick& brick) {
    blocks_.clear();
    find_blocks(brick.cell, brick.at, brick.depth);
    if (blocks_.empty()) return;
    const int shift = brick.depth - brick.cell.depth;
    width_ = (1 << shift) + 2 * kMargin;
    for (int a = 0; a < 3; ++a) low_[a] = (brick.at[a] << shift) - kMargin;
    values_.assign(static_cast<std::size_t>(width_) * width_ * width_, 0.0F);
    fill(tree_.root(), {0, 0, 0}, brick.depth);
    for (const LeafBlock& block : blocks_) fit_block(block, brick.depth);
  }

 private:
  static CellCoordinates octant_at(const CellCoordinates& at, int o) {
    return {2 * at[0] + (o & 1), 2 * at[1] + ((o >> 1) & 1), 2 * at[2] + ((o >> 2) & 1)};
  }

  void find_blocks(const CellNode& cell, const CellCoordinates& at, int depth) {
    if (cell.depth + 1 == depth) {
      if (vertices_.cuts(static_cast<std::size_t>(cell.depth), cell.octants) != 0) {
        blocks_.push_back({cell.octants, at});
      }
      return;
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree_.octant(cell, o);
      if (octant.is_split) find_blocks(octant, octant_at(at, o), depth);
    }
  }

  std::ptrdiff_t offset_of(const CellCoordinates& at) const {
    return (static_cast<std::ptrdiff_t>(at[0] - low_[0]) * width_ + (at[1] - low_[1])) * width_ +
           (at[2] - low_[2]);
  }

  // Writes the part of a cell that is within the window.
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
    for (std::int32_t x = low[0]; x < high[0]; ++x) {
      for (std::int32_t y = low[1]; y < high[1]; ++y) {
        std::fill_n(values_.begin() + offset_of({x, y, low[2]}), high[2] - low[2], value);
      }
    }
  }

  void fit_block(const LeafBlock& block, int depth) {
    const auto level = static_cast<std::size_t>(depth - 1);
    const std::array<std::ptrdiff_t, 3> strides = {static_cast<std::ptrdiff_t>(width_) * width_,
                                                   width_, 1};
    std::size_t vertex = vertices_.first(level, block.block);
    for (std::uint64_t cuts = vertices_.cuts(level, block.block); cuts != 0; cuts &= cuts - 1) {
      const int bit = std::countr_zero(cuts);
      const int face = bit % 6;
      const CellCoordinates at = octant_at(block.at, bit / 6);
      const std::optional<float> t = height_crossing(values_.data() + offset_of(at), strides, face);
      if (t) move(vertex, at, depth, face, *t);
      ++vertex;
    }
  }

  void move(std::size_t vertex, const CellCoordinates& at, int depth, int face, float t) {
    std::array<float, 3> position = vertices_.positions()[vertex];
    position[face / 2] =
        frame_.crossing(face, at[face / 2] + 0.5, static_cast<double>(t), 1.0, depth);
    vertices_.move(vertex, position);
  }

  const ContourTree& tree_;
  const RootFrame& frame_;
  SurfaceVertices& vertices_;
  std::vector<LeafBlock> blocks_;
  // Cells of the brick and kMargin around it, from low_ on.
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
    find_bricks(tree, tree.octant(cell, o),
                {2 * at[0] + (o & 1), 2 * at[1] + ((o >> 1) & 1), 2 * at[2] + ((o >> 2) & 1)},
                bricks);
  }
}
}  // namespace

void fit_vertices(const ContourTree& tree, const RootFrame& frame, const Progress& progress,
                  int threads, SurfaceVertices* vertices) {
  std::vector<Brick> bricks;
  find_bricks(tree, tree.root(), {0, 0, 0}, &bricks);
  const std::size_t tasks = (bricks.size() + kBricksPerTask - 1) / kBricksPerTask;
  parallel_for(static_cast<std::int64_t>(tasks), threads, progress, [&](std::int64_t task) {
    BrickFitter fitter(tree, frame, vertices);
    const std::size_t begin = static_cast<std::size_t>(task) * kBricksPerTask;
    const std::size_t end = std::min(bricks.size(), begin + kBricksPerTask);
    for (std::size_t i = begin; i < end; ++i) fitter.fit(bricks[i]);
  });
}

}  // namespace prefilter
