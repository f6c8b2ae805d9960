// SPDX-License-Identifier: GPL-3.0-or-later

// What becomes of the parts of a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/triangle_sides.h"

namespace prefilter {

enum class Fate : std::uint8_t {
  kWound,   // stays, and winding numbers say what is inside
  kSheet,   // replaced by a shell
  kBuried,  // dropped: the outside is on neither side
  kFilled,  // replaced by the surface of a region
};

/// A part, and whether the triangles of it that voxels lose get a shell.
struct PartFate {
  Fate fate = Fate::kWound;
  bool is_thickened = false;
};

/// Areas of a part.
struct PartAreas {
  double lost = 0.0;    // of what voxels do not keep
  double inside = 0.0;  // with regions on both sides
  double seen = 0.0;    // with the outside on a side
};

/// Those of each patch, by the areas of its triangles, how much of each voxels keep, and what is on
/// its sides; where nothing is known of these there are none.
std::vector<PartAreas> part_areas(const Patches& patches, std::span<const double> areas,
                                  std::span<const float> kept,
                                  std::span<const TriangleSides> sides);

/// Whether a closed part is thinner than `thickness` on average.
bool is_thin(const FacePatch& patch, double thickness);

/// The open parts that judge_parts would make sheets though some of their area is kept: others may
/// cover what is lost.
std::vector<std::size_t> parts_to_cover(const Patches& patches, std::span<const PartAreas> areas,
                                        double thickness, std::span<const PartFate> fates);

/// Decides on the parts that are wound: open ones are buried if most of what they lose is inside,
/// and sheets if they lose much; closed ones that are thin, and others that lose a little, are
/// thickened. Without a thickness there are no sheets. Returns whether any part is another one now.
bool judge_parts(const Patches& patches, std::span<const PartAreas> areas, double thickness,
                 std::span<PartFate> fates);

}  // namespace prefilter
