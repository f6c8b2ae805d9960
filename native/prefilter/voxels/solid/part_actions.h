// SPDX-License-Identifier: GPL-3.0-or-later

// Decides how the parts of a mesh are made solid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/triangle_sides.h"

namespace prefilter {

enum class PartAction : std::uint8_t {
  kKeepWinding,      // kept; winding numbers define the inside
  kReplaceByShell,   // replaced by a shell
  kDrop,             // dropped: the outside is on neither side
  kReplaceByRegion,  // replaced by the surface of a region
};

/// The decision on a part, and whether its triangles without a contour get a shell.
struct PartDecision {
  PartAction action = PartAction::kKeepWinding;
  bool is_thickened = false;
};

/// Areas of a part.
struct PartAreas {
  double lost = 0.0;    // not covered by the contour
  double inside = 0.0;  // with regions on both sides
  double seen = 0.0;    // with the outside on a side
};

/// Sums the areas of each patch, from the areas, coverage and sides of its triangles. If `sides` is
/// empty, `inside` and `seen` are 0.
std::vector<PartAreas> part_areas(const Patches& patches, std::span<const double> areas,
                                  std::span<const float> coverage,
                                  std::span<const TriangleSides> sides);

/// Whether a closed part is thinner than `thickness` on average.
bool is_thin(const FacePatch& patch, double thickness);

/// The open parts that would become sheets although the contour covers some of their area; other
/// parts may cover the rest.
std::vector<std::size_t> parts_to_cover(const Patches& patches, std::span<const PartAreas> areas,
                                        double thickness, std::span<const PartDecision> decisions);

/// Decides on the parts that keep their winding. Open parts are dropped if most of their loss is
/// inside, and become sheets if they lose much. Thin closed parts, and others that lose a little,
/// are thickened. With a thickness of 0 there are no sheets. Returns whether any decision changed.
bool decide_parts(const Patches& patches, std::span<const PartAreas> areas, double thickness,
                  std::span<PartDecision> decisions);

}  // namespace prefilter
