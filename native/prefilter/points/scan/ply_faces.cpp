// SPDX-License-Identifier: GPL-3.0-or-later

// Polygons, UVs and range grids of PLY files.
#include "prefilter/points/ply_faces.h"

#include <initializer_list>
#include <string_view>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/polygon_triangles.h"
#include "prefilter/points/scan/ply_file.h"

namespace prefilter {
namespace {

// Index of the list of vertex indices in an element.
std::size_t index_list(const PlyFile& file, const PlyElement& element) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    const std::size_t index = element.find(name);
    if (index < element.properties.size() && element.properties[index].count_type) return index;
  }
  throw_invalid(file.name() + ": " + element.name + " has no list 'vertex_indices'");
}

std::uint64_t point_count(const PlyFile& file) {
  const std::size_t vertex = file.find("vertex");
  return vertex < file.elements().size() ? file.elements()[vertex].count : 0;
}

std::int64_t checked_index(const PlyFile& file, double index, std::uint64_t count) {
  if (!(index >= 0.0 && index < static_cast<double>(count))) {
    file.throw_here("names point " + to_text(index) + "; there are " + std::to_string(count) +
                    ", numbered from 0");
  }
  return static_cast<std::int64_t>(index);
}

// The number in a line such as "obj_info num_rows 400".
std::uint64_t grid_size(const PlyFile& file, std::string_view name) {
  for (const std::string& info : file.obj_info()) {
    std::string_view rest = info;
    std::uint64_t size = 0;
    if (take_word(&rest) == name && to_count(take_word(&rest), &size)) return size;
  }
  throw_invalid(file.name() + ": there is a range grid, but no line 'obj_info " +
                std::string(name) + "' with a whole number");
}

// Reports rarely, as reading the clock takes longer than a row.
void report_rows(const PlyFile& file, std::uint64_t count, const Run& run) {
  constexpr std::uint64_t kRowsPerReport = 1 << 12;
  if (file.rows_left() % kRowsPerReport != 0) return;
  run.report(1.0 - static_cast<double>(file.rows_left()) / static_cast<double>(count));
}

std::optional<RangeGrid> range_grid_of(PlyFile file, const Run& run) {
  const std::size_t element_index = file.find("range_grid");
  if (element_index == file.elements().size()) return std::nullopt;
  const PlyElement& element = file.elements()[element_index];
  const std::uint64_t rows = grid_size(file, "num_rows");
  const std::uint64_t columns = grid_size(file, "num_cols");
  // Divides, as the product of numbers from a file may overflow.
  const bool fits = columns == 0 ? element.count == 0
                                 : element.count / columns == rows && element.count % columns == 0;
  if (!fits) {
    throw_invalid(file.name() + ": a range grid of " + std::to_string(element.count) +
                  " places; its header says " + std::to_string(rows) + " rows of " +
                  std::to_string(columns));
  }
  const std::size_t list = index_list(file, element);
  const std::uint64_t count = point_count(file);
  RangeGrid grid{static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns), {}};
  file.go_to(element_index, run);
  while (file.rows_left() > 0) {
    report_rows(file, file.elements()[element_index].count, run);
    file.read_row();
    const std::span<const double> points = file.list(list);
    grid.points.push_back(points.empty() ? -1 : checked_index(file, points[0], count));
  }
  return grid;
}

// Indices of the first group of names that the element has scalars for.
std::optional<std::vector<std::size_t>> scalars_named(
    const PlyElement& element, std::initializer_list<std::vector<const char*>> names) {
  for (const std::vector<const char*>& group : names) {
    std::vector<std::size_t> indices;
    for (const char* name : group) {
      const std::size_t at = element.find(name);
      if (at < element.properties.size() && !element.properties[at].count_type)
        indices.push_back(at);
    }
    if (indices.size() == group.size()) return indices;
  }
  return std::nullopt;
}

// Reads positions; returns the UVs of vertices, if there are any.
std::vector<std::array<double, 2>> read_vertices(PlyFile* file, const Run& run, PlyMesh* mesh) {
  std::vector<std::array<double, 2>> uvs;
  const std::size_t vertex = file->find("vertex");
  if (vertex == file->elements().size()) return uvs;
  const PlyElement& element = file->elements()[vertex];
  const auto axes = scalars_named(element, {{"x", "y", "z"}});
  if (!axes) throw_invalid(file->name() + ": its element 'vertex' has no x, y and z");
  const auto uv = scalars_named(element, {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}});
  file->go_to(vertex, run);
  while (file->rows_left() > 0) {
    report_rows(*file, element.count, run);
    file->read_row();
    const std::span<const double> values = file->scalars();
    mesh->positions.push_back({values[(*axes)[0]], values[(*axes)[1]], values[(*axes)[2]]});
    if (uv) uvs.push_back({values[(*uv)[0]], values[(*uv)[1]]});
  }
  return uvs;
}

PlyMesh mesh_of(PlyFile file, const Run& run) {
  PlyMesh mesh;
  const std::size_t face = file.find("face");
  const bool has_faces = face < file.elements().size();
  const std::size_t list = has_faces ? index_list(file, file.elements()[face]) : 0;
  const Stages stages(run, {1, 1});
  const auto uvs = read_vertices(&file, stages[0], &mesh);
  if (!has_faces) return mesh;
  const PlyElement& element = file.elements()[face];
  const std::size_t texcoord = element.find("texcoord");
  const bool has_texcoord =
      texcoord < element.properties.size() && element.properties[texcoord].count_type;
  bool all_have_texcoords = has_texcoord;
  file.go_to(face, run);
  while (file.rows_left() > 0) {
    report_rows(file, element.count, stages[1]);
    file.read_row();
    const std::span<const double> corners = file.list(list);
    for (const double index : corners) {
      mesh.corners.push_back(checked_index(file, index, mesh.positions.size()));
    }
    mesh.sizes.push_back(static_cast<std::int64_t>(corners.size()));
    if (!has_texcoord) continue;
    const std::span<const double> own = file.list(texcoord);
    all_have_texcoords = all_have_texcoords && own.size() == 2 * corners.size();
    for (std::size_t k = 0; all_have_texcoords && k < corners.size(); ++k) {
      mesh.uvs.push_back({own[2 * k], own[2 * k + 1]});
    }
  }
  if (const std::string surplus = file.surplus(); !surplus.empty()) throw_invalid(surplus);
  if (all_have_texcoords) return mesh;
  mesh.uvs.clear();
  if (uvs.empty()) return mesh;
  for (const std::int64_t vertex : mesh.corners) {
    mesh.uvs.push_back(uvs[static_cast<std::size_t>(vertex)]);
  }
  return mesh;
}

std::vector<std::array<std::int64_t, 3>> faces_of(PlyFile file, const Run& run) {
  if (file.find("face") == file.elements().size()) return {};
  const Stages stages(run, {9, 1});
  const PlyMesh mesh = mesh_of(std::move(file), stages[0]);
  auto triangles = triangulate_polygons(mesh.positions, mesh.corners, mesh.sizes, stages[1]);
  for (auto& corners : triangles) {
    for (std::int64_t& corner : corners) corner = mesh.corners[static_cast<std::size_t>(corner)];
  }
  return triangles;
}

}  // namespace

std::optional<RangeGrid> read_range_grid(const std::string& path, const Run& run) {
  return range_grid_of(PlyFile(ByteReader(path)), run);
}

std::optional<RangeGrid> read_range_grid(const UnpackedFile& file, const Run& run) {
  return range_grid_of(PlyFile(ByteReader(file.file())), run);
}

PlyMesh read_ply_mesh(const std::string& path, const Run& run) {
  return mesh_of(PlyFile(ByteReader(path)), run);
}

std::vector<std::array<std::int64_t, 3>> read_faces(const std::string& path, const Run& run) {
  return faces_of(PlyFile(ByteReader(path)), run);
}

std::vector<std::array<std::int64_t, 3>> read_faces(const UnpackedFile& file, const Run& run) {
  return faces_of(PlyFile(ByteReader(file.file())), run);
}

}  // namespace prefilter
