// SPDX-License-Identifier: GPL-3.0-or-later

// Meshes larger than memory, written to PLY files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "prefilter/base/point_attribute.h"
#include "prefilter/base/progress.h"
#include "prefilter/io/staged_file.h"
#include "prefilter/io/temporary_file.h"
#include "prefilter/mesh/mesh_sink.h"

namespace prefilter {

/// Writes binary little-endian PLY. Vertices go to the file as they come; triangles, which follow
/// them there, to a temporary file beside it until the end. Attributes are properties of their
/// names, "uchar" or "float"; characters that a name cannot have there become "_". All functions
/// throw Error(kFile) where the system refuses, as a full disk does; the message names the file
/// and the bytes. Without finish nothing is left.
class PlyMeshWriter final : public MeshSink {
 public:
  /// `is_double`: positions are written in double precision, else as floats.
  PlyMeshWriter(const std::string& path, std::vector<PointAttribute> attributes, bool is_double);

  /// Throws Error for more vertices than a PLY file can number, 2^32 - 1.
  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override;
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override;

  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t triangle_count() const { return triangle_count_; }

  /// Puts the file in place. Reports 0 to 1; a cancel leaves things as they were.
  void finish(const Progress& progress);

 private:
  std::string header(std::size_t size) const;
  void write_vertices();
  void write_triangles();

  StagedFile staged_;
  TemporaryFile triangles_;
  std::vector<PointAttribute> attributes_;
  bool is_double_;
  std::size_t header_size_;
  std::uint64_t vertices_end_;  // in the file
  std::size_t vertex_count_ = 0;
  std::size_t triangle_count_ = 0;
  // Not written yet.
  std::vector<std::byte> vertex_buffer_;
  std::vector<std::byte> triangle_buffer_;
};

}  // namespace prefilter
