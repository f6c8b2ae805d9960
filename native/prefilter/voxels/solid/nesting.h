// SPDX-License-Identifier: GPL-3.0-or-later

// Closed surfaces inside of others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// A closed part of a mesh.
struct ClosedPart {
  double volume = 0.0;
  double area = 0.0;
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t first_triangle = 0;
  bool is_mixed = false;  // its faces did not agree on which side is out: it is no cavity
  Box box = kEmptyBox;
};

/// Which parts are to be turned for each to be right side out or a cavity of others. `part_of` has
/// the part of each triangle, or parts.size() where it has none.
///
/// Where the volumes sum up to less than 0 all are turned first. Parts of negative volume are then
/// turned where the others do not wind around them. Mixed parts are cavities where they lie in an
/// odd number of others. Throws Error(kCancelled).
std::vector<bool> parts_to_turn(const InputMesh& mesh, std::span<const ClosedPart> parts,
                                std::span<const std::uint32_t> part_of, const Progress& progress,
                                int threads);

}  // namespace prefilter
