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
#include "prefilter/contour/contour_tree.h"
#include "prefilter/contour/fit_vertices.h"
#include "prefilter/contour/tree_contour.h"

namespace prefilter {
namespace {

constexpr int kLargestSide = 1 << kMaxTreeDepth;
constexpr int kTaskDepth = 3;

using CellCoordinates = std::array<int, 3>;
using Levels = std::vector<TreeLevel>;

void check_size(const GridView& grid) {
  for (int a = 0; a < 3; ++a) {
    if (grid.size[a] < 1 || grid.size[a] > kLargestSide) {
      throw_invalid("grid: " + std::to_string(grid.size[a]) + " cells along " +
                    std::string(1, "xyz"[a]) + "; 1 to " + std::to_string(kLargestSide) +
                    " are needed");
    }
  }
}

void check_samples(const float* begin, std::size_t count) {
  for (const float* at = begin; at != begin + count; ++at) {
    if (!std::isfinite(*at)) {
      throw_invalid("grid: holds " + to_text(static_cast<double>(*at)) +
                    "; all samples must be finite");
    }
  }
}

// On which sides of the iso-value the samples of each block of 2 x 2 x 2 are; what is outside of
// the grid is empty.
class BlockSides {
 public:
  BlockSides(const GridView& grid, const ContourOptions& options, const Progress& progress)
      : grid_(grid), least_inside_(options.isovalue), most_outside_(options.isovalue) {
    if (options.interpolant == Interpolant::kPlane && options.isovalue == 0.5F) {
      // settle_sides may put these on either side.
      least_inside_ -= kDoubt;
      most_outside_ += kDoubt;
    }
    for (std::size_t a = 0; a < 3; ++a) size_[a] = (grid.size[a] + 1) / 2;
    const auto slice = static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]);
    sides_.resize(static_cast<std::size_t>(size_[0]) * slice);
    parallel_for(size_[0], options.threads, progress, [&](std::int64_t x) {
      std::uint8_t* of_slice = sides_.data() + static_cast<std::size_t>(x) * slice;
      const int low = 2 * static_cast<int>(x);
      for (int i = low; i < std::min(low + 2, grid.size[0]); ++i) {
        for (int j = 0; j < grid.size[1]; ++j) {
          const float* row = &grid.values[grid.index(i, j, 0)];
          check_samples(row, static_cast<std::size_t>(grid.size[2]));
          std::uint8_t* of_row = of_slice + static_cast<std::size_t>(j / 2) * size_[2];
          for (int k = 0; k < grid.size[2]; ++k) of_row[k / 2] |= side_of(row[k]);
        }
      }
    });
  }

  /// Whether the surface passes between samples of a block, or between them and those around.
  bool is_near_surface(const CellCoordinates& block) const {
    unsigned sides = 0;
    for_around(block, 1, [&](int x, int y, int z) {
      const bool is_within =
          x >= 0 && y >= 0 && z >= 0 && x < size_[0] && y < size_[1] && z < size_[2];
      sides |= is_within ? sides_[(static_cast<std::size_t>(x) * size_[1] + y) * size_[2] + z]
                         : kOutside;
    });
    if (sides != kBothSides) return false;
    sides = 0;
    for_around({2 * block[0], 2 * block[1], 2 * block[2]}, 2, [&](int x, int y, int z) {
      const bool is_within =
          x >= 0 && y >= 0 && z >= 0 && x < grid_.size[0] && y < grid_.size[1] && z < grid_.size[2];
      sides |= is_within ? side_of(grid_.at(x, y, z)) : kOutside;
    });
    return sides == kBothSides;
  }

 private:
  std::uint8_t side_of(float sample) const {
    return static_cast<std::uint8_t>((sample >= least_inside_ ? kInside : 0) |
                                     (sample < most_outside_ ? kOutside : 0));
  }

  // Places from one before `low` to one after the `count` from there on.
  template <typename Visit>
  static void for_around(const CellCoordinates& low, int count, const Visit& visit) {
    for (int x = low[0] - 1; x <= low[0] + count; ++x) {
      for (int y = low[1] - 1; y <= low[1] + count; ++y) {
        for (int z = low[2] - 1; z <= low[2] + count; ++z) visit(x, y, z);
      }
    }
  }

  const GridView& grid_;
  float least_inside_;
  float most_outside_;
  CellCoordinates size_{};
  std::vector<std::uint8_t> sides_;
};

struct Built {
  float value = 0.0F;
  bool is_split = false;
};

class TreeBuilder {
 public:
  TreeBuilder(const GridView& grid, const BlockSides& sides, float isovalue, int depth)
      : grid_(grid), sides_(sides), empty_(empty_sample(isovalue)), depth_(depth) {}

  // The cell of a depth; its blocks are appended to the levels.
  Built build(const CellCoordinates& cell, int at_depth, Levels* levels) const {
    if (depth_ - at_depth == 1) {
      return build_with(cell, at_depth, levels,
                        [&](const CellCoordinates& octant) { return sample(octant); });
    }
    return build_with(cell, at_depth, levels, [&](const CellCoordinates& octant) {
      return build(octant, at_depth + 1, levels);
    });
  }

  template <typename BuildOctant>
  Built build_with(const CellCoordinates& cell, int at_depth, Levels* levels,
                   const BuildOctant& build_octant) const {
    const int shift = depth_ - at_depth;
    for (int a = 0; a < 3; ++a) {
      if (cell[a] << shift >= grid_.size[a]) return {empty_, false};
    }
    if (shift == 0) return sample(cell);
    OctantValues values;
    unsigned split = 0;
    for (int o = 0; o < 8; ++o) {
      const Built octant = build_octant(
          {2 * cell[0] + (o & 1), 2 * cell[1] + ((o >> 1) & 1), 2 * cell[2] + ((o >> 2) & 1)});
      values[static_cast<std::size_t>(o)] = octant.value;
      if (octant.is_split) split |= 1U << o;
    }
    // Equal samples are one leaf, but not beside the surface: a vertex is half-way between two
    // centres, and those have to be the samples' own.
    if (split == 0 &&
        std::all_of(values.begin(), values.end(),
                    [&](float value) { return value == values[0]; }) &&
        !(shift == 1 && sides_.is_near_surface(cell))) {
      return {values[0], false};
    }
    TreeLevel& level = (*levels)[static_cast<std::size_t>(at_depth)];
    level.blocks.push_back(values);
    level.split.push_back(static_cast<std::uint8_t>(split));
    return {block_mean(values), true};
  }

 private:
  Built sample(const CellCoordinates& at) const {
    const bool is_within = at[0] < grid_.size[0] && at[1] < grid_.size[1] && at[2] < grid_.size[2];
    return {is_within ? grid_.at(at[0], at[1], at[2]) : empty_, false};
  }

  const GridView& grid_;
  const BlockSides& sides_;
  float empty_;
  int depth_;
};

struct Task {
  CellCoordinates cell;
  Built built;
  Levels levels;
};

CellTree tree_of(const GridView& grid, int depth, const ContourOptions& options,
                 const Progress& progress) {
  const BlockSides sides(grid, options, progress.part(0.0, 0.3));
  const TreeBuilder builder(grid, sides, options.isovalue, depth);
  const int task_depth = std::min(kTaskDepth, depth);
  const int tasks_along = 1 << task_depth;
  std::vector<Task> tasks(static_cast<std::size_t>(tasks_along * tasks_along * tasks_along));
  const auto task_at = [&](const CellCoordinates& cell) -> Task& {
    return tasks[static_cast<std::size_t>((cell[0] * tasks_along + cell[1]) * tasks_along +
                                          cell[2])];
  };
  const auto count = static_cast<std::int64_t>(tasks.size());
  parallel_for(count, options.threads, progress.part(0.3, 1.0), [&](std::int64_t i) {
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
    return is_within ? image_.at(x, y, 0) : empty_sample(options_.isovalue);
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
  check_size(grid);
  const int longest = std::max({grid.size[0], grid.size[1], grid.size[2]});
  const int depth =
      std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(longest - 1))));
  const CellTree tree = tree_of(grid, depth, options, options.progress.part(0.0, 0.3));
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
  check_size(image);
  check_samples(image.values,
                static_cast<std::size_t>(image.size[0]) * static_cast<std::size_t>(image.size[1]));
  Outliner outliner(image, frame, options);
  outliner.cut_rows(options.progress);
  return outliner.take();
}

}  // namespace prefilter
