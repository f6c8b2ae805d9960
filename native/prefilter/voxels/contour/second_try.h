// SPDX-License-Identifier: GPL-3.0-or-later

// Restores retracted loops and vertices where obstacles have moved since.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/mended_loops.h"

namespace prefilter {

/// Marks the loops adjacent to a loop, which gain or lose a joint.
void mark_around(std::size_t loop, const LinkedLoops& loops, std::vector<std::uint8_t>* is_changed);

/// Retracted loops and moved vertices that are put back on trial, since their obstacles may have
/// moved.
class SecondTry {
 public:
  /// Puts all of them at their targets. Keeps references to `loops`, `states` and `positions`.
  SecondTry(const LinkedLoops& loops, std::span<const Feature> wanted,
            std::span<const Vector3> wanted_places, LoopStates* states,
            std::vector<Vector3>* positions);

  LoopChanges changed() const;

  /// Reverts the given loops and vertices if they are on trial, or everything on trial if none of
  /// them is; returns what changed.
  LoopChanges give_up(std::span<const std::size_t> loops, std::span<const std::size_t> vertices);

 private:
  // The state to which a loop reverts.
  struct Settled {
    Feature feature;
    std::uint8_t is_sharp;
  };
  using Loops = std::unordered_map<std::size_t, Settled>;
  using Places = std::unordered_map<std::size_t, Vector3>;

  void put_back(Loops::iterator found, std::vector<std::uint8_t>* is_changed);
  void put_vertex_back(Places::iterator found, std::vector<std::uint8_t>* is_changed);

  const LinkedLoops& loops_;
  LoopStates& states_;
  std::vector<Vector3>& positions_;
  std::size_t vertices_;  // number of vertices that may be moved
  Loops settled_;
  Places settled_places_;
  std::vector<std::uint8_t> settled_single_;
};

}  // namespace prefilter
