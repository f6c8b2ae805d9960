// SPDX-License-Identifier: GPL-3.0-or-later

// Polygons and range grids of PLY files.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/range_grid.h"
#include "prefilter/points/unpacked_file.h"

namespace prefilter {

/// The element "range_grid" of a PLY file, with the size from the lines "obj_info num_rows" and
/// "num_cols"; nothing if there is none. Throws Error for files that are not PLY or are damaged,
/// and for an invalid point index.
std::optional<RangeGrid> read_range_grid(const std::string& path, const Run& run);
std::optional<RangeGrid> read_range_grid(const UnpackedFile& file, const Run& run);

/// The polygons of a PLY file.
struct PlyMesh {
  std::vector<Vector3> positions;
  /// Number of corners of each polygon, and the vertex index of each corner.
  std::vector<std::int64_t> sizes;
  std::vector<std::int64_t> corners;
  /// UVs of all corners, empty if there are none: from a list "texcoord" of faces, otherwise from
  /// vertex properties s and t, u and v, or texture_u and texture_v.
  std::vector<std::array<double, 2>> uvs;
};

/// Reads the elements "vertex" and "face" of a PLY file; without faces there are no polygons.
/// Throws Error as read_range_grid does.
PlyMesh read_ply_mesh(const std::string& path, const Run& run);

/// Reads the element "face" of a PLY file as triangles, by `triangulate_polygons`; empty if there
/// is none. Throws Error as read_range_grid does.
std::vector<std::array<std::int64_t, 3>> read_faces(const std::string& path, const Run& run);
std::vector<std::array<std::int64_t, 3>> read_faces(const UnpackedFile& file, const Run& run);

}  // namespace prefilter
