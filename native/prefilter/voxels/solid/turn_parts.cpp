// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/turn_parts.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace prefilter {
namespace {

// Ratio of back to front visibility from which a consistently oriented part is turned.
constexpr double kMinBackToFront = 4.0;
// Shares of a part's area: the least visible from behind for a part to be turned, and the most with
// the outside on both sides for visibility to decide.
constexpr double kMinSeenShare = 0.1;
constexpr double kMaxOpenShare = 0.5;
// In cells: least ratio of volume to area for a part to enclose something.
constexpr double kMinBulkCells = 1.0;

// Areas of a patch by the labels on its sides, and its volume with a fan over its border.
struct PatchSides {
  double front = 0.0;
  double back = 0.0;
  double both = 0.0;
  double volume = 0.0;
};

std::vector<PatchSides> sides_of_patches(const Patches& patches, std::span<const double> areas,
                                         const WorkMesh& mesh,
                                         std::span<const TriangleSides> sides) {
  std::vector<PatchSides> sums(patches.patches.size());
  for (std::size_t t = 0; t < sides.size(); ++t) {
    const std::uint32_t p = patches.patch_of[t];
    sums[p].front += areas[t] * sides[t].outside_front;
    sums[p].back += areas[t] * sides[t].outside_back;
    sums[p].both += areas[t] * sides[t].outside_both;
    const std::array<Vector3, 3> corners = mesh.corners(t);
    const Vector3& middle = patches.patches[p].border_middle;
    sums[p].volume +=
        dot(corners[0] - middle, cross(corners[1] - middle, corners[2] - middle)) / 6.0;
  }
  return sums;
}

bool must_turn(const FacePatch& patch, const PatchSides& sides, double cell) {
  if (patch.is_closed() || !patch.is_orientable) return false;
  // Wide open parts have the outside on both sides, so their volume decides, as for closed ones.
  if (sides.both > kMaxOpenShare * patch.area)
    return -sides.volume > kMinBulkCells * cell * patch.area;
  const double limit = patch.turned_area > 0.0 || patch.triangles == 1 ? 1.0 : kMinBackToFront;
  return sides.back > limit * sides.front && sides.back > kMinSeenShare * patch.area;
}

}  // namespace

TurnedParts turn_open_parts(const Patches& patches, std::span<const double> areas, double cell,
                            WorkMesh* mesh, std::span<TriangleSides> sides) {
  const std::vector<PatchSides> sums = sides_of_patches(patches, areas, *mesh, sides);
  TurnedParts turned;
  std::vector<bool> is_turned(sums.size());
  for (std::size_t p = 0; p < sums.size(); ++p) {
    is_turned[p] = must_turn(patches.patches[p], sums[p], cell);
    if (is_turned[p]) ++turned.parts;
  }
  for (std::size_t t = 0; t < sides.size(); ++t) {
    const std::uint32_t p = patches.patch_of[t];
    const bool is_single =
        !patches.patches[p].is_orientable && sides[t].outside_back > sides[t].outside_front;
    if (!is_single && !is_turned[p]) continue;
    if (is_single) ++turned.faces;
    std::swap(mesh->triangles[t][1], mesh->triangles[t][2]);
    std::swap(sides[t].outside_front, sides[t].outside_back);
  }
  return turned;
}

}  // namespace prefilter
