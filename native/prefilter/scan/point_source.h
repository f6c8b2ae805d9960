// SPDX-License-Identifier: GPL-3.0-or-later

// Where points come from: an array, a file that is larger than memory.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A value that points carry besides their normals; a colour is three of these.
struct PointAttribute {
  std::string name;      // of the PLY property: "red", "intensity"
  bool is_byte = false;  // stored as a byte, 0 to 255: rounded and clamped where it is written
};

/// Some points, with what is known of them.
struct PointBatch {
  std::vector<Vector3> positions;
  // One for each point, or none at all. Outward, of any length; zero where it is not known.
  std::vector<std::array<float, 3>> normals;
  // How much each point counts (a scanner's confidence), 0 and up; empty where all count 1.
  std::vector<float> weights;
  // For each point where the scanner stood that saw it, where that differs among the points of the
  // source; else none.
  std::vector<Vector3> viewpoints;
  // For each point one value for each attribute of the source.
  std::vector<float> attributes;

  void clear() {
    positions.clear();
    normals.clear();
    weights.clear();
    viewpoints.clear();
    attributes.clear();
  }
};

/// Points in an order that does not change, read from the first to the last as often as is needed.
class PointSource {
 public:
  virtual ~PointSource() = default;

  /// How many points there are, where that is known before they are read.
  virtual std::optional<std::size_t> count() const = 0;
  virtual bool has_normals() const = 0;
  /// What every batch carries, in this order.
  virtual const std::vector<PointAttribute>& attributes() const = 0;
  /// Where the scanner stood, in the points' coordinates; none where batches tell it, or nothing
  /// does.
  virtual std::optional<Vector3> viewpoint() const { return std::nullopt; }
  /// Whether positions need more than float precision (a file of doubles).
  virtual bool is_double() const { return false; }

  /// Goes back to the first point.
  virtual void rewind() = 0;
  /// Replaces the batch by the next points, `most` at the most; false where there are no more.
  /// Values that are not finite are passed on as they are. Throws Error where a file is damaged or
  /// cannot be read; the message names it, and where in it.
  virtual bool read(std::size_t most, PointBatch* batch) = 0;
};

/// Takes a mesh in pieces. Triangles name vertices by their place among all that were added.
class MeshSink {
 public:
  virtual ~MeshSink() = default;

  /// Attributes: for each vertex one value for each attribute of the points; none where the points
  /// have none.
  virtual void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) = 0;
  /// Triangles of vertices that were added before.
  virtual void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) = 0;
};

}  // namespace prefilter
