// SPDX-License-Identifier: GPL-3.0-or-later

// Stores the parts of a mesh, in memory or in a file, until the regions to cut are known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/io/temporary_file.h"

namespace prefilter {

/// A facet divided into triangles around its middle: the range of those triangles, and its corners.
struct CutFan {
  std::uint32_t first;
  std::uint32_t count;
  std::array<std::uint32_t, 3> corners;
};

/// Contains every vertex that its triangles refer to, including vertices of earlier parts.
struct CutPart {
  std::vector<Vector3> positions;
  std::vector<float> attributes;
  std::vector<std::int64_t> ids;                        // of vertices, in the whole mesh
  std::vector<std::int32_t> components;                 // of vertices
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices of the part
  std::vector<CutFan> fans;                             // in order of their triangles
  std::vector<std::int64_t> shared_ids;  // vertex ids that later parts may refer to, sorted

  std::size_t size() const { return positions.size(); }
};

class CutParts {
 public:
  /// At most `memory_limit` bytes stay in memory; further parts go to a temporary file in `folder`.
  CutParts(std::uint64_t memory_limit, std::string folder)
      : memory_limit_(memory_limit), folder_(std::move(folder)) {}

  void add(CutPart part);
  std::size_t count() const { return parts_.size(); }
  bool is_spilled() const { return file_ != nullptr; }
  /// Returns a part and releases its memory; call once per part.
  CutPart take(std::size_t index);

 private:
  struct Entry {
    CutPart part;
    bool is_in_file = false;
    std::uint64_t offset = 0;
    std::array<std::size_t, 7> sizes{};  // lengths of its arrays
  };

  std::uint64_t memory_limit_;
  std::string folder_;
  std::uint64_t held_ = 0;  // bytes
  std::vector<Entry> parts_;
  std::unique_ptr<TemporaryFile> file_;
};

}  // namespace prefilter
