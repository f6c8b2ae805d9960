// SPDX-License-Identifier: GPL-3.0-or-later

// Writes meshes larger than memory to PLY files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "prefilter/base/point_attribute.h"
#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"

namespace prefilter {

/// Writes binary little-endian PLY. Vertices are written as they arrive; triangles, which follow
/// them in the file, are kept in a temporary file beside it until the end. Attributes become
/// properties of the same name, "uchar" or "float"; invalid characters in names become "_". All
/// functions throw Error(kFile) if the system fails, for example on a full disk; the message gives
/// the file and the number of bytes. Without finish() no file is left.
class PlyMeshWriter final : public MeshSink {
 public:
  /// `is_double`: writes positions in double instead of single precision.
  PlyMeshWriter(const std::string& path, std::vector<PointAttribute> attributes, bool is_double);
  ~PlyMeshWriter() override;

  /// Throws Error for more vertices than PLY can index, 2^32 - 1.
  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override;
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override;

  std::size_t vertex_count() const;
  std::size_t triangle_count() const;

  /// Moves the file to its target. Reports progress from 0 to 1; cancellation leaves the target
  /// unchanged.
  void finish(const Run& run);

 private:
  class Files;
  std::unique_ptr<Files> files_;
};

}  // namespace prefilter
