// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/part_actions.h"

#include <cmath>

namespace prefilter {
namespace {

// Shares of a part's area. Loss is the area that the contour does not cover: of an open part that
// becomes a sheet, of a closed part that is thickened, and of a part thickened only where lost.
constexpr double kSheetLoss = 0.25;
constexpr double kThinLoss = 0.5;
constexpr double kPartialLoss = 0.005;
constexpr double kCoveredLoss = 0.8;   // of an open part that others cover
constexpr double kBuriedInside = 0.8;  // area with the outside on neither side

}  // namespace

std::vector<PartAreas> part_areas(const Patches& patches, std::span<const double> areas,
                                  std::span<const float> coverage,
                                  std::span<const TriangleSides> sides) {
  std::vector<PartAreas> sums(patches.patches.size());
  for (std::size_t t = 0; t < areas.size(); ++t) {
    PartAreas& part = sums[patches.patch_of[t]];
    part.lost += areas[t] * (1.0 - coverage[t]);
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
                                        double thickness, std::span<const PartDecision> decisions) {
  std::vector<std::size_t> parts;
  for (std::size_t p = 0; p < decisions.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    const bool is_sheet = areas[p].lost > kSheetLoss * patch.area && thickness > 0.0;
    if (patch.is_closed() || decisions[p].action != PartAction::kKeepWinding || !is_sheet) continue;
    if (areas[p].lost < kCoveredLoss * patch.area) parts.push_back(p);
  }
  return parts;
}

bool decide_parts(const Patches& patches, std::span<const PartAreas> areas, double thickness,
                  std::span<PartDecision> decisions) {
  bool has_changed = false;
  for (std::size_t p = 0; p < decisions.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    const auto& [lost, inside, seen] = areas[p];
    auto& [action, is_thickened] = decisions[p];
    is_thickened = false;
    if (action != PartAction::kKeepWinding) continue;
    if (patch.is_closed()) {
      is_thickened = is_thin(patch, thickness) && lost > kThinLoss * patch.area;
    } else if (lost > kThinLoss * patch.area && inside > kBuriedInside * (inside + seen)) {
      action = PartAction::kDrop;
      has_changed = true;
    } else if (lost > kSheetLoss * patch.area && thickness > 0.0) {
      action = PartAction::kReplaceByShell;
      has_changed = true;
    } else {
      is_thickened = lost > kPartialLoss * patch.area && thickness > 0.0;
    }
  }
  return has_changed;
}

}  // namespace prefilter
