// SPDX-License-Identifier: GPL-3.0-or-later

// Meshes larger than memory, written to PLY files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "prefilter/base/point_attribute.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"

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
  ~PlyMeshWriter() override;

  /// Throws Error for more vertices than a PLY file can number, 2^32 - 1.
  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override;
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override;

  std::size_t vertex_count() const;
  std::size_t triangle_count() const;

  /// Puts the file in place. Reports 0 to 1; a cancel leaves things as they were.
  void finish(const Progress& progress);

 private:
  class Files;
  std::unique_ptr<Files> files_;
};

}  // namespace prefilter
