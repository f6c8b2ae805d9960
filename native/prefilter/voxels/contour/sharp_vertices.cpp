// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/sharp_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr int kSharpVerticesTaskDepth = 3;
constexpr double kSharpVerticesTipCells = 3.0;  // search radius for the vertex that moves to a tip
// search radius for a vertex whose line does not cross the surface
constexpr double kSharpVerticesReachCells = 1.25;

struct Block {
  CellNode cell;
  CellCoordinates at;  // in cells of its depth
};

struct TaskSamples {
  std::vector<std::int32_t> vertices;
  std::vector<SourcePoint> samples;
  std::vector<Vector3> on_lines;
  std::vector<float> facing;
};

class Sampler {
 public:
  Sampler(const ContourTree& tree, const RootFrame& frame, const SourceSurface& surface,
          const PartSides* parts, const ThickenedCells& thickened, SurfaceVertices* vertices)
      : tree_(tree),
        frame_(frame),
        surface_(surface),
        parts_(parts),
        thickened_(thickened),
        vertices_(*vertices) {}

  template <typename Descend>
  void visit_block(const Block& block, TaskSamples* task, const Descend& descend) const {
    const auto level = static_cast<std::size_t>(block.cell.depth);
    std::size_t vertex = vertices_.first(level, block.cell.octants);
    for (std::uint64_t cuts = vertices_.cuts(level, block.cell.octants); cuts != 0;
         cuts &= cuts - 1) {
      const int bit = std::countr_zero(cuts);
      const bool is_inside = tree_.octant(block.cell, bit / 6).sides == kInside;
      sample(vertex++, octant_at(block.at, bit / 6), block.cell.depth + 1, bit % 6, is_inside,
             task);
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree_.octant(block.cell, o);
      if (octant.is_split) descend({octant, octant_at(block.at, o)});
    }
  }

  void visit_all(const Block& block, TaskSamples* task) const {
    visit_block(block, task, [&](const Block& octant) { visit_all(octant, task); });
  }

 private:
  void sample(std::size_t vertex, const CellCoordinates& at, int depth, int face, bool is_inside,
              TaskSamples* task) const {
    const Vector3& expected = vertices_.positions()[vertex];
    if (!surface_.is_near(expected)) return;
    const int axis = face / 2;
    Vector3 from;
    for (int a = 0; a < 3; ++a) from[a] = frame_.position(a, at[a] + 0.5, depth);
    Vector3 to = from;
    const double side = frame_.cell(axis, depth);
    to[axis] += (face & 1) != 0 ? side : -side;
    if (thickened_.holds(from) || thickened_.holds(to)) return;
    std::optional<SourcePoint> found;
    bool is_known = false;
    if (parts_ != nullptr && !surface_.meeting_parts(expected).empty()) {
      found = parts_->exit(is_inside ? from : to, is_inside ? to : from, expected, &is_known);
    }
    if (!is_known) found = surface_.crossing(from, to, expected);
    const bool is_on_line = found.has_value();
    if (!is_on_line)
      found = surface_.nearest(expected, kSharpVerticesReachCells * surface_.cell(), -1);
    if (!found) return;
    Vector3 on_line = from;
    const double offset = found->position[axis] - from[axis];
    const double t = std::clamp(((face & 1) != 0 ? offset : -offset) / side, 0.0, 1.0);
    on_line[axis] = frame_.crossing(face, at[axis] + 0.5, t, 1.0, depth);
    if (is_on_line) found->position = on_line;
    vertices_.move(vertex, found->position);
    task->vertices.push_back(static_cast<std::int32_t>(vertex));
    task->samples.push_back(*found);
    task->on_lines.push_back(on_line);
    const double up = (face & 1) != 0 ? found->normal[axis] : -found->normal[axis];
    task->facing.push_back(is_on_line ? static_cast<float>(is_inside ? up : -up) : 0.0F);
  }

  const ContourTree& tree_;
  const RootFrame& frame_;
  const SourceSurface& surface_;
  const PartSides* parts_;
  const ThickenedCells& thickened_;
  SurfaceVertices& vertices_;
};

// Grid cells by their coordinates.
using SharpVerticesPlace = std::array<std::int64_t, 3>;

void move_tips(const SourceSurface& surface, VertexSamples* samples, SurfaceVertices* vertices) {
  const double reach = kSharpVerticesTipCells * surface.cell();
  const auto place_of = [&](const Vector3& p) {
    SharpVerticesPlace place;
    for (std::size_t a = 0; a < 3; ++a)
      place[a] = static_cast<std::int64_t>(std::floor(p[a] / reach));
    return place;
  };
  std::map<SharpVerticesPlace, std::vector<std::size_t>> tips;
  const auto& corners = surface.regions().corners;
  const auto tip_at = [&](std::size_t i) -> Vector3 {
    return surface.regions().positions[static_cast<std::size_t>(corners[i].vertex)];
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].labels.size() == 1) tips[place_of(tip_at(i))].push_back(i);
  }
  if (tips.empty()) return;
  struct Nearest {
    std::int32_t vertex = -1;
    double distance = 0.0;
  };
  std::vector<Nearest> found(corners.size());
  for (std::size_t v = 0; v < samples->index.size(); ++v) {
    const SourcePoint* sample = samples->of(static_cast<std::int32_t>(v));
    if (sample == nullptr) continue;
    const SharpVerticesPlace place = place_of(sample->position);
    for (int k = 0; k < 27; ++k) {
      const auto around =
          tips.find({place[0] + k % 3 - 1, place[1] + k / 3 % 3 - 1, place[2] + k / 9 - 1});
      if (around == tips.end()) continue;
      for (const std::size_t i : around->second) {
        const double distance = length(tip_at(i) - sample->position);
        if (sample->label != corners[i].labels[0] || distance > reach) continue;
        if (found[i].vertex >= 0 && distance >= found[i].distance) continue;
        found[i] = {static_cast<std::int32_t>(v), distance};
      }
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].vertex < 0) continue;
    const auto vertex = static_cast<std::size_t>(found[i].vertex);
    const auto sample = static_cast<std::size_t>(samples->index[vertex]);
    samples->samples[sample].position = tip_at(i);
    vertices->move(vertex, tip_at(i));
    samples->tips.push_back(found[i].vertex);
  }
}
}  // namespace

VertexSamples sample_vertices(const ContourTree& tree, const RootFrame& frame,
                              const SourceSurface& surface, const PartSides* parts,
                              const ThickenedCells& thickened, const Run& run,
                              SurfaceVertices* vertices) {
  const Sampler sampler(tree, frame, surface, parts, thickened, vertices);
  std::vector<TaskSamples> tasks(1);
  std::vector<Block> roots;
  const auto above = [&](const auto& self, const Block& block) -> void {
    if (block.cell.depth == kSharpVerticesTaskDepth) {
      roots.push_back(block);
      return;
    }
    sampler.visit_block(block, tasks.data(), [&](const Block& octant) { self(self, octant); });
  };
  above(above, {tree.root(), {0, 0, 0}});
  tasks.resize(roots.size() + 1);
  parallel_for(static_cast<std::int64_t>(roots.size()), run, [&](std::int64_t i) {
    sampler.visit_all(roots[static_cast<std::size_t>(i)], &tasks[static_cast<std::size_t>(i) + 1]);
  });
  VertexSamples result;
  result.index.assign(vertices->positions().size(), -1);
  for (const TaskSamples& task : tasks) {
    for (std::size_t i = 0; i < task.vertices.size(); ++i) {
      result.index[static_cast<std::size_t>(task.vertices[i])] =
          static_cast<std::int32_t>(result.samples.size());
      result.samples.push_back(task.samples[i]);
      result.on_lines.push_back(task.on_lines[i]);
      result.facing.push_back(task.facing[i]);
    }
  }
  move_tips(surface, &result, vertices);
  return result;
}

}  // namespace prefilter
