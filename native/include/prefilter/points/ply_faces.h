// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles and range grids of PLY files: how their points are connected.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/range_grid.h"
#include "prefilter/points/unpacked_file.h"

namespace prefilter {

/// The element "range_grid" of a PLY file, with the size that lines "obj_info num_rows" and
/// "num_cols" tell; none where it has none. Throws Error for what is no PLY file or is damaged,
/// and for an index that names no point.
std::optional<RangeGrid> read_range_grid(const std::string& path, const Progress& progress);
std::optional<RangeGrid> read_range_grid(const UnpackedFile& file, const Progress& progress);

/// The polygons of a PLY file.
struct PlyMesh {
  std::vector<Vector3> positions;
  /// The number of corners of each polygon, and the vertices of all corners.
  std::vector<std::int64_t> sizes;
  std::vector<std::int64_t> corners;
  /// The UVs of all corners; empty for a file without. They are those of a list "texcoord" of
  /// faces, else those of vertices, called s and t, u and v, or texture_u and texture_v.
  std::vector<std::array<double, 2>> uvs;
};

/// The elements "vertex" and "face" of a PLY file; without polygons where it has no faces.
/// Throws Error likewise.
PlyMesh read_ply_mesh(const std::string& path, const Progress& progress);

/// The element "face" of a PLY file as triangles, polygons by `triangulate_polygons`; none where it
/// has none. Throws Error likewise.
std::vector<std::array<std::int64_t, 3>> read_faces(const std::string& path,
                                                    const Progress& progress);
std::vector<std::array<std::int64_t, 3>> read_faces(const UnpackedFile& file,
                                                    const Progress& progress);

}  // namespace prefilter
