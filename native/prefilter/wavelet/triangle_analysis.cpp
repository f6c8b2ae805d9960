// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles are sorted into bricks of 16^3 cells. Within a brick they are cut into cells, whose
// fluxes are summed up level by level; the bricks' own fluxes are summed in the same way. Bricks
// are processed in Morton order, and triangles within a brick in mesh order, so that no sum depends
// on the number of threads.
#include "prefilter/wavelet/triangle_analysis.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/wavelet/boundary_flux.h"
#include "prefilter/wavelet/cell_polygon.h"
#include "prefilter/wavelet/root_mean.h"

namespace prefilter {
namespace {

constexpr int kBrickDepth = 4;  // a brick is 2^4 cells wide
constexpr std::int64_t kTrianglesPerTask = 1 << 13;
constexpr std::size_t kPairsPerTask = 1U << 11;
constexpr double kScatterShare = 0.2;  // of the time
constexpr double kAnalyzedShare = 0.95;

// A triangle, and a brick that it intersects.
struct BrickTriangle {
  std::uint32_t brick;  // Morton index
  std::uint32_t triangle;
};

CellPolygon triangle_of(const RootTriangles& mesh, std::size_t index, double scale) {
  CellPolygon polygon;
  for (const Vector3& p : mesh.corners(index)) {
    polygon.add({p[0] * scale, p[1] * scale, p[2] * scale});
  }
  return polygon;
}

bool is_within(const CellPolygon& polygon, int axis, double low, double high) {
  return polygon.lowest(axis) >= low && polygon.highest(axis) <= high;
}

// Pairs of triangles and bricks, and the triangles that extend beyond the root.
struct Scattered {
  std::vector<BrickTriangle> pairs;
  std::vector<std::uint32_t> leaving;
};

void scatter(const RootTriangles& mesh, std::size_t begin, std::size_t end, int bricks_per_axis,
             Scattered* result) {
  const double side = bricks_per_axis;
  const CellBox all = {{0, 0, 0}, {bricks_per_axis, bricks_per_axis, bricks_per_axis}};
  for (std::size_t t = begin; t < end; ++t) {
    CellPolygon polygon = triangle_of(mesh, t, side);
    const auto triangle = static_cast<std::uint32_t>(t);
    bool leaves = false;
    for (int axis = 0; axis < 3 && polygon.count > 0; ++axis) {
      if (is_within(polygon, axis, 0.0, side)) continue;
      leaves = true;
      clip_to_slab(axis, 0.0, side, &polygon);
    }
    if (leaves) result->leaving.push_back(triangle);
    if (polygon.count == 0) continue;
    cut_polygon(polygon, all, [&](const std::array<int, 3>& brick, const CellPolygon&) {
      result->pairs.push_back({static_cast<std::uint32_t>(morton_index(brick)), triangle});
    });
  }
}

// One pass of a stable radix sort by some bits of the brick, from chunks to `sorted`.
void sort_by_digit(std::span<const std::span<const BrickTriangle>> chunks, int shift, int bits,
                   const Run& run, std::span<BrickTriangle> sorted) {
  const std::size_t digits = std::size_t{1} << bits;
  const auto digit_of = [&](const BrickTriangle& pair) {
    return (pair.brick >> shift) & (digits - 1);
  };
  // Counts per chunk and digit, then the position of the next pair of each.
  std::vector<std::size_t> places(chunks.size() * digits);
  const auto count = static_cast<std::int64_t>(chunks.size());
  const Stages stages(run, {3, 7});
  parallel_for(count, stages[0], [&](std::int64_t i) {
    const auto chunk = static_cast<std::size_t>(i);
    std::size_t* const own = places.data() + chunk * digits;
    for (const BrickTriangle& pair : chunks[chunk]) ++own[digit_of(pair)];
  });
  std::size_t next = 0;
  for (std::size_t digit = 0; digit < digits; ++digit) {
    for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
      next += std::exchange(places[chunk * digits + digit], next);
    }
  }
  parallel_for(count, stages[1], [&](std::int64_t i) {
    const auto chunk = static_cast<std::size_t>(i);
    std::size_t* const own = places.data() + chunk * digits;
    for (const BrickTriangle& pair : chunks[chunk]) sorted[own[digit_of(pair)]++] = pair;
  });
}

// Sorts the pairs of all parts by brick, stably, so that each brick's triangles remain in order.
// Least significant digit first.
std::vector<BrickTriangle> sorted_by_brick(const std::vector<Scattered>& parts, int key_bits,
                                           const Run& run) {
  constexpr int kMaxDigitBits = 9;
  constexpr std::size_t kPairsPerChunk = 1U << 15;
  const int passes = std::max(1, (key_bits + kMaxDigitBits - 1) / kMaxDigitBits);
  const int bits = (key_bits + passes - 1) / passes;
  std::size_t count = 0;
  std::vector<std::span<const BrickTriangle>> chunks;
  for (const Scattered& part : parts) {
    count += part.pairs.size();
    chunks.emplace_back(part.pairs);
  }
  std::vector<BrickTriangle> sorted(count);
  std::vector<BrickTriangle> other(passes > 1 ? count : 0);
  for (int pass = 0; pass < passes; ++pass) {
    const Run part = run.part(static_cast<double>(pass) / passes, (pass + 1.0) / passes);
    sort_by_digit(chunks, pass * bits, bits, part, sorted);
    if (pass + 1 == passes) break;
    sorted.swap(other);
    chunks.clear();
    for (std::size_t begin = 0; begin < count; begin += kPairsPerChunk) {
      chunks.push_back(std::span(other).subspan(begin, std::min(kPairsPerChunk, count - begin)));
    }
  }
  return sorted;
}

// Flux of a brick with some boundary.
struct BrickFlux {
  std::uint32_t brick;
  BoundaryFlux flux;
};

// The blocks of several bricks, coarsest level first, and the fluxes for their parents.
struct BrickBlocks {
  std::array<TreeLevel, kBrickDepth> levels;
  std::vector<BrickFlux> bricks;
};

// The cells of one brick of 2^depth cells along an axis.
class Brick {
 public:
  explicit Brick(int depth) : depth_(depth), side_(1 << depth) {
    for (int k = 0; k < depth; ++k) {
      met_[k].resize(std::size_t{1} << (3 * k));
      fluxes_[k + 1].resize(std::size_t{1} << (3 * (k + 1)));
    }
  }

  // Adds the part of a triangle, in units of cells, within the brick with this low corner.
  void add(CellPolygon triangle, const std::array<int, 3>& low) {
    for (int axis = 0; axis < 3; ++axis) {
      clip_to_slab(axis, low[axis], low[axis] + side_, &triangle);
      if (triangle.count == 0) return;
    }
    const CellBox box = {low, {low[0] + side_, low[1] + side_, low[2] + side_}};
    cut_polygon(triangle, box, [&](const std::array<int, 3>& cell, const CellPolygon& piece) {
      const std::uint64_t index =
          morton_index({cell[0] - low[0], cell[1] - low[1], cell[2] - low[2]});
      fluxes_[depth_][index].add(
          polygon_flux(piece, {static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                               static_cast<double>(cell[2])}));
      met_[depth_ - 1][index >> 3] |= static_cast<std::uint8_t>(1U << (index & 7U));
      is_empty_ = false;
    });
  }

  bool is_empty() const { return is_empty_; }

  // Appends the brick's blocks to the levels, and clears it. Returns its flux.
  BoundaryFlux take(std::array<TreeLevel, kBrickDepth>* levels) {
    BoundaryFlux root;
    for (int k = depth_ - 1; k >= 0; --k) {
      TreeLevel& level = (*levels)[k];
      for (std::size_t parent = 0; parent < met_[k].size(); ++parent) {
        const std::uint8_t met = met_[k][parent];
        if (met == 0) continue;
        std::array<BoundaryFlux, 8> octants;
        std::copy_n(fluxes_[k + 1].begin() + static_cast<std::ptrdiff_t>(8 * parent), 8,
                    octants.begin());
        level.blocks.push_back(details_of_octants(octants));
        level.split.push_back(met);
        const BoundaryFlux flux = flux_of_octants(octants);
        if (k > 0) {
          fluxes_[k][parent] = flux;
          met_[k - 1][parent >> 3] |= static_cast<std::uint8_t>(1U << (parent & 7U));
        } else {
          root = flux;
        }
        std::fill_n(fluxes_[k + 1].begin() + static_cast<std::ptrdiff_t>(8 * parent), 8,
                    BoundaryFlux());
        met_[k][parent] = 0;
      }
    }
    is_empty_ = true;
    return root;
  }

 private:
  int depth_;
  int side_;
  bool is_empty_ = true;
  // For the cells of depth k within the brick, in Morton order.
  std::array<std::vector<BoundaryFlux>, kBrickDepth + 1> fluxes_;
  // Bit o of a cell of depth k: its octant o contains boundary.
  std::array<std::vector<std::uint8_t>, kBrickDepth> met_;
};

// Pairs for all triangles, sorted by brick and then by triangle.
Scattered scatter_all(const RootTriangles& mesh, int bricks_per_axis, const Run& run) {
  const auto count = static_cast<std::int64_t>(mesh.mesh.triangles.size());
  std::vector<Scattered> parts(static_cast<std::size_t>(range_count(count, kTrianglesPerTask)));
  const Stages stages(run, {3, 2});
  parallel_ranges(count, kTrianglesPerTask, stages[0], [&](std::int64_t begin, std::int64_t end) {
    scatter(mesh, static_cast<std::size_t>(begin), static_cast<std::size_t>(end), bricks_per_axis,
            &parts[static_cast<std::size_t>(begin / kTrianglesPerTask)]);
  });
  Scattered all;
  const int bits = 3 * std::bit_width(static_cast<unsigned>(bricks_per_axis - 1));
  all.pairs = sorted_by_brick(parts, bits, stages[1]);
  for (const Scattered& part : parts) {
    all.leaving.insert(all.leaving.end(), part.leaving.begin(), part.leaving.end());
  }
  return all;
}

// Start indices of the tasks: at bricks, about kPairsPerTask apart. The last entry is the end.
std::vector<std::size_t> task_starts(const std::vector<BrickTriangle>& pairs) {
  std::vector<std::size_t> starts = {0};
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (i - starts.back() >= kPairsPerTask && pairs[i].brick != pairs[i - 1].brick) {
      starts.push_back(i);
    }
  }
  if (!pairs.empty()) starts.push_back(pairs.size());
  return starts;
}

BrickBlocks analyze_bricks(const RootTriangles& mesh, std::span<const BrickTriangle> pairs,
                           int brick_depth, double cells_per_axis) {
  BrickBlocks blocks;
  Brick brick(brick_depth);
  for (std::size_t i = 0; i < pairs.size();) {
    const std::uint32_t index = pairs[i].brick;
    std::array<int, 3> low = morton_cell(index);
    for (int& x : low) x <<= brick_depth;
    for (; i < pairs.size() && pairs[i].brick == index; ++i) {
      brick.add(triangle_of(mesh, pairs[i].triangle, cells_per_axis), low);
    }
    if (!brick.is_empty()) blocks.bricks.push_back({index, brick.take(&blocks.levels)});
  }
  return blocks;
}

// Concatenates the tasks' blocks, level by level.
void join(const Run& run, std::vector<BrickBlocks>* parts, int brick_depth,
          std::span<TreeLevel> levels) {
  for (int k = 0; k < brick_depth; ++k) {
    const Run of_level = run.part(static_cast<double>(k) / brick_depth, (k + 1.0) / brick_depth);
    std::size_t count = 0;
    for (const BrickBlocks& part : *parts) count += part.levels[k].size();
    TreeLevel& level = levels[static_cast<std::size_t>(k)];
    level.blocks.reserve(count);
    level.split.reserve(count);
    for (BrickBlocks& part : *parts) {
      TreeLevel& from = part.levels[k];
      level.blocks.insert(level.blocks.end(), from.blocks.begin(), from.blocks.end());
      level.split.insert(level.split.end(), from.split.begin(), from.split.end());
      from = TreeLevel();
      of_level.report(static_cast<double>(level.size()) / static_cast<double>(count));
    }
  }
}

// Appends the blocks of the parents of `cells`; returns these parents.
std::vector<BrickFlux> add_parents(const std::vector<BrickFlux>& cells, TreeLevel* level) {
  std::vector<BrickFlux> parents;
  for (std::size_t i = 0; i < cells.size();) {
    const std::uint32_t parent = cells[i].brick >> 3U;
    std::array<BoundaryFlux, 8> octants;
    std::uint8_t met = 0;
    for (; i < cells.size() && cells[i].brick >> 3U == parent; ++i) {
      const std::uint32_t o = cells[i].brick & 7U;
      octants[o] = cells[i].flux;
      met |= static_cast<std::uint8_t>(1U << o);
    }
    level->blocks.push_back(details_of_octants(octants));
    level->split.push_back(met);
    parents.push_back({parent, flux_of_octants(octants)});
  }
  return parents;
}
}  // namespace

HaarTree analyze_triangles(const RootTriangles& mesh, int depth, const Run& run) {
  const int brick_depth = std::min(depth, kBrickDepth);
  const int coarse_depth = depth - brick_depth;
  const Scattered scattered = scatter_all(mesh, 1 << coarse_depth, run.part(0.0, kScatterShare));

  const std::vector<std::size_t> starts = task_starts(scattered.pairs);
  std::vector<BrickBlocks> parts(starts.size() - 1);
  parallel_for(static_cast<std::int64_t>(parts.size()), run.part(kScatterShare, kAnalyzedShare),
               [&](std::int64_t task) {
                 const auto i = static_cast<std::size_t>(task);
                 const std::span<const BrickTriangle> pairs(scattered.pairs);
                 parts[i] =
                     analyze_bricks(mesh, pairs.subspan(starts[i], starts[i + 1] - starts[i]),
                                    brick_depth, static_cast<double>(1 << depth));
               });

  std::vector<BrickFlux> cells;
  for (BrickBlocks& part : parts) {
    cells.insert(cells.end(), part.bricks.begin(), part.bricks.end());
  }
  RootMean mean;
  for (const std::uint32_t triangle : scattered.leaving) {
    mean.add_outside(triangle_of(mesh, triangle, 1.0));
  }
  HaarTree tree;
  if (!cells.empty()) {
    tree.levels.resize(static_cast<std::size_t>(depth));
    join(run.part(kAnalyzedShare, 1.0), &parts, brick_depth,
         std::span(tree.levels).subspan(coarse_depth));
    for (int k = coarse_depth - 1; k >= 0; --k) {
      cells = add_parents(cells, &tree.levels[static_cast<std::size_t>(k)]);
    }
    mean.add_inside(cells.front().flux);
  }
  tree.mean = mean.median();
  return tree;
}

}  // namespace prefilter
