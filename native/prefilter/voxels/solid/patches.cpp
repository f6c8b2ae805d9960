// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/patches.h"

#include <array>
#include <limits>
#include <span>

#include "prefilter/base/cancel_check.h"

namespace prefilter {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The neighbor across each side i of a triangle, from corner i to the next; kNone where the edge
// does not have exactly two triangles.
std::vector<std::array<std::uint32_t, 3>> neighbors_of(const MeshView<std::int32_t>& mesh,
                                                       const EdgeTable& edges) {
  std::vector<std::array<std::uint32_t, 3>> neighbors(mesh.triangles.size(), {kNone, kNone, kNone});
  const auto connect = [&](const EdgeUse& use, std::size_t low, std::size_t high,
                           std::uint32_t other) {
    const auto from = static_cast<std::int32_t>(use.is_down ? high : low);
    const auto& corners = mesh.triangles[use.triangle];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto to = static_cast<std::int32_t>(use.is_down ? low : high);
      if (corners[i] == from && corners[(i + 1) % 3] == to) neighbors[use.triangle][i] = other;
    }
  };
  for (std::size_t low = 0; low < edges.vertex_count(); ++low) {
    edges.for_edges_from(low, [&](std::size_t high, std::span<const std::uint64_t> uses) {
      if (uses.size() != 2) return;
      const EdgeUse a = EdgeTable::use(uses[0]);
      const EdgeUse b = EdgeTable::use(uses[1]);
      if (a.triangle == b.triangle) return;
      connect(a, low, high, b.triangle);
      connect(b, low, high, a.triangle);
    });
  }
  return neighbors;
}

double patch_area(const std::array<Vector3, 3>& corners) {
  return length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2.0;
}

// Whether a triangle traverses an edge in this direction.
bool runs_along(const std::array<std::int32_t, 3>& triangle, std::int32_t from, std::int32_t to) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (triangle[i] == from && triangle[(i + 1) % 3] == to) return true;
  }
  return false;
}

class PatchWalk {
 public:
  PatchWalk(const MeshView<std::int32_t>& mesh, const EdgeTable& edges, Patches* result)
      : mesh_(mesh), neighbors_(neighbors_of(mesh, edges)), result_(result) {}

  // Collects the patch of a triangle that is in none yet.
  void walk(std::uint32_t seed) {
    const auto number = static_cast<std::uint32_t>(result_->patches.size());
    FacePatch patch;
    members_.assign(1, seed);
    result_->patch_of[seed] = number;
    const Vector3 origin = mesh_.corners(seed)[0];
    for (std::size_t next = 0; next < members_.size(); ++next) {
      const std::uint32_t t = members_[next];
      const auto& corners = mesh_.triangles[t];
      const std::uint8_t turned = result_->is_turned[t];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t other = neighbors_[t][i];
        if (other == kNone) continue;
        const bool same_way = runs_along(mesh_.triangles[other], corners[i], corners[(i + 1) % 3]);
        const auto fitting = static_cast<std::uint8_t>(same_way ? 1 - turned : turned);
        if (result_->patch_of[other] == kNone) {
          result_->patch_of[other] = number;
          result_->is_turned[other] = fitting;
          members_.push_back(other);
        } else if (result_->is_turned[other] != fitting) {
          patch.is_orientable = false;
        }
      }
      const std::array<Vector3, 3> p = mesh_.corners(t);
      const double area = patch_area(p);
      const double cone = dot(p[0] - origin, cross(p[1] - origin, p[2] - origin)) / 6.0;
      patch.area += area;
      patch.volume += turned != 0 ? -cone : cone;
      if (turned != 0) patch.turned_area += area;
      for (const Vector3& corner : p) patch.box.include(corner);
    }
    patch.triangles = members_.size();
    if (patch.turned_area > patch.area / 2.0) {
      for (const std::uint32_t t : members_) result_->is_turned[t] ^= 1U;
      patch.turned_area = patch.area - patch.turned_area;
      patch.volume = -patch.volume;
    }
    result_->patches.push_back(patch);
  }

 private:
  const MeshView<std::int32_t>& mesh_;
  std::vector<std::array<std::uint32_t, 3>> neighbors_;
  Patches* result_;
  std::vector<std::uint32_t> members_;
};

// Adds the lengths of the edges that a patch does not traverse equally in both directions.
void add_borders(const MeshView<std::int32_t>& mesh, const EdgeTable& edges, Patches* result) {
  struct Balance {
    std::uint32_t patch;
    int excess;
  };
  std::vector<Balance> balances;
  for (std::size_t low = 0; low < edges.vertex_count(); ++low) {
    edges.for_edges_from(low, [&](std::size_t high, std::span<const std::uint64_t> uses) {
      if (uses.size() == 2 &&
          result->patch_of[EdgeTable::use(uses[0]).triangle] ==
              result->patch_of[EdgeTable::use(uses[1]).triangle] &&
          result->patches[result->patch_of[EdgeTable::use(uses[0]).triangle]].is_orientable) {
        return;
      }
      balances.clear();
      for (const std::uint64_t number : uses) {
        const EdgeUse use = EdgeTable::use(number);
        const std::uint32_t patch = result->patch_of[use.triangle];
        const int way = use.is_down != (result->is_turned[use.triangle] != 0) ? -1 : 1;
        auto balance = balances.begin();
        while (balance != balances.end() && balance->patch != patch) ++balance;
        if (balance == balances.end()) balance = balances.insert(balance, {patch, 0});
        balance->excess += way;
      }
      const double side = length(mesh.positions[high] - mesh.positions[low]);
      for (const Balance& balance : balances) {
        if (balance.excess == 0) continue;
        FacePatch& patch = result->patches[balance.patch];
        patch.border += side;
        for (std::size_t a = 0; a < 3; ++a) {
          const double middle = mesh.positions[low][a] / 2.0 + mesh.positions[high][a] / 2.0;
          patch.border_middle[a] += (middle - patch.border_middle[a]) * (side / patch.border);
        }
      }
    });
  }
}

}  // namespace

Patches find_patches(const MeshView<std::int32_t>& mesh, const Run& run) {
  const EdgeTable edges(mesh, run.part(0.0, 0.4));
  Patches result;
  result.patch_of.assign(mesh.triangles.size(), kNone);
  result.is_turned.assign(mesh.triangles.size(), 0);
  PatchWalk patches(mesh, edges, &result);
  const Run walking = run.part(0.4, 0.8);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % 4096 == 0)
      walking.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    if (result.patch_of[t] == kNone) patches.walk(t);
  }
  add_borders(mesh, edges, &result);
  run.report(1.0);
  return result;
}

}  // namespace prefilter
