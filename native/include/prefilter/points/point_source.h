// SPDX-License-Identifier: GPL-3.0-or-later

// Where points come from: an array, a file that is larger than memory.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/point_attribute.h"

namespace prefilter {

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
  // Of several clouds that are joined, which one it is from.
  std::size_t cloud = 0;

  void clear() {
    positions.clear();
    normals.clear();
    weights.clear();
    viewpoints.clear();
    attributes.clear();
  }
};

/// Keeps the points of a batch that `is_kept` says, each with so many attributes.
void keep_points(const std::vector<bool>& is_kept, std::size_t attribute_count, PointBatch* batch);

/// Points in an order that does not change, read from the first to the last as often as is needed.
class PointSource {
 public:
  virtual ~PointSource() = default;

  /// How many points there are, where that is known before they are read.
  virtual std::optional<std::size_t> count() const = 0;
  virtual bool has_normals() const = 0;
  /// Whether normals point outward; where not, some point inward, and which is not known.
  virtual bool are_normals_directed() const { return true; }
  /// What every batch carries, in this order.
  virtual const std::vector<PointAttribute>& attributes() const = 0;
  /// Where the scanner stood, in the points' coordinates; none where batches tell it, or nothing
  /// does.
  virtual std::optional<Vector3> viewpoint() const { return std::nullopt; }
  /// Whether positions need more than float precision (a file of doubles).
  virtual bool is_double() const { return false; }
  /// What is odd about the file, as far as it has been read; each names the file.
  virtual std::vector<std::string> warnings() const { return {}; }
  /// How many rows points come from, where some of these can be read without those before them;
  /// none where not. Rows that were not chosen count, too.
  virtual std::optional<std::size_t> rows() const { return std::nullopt; }

  /// Rewinds, and has the points of rows from `begin` up to `end` alone from now on. Only where
  /// there are `rows`.
  virtual void choose_rows(std::size_t /*begin*/, std::size_t /*end*/) {}

  /// Goes back to the first point.
  virtual void rewind() = 0;
  /// Replaces the batch by the next points, `most` at the most; false where there are no more.
  /// Values that are not finite are passed on as they are. Throws Error where a file is damaged or
  /// cannot be read; the message names it, and where in it.
  virtual bool read(std::size_t most, PointBatch* batch) = 0;
};

/// What changes the points of another source, which must outlive it, and knows of them what that
/// one does.
class ChangedPoints : public PointSource {
 public:
  explicit ChangedPoints(PointSource* source) : source_(source) {}

  std::optional<std::size_t> count() const override { return source_->count(); }
  bool has_normals() const override { return source_->has_normals(); }
  bool are_normals_directed() const override { return source_->are_normals_directed(); }
  const std::vector<PointAttribute>& attributes() const override { return source_->attributes(); }
  std::optional<Vector3> viewpoint() const override { return source_->viewpoint(); }
  bool is_double() const override { return source_->is_double(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }
  std::optional<std::size_t> rows() const override { return source_->rows(); }
  void choose_rows(std::size_t begin, std::size_t end) override {
    source_->choose_rows(begin, end);
  }
  void rewind() override { source_->rewind(); }

 protected:
  PointSource* source_;
};

}  // namespace prefilter
