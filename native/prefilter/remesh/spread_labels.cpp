// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/remesh/spread_labels.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

struct Side {
  std::uint64_t ends;
  std::uint32_t triangle;

  bool operator<(const Side& other) const {
    return ends != other.ends ? ends < other.ends : triangle < other.triangle;
  }
};

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
}  // namespace

int spread_labels(FacetedMesh* mesh, std::int32_t count, const Progress& progress, int threads) {
  const std::size_t triangles = mesh->triangles.size();
  mesh->labels.resize(triangles, kNoLabel);
  std::vector<Side> sides(3 * triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint64_t>(mesh->triangles[t][k]);
      const auto b = static_cast<std::uint64_t>(mesh->triangles[t][(k + 1) % 3]);
      sides[3 * t + k] = {std::min(a, b) << 32U | std::max(a, b), static_cast<std::uint32_t>(t)};
    }
  }
  sort_in_parallel(&sides, progress.part(0.0, 0.7), threads);
  std::vector<std::array<std::uint32_t, 3>> beside(triangles, {kNone, kNone, kNone});
  std::vector<std::uint8_t> known(triangles, 0);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].ends != sides[i + 1].ends) continue;
    const std::uint32_t t = sides[i].triangle;
    const std::uint32_t u = sides[i + 1].triangle;
    beside[t][known[t]++] = u;
    beside[u][known[u]++] = t;
    ++i;
  }
  progress.report(0.8);
  std::vector<std::uint32_t> waiting;
  const auto spread = [&] {
    for (std::size_t next = 0; next < waiting.size(); ++next) {
      const std::uint32_t t = waiting[next];
      for (const std::uint32_t u : beside[t]) {
        if (u == kNone || mesh->labels[u] != kNoLabel) continue;
        mesh->labels[u] = mesh->labels[t];
        waiting.push_back(u);
      }
    }
    waiting.clear();
  };
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh->labels[t] != kNoLabel) waiting.push_back(static_cast<std::uint32_t>(t));
  }
  spread();
  progress.report(0.9);
  int added = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh->labels[t] != kNoLabel) continue;
    mesh->labels[t] = count + added++;
    waiting.push_back(static_cast<std::uint32_t>(t));
    spread();
  }
  progress.report(1.0);
  return added;
}

}  // namespace prefilter
