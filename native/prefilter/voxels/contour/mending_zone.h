// SPDX-License-Identifier: GPL-3.0-or-later

// Mending a few loops without looking at all others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/mended_loops.h"

namespace prefilter {

/// The loops and triangles around those that have changed, with loops numbered anew. Vertices keep
/// their numbers.
struct MendingZone {
  std::vector<std::size_t> numbers;     // of each loop, among all
  std::vector<std::uint8_t> is_inside;  // of each loop: far from where the zone ends
  LinkedLoops loops;
  LoopStates states;
  LayeredMesh layered;  // its positions and kinds are those of all, while it has them
  LoopChanges changes;
};

/// Finds zones by the cubes of a grid, whose side is at least four cells, and twice the size of any
/// loop or triangle. What changes is two cubes at least from where its zone ends, and the loops
/// inside are one.
class ZoneFinder {
 public:
  /// Of a mesh without the triangles of loops.
  ZoneFinder(const LinkedLoops& loops, const LayeredMesh& layered, double cell);

  /// Whether most loops have changed: then no zone is worth while.
  static bool are_most(const LoopChanges& changes);

  /// Moves the positions and kinds of `layered` into the zone, and all changes of vertices. Does
  /// nothing, and returns nothing, where looking at everything is as fast.
  std::optional<MendingZone> enter(const LinkedLoops& loops, const LoopStates& states,
                                   LoopChanges* changes, LayeredMesh* layered) const;

  /// Takes what changed in a zone out of it, and its positions and kinds.
  static void leave(MendingZone zone, LoopStates* states, LoopChanges* changes,
                    LayeredMesh* layered);

 private:
  using Cube = std::array<std::int32_t, 3>;
  struct CubeHash {
    std::size_t operator()(const Cube& cube) const;
  };

  Cube cube_of(const Vector3& point) const;
  std::uint32_t number_of(const Cube& cube);
  std::vector<Cube> changed_cubes(const LoopChanges& changes,
                                  std::span<const Vector3> positions) const;
  std::vector<std::uint8_t> around(std::span<const Cube> cubes, std::int32_t reach) const;

  double per_side_;
  std::unordered_map<Cube, std::uint32_t, CubeHash> numbers_;
  std::vector<Cube> cubes_;
  std::vector<std::uint32_t> loops_;      // the cube of each
  std::vector<std::uint32_t> triangles_;  // the cube of each
  std::vector<std::uint32_t> counts_;     // of the triangles in each cube
};

}  // namespace prefilter
