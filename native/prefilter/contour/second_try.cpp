// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/second_try.h"

namespace prefilter {

using Flags = std::vector<std::uint8_t>;

void mark_around(std::size_t loop, const LinkedLoops& loops, Flags* is_changed) {
  (*is_changed)[loop] = 1;
  for (std::size_t k = 0; k < loops.side_count(loop); ++k) {
    const std::int32_t other = loops.sides[loop][k].other;
    if (other >= 0) (*is_changed)[static_cast<std::size_t>(other)] = 1;
  }
}

SecondTry::SecondTry(const LinkedLoops& loops, std::span<const Feature> wanted,
                     std::span<const Vector3> wanted_places, LoopStates* states,
                     std::vector<Vector3>* positions)
    : loops_(loops),
      states_(*states),
      positions_(*positions),
      settled_(*states),
      settled_places_(positions->begin(),
                      positions->begin() + static_cast<std::ptrdiff_t>(wanted_places.size())),
      is_tried_(loops.size(), 0),
      is_moved_(wanted_places.size(), 0) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (states->halvings[i] == 0) continue;
    is_tried_[i] = 1;
    states->features[i] = wanted[i];
    states->is_sharp[i] = 1;
  }
  for (std::size_t v = 0; v < wanted_places.size(); ++v) {
    if (positions_[v] == wanted_places[v]) continue;
    is_moved_[v] = 1;
    positions_[v] = wanted_places[v];
  }
}

LoopChanges SecondTry::changed() const {
  LoopChanges changes{Flags(loops_.size(), 0), is_moved_};
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (is_tried_[i] != 0) mark_around(i, loops_, &changes.loops);
  }
  return changes;
}

LoopChanges SecondTry::give_up(std::span<const std::size_t> loops,
                               std::span<const std::size_t> vertices) {
  LoopChanges changes{Flags(loops_.size(), 0), Flags(is_moved_.size(), 0)};
  states_.is_single = settled_.is_single;
  for (const std::size_t i : loops) put_back(i, &changes.loops);
  for (const std::size_t v : vertices) put_vertex_back(v, &changes.vertices);
  if (changes.is_any()) return changes;
  for (std::size_t i = 0; i < loops_.size(); ++i) put_back(i, &changes.loops);
  for (std::size_t v = 0; v < is_moved_.size(); ++v) put_vertex_back(v, &changes.vertices);
  return changes;
}

void SecondTry::put_back(std::size_t i, Flags* is_changed) {
  if (is_tried_[i] == 0) return;
  is_tried_[i] = 0;
  states_.features[i] = settled_.features[i];
  states_.is_sharp[i] = settled_.is_sharp[i];
  mark_around(i, loops_, is_changed);
}

void SecondTry::put_vertex_back(std::size_t v, Flags* is_changed) {
  if (v >= is_moved_.size() || is_moved_[v] == 0) return;
  is_moved_[v] = 0;
  positions_[v] = settled_places_[v];
  (*is_changed)[v] = 1;
}

}  // namespace prefilter
