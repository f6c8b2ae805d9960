// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/regrid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/wavelet/leaf_surface.h"
#include "prefilter/wavelet/tree_builder.h"

namespace prefilter {
namespace {

Box octant_of(const Box& box, int octant) {
  Box half = box;
  for (int a = 0; a < 3; ++a) {
    const double middle = (box.low[a] + box.high[a]) / 2.0;
    (((octant >> a) & 1) != 0 ? half.low[a] : half.high[a]) = middle;
  }
  return half;
}

// Cells whose overlap is a smaller share of their size only touch, so that lattices that differ by
// rounding count as equal.
constexpr double kTouchingShare = 1e-9;

bool overlaps(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    const double common = std::min(a.high[i], b.high[i]) - std::max(a.low[i], b.low[i]);
    if (common <= kTouchingShare * std::min(a.size(i), b.size(i))) return false;
  }
  return true;
}

bool is_within(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    const double slack = kTouchingShare * a.size(i);
    if (a.low[i] < b.low[i] - slack || a.high[i] > b.high[i] + slack) return false;
  }
  return true;
}

// The surfaces in the leaves of a tree.
class LeafSurfaces {
 public:
  LeafSurfaces(const CellTree& tree, const Run& run) : firsts_(tree.levels.size()) {
    std::vector<std::vector<LeafPlace>> places(tree.levels.size());
    std::size_t count = 0;
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      const TreeLevel& level = tree.levels[k];
      if (k == 0) places[k] = {{0, 0, 0}};
      if (k + 1 < tree.levels.size()) places[k + 1].reserve(tree.levels[k + 1].size());
      firsts_[k].reserve(level.size());
      for (std::size_t b = 0; b < level.size(); ++b) {
        firsts_[k].push_back(count);
        for (int o = 0; o < 8; ++o) {
          if (level.is_split(b, o)) {
            places[k + 1].push_back(octant_place(places[k][b], o));
          } else if (is_fraction(level.blocks[b][static_cast<std::size_t>(o)])) {
            ++count;
          }
        }
      }
    }
    surfaces_.resize(count);
    const auto steps = static_cast<double>(tree.levels.size());
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      const TreeLevel& level = tree.levels[k];
      const auto step = static_cast<double>(k);
      for_blocks(level, run.part(step / steps, (step + 1.0) / steps),
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t b = begin; b < end; ++b) {
                     std::size_t next = firsts_[k][b];
                     for (int o = 0; o < 8; ++o) {
                       if (level.is_split(b, o) ||
                           !is_fraction(level.blocks[b][static_cast<std::size_t>(o)])) {
                         continue;
                       }
                       surfaces_[next++] = LeafSurface::find(tree, static_cast<int>(k) + 1,
                                                             octant_place(places[k][b], o), 2);
                     }
                   }
                 });
    }
  }

  /// Surface of a leaf that is neither full nor empty.
  const std::optional<LeafSurface>& of(const CellTree& tree, std::size_t level, std::size_t block,
                                       int octant) const {
    std::size_t index = firsts_[level][block];
    for (int o = 0; o < octant; ++o) {
      const float value = tree.levels[level].blocks[block][static_cast<std::size_t>(o)];
      if (!tree.levels[level].is_split(block, o) && is_fraction(value)) ++index;
    }
    return surfaces_[index];
  }

 private:
  std::vector<std::vector<std::size_t>> firsts_;  // index of each block's first surface
  std::vector<std::optional<LeafSurface>> surfaces_;
};

// A cell enlarged by the finest cells around it, whose sides are 2^-shift times its own.
Box widened(const Box& cell, int shift) {
  Box box = cell;
  for (int a = 0; a < 3; ++a) {
    const double finest = std::ldexp(cell.size(a), -shift);
    box.low[a] -= finest;
    box.high[a] += finest;
  }
  return box;
}

// Samples an octree in cells of another box.
class RegridRule {
 public:
  // A cell of the source octree.
  struct SourceCell {
    Box box;
    bool is_split;
    std::size_t level;  // level of its octants, if split
    std::size_t block;
    float value;
    const LeafSurface* surface;  // null if there is none
  };
  struct TargetCell {
    Box box;
    std::vector<SourceCell> sources;  // overlap the cell or the finest cells around it
    bool is_uniform;
    float value;  // if uniform
  };

  RegridRule(const Octree& source, int depth, const LeafSurfaces& surfaces)
      : source_(source), depth_(depth), surfaces_(surfaces) {}

  TargetCell root(const Box& bounds) const {
    const CellTree& tree = source_.cells;
    return part_of(bounds, 0, {{source_.bounds, !tree.levels.empty(), 0, 0, tree.root, nullptr}});
  }

  bool is_split(const TargetCell& part, int depth) const {
    return !part.is_uniform && depth < depth_;
  }

  float value(const TargetCell& part, int /*depth*/) const {
    if (part.is_uniform) return part.value;
    double volume = 0.0;
    for (const SourceCell& source : part.sources) volume += volume_within(source, part.box);
    return static_cast<float>(std::clamp(volume / part.box.volume(), 0.0, 1.0));
  }

  TargetCell octant(const TargetCell& part, int depth, int o) const {
    return part_of(octant_of(part.box, o), depth + 1, part.sources);
  }

 private:
  TargetCell part_of(const Box& box, int depth, const std::vector<SourceCell>& candidates) const {
    // A surface along cell borders leaves cells uniform, but they must stay fine, as contours
    // between larger cells cut corners off.
    const Box around = depth < depth_ ? widened(box, depth_ - depth) : box;
    TargetCell part{box, {}, true, 0.0F};
    const double longest = 1.5 * std::max({box.size(0), box.size(1), box.size(2)});
    for (const SourceCell& source : candidates) add_sources(source, around, longest, &part.sources);
    std::optional<float> value;
    if (!is_within(around, source_.bounds)) value = 0.0F;
    for (const SourceCell& source : part.sources) {
      const std::optional<float> found = value_over(source, around);
      part.is_uniform = found && (!value || *value == *found);
      if (!part.is_uniform) return part;
      value = found;
    }
    part.value = value.value_or(0.0F);
    return part;
  }

  // Replaces sources larger than the cell by their octants.
  void add_sources(const SourceCell& source, const Box& around, double longest,
                   std::vector<SourceCell>* sources) const {
    if (!overlaps(source.box, around)) return;
    if (!source.is_split ||
        std::max({source.box.size(0), source.box.size(1), source.box.size(2)}) < longest) {
      sources->push_back(source);
      return;
    }
    for (int o = 0; o < 8; ++o) add_sources(octant_source(source, o), around, longest, sources);
  }

  SourceCell octant_source(const SourceCell& source, int o) const {
    const TreeLevel& level = source_.cells.levels[source.level];
    SourceCell result;
    result.box = octant_of(source.box, o);
    result.is_split = level.is_split(source.block, o);
    result.level = source.level + 1;
    result.block = result.is_split ? level.child(source.block, o) : 0;
    result.value = level.blocks[source.block][static_cast<std::size_t>(o)];
    result.surface = nullptr;
    if (!result.is_split && is_fraction(result.value)) {
      const std::optional<LeafSurface>& surface =
          surfaces_.of(source_.cells, source.level, source.block, o);
      if (surface) result.surface = &*surface;
    }
    return result;
  }

  // The part of a box inside a source, in coordinates in which the source is the unit cube.
  static Box within(const SourceCell& source, const Box& box) {
    Box part;
    for (int a = 0; a < 3; ++a) {
      const double size = source.box.size(a);
      part.low[a] = std::clamp((box.low[a] - source.box.low[a]) / size, 0.0, 1.0);
      part.high[a] = std::clamp((box.high[a] - source.box.low[a]) / size, 0.0, 1.0);
    }
    return part;
  }

  // The source's value if it is uniform over a box, otherwise none.
  std::optional<float> value_over(const SourceCell& source, const Box& box) const {
    if (!source.is_split) {
      if (source.surface == nullptr) return source.value;
      return source.surface->uniform_value(within(source, box));
    }
    std::optional<float> value;
    for (int o = 0; o < 8; ++o) {
      const SourceCell octant = octant_source(source, o);
      if (!overlaps(octant.box, box)) continue;
      const std::optional<float> found = value_over(octant, box);
      if (!found || (value && *value != *found)) return std::nullopt;
      value = found;
    }
    return value ? value : source.value;
  }

  double volume_within(const SourceCell& source, const Box& box) const {
    if (!overlaps(source.box, box)) return 0.0;
    if (is_within(source.box, box)) {
      return source.box.volume() * static_cast<double>(source.value);
    }
    if (source.is_split) {
      double volume = 0.0;
      for (int o = 0; o < 8; ++o) volume += volume_within(octant_source(source, o), box);
      return volume;
    }
    const Box part = within(source, box);
    const double share =
        source.surface != nullptr ? source.surface->share(part) : static_cast<double>(source.value);
    return share * part.volume() * source.box.volume();
  }

  const Octree& source_;
  int depth_;
  const LeafSurfaces& surfaces_;
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

Octree regridded(const Octree& octree, const Box& bounds, int depth, const Run& run) {
  const Stages stages(run, {1, 4});
  const LeafSurfaces surfaces(octree.cells, stages[0]);
  const RegridRule rule(octree, depth, surfaces);
  Octree result;
  result.bounds = bounds;
  result.depth = depth;
  result.cells = build_tree(rule.root(bounds), depth, rule, stages[1]);
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
    // The old root becomes the octant that leaves space toward the box.
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
