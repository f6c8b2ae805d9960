// SPDX-License-Identifier: GPL-3.0-or-later

// Finds closed parts of a mesh nested in others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// A closed part of a mesh.
struct ClosedPart {
  double volume = 0.0;
  double area = 0.0;
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t first_triangle = 0;
  // its faces were not consistently oriented, so orientation does not mark cavities
  bool is_mixed = false;
  Box box = kEmptyBox;
};

/// Returns the parts to turn, so that each is oriented outward or is a cavity of others. `part_of`
/// is the part of each triangle, or parts.size() for none.
///
/// If the total volume is negative, all parts are turned first. Parts of negative volume are then
/// turned unless the others wind around them. Mixed parts are cavities if an odd number of others
/// contain them. Throws Error(kCancelled).
std::vector<bool> parts_to_turn(const InputMesh& mesh, std::span<const ClosedPart> parts,
                                std::span<const std::uint32_t> part_of, const Run& run);

}  // namespace prefilter
