// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/part_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace prefilter {
namespace {

// A VertexPlace as integers, because the struct has padding.
using PlaceNumbers = std::array<std::int32_t, 5>;

bool are_within(const SlabMesh& part) {
  const auto vertices = static_cast<std::int64_t>(part.contour.mesh.positions.size());
  const auto triangles = static_cast<std::int64_t>(part.contour.mesh.triangles.size());
  const auto is_vertex = [&](std::int32_t v) { return v >= 0 && v < vertices; };
  const auto is_triangle = [&](const std::array<std::int32_t, 3>& corners) {
    return std::all_of(corners.begin(), corners.end(), is_vertex);
  };
  const auto is_place = [&](const FarMidpoint<std::int32_t>& place) {
    if (place.b >= 0) return is_vertex(place.a) && is_vertex(place.b);
    return place.a >= 0 && place.a < triangles;
  };
  return std::all_of(part.contour.mesh.triangles.begin(), part.contour.mesh.triangles.end(),
                     is_triangle) &&
         std::all_of(part.far_midpoints.begin(), part.far_midpoints.end(), is_place);
}

}  // namespace

void write_part(const SlabMesh& part, ArchiveWriter* file) {
  std::vector<PlaceNumbers> places;
  for (const VertexPlace& place : part.contour.places) {
    places.push_back({place.leaf[0], place.leaf[1], place.leaf[2], place.depth, place.face});
  }
  file->put_structs(part.contour.mesh.positions);
  file->put_structs(part.contour.mesh.triangles);
  file->put_structs(places);
  file->put_all(part.attributes);
  file->put_all(part.is_trimmed);
  file->put_structs(part.far_midpoints);
}

SlabMesh read_part(std::size_t width, ArchiveReader* file) {
  SlabMesh part;
  part.contour.mesh.positions = file->get_all<Vector3>();
  part.contour.mesh.triangles = file->get_all<std::array<std::int32_t, 3>>();
  for (const auto& [x, y, z, depth, face] : file->get_all<PlaceNumbers>()) {
    VertexPlace place{};
    place.leaf = {x, y, z};
    place.depth = static_cast<std::int8_t>(depth);
    place.face = static_cast<std::int8_t>(face);
    part.contour.places.push_back(place);
  }
  part.attributes = file->get_all<float>();
  part.is_trimmed = file->get_all<std::uint8_t>();
  part.far_midpoints = file->get_all<FarMidpoint<std::int32_t>>();
  const std::size_t vertices = part.contour.mesh.positions.size();
  const bool fits = part.contour.places.size() <= vertices &&
                    part.attributes.size() == vertices * width &&
                    (part.is_trimmed.empty() || part.is_trimmed.size() == vertices);
  if (!fits || !are_within(part)) file->refuse();
  return part;
}

}  // namespace prefilter
