// SPDX-License-Identifier: GPL-3.0-or-later

// Parts of a mesh that is to be cut, kept until it is known where: in memory, or in a file.
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

/// A facet divided into triangles around its middle: which those are, and its corners.
struct CutFan {
  std::uint32_t first;
  std::uint32_t count;
  std::array<std::uint32_t, 3> corners;
};

/// Vertices are those that triangles of the part name, also where earlier parts have them.
struct CutPart {
  std::vector<Vector3> positions;
  std::vector<float> attributes;
  std::vector<std::int64_t> ids;                        // of vertices, in the whole mesh
  std::vector<std::int32_t> components;                 // of vertices
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices of the part
  std::vector<CutFan> fans;                             // in the order of their triangles
  std::vector<std::int64_t> kept;                       // ids that later parts may have

  std::size_t size() const { return positions.size(); }
};

class CutParts {
 public:
  /// What is held is at most `memory_limit` bytes, but for one part; the rest goes to a file in a
  /// folder.
  CutParts(std::uint64_t memory_limit, std::string folder)
      : memory_limit_(memory_limit), folder_(std::move(folder)) {}

  void add(CutPart part);
  std::size_t count() const { return parts_.size(); }
  bool is_spilled() const { return file_ != nullptr; }
  /// A part, for the last time.
  CutPart take(std::size_t index);

 private:
  struct Entry {
    CutPart part;
    bool is_in_file = false;
    std::uint64_t offset = 0;
    std::array<std::size_t, 7> sizes{};  // of its arrays
  };

  std::uint64_t memory_limit_;
  std::string folder_;
  std::uint64_t held_ = 0;  // bytes
  std::vector<Entry> parts_;
  std::unique_ptr<TemporaryFile> file_;
};

}  // namespace prefilter
