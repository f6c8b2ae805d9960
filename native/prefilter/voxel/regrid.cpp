#include "prefilter/voxel/regrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/voxel/queries.h"

namespace prefilter {
namespace {

struct ValueSpan {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  void add(float value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool is_constant() const { return low >= high; }
};

Box octant_of(const Box& box, int octant) {
  Box half = box;
  for (int a = 0; a < 3; ++a) {
    const double middle = (box.low[a] + box.high[a]) / 2.0;
    (((octant >> a) & 1) != 0 ? half.low[a] : half.high[a]) = middle;
  }
  return half;
}

// Cells that overlap by less than this share of their size only touch: lattices that agree but for
// rounding are the same.
constexpr double kTouching = 1e-9;

bool overlaps(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    const double common = std::min(a.high[i], b.high[i]) - std::max(a.low[i], b.low[i]);
    if (common <= kTouching * std::min(a.size(i), b.size(i))) return false;
  }
  return true;
}

bool is_within(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    const double slack = kTouching * a.size(i);
    if (a.low[i] < b.low[i] - slack || a.high[i] > b.high[i] + slack) return false;
  }
  return true;
}

// Adds the values of leaves that overlap the box, until they differ.
void add_leaves(const CellTree& tree, std::size_t level, std::size_t block, const Box& cell,
                const Box& box, ValueSpan* span) {
  const TreeLevel& cells = tree.levels[level];
  for (int o = 0; o < 8; ++o) {
    const Box octant = octant_of(cell, o);
    if (!overlaps(octant, box)) continue;
    if (cells.is_split(block, o)) {
      add_leaves(tree, level + 1, cells.child(block, o), octant, box, span);
    } else {
      span->add(cells.blocks[block][o]);
    }
    if (!span->is_constant()) return;
  }
}

// A cell and the finest cells around it, which are 2^-shift as wide.
Box widened(const Box& cell, int shift) {
  Box box = cell;
  for (int a = 0; a < 3; ++a) {
    const double finest = std::ldexp(cell.size(a), -shift);
    box.low[a] -= finest;
    box.high[a] += finest;
  }
  return box;
}

class Regridder {
 public:
  Regridder(const Octree& source, int depth, const Progress& progress)
      : source_(source), depth_(depth), progress_(progress) {
    levels_.resize(static_cast<std::size_t>(depth));
  }

  // The value of a cell; `is_split` tells that its block went to the levels.
  float value_of(const Box& box, int at_depth, double share, bool* is_split) {
    *is_split = false;
    ValueSpan span;
    // A surface along the borders of cells leaves them uniform; they have to stay fine, as contours
    // between larger cells cut corners off.
    const Box around = at_depth < depth_ ? widened(box, depth_ - at_depth) : box;
    if (!is_within(around, source_.bounds)) span.add(0.0F);
    if (source_.cells.levels.empty()) {
      if (overlaps(source_.bounds, around)) span.add(source_.cells.root);
    } else {
      add_leaves(source_.cells, 0, 0, source_.bounds, around, &span);
    }
    if (span.is_constant()) {
      advance(share);
      return std::isfinite(span.low) ? span.low : 0.0F;
    }
    if (at_depth == depth_) {
      advance(share);
      return static_cast<float>(box_occupancy(source_, box));
    }
    *is_split = true;
    TreeLevel& level = levels_[static_cast<std::size_t>(at_depth)];
    const std::size_t block = level.size();
    level.blocks.emplace_back();
    level.split.push_back(0);
    for (int o = 0; o < 8; ++o) {
      bool octant_is_split = false;
      const float value = value_of(octant_of(box, o), at_depth + 1, share / 8.0, &octant_is_split);
      level.blocks[block][o] = value;
      if (octant_is_split) level.split[block] |= static_cast<std::uint8_t>(1U << o);
    }
    return block_mean(level.blocks[block]);
  }

  std::vector<TreeLevel> take_levels() {
    while (!levels_.empty() && levels_.back().size() == 0) levels_.pop_back();
    return std::move(levels_);
  }

 private:
  void advance(double share) {
    done_ += share;
    progress_.report(std::min(done_, 1.0));
  }

  const Octree& source_;
  int depth_;
  const Progress& progress_;
  double done_ = 0.0;
  std::vector<TreeLevel> levels_;
};

void add_occupied(const CellTree& tree, std::size_t level, std::size_t block, const Box& cell,
                  std::optional<Box>* box) {
  const TreeLevel& cells = tree.levels[level];
  for (int o = 0; o < 8; ++o) {
    const Box octant = octant_of(cell, o);
    if (*box && is_within(octant, **box)) continue;
    if (cells.is_split(block, o)) {
      add_occupied(tree, level + 1, cells.child(block, o), octant, box);
    } else if (cells.blocks[block][o] > 0.0F) {
      if (!*box) *box = octant;
      (*box)->include(octant);
    }
  }
}
}  // namespace

Octree regridded(const Octree& octree, const Box& bounds, int depth, const Progress& progress,
                 int threads) {
  const Progress finding = progress.part(0.0, 0.95);
  Regridder regridder(octree, depth, finding);
  Octree result;
  result.bounds = bounds;
  result.depth = depth;
  bool is_split = false;
  result.cells.root = regridder.value_of(bounds, 0, 1.0, &is_split);
  result.cells.levels = regridder.take_levels();
  for (TreeLevel& level : result.cells.levels) link_blocks(&level);
  update_means(&result.cells, progress.part(0.95, 1.0), threads);
  return result;
}

bool holds(const Box& bounds, const Box& box) { return is_within(box, bounds); }

Octree grown(Octree octree, const Box& box) {
  while (!holds(octree.bounds, box)) {
    if (octree.depth == kMaxTreeDepth) {
      throw_invalid(
          "other: what it holds, and cells of this octree's size, ask for a depth of more "
          "than " +
          std::to_string(kMaxTreeDepth));
    }
    // The old root becomes the octant that leaves room towards the box.
    int place = 0;
    Box bounds = octree.bounds;
    for (int a = 0; a < 3; ++a) {
      const double below = octree.bounds.low[a] - box.low[a];
      const double above = box.high[a] - octree.bounds.high[a];
      if (below > above) {
        place |= 1 << a;
        bounds.low[a] -= octree.bounds.size(a);
      } else {
        bounds.high[a] += octree.bounds.size(a);
      }
    }
    check_box(bounds, "other: bounds");
    TreeLevel top;
    top.blocks.emplace_back();
    top.blocks[0][static_cast<std::size_t>(place)] = octree.cells.root;
    top.split.push_back(octree.cells.levels.empty() ? std::uint8_t{0}
                                                    : static_cast<std::uint8_t>(1U << place));
    link_blocks(&top);
    octree.cells.root /= 8.0F;
    octree.cells.levels.insert(octree.cells.levels.begin(), std::move(top));
    octree.bounds = bounds;
    ++octree.depth;
  }
  return octree;
}

std::optional<Box> occupied_box(const Octree& octree) {
  std::optional<Box> box;
  if (!octree.cells.levels.empty()) {
    add_occupied(octree.cells, 0, 0, octree.bounds, &box);
  } else if (octree.cells.root > 0.0F) {
    box = octree.bounds;
  }
  return box;
}

}  // namespace prefilter
