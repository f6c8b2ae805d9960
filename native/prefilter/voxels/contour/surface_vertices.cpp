// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/surface_vertices.h"

#include <cmath>
#include <limits>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr int kSurfaceVerticesTaskDepth = 3;

// A split cell with its neighbors.
struct Visit {
  CellNode cell;
  FaceNeighbors neighbors;
  CellCoordinates at;  // in cells of its depth
};

Visit octant_of(const ContourTree& tree, const Visit& visit, int o) {
  return {tree.octant(visit.cell, o), octant_neighbors(tree, visit.cell, visit.neighbors, o),
          octant_at(visit.at, o)};
}

bool meets_surface(const Visit& visit) {
  unsigned sides = visit.cell.sides;
  for (const CellNode& neighbor : visit.neighbors) sides |= neighbor.sides;
  return sides == kBothSides;
}

// Whether a leaf owns the vertex between it and its neighbor across a face, if there is one.
bool owns(const CellNode& leaf, const CellNode& neighbor, int face) {
  if (neighbor.is_split) return false;
  return neighbor.depth < leaf.depth || (face & 1) != 0;
}

// Positions of the surface and of the neighbor's center on the way from a leaf's center, in sides
// of the leaf.
struct SurfaceVerticesCrossing {
  float t;
  float distance;
};

SurfaceVerticesCrossing crossing(const ContourTree& tree, const CellNode& leaf,
                                 const CellNode& neighbor, Interpolant interpolant) {
  const float a = tree.value(leaf);
  const float b = tree.value(neighbor);
  const float isovalue = tree.isovalue();
  // The side was not determined by the value, so the surface is close to that center.
  if ((a >= isovalue) == (b >= isovalue)) {
    return {std::abs(a - isovalue) < std::abs(b - isovalue) ? 0.0F : 1.0F, 1.0F};
  }
  const bool are_occupancies = a >= 0.0F && a <= 1.0F && b >= 0.0F && b <= 1.0F && isovalue == 0.5F;
  // A coarser leaf that is full or empty contains equal cells of this size; between fractions of
  // different cells only the line through the centers is known.
  const bool is_fraction = b > 0.0F && b < 1.0F;
  if (is_fraction && neighbor.depth < leaf.depth) {
    const float apart = 0.5F * (1.0F + static_cast<float>(1 << (leaf.depth - neighbor.depth)));
    return {linear_crossing(a, b, isovalue) * apart, apart};
  }
  if (interpolant == Interpolant::kLinear || !are_occupancies) {
    return {linear_crossing(a, b, isovalue), 1.0F};
  }
  return {occupancy_crossing(a, b), 1.0F};
}

// Results of a task: vertices in order, and the range of blocks visited on each level.
struct TaskVertices {
  std::vector<Vector3> positions;
  std::vector<VertexPlace> places;  // if heights are given
  struct Range {
    std::size_t begin = std::numeric_limits<std::size_t>::max();
    std::size_t end = 0;
  };
  std::vector<Range> ranges;
};

class VertexMaker {
 public:
  VertexMaker(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
              const HeightRange* heights, std::vector<std::vector<std::uint64_t>>* cuts,
              std::vector<std::vector<std::uint32_t>>* firsts)
      : tree_(tree),
        frame_(frame),
        interpolant_(interpolant),
        heights_(heights),
        cuts_(*cuts),
        firsts_(*firsts) {}

  // Adds the vertices of leaf octants of a cell; calls descend(octant) for other octants with
  // surface.
  template <typename Descend>
  void visit_block(const Visit& visit, TaskVertices* task, const Descend& descend) const {
    const auto level = static_cast<std::size_t>(visit.cell.depth);
    const std::size_t block = visit.cell.octants;
    TaskVertices::Range& range = task->ranges[level];
    range.begin = std::min(range.begin, block);
    range.end = std::max(range.end, block + 1);
    firsts_[level][block] = static_cast<std::uint32_t>(task->positions.size());
    std::uint64_t cuts = 0;
    for (int o = 0; o < 8; ++o) {
      const CellNode leaf = tree_.octant(visit.cell, o);
      if (leaf.is_split || !is_wanted(octant_at(visit.at, o), leaf.depth)) continue;
      const FaceNeighbors neighbors = octant_neighbors(tree_, visit.cell, visit.neighbors, o);
      for (int face = 0; face < 6; ++face) {
        const CellNode& neighbor = neighbors[face];
        if (!owns(leaf, neighbor, face) || leaf.sides == neighbor.sides) continue;
        cuts |= std::uint64_t{1} << (6 * o + face);
        task->positions.push_back(position(visit, o, face, leaf, neighbor));
        if (heights_ != nullptr) {
          task->places.push_back(
              {octant_at(visit.at, o), leaf.depth, static_cast<std::int8_t>(face)});
        }
      }
    }
    cuts_[level][block] = cuts;
    for (int o = 0; o < 8; ++o) {
      if (!tree_.octant(visit.cell, o).is_split) continue;
      const Visit octant = octant_of(tree_, visit, o);
      if (meets_surface(octant) && is_wanted(octant.at, octant.cell.depth)) descend(octant);
    }
  }

  void visit_all(const Visit& visit, TaskVertices* task) const {
    visit_block(visit, task, [&](const Visit& octant) { visit_all(octant, task); });
  }

 private:
  bool is_wanted(const CellCoordinates& at, int depth) const {
    if (heights_ == nullptr) return true;
    const int shift = tree_.cells().depth() - depth;
    return at[2] << shift < heights_->high && (at[2] + 1) << shift >= heights_->low;
  }

  Vector3 position(const Visit& visit, int o, int face, const CellNode& leaf,
                   const CellNode& neighbor) const {
    const SurfaceVerticesCrossing found = crossing(tree_, leaf, neighbor, interpolant_);
    Vector3 result;
    const int shift = leaf.depth - neighbor.depth;
    for (int a = 0; a < 3; ++a) {
      const int cell = 2 * visit.at[a] + ((o >> a) & 1);
      double center = cell + 0.5;
      // For values of a smooth function the surface continues between them, so use the line through
      // the centers.
      if (heights_ != nullptr && shift > 0 && found.distance > 1.0F && a != face / 2) {
        const double other = ((cell >> shift) + 0.5) * (1 << shift);
        center += static_cast<double>(found.t / found.distance) * (other - center);
      }
      result[a] = a == face / 2 ? frame_.crossing(face, center, static_cast<double>(found.t),
                                                  static_cast<double>(found.distance), leaf.depth)
                                : frame_.position(a, center, leaf.depth);
    }
    return result;
  }

  const ContourTree& tree_;
  const RootFrame& frame_;
  Interpolant interpolant_;
  const HeightRange* heights_;
  std::vector<std::vector<std::uint64_t>>& cuts_;
  std::vector<std::vector<std::uint32_t>>& firsts_;
};
}  // namespace

SurfaceVertices::SurfaceVertices(const ContourTree& tree, const RootFrame& frame,
                                 Interpolant interpolant, const Run& run) {
  make(tree, frame, interpolant, nullptr, run);
}

SurfaceVertices::SurfaceVertices(const ContourTree& tree, const RootFrame& frame,
                                 Interpolant interpolant, const HeightRange& heights) {
  make(tree, frame, interpolant, &heights, Run(1));
}

void SurfaceVertices::make(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                           const HeightRange* heights, const Run& run) {
  const std::vector<TreeLevel>& levels = tree.cells().levels;
  for (const TreeLevel& level : levels) {
    cuts_.emplace_back(level.size());
    firsts_.emplace_back(level.size());
  }
  const VertexMaker maker(tree, frame, interpolant, heights, &cuts_, &firsts_);

  // The first task covers the levels above the others.
  std::vector<TaskVertices> tasks(1);
  tasks[0].ranges.resize(levels.size());
  std::vector<Visit> roots;
  const auto above = [&](const auto& self, const Visit& visit) -> void {
    if (visit.cell.depth == kSurfaceVerticesTaskDepth) {
      roots.push_back(visit);
      return;
    }
    maker.visit_block(visit, tasks.data(), [&](const Visit& octant) { self(self, octant); });
  };
  FaceNeighbors surroundings;
  surroundings.fill(kSurroundings);
  above(above, {tree.root(), surroundings, {0, 0, 0}});
  tasks.resize(roots.size() + 1);
  const Stages stages(run, {9, 1});
  const Run making = stages[0];
  parallel_for(static_cast<std::int64_t>(roots.size()), making, [&](std::int64_t i) {
    TaskVertices& task = tasks[static_cast<std::size_t>(i) + 1];
    task.ranges.resize(levels.size());
    maker.visit_all(roots[static_cast<std::size_t>(i)], &task);
  });

  std::size_t count = 0;
  for (const TaskVertices& task : tasks) count += task.positions.size();
  if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error(ErrorCode::kOutOfMemory, "the contour has more than 2^31 vertices");
  }
  positions_.reserve(count);
  const Run joining = stages[1];
  for (TaskVertices& task : tasks) {
    const auto offset = static_cast<std::uint32_t>(positions_.size());
    for (std::size_t k = 0; k < levels.size(); ++k) {
      // Blocks of a task are contiguous; unvisited blocks in between have no vertices.
      for (std::size_t b = task.ranges[k].begin; b < task.ranges[k].end; ++b) {
        firsts_[k][b] += offset;
      }
    }
    positions_.insert(positions_.end(), task.positions.begin(), task.positions.end());
    places_.insert(places_.end(), task.places.begin(), task.places.end());
    task = TaskVertices();
    joining.report(static_cast<double>(positions_.size()) / static_cast<double>(count));
  }
}

}  // namespace prefilter
