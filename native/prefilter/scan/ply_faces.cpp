// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/scan/ply_faces.h"

#include <string_view>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/scan/ply_file.h"

namespace prefilter {
namespace {

// The property with the indices of points, in an element.
std::size_t index_list(const PlyFile& file, const PlyElement& element) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    const std::size_t found = element.find(name);
    if (found < element.properties.size() && element.properties[found].count_type) return found;
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

// What a line "obj_info num_rows 400" tells.
std::uint64_t grid_size(const PlyFile& file, std::string_view name) {
  for (const std::string& info : file.obj_info()) {
    std::string_view rest = info;
    std::uint64_t size = 0;
    if (take_word(&rest) == name && to_count(take_word(&rest), &size)) return size;
  }
  throw_invalid(file.name() + ": there is a range grid, but no line 'obj_info " +
                std::string(name) + "' with a whole number");
}

// Now and then, as a look at the clock takes longer than a row.
void report_rows(const PlyFile& file, std::uint64_t count, const Progress& progress) {
  constexpr std::uint64_t kRowsPerReport = 1 << 12;
  if (file.rows_left() % kRowsPerReport != 0) return;
  progress.report(1.0 - static_cast<double>(file.rows_left()) / static_cast<double>(count));
}

std::optional<RangeGrid> range_grid_of(PlyFile file, const Progress& progress) {
  const std::size_t found = file.find("range_grid");
  if (found == file.elements().size()) return std::nullopt;
  const PlyElement& element = file.elements()[found];
  const std::uint64_t rows = grid_size(file, "num_rows");
  const std::uint64_t columns = grid_size(file, "num_cols");
  // A quotient, as a product of what a file says can be too large.
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
  file.go_to(found, progress);
  while (file.rows_left() > 0) {
    report_rows(file, file.elements()[found].count, progress);
    file.read_row();
    const std::span<const double> points = file.list(list);
    grid.points.push_back(points.empty() ? -1 : checked_index(file, points[0], count));
  }
  return grid;
}

std::vector<std::array<std::int64_t, 3>> faces_of(PlyFile file, const Progress& progress) {
  std::vector<std::array<std::int64_t, 3>> triangles;
  const std::size_t found = file.find("face");
  if (found == file.elements().size()) return triangles;
  const std::size_t list = index_list(file, file.elements()[found]);
  const std::uint64_t count = point_count(file);
  std::vector<std::int64_t> corners;
  file.go_to(found, progress);
  while (file.rows_left() > 0) {
    report_rows(file, file.elements()[found].count, progress);
    file.read_row();
    corners.clear();
    for (const double index : file.list(list)) {
      corners.push_back(checked_index(file, index, count));
    }
    for (std::size_t k = 2; k < corners.size(); ++k) {
      triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  file.check_end();
  return triangles;
}

}  // namespace

std::optional<RangeGrid> read_range_grid(const std::string& path, const Progress& progress) {
  return range_grid_of(PlyFile(ByteReader(path)), progress);
}

std::optional<RangeGrid> read_range_grid(const UnpackedFile& file, const Progress& progress) {
  return range_grid_of(PlyFile(ByteReader(file.file())), progress);
}

std::vector<std::array<std::int64_t, 3>> read_faces(const std::string& path,
                                                    const Progress& progress) {
  return faces_of(PlyFile(ByteReader(path)), progress);
}

std::vector<std::array<std::int64_t, 3>> read_faces(const UnpackedFile& file,
                                                    const Progress& progress) {
  return faces_of(PlyFile(ByteReader(file.file())), progress);
}

}  // namespace prefilter
