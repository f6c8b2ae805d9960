// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/dual_loops.h"

#include <algorithm>
#include <limits>
#include <map>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/dual_cells.h"
#include "prefilter/voxels/contour/marching_table.h"

namespace prefilter {
namespace {

constexpr std::int64_t kDualLoopsPartsPerTask = 8;

// A vertex of a loop, and the edge of its dual cell on which it lies.
struct DualLoopsCrossing {
  std::int32_t vertex;
  std::uint8_t edge;
  bool is_low_inside;
};

// A face of a dual cell that one loop passes through twice.
struct DoubledFace {
  std::array<std::int32_t, 4> vertices;  // of the face, in order
  std::array<std::int32_t, 12> on_edge;
  std::uint8_t inside;
  std::uint8_t face;
  std::size_t first;  // the first loop of the cell
  std::size_t end;
};

struct TaskLoops {
  std::vector<std::uint32_t> ends;
  std::vector<std::uint8_t> shares_cell;
  std::vector<DualLoopsCrossing> crossings;
  std::vector<DoubledFace> doubled;
};

// The faces that loops of a case pass through twice.
unsigned doubled_faces(const std::vector<MarchingLoop>& loops) {
  unsigned doubled = 0;
  for (const MarchingLoop& loop : loops) {
    unsigned seen = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const unsigned face = faces_of_edge(loop[k]) & faces_of_edge(loop[(k + 1) % loop.size()]);
      doubled |= seen & face;
      seen |= face;
    }
  }
  return doubled;
}

class LoopMaker {
 public:
  explicit LoopMaker(const SurfaceVertices& vertices)
      : vertices_(vertices), cases_(marching_cases()) {
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      doubled_[i] = cases_[i].ambiguous_faces == 0 ? 0 : doubled_faces(cases_[i].loops);
    }
  }

  void add(const Meeting& leaves, TaskLoops* task) const {
    unsigned inside = 0;
    for (int i = 0; i < 8; ++i) {
      if (leaves[i].sides == kInside) inside |= 1U << i;
    }
    const std::size_t first = task->ends.size();
    std::array<std::int32_t, 12> on_edge;
    for (const MarchingLoop& loop : cases_[inside].loops) {
      for (const int edge : loop) {
        on_edge[edge] =
            vertices_.between(leaves[low_corner(edge)], leaves[high_corner(edge)], edge / 4);
      }
      add_loop(loop, on_edge, inside, task);
      task->shares_cell.push_back(cases_[inside].loops.size() > 1 ? 1 : 0);
    }
    for (int face = 0; face < 6; ++face) {
      if (((doubled_[inside] >> face) & 1U) == 0U) continue;
      std::array<std::int32_t, 4> around;
      std::size_t count = 0;
      for (int edge = 0; edge < 12; ++edge) {
        if (((faces_of_edge(edge) >> face) & 1U) != 0U) around[count++] = on_edge[edge];
      }
      std::sort(around.begin(), around.end());
      task->doubled.push_back({around, on_edge, static_cast<std::uint8_t>(inside),
                               static_cast<std::uint8_t>(face), first, task->ends.size()});
    }
  }

  static void add_loop(const MarchingLoop& loop, const std::array<std::int32_t, 12>& on_edge,
                       unsigned inside, TaskLoops* task) {
    for (const std::uint8_t edge : loop) {
      const bool is_low_inside = ((inside >> low_corner(edge)) & 1U) != 0U;
      task->crossings.push_back({on_edge[edge], edge, is_low_inside});
    }
    task->ends.push_back(static_cast<std::uint32_t>(task->crossings.size()));
  }

 private:
  const SurfaceVertices& vertices_;
  const std::array<MarchingCase, 256>& cases_;
  std::array<unsigned, 256> doubled_{};
};

// The faces that are doubled in both adjacent dual cells, by the first loop of each cell.
std::map<std::size_t, DoubledFace> doubled_twice(std::vector<DoubledFace> doubled) {
  std::sort(doubled.begin(), doubled.end(), [](const DoubledFace& a, const DoubledFace& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.first < b.first;
  });
  std::map<std::size_t, DoubledFace> found;
  for (std::size_t i = 0; i + 1 < doubled.size(); ++i) {
    if (doubled[i].vertices != doubled[i + 1].vertices) continue;
    found.emplace(doubled[i].first, doubled[i]);
    found.emplace(doubled[i + 1].first, doubled[i + 1]);
  }
  return found;
}

// Adds a loop to the quads of its vertices. Among the four dual cells around an edge, the one with
// the edge at its low sides comes first.
void add_to_quads(std::span<const DualLoopsCrossing> crossings, std::uint8_t shares_cell,
                  DualLoops* loops) {
  constexpr std::array<std::size_t, 4> kInTurn = {0, 1, 3, 2};
  const auto number = static_cast<std::int32_t>(loops->size());
  for (const DualLoopsCrossing& crossing : crossings) {
    const std::size_t place = kInTurn[crossing.edge % 4U];
    loops->quads[static_cast<std::size_t>(crossing.vertex)]
                [crossing.is_low_inside ? place : 3 - place] = number;
    loops->corners.push_back(crossing.vertex);
  }
  loops->begins.push_back(static_cast<std::uint32_t>(loops->corners.size()));
  loops->first_edges.push_back(crossings[0].edge);
  loops->shares_cell.push_back(shares_cell);
}

// Joins the loops of all tasks, except loops of cells that are cut differently.
DualLoops join(std::size_t vertices, std::vector<TaskLoops>* tasks) {
  std::vector<DoubledFace> doubled;
  std::size_t start = 0;
  for (const TaskLoops& task : *tasks) {
    for (DoubledFace face : task.doubled) {
      face.first += start;
      face.end += start;
      doubled.push_back(face);
    }
    start += task.ends.size();
  }
  if (start > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error(ErrorCode::kOutOfMemory, "the contour has more than 2^31 vertices");
  }
  const std::map<std::size_t, DoubledFace> cut = doubled_twice(std::move(doubled));
  DualLoops loops;
  loops.begins.push_back(0);
  loops.begins.reserve(start + 1);
  loops.corners.reserve(4 * vertices);
  loops.quads.assign(vertices, {-1, -1, -1, -1});
  auto next = cut.begin();
  std::size_t number = 0;
  for (TaskLoops& task : *tasks) {
    std::uint32_t begin = 0;
    for (std::size_t k = 0; k < task.ends.size(); ++k) {
      const std::uint32_t end = task.ends[k];
      while (next != cut.end() && number >= next->second.end) ++next;
      if (next == cut.end() || number < next->first) {
        add_to_quads(std::span(task.crossings).subspan(begin, end - begin), task.shares_cell[k],
                     &loops);
      }
      begin = end;
      ++number;
    }
    task = TaskLoops();
  }
  for (const auto& [first, cell] : cut) {
    TaskLoops task;
    for (const MarchingLoop& loop : marching_loops(cell.inside, 1U << cell.face)) {
      task = TaskLoops();
      LoopMaker::add_loop(loop, cell.on_edge, cell.inside, &task);
      add_to_quads(task.crossings, 1, &loops);
    }
  }
  return loops;
}
}  // namespace

bool has_finest_vertices(const CellTree& cells, const SurfaceVertices& vertices) {
  for (std::size_t level = 0; level + 1 < cells.levels.size(); ++level) {
    for (std::size_t block = 0; block < cells.levels[level].size(); ++block) {
      if (vertices.cuts(level, block) != 0) return false;
    }
  }
  return true;
}

DualLoops dual_loops(const ContourTree& tree, const SurfaceVertices& vertices, const Run& run) {
  const DualCells dual(tree);
  const LoopMaker maker(vertices);
  const auto parts = static_cast<std::int64_t>(dual.part_count());
  std::vector<TaskLoops> tasks(
      static_cast<std::size_t>(range_count(parts, kDualLoopsPartsPerTask)));
  const auto make_some = [&](std::int64_t begin, std::int64_t end) {
    TaskLoops& task = tasks[static_cast<std::size_t>(begin / kDualLoopsPartsPerTask)];
    for (std::int64_t part = begin; part < end; ++part) {
      dual.for_part(static_cast<std::size_t>(part),
                    [&](const Meeting& leaves) { maker.add(leaves, &task); });
    }
  };
  parallel_ranges(parts, kDualLoopsPartsPerTask, run.part(0.0, 0.8), make_some);
  DualLoops loops = join(vertices.positions().size(), &tasks);
  run.report(1.0);
  return loops;
}

}  // namespace prefilter
