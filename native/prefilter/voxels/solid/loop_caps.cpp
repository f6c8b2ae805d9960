// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/loop_caps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/fair_patch.h"
#include "prefilter/voxels/solid/span_loop.h"
#include "prefilter/voxels/solid/unit_frame.h"

namespace prefilter {
namespace {

constexpr std::size_t kMaxFanEdges = 6;         // edges of a loop that is closed by a fan
constexpr std::size_t kMaxFairedPoints = 400;   // points of a border over which a patch is faired
constexpr std::size_t kMaxShortLoopEdges = 64;  // edges of loops that are fast to close
constexpr std::int64_t kLoopsPerTask = 16;

// A smooth patch over a loop. Long loops are simplified first, and the other points inserted later.
HolePatch smooth_patch(const std::vector<Vector3>& loop, std::span<const Vector3> normals,
                       const Run& run) {
  const std::vector<std::uint32_t> kept = simplify_loop(loop, kMaxFairedPoints);
  std::vector<Vector3> points;
  for (const std::uint32_t i : kept) points.push_back(loop[i]);
  const std::vector<Vector3> beside = mean_normals(normals, kept);
  const Stages stages(run, {1, 1, 7, 1});
  HolePatch patch = span_loop(points, beside, stages[0]);
  refine_patch(&patch, stages[1]);
  fair_patch(beside, &patch, stages[2]);
  if (kept.size() == loop.size()) return patch;
  const auto within = patch.points().subspan(kept.size());
  const auto added = static_cast<std::uint32_t>(loop.size() - kept.size());
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const HolePatch::Triangle& triangle : patch.triangles()) {
    triangles.push_back(triangle.corners);
    for (std::uint32_t& corner : triangles.back()) {
      corner = corner < kept.size() ? kept[corner] : corner + added;
    }
  }
  points = loop;
  points.insert(points.end(), within.begin(), within.end());
  HolePatch whole(std::move(points), triangles, {normals.begin(), normals.end()});
  insert_points(loop, true, &whole, stages[3]);
  return whole;
}

bool is_fanned(const BorderLoops& loops, HoleMethod method, std::size_t i) {
  if (method == HoleMethod::kFan || loops.loop(i).size() == 3) return true;
  const auto faces = loops.faces_beside(i);
  const bool is_double = std::all_of(faces.begin(), faces.end(),
                                     [](std::uint32_t face) { return face == BorderLoops::kNone; });
  return is_double || (method == HoleMethod::kSmooth && faces.size() <= kMaxFanEdges);
}

UnitFrame frame_of_loop(const InputMesh& mesh, std::span<const std::uint32_t> loop) {
  Box box = kEmptyBox;
  for (const std::uint32_t v : loop) box.include(mesh.positions[v]);
  return UnitFrame(box);
}

// Unit normals of the faces at a loop's edges; zero where there is none.
std::vector<Vector3> normals_beside(const InputMesh& mesh, std::span<const std::uint32_t> faces,
                                    const UnitFrame& frame) {
  std::vector<Vector3> normals;
  for (const std::uint32_t face : faces) {
    Vector3 normal{};
    if (face != BorderLoops::kNone) {
      auto [a, b, c] = mesh.corners(face);
      a = frame.to(a);
      normal = cross(frame.to(b) - a, frame.to(c) - a);
      const double size = length(normal);
      for (double& x : normal) x = size > 0.0 && std::isfinite(size) ? x / size : 0.0;
    }
    normals.push_back(normal);
  }
  return normals;
}

// A cap built by make_patch(points, normals) in normalized coordinates.
template <typename MakePatch>
LoopCap patch_over(const InputMesh& mesh, const BorderLoops& loops, std::size_t i,
                   const UnitFrame& frame, const MakePatch& make_patch) {
  const auto loop = loops.loop(i);
  std::vector<Vector3> points;
  for (const std::uint32_t v : loop) points.push_back(frame.to(mesh.positions[v]));
  const HolePatch patch = make_patch(points, normals_beside(mesh, loops.faces_beside(i), frame));
  LoopCap cap;
  for (const Vector3& p : patch.points().subspan(loop.size())) cap.added.push_back(frame.back(p));
  for (const HolePatch::Triangle& triangle : patch.triangles()) {
    cap.triangles.push_back(triangle.corners);
  }
  return cap;
}

// Calls close(loop, progress) for each loop that is kept: short ones in parallel, then long ones in
// sequence.
template <typename Close>
void for_capped_loops(const BorderLoops& loops, std::span<const unsigned char> is_kept,
                      const Run& run, const Close& close) {
  parallel_ranges(static_cast<std::int64_t>(loops.size()), kLoopsPerTask, run.part(0.0, 0.5),
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t i = begin; i < end; ++i) {
                      const auto loop = static_cast<std::size_t>(i);
                      if (is_kept[loop] == 0 || loops.loop(loop).size() > kMaxShortLoopEdges)
                        continue;
                      close(loop, Run());
                    }
                  });
  const double all = static_cast<double>(loops.vertices.size());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_kept[i] == 0 || loops.loop(i).size() <= kMaxShortLoopEdges) continue;
    close(i, run.part(0.5 + 0.5 * static_cast<double>(loops.begins[i]) / all,
                      0.5 + 0.5 * static_cast<double>(loops.begins[i + 1]) / all));
  }
}

}  // namespace

std::array<Vector3, 3> cap_corners(const PositionView& positions,
                                   std::span<const std::uint32_t> loop, const LoopCap& cap,
                                   std::size_t triangle) {
  std::array<Vector3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t index = cap.triangles[triangle][k];
    corners[k] = index < loop.size() ? positions[loop[index]] : cap.added[index - loop.size()];
  }
  return corners;
}

LoopCap fan_over(const PositionView& positions, std::span<const std::uint32_t> loop) {
  LoopCap cap;
  const auto count = static_cast<std::uint32_t>(loop.size());
  if (count == 3) {
    cap.triangles.push_back({0, 1, 2});
    return cap;
  }
  // Center of the border line rather than of its vertices, whose density may vary.
  Vector3 middle{};
  double around = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3& a = positions[loop[i]];
    const Vector3& b = positions[loop[(i + 1) % loop.size()]];
    const double weight = length(b - a);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      middle[axis] += weight * (a[axis] / 2.0 + b[axis] / 2.0);
    }
    around += weight;
  }
  for (double& x : middle) x /= around;
  cap.added.push_back(middle);
  for (std::uint32_t i = 0; i < count; ++i) cap.triangles.push_back({count, i, (i + 1) % count});
  return cap;
}

std::vector<LoopCap> first_caps(const InputMesh& mesh, const BorderLoops& loops,
                                std::span<const unsigned char> is_kept, HoleMethod method,
                                const Run& run) {
  std::vector<LoopCap> caps(loops.size());
  for_capped_loops(loops, is_kept, run, [&](std::size_t i, const Run& own) {
    const UnitFrame frame = frame_of_loop(mesh, loops.loop(i));
    if (is_fanned(loops, method, i) || !frame.has_size()) {
      caps[i] = fan_over(mesh.positions, loops.loop(i));
      return;
    }
    caps[i] = patch_over(mesh, loops, i, frame, [&](const auto& points, const auto& normals) {
      return span_loop(points, normals, own);
    });
  });
  return caps;
}

void smooth_caps(const InputMesh& mesh, const BorderLoops& loops,
                 std::span<const unsigned char> is_kept, const Run& run,
                 std::vector<LoopCap>* caps) {
  for_capped_loops(loops, is_kept, run, [&](std::size_t i, const Run& own) {
    const UnitFrame frame = frame_of_loop(mesh, loops.loop(i));
    if (is_fanned(loops, HoleMethod::kSmooth, i) || !frame.has_size()) return;
    (*caps)[i] = patch_over(mesh, loops, i, frame, [&](const auto& points, const auto& normals) {
      return smooth_patch(points, normals, own);
    });
  });
}

void append_cap(std::size_t vertex_count, std::span<const std::uint32_t> loop, const LoopCap& cap,
                Caps* caps) {
  const auto first = static_cast<std::int64_t>(vertex_count + caps->positions.size()) -
                     static_cast<std::int64_t>(loop.size());
  caps->positions.insert(caps->positions.end(), cap.added.begin(), cap.added.end());
  for (const auto& triangle : cap.triangles) {
    std::array<std::int64_t, 3> own;
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = triangle[k] < loop.size() ? static_cast<std::int64_t>(loop[triangle[k]])
                                         : first + static_cast<std::int64_t>(triangle[k]);
    }
    caps->triangles.push_back(own);
  }
}

}  // namespace prefilter
