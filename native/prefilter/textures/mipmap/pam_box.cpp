// SPDX-License-Identifier: GPL-3.0-or-later

// Equation 7.1 with a box, as sums over cells that are passed on from level to level.
#include "prefilter/textures/mipmap/pam_box.h"

#include <algorithm>
#include <utility>

#include "prefilter/base/lanes.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/images/filters/push_pull.h"
#include "prefilter/textures/texels/level_grid.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

// The surface's mass in cells or texels, and mass times color.
struct MassSums {
  Image image;
  std::vector<float> masses;
};

// The column and row of sums that each cell belongs to. Both are nondecreasing.
struct Blocks {
  const std::vector<int>& columns;
  int width;
  const std::vector<int>& rows;
  int height;
};

// Sums over blocks of cells. add(x, y, sums, mass) adds cell (x, y).
template <int C, typename Add>
MassSums sum_cells(const Blocks& to, const Run& run, const Add& add) {
  MassSums sums{Image(to.width, to.height, C),
                std::vector<float>(static_cast<std::size_t>(to.width) * to.height)};
  parallel_for(to.height, run, [&](std::int64_t row) {
    const auto [first, last] = std::equal_range(to.rows.begin(), to.rows.end(), row);
    float* row_masses = sums.masses.data() + row * to.width;
    float* row_sums = sums.image.texel(0, static_cast<int>(row));
    for (auto y = first - to.rows.begin(); y < last - to.rows.begin(); ++y) {
      for (std::size_t x = 0; x < to.columns.size(); ++x) {
        const int column = to.columns[x];
        add(static_cast<int>(x), static_cast<int>(y), row_sums + C * column, row_masses + column);
      }
    }
  });
  return sums;
}

template <int C>
MassSums sum_cells(const MassSums& from, const Blocks& to, const Run& run) {
  const int width = from.image.width;
  return sum_cells<C>(to, run, [&](int x, int y, float* sum, float* mass) {
    const float* own = from.image.texel(x, y);
    for (int c = 0; c < C; ++c) sum[c] += own[c];
    *mass += from.masses[static_cast<std::size_t>(y) * width + x];
  });
}

// Turns sums into means; 0 where there is no mass.
template <int C>
void divide(const Run& run, MassSums* sums) {
  parallel_for(sums->image.height, run, [&](std::int64_t row) {
    float* sum = sums->image.texel(0, static_cast<int>(row));
    const float* mass = sums->masses.data() + row * sums->image.width;
    for (int x = 0; x < sums->image.width; ++x, sum += C) {
      for (int c = 0; c < C; ++c) sum[c] = mass[x] > 0.0F ? sum[c] / mass[x] : 0.0F;
    }
  });
}

template <int C>
std::vector<Image> levels_of(const TexelSource& image, const TexelTriangles& triangles,
                             int level_count, WrapModes wrap, const Run& run) {
  const AxisTexels columns(image.width, level_count);
  const AxisTexels rows(image.height, level_count);
  std::vector<Image> levels;
  if (level_count < 2) return levels;
  const auto cells_of = [&](int level) {
    return Blocks{columns.parents(level - 1), columns.cell_count(level), rows.parents(level - 1),
                  rows.cell_count(level)};
  };
  std::vector<float> masses =
      cell_masses(triangles, columns.lines(0), rows.lines(0), run.part(0.0, 0.5));
  const std::size_t stride = columns.texels(0).size();
  const auto add_cell = [&](const auto& value) {
    return [&](int x, int y, float* sum, float* mass) {
      const float own = masses[static_cast<std::size_t>(y) * stride + x];
      if (own == 0.0F) return;
      const int column = columns.texels(0)[x];
      const int row = rows.texels(0)[y];
      for (int c = 0; c < C; ++c) sum[c] += own * value(column, row, c);
      *mass += own;
    };
  };
  const Run gathering = run.part(0.5, 0.65);
  MassSums sums = image.has_bytes()
                      ? sum_cells<C>(cells_of(1), gathering, add_cell([&](int x, int y, int c) {
                                       return image.value(image.byte_texel(x, y)[c], c);
                                     }))
                      : sum_cells<C>(cells_of(1), gathering, add_cell([&](int x, int y, int c) {
                                       return image.floats().texel(x, y)[c];
                                     }));
  std::vector<float>().swap(masses);

  double from = 0.65;
  for (int level = 1; level < level_count; ++level) {
    // Each level has a quarter of the texels of the one before.
    const double to = from + 0.75 * (1.0 - from);
    const Run part = run.part(from, to);
    from = to;
    const Stages stages(part, {3, 2, 1, 4});
    if (level > 1) sums = sum_cells<C>(sums, cells_of(level), stages[0]);
    const Blocks texels = {columns.texels(level), level_size(image.width, level),
                           rows.texels(level), level_size(image.height, level)};
    const bool nested = sums.image.width == texels.width && sums.image.height == texels.height;
    MassSums means = nested ? sums : sum_cells<C>(sums, texels, stages[1]);
    divide<C>(stages[2], &means);
    fill_holes(means.masses, wrap, C, stages[3], &means.image);
    levels.push_back(std::move(means.image));
  }
  return levels;
}

}  // namespace

std::vector<Image> pam_box_levels(const TexelSource& image, const TexelTriangles& triangles,
                                  int level_count, WrapModes wrap, const Run& run) {
  switch (image.channels) {
    case 1:
      return levels_of<1>(image, triangles, level_count, wrap, run);
    case 2:
      return levels_of<2>(image, triangles, level_count, wrap, run);
    case 3:
      return levels_of<3>(image, triangles, level_count, wrap, run);
    default:
      return levels_of<4>(image, triangles, level_count, wrap, run);
  }
}

}  // namespace prefilter
