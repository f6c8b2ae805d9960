// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr int kMaxPyramidSide = 1 << 20;

bool is_half(int side, int finer) {
  return side == std::max(1, finer / 2) || side == finer / 2 + finer % 2;
}

std::string size_of(const PyramidLevel& level) {
  return std::to_string(level.width) + " x " + std::to_string(level.height) + " texels";
}

[[noreturn]] void refuse(std::size_t number, const PyramidLevel& level, const std::string& what) {
  throw_invalid("levels: level " + std::to_string(number) + " has " + size_of(level) + what);
}

// For each level, the extent of the image along an axis in texels of the level.
std::vector<double> extents(const std::vector<PyramidLevel>& levels, int PyramidLevel::*side) {
  const int finest = levels[0].*side;
  bool nest = true;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const std::int64_t step = std::int64_t{1} << std::min<std::size_t>(k, 32);
    nest = nest && levels[k].*side == (finest + step - 1) / step;
  }
  std::vector<double> found;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    found.push_back(nest ? std::ldexp(finest, -static_cast<int>(k)) : levels[k].*side);
  }
  return found;
}

}  // namespace

int PyramidLevel::wrapped(int i, int size, double extent, Wrap mode) {
  if (mode != Wrap::kRepeat || extent == size || (i >= 0 && i < size)) {
    return wrap_index(i, size, mode);
  }
  const double center = i + 0.5;
  const double in_period = center - std::floor(center / extent) * extent;
  return std::clamp(static_cast<int>(in_period), 0, size - 1);
}

Pyramid::Pyramid(std::vector<PyramidLevel> levels_of_image, int channel_count, bool of_bytes)
    : levels(std::move(levels_of_image)), channels(channel_count), bytes(of_bytes) {
  if (levels.empty()) throw_invalid("levels: there are none; at least one is needed");
  if (channels < 1) throw_invalid("levels: no channels; at least one is needed");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const PyramidLevel& level = levels[i];
    if (level.width < 1 || level.height < 1 || level.width > kMaxPyramidSide ||
        level.height > kMaxPyramidSide) {
      refuse(i, level, "; sides from 1 to " + std::to_string(kMaxPyramidSide) + " are needed");
    }
    if (i == 0) continue;
    const PyramidLevel& finer = levels[i - 1];
    if (!is_half(level.width, finer.width) || !is_half(level.height, finer.height)) {
      refuse(i, level,
             "; half as many along each side as the " + size_of(finer) +
                 " of the level before it are needed, rounded to whole ones");
    }
  }
  const std::vector<double> columns = extents(levels, &PyramidLevel::width);
  const std::vector<double> rows = extents(levels, &PyramidLevel::height);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].columns = columns[i];
    levels[i].rows = rows[i];
  }
}

}  // namespace prefilter
