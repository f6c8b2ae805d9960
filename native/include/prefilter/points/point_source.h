// SPDX-License-Identifier: GPL-3.0-or-later

// Interface for reading points: from an array, or from a file larger than memory.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/point_attribute.h"

namespace prefilter {

/// A batch of points.
struct PointBatch {
  std::vector<Vector3> positions;
  // One for each point, or empty. Outward, of any length; zero if unknown.
  std::vector<std::array<float, 3>> normals;
  // The weight of each point (a scanner's confidence), at least 0; empty if all are 1.
  std::vector<float> weights;
  // The scanner's position for each point, if it differs within the source; otherwise empty.
  std::vector<Vector3> viewpoints;
  // For each point, one value per attribute of the source.
  std::vector<float> attributes;
  // Index of the cloud, if several clouds are joined.
  std::size_t cloud = 0;

  void clear() {
    positions.clear();
    normals.clear();
    weights.clear();
    viewpoints.clear();
    attributes.clear();
  }
};

/// Keeps the points of a batch selected by `is_kept`, each with `attribute_count` attributes.
void keep_points(const std::vector<bool>& is_kept, std::size_t attribute_count, PointBatch* batch);

/// Points in a fixed order, which can be read repeatedly from first to last.
class PointSource {
 public:
  virtual ~PointSource() = default;

  /// Number of points, if known before reading.
  virtual std::optional<std::size_t> count() const = 0;
  virtual bool has_normals() const = 0;
  /// Whether normals point outward; otherwise their sign is unknown.
  virtual bool are_normals_directed() const { return true; }
  /// The attributes in every batch, in this order.
  virtual const std::vector<PointAttribute>& attributes() const = 0;
  /// The scanner's position, in the points' coordinates; nothing if batches have it, or it is
  /// unknown.
  virtual std::optional<Vector3> viewpoint() const { return std::nullopt; }
  /// Whether positions need double precision.
  virtual bool is_double() const { return false; }
  /// Warnings about the file, as far as it has been read; each names the file.
  virtual std::vector<std::string> warnings() const { return {}; }
  /// Number of rows that points come from, if ranges of rows can be read directly; otherwise
  /// nothing. Includes rows that were not chosen.
  virtual std::optional<std::size_t> rows() const { return std::nullopt; }

  /// Rewinds, and restricts the source to the rows [begin, end). Only for sources with `rows`.
  virtual void choose_rows(std::size_t /*begin*/, std::size_t /*end*/) {}

  /// Returns to the first point.
  virtual void rewind() = 0;
  /// Replaces the batch by the next points, at most `most`; returns false at the end. Values that
  /// are not finite are passed on. Throws Error if a file is damaged or cannot be read; the message
  /// names the file and the position.
  virtual bool read(std::size_t most, PointBatch* batch) = 0;
};

/// Base of sources that modify the points of another source, which must outlive it. Everything is
/// forwarded to that source by default.
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
