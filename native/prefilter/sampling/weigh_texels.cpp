// SPDX-License-Identifier: GPL-3.0-or-later

// Section 6.2: looks up the texels and weights of a sample's subdomain.
#include "prefilter/sampling/weigh_texels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

// Beyond the reach of every texel of every table, in texels of any level.
constexpr double kFarOutside = 1024.0;

void add(WeightedTexels& found, const Pyramid& pyramid, const WrapModes& wrap, int level, int x,
         int y, double weight) {
  const PyramidLevel& size = pyramid.levels[level];
  found.texels[found.count++] = {level, size.column_of(x, wrap.u), size.row_of(y, wrap.v), weight};
}

void add_bilinear(WeightedTexels& found, const Pyramid& pyramid, const WrapModes& wrap, int level,
                  double u, double v, double weight) {
  const double x = u * pyramid.levels[level].columns - 0.5;
  const double y = v * pyramid.levels[level].rows - 0.5;
  const int low_x = static_cast<int>(std::floor(x));
  const int low_y = static_cast<int>(std::floor(y));
  for (int j = 0; j < 2; ++j) {
    const double weight_y = weight * (1.0 - std::abs(y - low_y - j));
    for (int i = 0; i < 2; ++i) {
      add(found, pyramid, wrap, level, low_x + i, low_y + j,
          weight_y * (1.0 - std::abs(x - low_x - i)));
    }
  }
}

WeightedTexels weigh_by_table(const Pyramid& pyramid, const SamplingTable& table,
                              const WrapModes& wrap, double u, double v, double scale) {
  const MipPlace mip = place_between_levels(scale, static_cast<int>(pyramid.levels.size()));
  const PyramidLevel& cells = pyramid.levels[mip.cell_level];
  const double x = u * cells.columns - std::floor(u * cells.columns);
  const double y = v * cells.rows - std::floor(v * cells.rows);
  const TableSection& section = table.section(mip.available);
  const FoldedPlace folded = fold_place(x, y);
  const double f = mip.available == 1 ? folded.x * folded.y : mip.f;
  const auto subdomain =
      static_cast<std::size_t>(subdomain_of(table.shape, section, folded.x, folded.y, mip.f));
  WeightedTexels found;
  for (int i = 0; i < table.shape.texels; ++i) {
    const std::size_t index = subdomain * table.shape.texels + i;
    const TexelOffset offset = unfold(section.texels[index], folded);
    const int level = mip.cell_level - offset.finer;
    const int texels_of_cell = 1 << offset.finer;
    // Exactly the cell's low corner if levels nest.
    const double base_x = std::floor(u * pyramid.levels[level].columns - texels_of_cell * x + 0.5);
    const double base_y = std::floor(v * pyramid.levels[level].rows - texels_of_cell * y + 0.5);
    add(found, pyramid, wrap, level, static_cast<int>(base_x) + offset.x,
        static_cast<int>(base_y) + offset.y,
        weight_at(&section.coefficients[index * table.shape.terms()], table.shape.degree, folded.x,
                  folded.y, f));
  }
  return found;
}

}  // namespace

MipPlace place_between_levels(double scale, int levels) {
  const int last = levels - 1;
  if (scale <= 1.0 || last == 0) return {0, 1, 0.0};
  const double mip_value = elementary::log2(scale);
  const int finer = std::min(static_cast<int>(std::ceil(mip_value)) - 1, last - 1);
  return {finer + 1, std::min(finer + 2, 3), std::min(mip_value - finer, 1.0)};
}

double wrap_coordinate(double coordinate, Wrap mode) {
  return mode == Wrap::kRepeat ? coordinate - std::floor(coordinate)
                               : std::clamp(coordinate, -kFarOutside, 1.0 + kFarOutside);
}

WeightedTexels weigh_texels(const Pyramid& pyramid, const SamplingTable* table,
                            const WrapModes& wrap, double u, double v, double scale) {
  u = wrap_coordinate(u, wrap.u);
  v = wrap_coordinate(v, wrap.v);
  if (table != nullptr) return weigh_by_table(pyramid, *table, wrap, u, v, scale);
  const MipPlace mip = place_between_levels(scale, static_cast<int>(pyramid.levels.size()));
  WeightedTexels found;
  if (mip.cell_level == 0) {
    add_bilinear(found, pyramid, wrap, 0, u, v, 1.0);
    return found;
  }
  add_bilinear(found, pyramid, wrap, mip.cell_level, u, v, mip.f);
  add_bilinear(found, pyramid, wrap, mip.cell_level - 1, u, v, 1.0 - mip.f);
  return found;
}

}  // namespace prefilter
