// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/mending_zone.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prefilter {
namespace {

constexpr double kLeastCells = 2.0;
constexpr double kSides = 2.0;  // side of a cube, in multiples of the largest size
constexpr std::int32_t kZoneReach = 2;
constexpr std::int32_t kInsideReach = 1;
// Reciprocal shares of all triangles in a zone, and of all cubes with changes, above which
// processing everything is as fast; several cubes surround each change.
constexpr std::size_t kTrianglePart = 2;
constexpr std::size_t kCubePart = 6;

using Flags = std::vector<std::uint8_t>;

double largest_side(const Box& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

// Largest size of the boxes of loops and triangles.
double largest_size(const LinkedLoops& loops, const FacetedMesh& mesh) {
  double largest = 0.0;
  const auto include = [&](std::span<const std::int32_t> corners) {
    Box box = kEmptyBox;
    for (const std::int32_t v : corners) box.include(mesh.positions[static_cast<std::size_t>(v)]);
    largest = std::max(largest, largest_side(box));
  };
  for (std::size_t i = 0; i < loops.size(); ++i) {
    include({loops.loops[i].corners.data(), loops.side_count(i)});
  }
  for (const auto& triangle : mesh.triangles) include(triangle);
  return largest;
}

std::size_t count_of(const Flags& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

// Index of a loop in a zone; -1: not in the zone.
std::int32_t number_in(const std::vector<std::size_t>& numbers, std::size_t loop) {
  const auto found = std::lower_bound(numbers.begin(), numbers.end(), loop);
  if (found == numbers.end() || *found != loop) return -1;
  return static_cast<std::int32_t>(found - numbers.begin());
}

void take_loops(const LinkedLoops& loops, const LoopStates& states, MendingZone* zone) {
  for (const std::size_t i : zone->numbers) {
    zone->loops.loops.push_back(loops.loops[i]);
    auto sides = loops.sides[i];
    for (std::size_t k = 0; k < loops.side_count(i); ++k) {
      if (sides[k].other < 0) continue;
      sides[k].other = number_in(zone->numbers, static_cast<std::size_t>(sides[k].other));
    }
    zone->loops.sides.push_back(sides);
    LoopStates& taken = zone->states;
    taken.features.push_back(states.features[i]);
    taken.is_sharp.push_back(states.is_sharp[i]);
    taken.is_single.push_back(states.is_single[i]);
    taken.attempts.push_back(states.attempts[i]);
    taken.halvings.push_back(states.halvings[i]);
    const std::int32_t first = number_in(zone->numbers, states.merged[i]);
    taken.merged.push_back(first < 0 ? taken.merged.size() : static_cast<std::size_t>(first));
  }
}

}  // namespace

ZoneFinder::ZoneFinder(const LinkedLoops& loops, const LayeredMesh& layered, double cell)
    : per_side_(1.0 / (kSides * std::max(kLeastCells * cell, largest_size(loops, layered.mesh)))) {
  Cube last{};
  std::uint32_t number = number_of(last);
  const auto number_at = [&](std::int32_t vertex) {
    const Cube cube = cube_of(layered.mesh.positions[static_cast<std::size_t>(vertex)]);
    if (cube != last) {
      last = cube;
      number = number_of(cube);
    }
    return number;
  };
  loops_.reserve(loops.size());
  for (const SharpLoop& loop : loops.loops) loops_.push_back(number_at(loop.corners[0]));
  triangles_.reserve(layered.loops);
  for (std::size_t t = 0; t < layered.loops; ++t) {
    triangles_.push_back(number_at(layered.mesh.triangles[t][0]));
  }
  counts_.assign(cubes_.size(), 0);
  for (const std::uint32_t cube : triangles_) ++counts_[cube];
}

bool ZoneFinder::are_most(const LoopChanges& changes) {
  return 2 * count_of(changes.loops) > changes.loops.size();
}

ZoneFinder::Cube ZoneFinder::cube_of(const Vector3& point) const {
  constexpr double kMost = 1e9;
  Cube cube;
  for (std::size_t a = 0; a < 3; ++a) {
    const double place = std::floor(point[a] * per_side_);
    cube[a] = static_cast<std::int32_t>(std::clamp(place, -kMost, kMost));
  }
  return cube;
}

std::size_t ZoneFinder::CubeHash::operator()(const Cube& cube) const {
  std::uint64_t mixed = 0;
  for (const std::int32_t c : cube) {
    mixed = (mixed ^ static_cast<std::uint32_t>(c)) * 0x9E3779B97F4A7C15U;
    mixed ^= mixed >> 29U;
  }
  return static_cast<std::size_t>(mixed);
}

std::uint32_t ZoneFinder::number_of(const Cube& cube) {
  if (!cubes_.empty() && cubes_.back() == cube)
    return static_cast<std::uint32_t>(cubes_.size() - 1);
  const auto [found, is_new] =
      numbers_.try_emplace(cube, static_cast<std::uint32_t>(cubes_.size()));
  if (is_new) cubes_.push_back(cube);
  return found->second;
}

std::vector<ZoneFinder::Cube> ZoneFinder::changed_cubes(const LoopChanges& changes,
                                                        std::span<const Vector3> positions) const {
  std::vector<Cube> cubes;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (changes.loops[i] != 0) cubes.push_back(cubes_[loops_[i]]);
  }
  for (std::size_t v = 0; v < changes.vertices.size(); ++v) {
    if (changes.vertices[v] != 0) cubes.push_back(cube_of(positions[v]));
  }
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  return cubes;
}

// Flags the cubes around some cubes.
Flags ZoneFinder::around(std::span<const Cube> cubes, std::int32_t reach) const {
  Flags is_around(cubes_.size(), 0);
  for (const Cube& cube : cubes) {
    for (std::int32_t x = -reach; x <= reach; ++x) {
      for (std::int32_t y = -reach; y <= reach; ++y) {
        for (std::int32_t z = -reach; z <= reach; ++z) {
          const auto found = numbers_.find({cube[0] + x, cube[1] + y, cube[2] + z});
          if (found != numbers_.end()) is_around[found->second] = 1;
        }
      }
    }
  }
  return is_around;
}

std::optional<MendingZone> ZoneFinder::enter(const LinkedLoops& loops, const LoopStates& states,
                                             LoopChanges* changes, LayeredMesh* layered) const {
  const std::vector<Cube> cubes = changed_cubes(*changes, layered->mesh.positions);
  if (kCubePart * cubes.size() > cubes_.size()) return std::nullopt;
  const Flags is_here = around(cubes, kZoneReach);
  std::size_t count = 0;
  for (std::size_t i = 0; i < is_here.size(); ++i) count += is_here[i] * counts_[i];
  if (kTrianglePart * count > triangles_.size()) return std::nullopt;
  const Flags is_inside = around(cubes, kInsideReach);
  MendingZone zone;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_here[loops_[i]] == 0) continue;
    zone.numbers.push_back(i);
    zone.is_inside.push_back(is_inside[loops_[i]]);
    zone.changes.loops.push_back(changes->loops[i]);
  }
  take_loops(loops, states, &zone);
  FacetedMesh& mesh = zone.layered.mesh;
  for (std::size_t t = 0; t < layered->loops; ++t) {
    if (t == layered->near) zone.layered.near = mesh.triangles.size();
    if (is_here[triangles_[t]] == 0) continue;
    mesh.triangles.push_back(layered->mesh.triangles[t]);
    mesh.labels.push_back(layered->mesh.labels[t]);
  }
  if (layered->near == layered->loops) zone.layered.near = mesh.triangles.size();
  zone.layered.loops = mesh.triangles.size();
  zone.layered.contour_vertices = layered->contour_vertices;
  mesh.positions = std::move(layered->mesh.positions);
  mesh.kinds = std::move(layered->mesh.kinds);
  zone.changes.vertices = std::move(changes->vertices);
  return zone;
}

void ZoneFinder::leave(MendingZone zone, LoopStates* states, LoopChanges* changes,
                       LayeredMesh* layered) {
  std::fill(changes->loops.begin(), changes->loops.end(), std::uint8_t{0});
  for (std::size_t k = 0; k < zone.numbers.size(); ++k) {
    const std::size_t i = zone.numbers[k];
    changes->loops[i] = zone.changes.loops[k];
    states->features[i] = std::move(zone.states.features[k]);
    states->is_sharp[i] = zone.states.is_sharp[k];
    states->attempts[i] = zone.states.attempts[k];
    states->halvings[i] = zone.states.halvings[k];
    if (zone.is_inside[k] == 0) continue;
    states->is_single[i] = zone.states.is_single[k];
    states->merged[i] = zone.numbers[zone.states.merged[k]];
  }
  changes->vertices = std::move(zone.changes.vertices);
  layered->mesh.positions = std::move(zone.layered.mesh.positions);
  layered->mesh.kinds = std::move(zone.layered.mesh.kinds);
}

}  // namespace prefilter
