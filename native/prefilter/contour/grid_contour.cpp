#include "prefilter/contour/grid_contour.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/contour/tree_contour.h"

namespace prefilter {
namespace {

constexpr int kLargestSide = 1 << kMaxTreeDepth;
constexpr int kTaskDepth = 3;

using CellCoordinates = std::array<int, 3>;
using Levels = std::vector<TreeLevel>;

void check_grid(const GridView& grid) {
  std::size_t count = 1;
  for (int a = 0; a < 3; ++a) {
    if (grid.size[a] < 1 || grid.size[a] > kLargestSide) {
      throw_invalid("grid: " + std::to_string(grid.size[a]) + " cells along " +
                    std::string(1, "xyz"[a]) + "; 1 to " + std::to_string(kLargestSide) +
                    " are needed");
    }
    count *= static_cast<std::size_t>(grid.size[a]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(grid.values[i])) {
      throw_invalid("grid: holds " + to_text(static_cast<double>(grid.values[i])) +
                    "; all samples must be finite");
    }
  }
}

struct Built {
  float value = 0.0F;
  bool is_split = false;
};

class TreeBuilder {
 public:
  TreeBuilder(const GridView& grid, float isovalue, int depth)
      : grid_(grid), isovalue_(isovalue), depth_(depth) {}

  // The cell of a depth; its blocks are appended to the levels.
  Built build(const CellCoordinates& cell, int at_depth, Levels* levels) const {
    return build_with(cell, at_depth, levels, [&](const CellCoordinates& octant) {
      return build(octant, at_depth + 1, levels);
    });
  }

  template <typename BuildOctant>
  Built build_with(const CellCoordinates& cell, int at_depth, Levels* levels,
                   const BuildOctant& build_octant) const {
    const int shift = depth_ - at_depth;
    for (int a = 0; a < 3; ++a) {
      if (cell[a] << shift >= grid_.size[a]) return {};
    }
    if (shift == 0) return {grid_.at(cell[0], cell[1], cell[2]), false};
    TreeLevel& level = (*levels)[static_cast<std::size_t>(at_depth)];
    const std::size_t block = level.size();
    level.blocks.emplace_back();
    level.split.push_back(0);
    for (int o = 0; o < 8; ++o) {
      const Built octant = build_octant(
          {2 * cell[0] + (o & 1), 2 * cell[1] + ((o >> 1) & 1), 2 * cell[2] + ((o >> 2) & 1)});
      level.blocks[block][static_cast<std::size_t>(o)] = octant.value;
      if (octant.is_split) level.split[block] |= static_cast<std::uint8_t>(1U << o);
    }
    const OctantValues values = level.blocks[block];
    const bool is_uniform =
        level.split[block] == 0 &&
        std::all_of(values.begin(), values.end(), [&](float value) { return value == values[0]; });
    // A surface along the borders of cells leaves them uniform, and they have to stay fine: between
    // larger cells a contour would cut the corners off. Larger blocks are made of such as passed.
    if (is_uniform && (shift > 1 || is_far_from_surface(cell))) {
      level.blocks.pop_back();
      level.split.pop_back();
      return {values[0], false};
    }
    return {block_mean(values), true};
  }

 private:
  bool is_inside(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0) return false;
    if (x >= grid_.size[0] || y >= grid_.size[1] || z >= grid_.size[2]) return false;
    return grid_.at(x, y, z) >= isovalue_;
  }

  // Whether the samples around a block of two along each axis are on the side that it is on.
  bool is_far_from_surface(const CellCoordinates& cell) const {
    const bool side = is_inside(2 * cell[0], 2 * cell[1], 2 * cell[2]);
    for (int x = 2 * cell[0] - 1; x <= 2 * cell[0] + 2; ++x) {
      for (int y = 2 * cell[1] - 1; y <= 2 * cell[1] + 2; ++y) {
        for (int z = 2 * cell[2] - 1; z <= 2 * cell[2] + 2; ++z) {
          if (is_inside(x, y, z) != side) return false;
        }
      }
    }
    return true;
  }

  const GridView& grid_;
  float isovalue_;
  int depth_;
};

struct Task {
  CellCoordinates cell;
  Built built;
  Levels levels;
};

CellTree tree_of(const GridView& grid, float isovalue, int depth, const Progress& progress,
                 int threads) {
  const TreeBuilder builder(grid, isovalue, depth);
  const int task_depth = std::min(kTaskDepth, depth);
  const int tasks_along = 1 << task_depth;
  std::vector<Task> tasks(static_cast<std::size_t>(tasks_along * tasks_along * tasks_along));
  const auto task_at = [&](const CellCoordinates& cell) -> Task& {
    return tasks[static_cast<std::size_t>((cell[0] * tasks_along + cell[1]) * tasks_along +
                                          cell[2])];
  };
  const auto count = static_cast<std::int64_t>(tasks.size());
  parallel_for(count, threads, progress, [&](std::int64_t i) {
    Task& task = tasks[static_cast<std::size_t>(i)];
    const int index = static_cast<int>(i);
    task.cell = {index / (tasks_along * tasks_along), index / tasks_along % tasks_along,
                 index % tasks_along};
    task.levels.resize(static_cast<std::size_t>(depth));
    task.built = builder.build(task.cell, task_depth, &task.levels);
  });

  Levels levels(static_cast<std::size_t>(depth));
  const auto gather = [&](const auto& self, const CellCoordinates& cell, int at_depth) -> Built {
    if (at_depth == task_depth) {
      Task& task = task_at(cell);
      for (std::size_t k = 0; k < levels.size(); ++k) {
        TreeLevel& from = task.levels[k];
        levels[k].blocks.insert(levels[k].blocks.end(), from.blocks.begin(), from.blocks.end());
        levels[k].split.insert(levels[k].split.end(), from.split.begin(), from.split.end());
        from = TreeLevel();
      }
      return task.built;
    }
    return builder.build_with(cell, at_depth, &levels, [&](const CellCoordinates& octant) {
      return self(self, octant, at_depth + 1);
    });
  };
  CellTree tree;
  tree.root = gather(gather, {0, 0, 0}, 0).value;
  while (!levels.empty() && levels.back().size() == 0) levels.pop_back();
  tree.levels = std::move(levels);
  for (TreeLevel& level : tree.levels) link_blocks(&level);
  return tree;
}

// Outlines of an image, cut through the squares between four samples each. A point lies between two
// samples: along x (0) or y (1) from the lower one.
class Outliner {
 public:
  Outliner(const GridView& image, const GridFrame& frame, const ContourOptions& options)
      : image_(image), frame_(frame), options_(options) {
    nexts_.assign(static_cast<std::size_t>(2) * static_cast<std::size_t>(image.size[0] + 1) *
                      static_cast<std::size_t>(image.size[1] + 1),
                  -1);
  }

  void cut_rows(const Progress& progress) {
    for (int x = -1; x < image_.size[0]; ++x) {
      for (int y = -1; y < image_.size[1]; ++y) cut_square(x, y);
      progress.report((x + 1.0) / image_.size[0]);
    }
  }

  std::vector<Polyline> take() {
    std::vector<Polyline> lines;
    for (std::size_t start = 0; start < nexts_.size(); ++start) {
      Polyline line;
      for (std::int64_t at = static_cast<std::int64_t>(start); nexts_[at] >= 0;) {
        line.push_back(point(at));
        at = std::exchange(nexts_[static_cast<std::size_t>(at)], -1);
      }
      if (!line.empty()) lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  float value(int x, int y) const {
    const bool is_within = x >= 0 && y >= 0 && x < image_.size[0] && y < image_.size[1];
    return is_within ? image_.at(x, y, 0) : std::min(0.0F, options_.isovalue);
  }
  bool is_inside(int x, int y) const {
    const bool is_within = x >= 0 && y >= 0 && x < image_.size[0] && y < image_.size[1];
    return is_within && image_.at(x, y, 0) >= options_.isovalue;
  }
  std::int64_t point_between(int x, int y, int axis) const {
    return 2 * (static_cast<std::int64_t>(x + 1) * (image_.size[1] + 1) + (y + 1)) + axis;
  }

  // Corners around the square, counter-clockwise; runs of inside corners are cut off one by one,
  // the inside to the left.
  void cut_square(int x, int y) {
    const std::array<std::array<int, 2>, 4> corners = {
        {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
    const std::array<std::int64_t, 4> sides = {point_between(x, y, 0), point_between(x + 1, y, 1),
                                               point_between(x, y + 1, 0), point_between(x, y, 1)};
    std::array<bool, 4> inside;
    for (std::size_t i = 0; i < 4; ++i) inside[i] = is_inside(corners[i][0], corners[i][1]);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!inside[i] || inside[(i + 3) % 4]) continue;
      std::size_t last = i;
      while (inside[(last + 1) % 4]) last = (last + 1) % 4;
      nexts_[static_cast<std::size_t>(sides[last])] = sides[(i + 3) % 4];
    }
  }

  std::array<float, 2> point(std::int64_t index) const {
    const int axis = static_cast<int>(index % 2);
    const int y = static_cast<int>(index / 2 % (image_.size[1] + 1)) - 1;
    const int x = static_cast<int>(index / 2 / (image_.size[1] + 1)) - 1;
    const float a = value(x, y);
    const float b = axis == 0 ? value(x + 1, y) : value(x, y + 1);
    const bool are_occupancies = a >= 0.0F && a <= 1.0F && b >= 0.0F && b <= 1.0F &&
                                 options_.isovalue == 0.5F &&
                                 options_.interpolant != Interpolant::kLinear;
    const float t =
        are_occupancies ? occupancy_crossing(a, b) : linear_crossing(a, b, options_.isovalue);
    const double px = x + 0.5 + (axis == 0 ? static_cast<double>(t) : 0.0);
    const double py = y + 0.5 + (axis == 1 ? static_cast<double>(t) : 0.0);
    return {static_cast<float>(frame_.origin[0] + px * frame_.spacing[0]),
            static_cast<float>(frame_.origin[1] + py * frame_.spacing[1])};
  }

  const GridView& image_;
  const GridFrame& frame_;
  const ContourOptions& options_;
  // After a point the next one of its outline; -1: no outline passes.
  std::vector<std::int64_t> nexts_;
};
}  // namespace

TriangleMesh contour_grid(const GridView& grid, const GridFrame& frame,
                          const ContourOptions& options) {
  check_grid(grid);
  const int longest = std::max({grid.size[0], grid.size[1], grid.size[2]});
  const int depth =
      std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(longest - 1))));
  const CellTree tree =
      tree_of(grid, options.isovalue, depth, options.progress.part(0.0, 0.3), options.threads);
  RootFrame root;
  for (int a = 0; a < 3; ++a) {
    root.origin[a] = frame.origin[a];
    root.size[a] = std::ldexp(frame.spacing[a], depth);
  }
  ContourOptions rest = options;
  rest.progress = options.progress.part(0.3, 1.0);
  return contour_tree(tree, root, rest);
}

std::vector<Polyline> contour_image(const GridView& image, const GridFrame& frame,
                                    const ContourOptions& options) {
  check_grid(image);
  Outliner outliner(image, frame, options);
  outliner.cut_rows(options.progress);
  return outliner.take();
}

}  // namespace prefilter
