// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/cap_losses.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "prefilter/geometry/spatial/winding_numbers.h"
#include "prefilter/voxels/solid/unit_frame.h"

namespace prefilter {
namespace {

constexpr double kMaxWindingLoss = 0.2;  // mean decrease of the winding number that a cap may cause
constexpr double kMinCapWinding = -0.25;  // mean winding number below which a cap is inside out
constexpr std::size_t kMaxSamplesPerCap = 16;  // per cap
constexpr std::size_t kMaxCapSamples = 200000;

// Points on a cap, in the frame: centers of triangles, evenly distributed by area.
std::vector<Vector3> samples_on(const PositionView& positions, std::span<const std::uint32_t> loop,
                                const LoopCap& cap, const UnitFrame& frame, std::size_t most) {
  std::vector<double> sums = {0.0};
  for (std::size_t t = 0; t < cap.triangles.size(); ++t) {
    const auto [a, b, c] = cap_corners(positions, loop, cap, t);
    sums.push_back(sums.back() +
                   plain_length(cross(frame.to(b) - frame.to(a), frame.to(c) - frame.to(a))));
  }
  std::vector<Vector3> points;
  const std::size_t count = std::min(most, cap.triangles.size());
  for (std::size_t k = 0; k < count; ++k) {
    const double sum = sums.back() * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const auto above = std::upper_bound(sums.begin() + 1, sums.end() - 1, sum);
    const auto t = static_cast<std::size_t>(above - sums.begin()) - 1;
    const auto [a, b, c] = cap_corners(positions, loop, cap, t);
    Vector3 middle = frame.to(a) + frame.to(b) + frame.to(c);
    for (double& x : middle) x /= 3.0;
    points.push_back(middle);
  }
  return points;
}

std::vector<Vector3> framed(const PositionView& positions, const UnitFrame& frame) {
  std::vector<Vector3> result;
  result.reserve(positions.size());
  // Vertices that no triangle uses may be anywhere.
  for (const Vector3& p : positions) {
    Vector3 q = frame.to(p);
    for (double& x : q) x = std::clamp(x, -2.0, 2.0);
    result.push_back(q);
  }
  return result;
}

// Winding numbers of a mesh and of its caps at some points.
struct Windings {
  std::vector<double> of_mesh;
  std::vector<double> of_caps;
};

Windings windings_at(std::span<const Vector3> points, const InputMesh& mesh, const Caps& caps,
                     const UnitFrame& frame, const Run& run) {
  Windings windings;
  std::vector<Vector3> positions = framed(mesh.positions, frame);
  const Stages stages(run, {2, 1, 1, 1});
  const WindingNumbers of_mesh({positions, mesh.triangles}, stages[0]);
  windings.of_mesh = of_mesh.find(points, stages[1]);
  for (const Vector3& p : caps.positions) positions.push_back(frame.to(p));
  const WindingNumbers of_caps({positions, caps.triangles}, stages[2]);
  windings.of_caps = of_caps.find(points, stages[3]);
  return windings;
}

}  // namespace

void drop_canceling_caps(const InputMesh& mesh, const BorderLoops& loops,
                         std::span<const LoopCap> caps, const CappedSolids& solids, const Run& run,
                         std::span<unsigned char> is_kept) {
  // The caps of a single, outward part cannot cancel anything.
  if (solids.loops.empty() || !solids.has_others) return;
  Caps kept;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_kept[i] != 0) append_cap(mesh.positions.size(), loops.loop(i), caps[i], &kept);
  }
  if (kept.triangles.empty()) return;
  const UnitFrame frame = frame_of(mesh);
  const std::size_t most =
      std::clamp<std::size_t>(kMaxCapSamples / solids.loops.size(), 1, kMaxSamplesPerCap);
  std::vector<Vector3> points;
  std::vector<std::size_t> ends;  // end of the points of each loop
  for (const std::size_t i : solids.loops) {
    for (const Vector3& point : samples_on(mesh.positions, loops.loop(i), caps[i], frame, most)) {
      points.push_back(point);
    }
    ends.push_back(points.size());
  }
  const Windings windings = windings_at(points, mesh, kept, frame, run);
  const double sign = solids.is_turned ? -1.0 : 1.0;
  for (std::size_t k = 0, begin = 0; k < ends.size(); begin = ends[k++]) {
    double change = 0.0;
    double sum = 0.0;
    for (std::size_t p = begin; p < ends[k]; ++p) {
      change += sign * windings.of_caps[p];
      sum += sign * (windings.of_mesh[p] + windings.of_caps[p]);
    }
    const auto count = static_cast<double>(ends[k] - begin);
    if (change < -kMaxWindingLoss * count || sum < kMinCapWinding * count)
      is_kept[solids.loops[k]] = 0;
  }
}

}  // namespace prefilter
