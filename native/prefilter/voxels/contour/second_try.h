// SPDX-License-Identifier: GPL-3.0-or-later

// Loops and vertices that gave way to what has moved since.
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

/// Those beside a loop lose or gain a joint.
void mark_around(std::size_t loop, const LinkedLoops& loops, std::vector<std::uint8_t>* is_changed);

/// The loops that were drawn back, and the vertices that were moved, which may have their places
/// where what was in their way has moved since.
class SecondTry {
 public:
  /// Puts all of them where they were to be. Keeps references to `loops`, `states` and `positions`.
  SecondTry(const LinkedLoops& loops, std::span<const Feature> wanted,
            std::span<const Vector3> wanted_places, LoopStates* states,
            std::vector<Vector3>* positions);

  LoopChanges changed() const;

  /// Puts those of these back that are tried, or all where none is; returns what changed.
  LoopChanges give_up(std::span<const std::size_t> loops, std::span<const std::size_t> vertices);

 private:
  // What a loop is to be again.
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
  std::size_t vertices_;  // that may be moved
  Loops settled_;
  Places settled_places_;
  std::vector<std::uint8_t> settled_single_;
};

}  // namespace prefilter
