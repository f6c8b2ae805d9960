// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/part_fates.h"

#include <cmath>

namespace prefilter {
namespace {

// Shares of a part's area: lost of an open one that becomes a sheet, of a closed one that is
// thickened, of one that is thickened where it is lost; without an outside of one that is buried.
constexpr double kLostOfSheet = 0.25;
constexpr double kLostOfThin = 0.5;
constexpr double kLostInPart = 0.005;
constexpr double kLostOfCovered = 0.8;  // of an open part that reaches into others
constexpr double kInnerOfBuried = 0.8;

}  // namespace

std::vector<PartAreas> part_areas(const Patches& patches, std::span<const double> areas,
                                  std::span<const float> kept,
                                  std::span<const TriangleSides> sides) {
  std::vector<PartAreas> sums(patches.patches.size());
  for (std::size_t t = 0; t < areas.size(); ++t) {
    PartAreas& part = sums[patches.patch_of[t]];
    part.lost += areas[t] * (1.0 - kept[t]);
    if (sides.empty()) continue;
    part.inside += areas[t] * sides[t].inside_both;
    part.seen +=
        areas[t] * (sides[t].outside_both + sides[t].outside_front + sides[t].outside_back);
  }
  return sums;
}

bool is_thin(const FacePatch& patch, double thickness) {
  return patch.is_closed() && 2.0 * std::abs(patch.volume) < thickness * patch.area;
}

std::vector<std::size_t> parts_to_cover(const Patches& patches, std::span<const PartAreas> areas,
                                        double thickness, std::span<const PartFate> fates) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < fates.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    const bool is_sheet = areas[p].lost > kLostOfSheet * patch.area && thickness > 0.0;
    if (patch.is_closed() || fates[p].fate != Fate::kWound || !is_sheet) continue;
    if (areas[p].lost < kLostOfCovered * patch.area) found.push_back(p);
  }
  return found;
}

bool judge_parts(const Patches& patches, std::span<const PartAreas> areas, double thickness,
                 std::span<PartFate> fates) {
  bool has_changed = false;
  for (std::size_t p = 0; p < fates.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    const auto& [lost, inside, seen] = areas[p];
    auto& [fate, is_thickened] = fates[p];
    is_thickened = false;
    if (fate != Fate::kWound) continue;
    if (patch.is_closed()) {
      is_thickened = is_thin(patch, thickness) && lost > kLostOfThin * patch.area;
    } else if (lost > kLostOfThin * patch.area && inside > kInnerOfBuried * (inside + seen)) {
      fate = Fate::kBuried;
      has_changed = true;
    } else if (lost > kLostOfSheet * patch.area && thickness > 0.0) {
      fate = Fate::kSheet;
      has_changed = true;
    } else {
      is_thickened = lost > kLostInPart * patch.area && thickness > 0.0;
    }
  }
  return has_changed;
}

}  // namespace prefilter
