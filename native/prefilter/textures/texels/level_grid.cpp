// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/texels/level_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

// Texels: lines closer than this coincide. Texel centers of two levels are at fractions whose
// denominators are twice the level sizes, so that distinct ones are farther apart for sizes up to
// 2^16.
constexpr double kSameLine = 1e-10;

void append_centers(int size, int level, std::vector<double>* lines) {
  const int texels = level_size(size, level);
  for (int i = 0; i < texels; ++i) {
    lines->push_back((i + 0.5) * size / texels);
  }
}

void sort_and_merge(std::vector<double>* lines) {
  for (double& line : *lines) {
    const double whole = std::round(line);
    if (std::abs(line - whole) < kSameLine) line = whole;
  }
  std::sort(lines->begin(), lines->end());
  const auto same = [](double a, double b) { return b - a < kSameLine; };
  lines->erase(std::unique(lines->begin(), lines->end(), same), lines->end());
}

std::vector<CellPlace> place_cells(const std::vector<double>& lines, int size, int level) {
  const double texels_per_unit = static_cast<double>(level_size(size, level)) / size;
  std::vector<CellPlace> places(lines.size() - 1);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double middle = 0.5 * (lines[k] + lines[k + 1]);
    CellPlace& place = places[k];
    place.texel = static_cast<int>(std::floor(middle * texels_per_unit - 0.5));
    place.placement.offset = lines[k] * texels_per_unit - 0.5 - place.texel;
    place.placement.scale = (lines[k + 1] - lines[k]) * texels_per_unit;
  }
  return places;
}

std::vector<CellParent> find_parents(const std::vector<double>& fine,
                                     const std::vector<double>& coarse) {
  std::vector<CellParent> parents(fine.size() - 1);
  int cell = 0;
  for (std::size_t k = 0; k < parents.size(); ++k) {
    const double middle = 0.5 * (fine[k] + fine[k + 1]);
    while (coarse[cell + 1] < middle) ++cell;
    const double width = coarse[cell + 1] - coarse[cell];
    parents[k].cell = cell;
    parents[k].placement.offset = (fine[k] - coarse[cell]) / width;
    parents[k].placement.scale = (fine[k + 1] - fine[k]) / width;
  }
  return parents;
}

}  // namespace

AxisCells::AxisCells(int size, int level_count, int tile_size, int last_tile_level) {
  lines_.resize(level_count);
  std::vector<double> lines = {0.0, static_cast<double>(size)};
  for (int level = level_count - 1; level >= 0; --level) {
    append_centers(size, level, &lines);
    if (level == last_tile_level || (level == level_count - 1 && level < last_tile_level)) {
      for (int edge = tile_size; edge < size; edge += tile_size) lines.push_back(edge);
    }
    // Edges of the image's own texels.
    if (level == 0) {
      for (int i = 1; i < size; ++i) lines.push_back(i);
    }
    sort_and_merge(&lines);
    lines_[level] = lines;
  }
  for (int level = 0; level < level_count; ++level) {
    places_.push_back(place_cells(lines_[level], size, level));
    if (level + 1 == level_count) break;
    next_places_.push_back(place_cells(lines_[level], size, level + 1));
    parents_.push_back(find_parents(lines_[level], lines_[level + 1]));
  }
  if (level_count > 1) {
    halves_evenly_ = cell_count(1) == size;
    for (int i = 0; i <= size && halves_evenly_; ++i) halves_evenly_ = lines_[1][i] == i;
  }
}

AxisTexels::AxisTexels(int size, int level_count) {
  lines_.resize(level_count);
  std::vector<double> lines;
  for (int level = level_count - 1; level >= 0; --level) {
    const int texels = level_size(size, level);
    for (int i = 0; i <= texels; ++i) lines.push_back(static_cast<double>(i) * size / texels);
    sort_and_merge(&lines);
    lines_[level] = lines;
  }
  for (int level = 0; level < level_count; ++level) {
    const std::vector<double>& own = lines_[level];
    std::vector<int>& texels = texels_.emplace_back();
    for (std::size_t k = 0; k + 1 < own.size(); ++k) {
      const double middle = 0.5 * (own[k] + own[k + 1]);
      texels.push_back(static_cast<int>(middle * level_size(size, level) / size));
    }
    std::vector<int>& parents = parents_.emplace_back();
    if (level + 1 == level_count) break;
    for (const CellParent& parent : find_parents(own, lines_[level + 1])) {
      parents.push_back(parent.cell);
    }
  }
}

int AxisCells::cell_at(int level, double line) const {
  const std::vector<double>& lines = lines_[level];
  const auto found = std::lower_bound(lines.begin(), lines.end(), line - kSameLine);
  return static_cast<int>(found - lines.begin());
}

const std::vector<CellPlace>& AxisCells::places(int level, int of) const {
  assert(of == level || of == level + 1);
  return of == level ? places_[level] : next_places_[level];
}

}  // namespace prefilter
