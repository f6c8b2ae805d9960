// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "prefilter/voxels/solid/unit_frame.h"

namespace prefilter {
namespace {

constexpr double kMinThicknessRatio = 0.03;        // of a solid part, as a share of its width
constexpr double kMinThicknessRatioTurned = 0.12;  // the same if the whole mesh is inside out
constexpr double kMaxSheetHoleRatio = 0.25;        // as a share of the sheet's area
constexpr std::size_t kSheetsRowsPerReport = 1U << 18U;

// A part of the mesh including the caps of its loops.
struct Part {
  Vector3 origin{};
  double area = 0.0;
  double volume = 0.0;  // times 6, including caps
  std::vector<std::size_t> loops;
  std::vector<double> caps;  // areas of the loops' caps

  // Whether it encloses a volume. The largest cap is about as wide as the part.
  bool is_solid(double thinnest) const {
    const double widest = *std::max_element(caps.begin(), caps.end());
    return std::abs(volume) / 6.0 > thinnest * area * std::sqrt(widest);
  }
};

void add(const UnitFrame& frame, const std::array<Vector3, 3>& corners, Part* part, double* area) {
  const Vector3 a = frame.to(corners[0]) - part->origin;
  const Vector3 b = frame.to(corners[1]) - part->origin;
  const Vector3 c = frame.to(corners[2]) - part->origin;
  *area += plain_length(cross(b - a, c - a)) / 2.0;
  part->volume += dot(a, cross(b, c));
}

using Parts = std::map<std::uint32_t, Part>;

// The parts with loops that are kept.
Parts parts_with_loops(const InputMesh& mesh, const BorderLoops& loops,
                       std::span<const unsigned char> is_kept, const UnitFrame& frame) {
  Parts parts;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_kept[i] == 0) continue;
    const std::uint32_t first = loops.loop(i)[0];
    Part& part = parts[loops.parts[first]];
    if (part.loops.empty()) part.origin = frame.to(mesh.positions[first]);
    part.loops.push_back(i);
  }
  return parts;
}

// Sums over the parts without loops.
struct Others {
  bool exist = false;
  double volume = 0.0;  // times 6
};

// Measures the parts without their caps, and the sum of all others.
Others measure_parts(const InputMesh& mesh, const BorderLoops& loops, const UnitFrame& frame,
                     const Run& run, Parts* parts) {
  std::vector<Part*> part_of(mesh.positions.size(), nullptr);
  for (auto& [id, part] : *parts) part_of[id] = &part;
  Others others;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kSheetsRowsPerReport == 0) {
      run.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    }
    const auto first = static_cast<std::size_t>(mesh.triangles[t][0]);
    if (Part* part = part_of[loops.parts[first]]) {
      add(frame, mesh.corners(t), part, &part->area);
    } else {
      others.exist = true;
      Part other;
      double area = 0.0;
      add(frame, mesh.corners(t), &other, &area);
      others.volume += other.volume;
    }
  }
  return others;
}

void add_caps(const InputMesh& mesh, const BorderLoops& loops, std::span<const LoopCap> caps,
              const UnitFrame& frame, Part* part) {
  for (const std::size_t i : part->loops) {
    part->caps.push_back(0.0);
    for (std::size_t t = 0; t < caps[i].triangles.size(); ++t) {
      add(frame, cap_corners(mesh.positions, loops.loop(i), caps[i], t), part, &part->caps.back());
    }
  }
}

// The border around a sheet stays open, and so do large holes in it.
void drop_loops_of_sheet(const Part& sheet, std::span<unsigned char> is_kept) {
  const auto outer = std::max_element(sheet.caps.begin(), sheet.caps.end());
  for (auto cap = sheet.caps.begin(); cap != sheet.caps.end(); ++cap) {
    if (cap != outer && *cap <= kMaxSheetHoleRatio * sheet.area) continue;
    is_kept[sheet.loops[static_cast<std::size_t>(cap - sheet.caps.begin())]] = 0;
  }
}

}  // namespace

void drop_single_face_loops(const BorderLoops& loops, std::span<unsigned char> is_kept) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const auto faces = loops.faces_beside(i);
    if (faces.size() == 3 && faces[0] != BorderLoops::kNone && faces[0] == faces[1] &&
        faces[0] == faces[2]) {
      is_kept[i] = 0;
    }
  }
}

CappedSolids drop_sheet_loops(const InputMesh& mesh, const BorderLoops& loops,
                              std::span<const LoopCap> caps, const Run& run,
                              std::span<unsigned char> is_kept) {
  CappedSolids solids;
  const UnitFrame frame = frame_of(mesh);
  if (loops.size() == 0 || !(frame.scale > 0.0)) return solids;
  Parts parts = parts_with_loops(mesh, loops, is_kept, frame);
  const Others others = measure_parts(mesh, loops, frame, run, &parts);
  double whole = others.volume;
  for (auto& [id, part] : parts) {
    add_caps(mesh, loops, caps, frame, &part);
    whole += part.volume;
  }
  solids.is_turned = whole < 0.0;
  const double thinnest = solids.is_turned ? kMinThicknessRatioTurned : kMinThicknessRatio;
  std::size_t count = 0;
  for (const auto& [id, part] : parts) {
    if (part.is_solid(thinnest)) {
      ++count;
      solids.loops.insert(solids.loops.end(), part.loops.begin(), part.loops.end());
    } else {
      drop_loops_of_sheet(part, is_kept);
    }
  }
  solids.has_others = others.exist || count > 1 || count < parts.size();
  std::sort(solids.loops.begin(), solids.loops.end());
  return solids;
}

}  // namespace prefilter
