#include "prefilter/sampling/pyramid.h"

#include <algorithm>
#include <string>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr int kLongestSide = 1 << 20;

bool is_half(int side, int finer) {
  return side == std::max(1, finer / 2) || side == finer / 2 + finer % 2;
}

std::string size_of(const PyramidLevel& level) {
  return std::to_string(level.width) + " x " + std::to_string(level.height) + " texels";
}

[[noreturn]] void refuse(std::size_t number, const PyramidLevel& level, const std::string& what) {
  throw_invalid("levels: level " + std::to_string(number) + " has " + size_of(level) + what);
}

}  // namespace

void check_pyramid(const Pyramid& pyramid) {
  if (pyramid.levels.empty()) throw_invalid("levels: there are none; at least one is needed");
  if (pyramid.channels < 1) throw_invalid("levels: no channels; at least one is needed");
  for (std::size_t i = 0; i < pyramid.levels.size(); ++i) {
    const PyramidLevel& level = pyramid.levels[i];
    if (level.width < 1 || level.height < 1 || level.width > kLongestSide ||
        level.height > kLongestSide) {
      refuse(i, level, "; sides from 1 to " + std::to_string(kLongestSide) + " are needed");
    }
    if (i == 0) continue;
    const PyramidLevel& finer = pyramid.levels[i - 1];
    if (!is_half(level.width, finer.width) || !is_half(level.height, finer.height)) {
      refuse(i, level,
             "; half as many along each side as the " + size_of(finer) +
                 " of the level before it are needed, rounded to whole ones");
    }
  }
}

}  // namespace prefilter
