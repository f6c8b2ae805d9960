// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/marching_table.h"

namespace prefilter {

std::array<int, 4> face_corners(int axis, bool is_high) {
  const int b = 1 << ((axis + 1) % 3);
  const int c = 1 << ((axis + 2) % 3);
  const int base = is_high ? 1 << axis : 0;
  if (is_high) return {base, base | b, base | b | c, base | c};
  return {base, base | c, base | b | c, base | b};
}

namespace {

int edge_between(int corner, int other) {
  const int low = corner & other;
  const int bit = corner ^ other;
  const int axis = bit == 1 ? 0 : bit == 2 ? 1 : 2;
  const int k = ((low >> ((axis + 1) % 3)) & 1) | (((low >> ((axis + 2) % 3)) & 1) << 1);
  return 4 * axis + k;
}

}  // namespace

std::vector<MarchingLoop> marching_loops(unsigned inside, unsigned joined_faces) {
  const auto is_inside = [&](int corner) { return ((inside >> corner) & 1U) != 0U; };
  // The boundary around a face enters a run of inside corners at one edge, and is followed by the
  // edge where it leaves that run, or where it left the previous one. Each cut edge is entered in
  // one of its two faces and left in the other, so this is a permutation of the cut edges.
  std::array<int, 12> next{};
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> corners = face_corners(face / 2, (face & 1) != 0);
    const bool joins = ((joined_faces >> face) & 1U) != 0U;
    for (int i = 0; i < 4; ++i) {
      const int before = corners[(i + 3) % 4];
      if (!is_inside(corners[i]) || is_inside(before)) continue;
      int at = i;
      const int step = joins ? 3 : 1;
      if (joins) at = (at + 3) % 4;
      while (is_inside(corners[at]) != joins) at = (at + step) % 4;
      const int last = joins ? at : (at + 3) % 4;
      next[edge_between(before, corners[i])] = edge_between(corners[last], corners[(last + 1) % 4]);
    }
  }
  std::vector<MarchingLoop> loops;
  std::array<bool, 12> is_done{};
  for (int start = 0; start < 12; ++start) {
    if (next[start] < 0 || is_done[start]) continue;
    MarchingLoop loop;
    for (int edge = start; !is_done[edge]; edge = next[edge]) {
      is_done[edge] = true;
      loop.push_back(static_cast<std::uint8_t>(edge));
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

unsigned ambiguous_faces(unsigned inside) {
  unsigned faces = 0;
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> corners = face_corners(face / 2, (face & 1) != 0);
    const auto is_inside = [&](int i) { return ((inside >> corners[i]) & 1U) != 0U; };
    if (is_inside(0) == is_inside(2) && is_inside(1) == is_inside(3) &&
        is_inside(0) != is_inside(1)) {
      faces |= 1U << face;
    }
  }
  return faces;
}

const std::array<MarchingCase, 256>& marching_cases() {
  static const auto* const cases = [] {
    auto* all = new std::array<MarchingCase, 256>;
    for (unsigned inside = 0; inside < 256; ++inside) {
      (*all)[inside] = {marching_loops(inside, 0), ambiguous_faces(inside)};
    }
    return all;
  }();
  return *cases;
}

}  // namespace prefilter
