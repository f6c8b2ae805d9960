// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/second_try.h"

#include <utility>

namespace prefilter {

void mark_around(std::size_t loop, const LinkedLoops& loops,
                 std::vector<std::uint8_t>* is_changed) {
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
      vertices_(wanted_places.size()),
      settled_single_(states->is_single) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (states->halvings[i] == 0) continue;
    settled_.emplace(i, Settled{states->features[i], states->is_sharp[i]});
    states->features[i] = wanted[i];
    states->is_sharp[i] = 1;
  }
  for (std::size_t v = 0; v < vertices_; ++v) {
    if (positions_[v] == wanted_places[v]) continue;
    settled_places_.emplace(v, positions_[v]);
    positions_[v] = wanted_places[v];
  }
}

LoopChanges SecondTry::changed() const {
  LoopChanges changes{std::vector<std::uint8_t>(loops_.size(), 0),
                      std::vector<std::uint8_t>(vertices_, 0)};
  for (const auto& [i, settled] : settled_) mark_around(i, loops_, &changes.loops);
  for (const auto& [v, place] : settled_places_) changes.vertices[v] = 1;
  return changes;
}

LoopChanges SecondTry::give_up(std::span<const std::size_t> loops,
                               std::span<const std::size_t> vertices) {
  LoopChanges changes{std::vector<std::uint8_t>(loops_.size(), 0),
                      std::vector<std::uint8_t>(vertices_, 0)};
  states_.is_single = settled_single_;
  for (const std::size_t i : loops) put_back(settled_.find(i), &changes.loops);
  for (const std::size_t v : vertices) put_vertex_back(settled_places_.find(v), &changes.vertices);
  if (changes.is_any()) return changes;
  while (!settled_.empty()) put_back(settled_.begin(), &changes.loops);
  while (!settled_places_.empty()) put_vertex_back(settled_places_.begin(), &changes.vertices);
  return changes;
}

void SecondTry::put_back(Loops::iterator found, std::vector<std::uint8_t>* is_changed) {
  if (found == settled_.end()) return;
  const std::size_t i = found->first;
  states_.features[i] = std::move(found->second.feature);
  states_.is_sharp[i] = found->second.is_sharp;
  settled_.erase(found);
  mark_around(i, loops_, is_changed);
}

void SecondTry::put_vertex_back(Places::iterator found, std::vector<std::uint8_t>* is_changed) {
  if (found == settled_places_.end()) return;
  positions_[found->first] = found->second;
  (*is_changed)[found->first] = 1;
  settled_places_.erase(found);
}

}  // namespace prefilter
