// SPDX-License-Identifier: GPL-3.0-or-later

// Mends a few loops without examining all others.
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

/// The loops and triangles around changed ones, with loops renumbered. Vertices keep their numbers.
struct MendingZone {
  std::vector<std::size_t> numbers;     // per loop: its number among all
  std::vector<std::uint8_t> is_inside;  // per loop: far from the zone's border
  LinkedLoops loops;
  LoopStates states;
  LayeredMesh layered;  // temporarily owns the positions and kinds of the whole mesh
  LoopChanges changes;
};

/// Finds zones by the cubes of a grid with sides of at least four cells, and twice the size of any
/// loop or triangle. Changes are at least two cubes from the border of their zone, and inside loops
/// at least one.
class ZoneFinder {
 public:
  /// For a mesh without the triangles of loops.
  ZoneFinder(const LinkedLoops& loops, const LayeredMesh& layered, double cell);

  /// Whether most loops have changed, in which case zones are not worthwhile.
  static bool are_most(const LoopChanges& changes);

  /// Moves the positions and kinds of `layered`, and all changes of vertices, into the zone.
  /// Returns none, without effect, if processing everything is as fast.
  std::optional<MendingZone> enter(const LinkedLoops& loops, const LoopStates& states,
                                   LoopChanges* changes, LayeredMesh* layered) const;

  /// Moves the changes, positions and kinds of a zone back.
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
  std::vector<std::uint32_t> loops_;      // cube of each loop
  std::vector<std::uint32_t> triangles_;  // cube of each triangle
  std::vector<std::uint32_t> counts_;     // number of triangles in each cube
};

}  // namespace prefilter
