// SPDX-License-Identifier: GPL-3.0-or-later

// Joins several scans to one cloud.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points of sources, one after the other; the sources must outlive this object.
///
/// The cloud has all attributes of all sources, by name, each in the representation of the first
/// source that has it. Where a source lacks an attribute, its points get 0, or white for colors
/// ("red", "green", "blue" and "alpha", or these after a prefix and a dot). Colors as bytes are
/// sRGB-encoded, except alpha; colors as floats are linear, with 1 for 255.
///
/// Sources that have `rows` can be split into shares. Each share is a cloud of its own: sums over
/// it are the same whether it is read alone or with others.
class JoinedPoints final : public PointSource {
 public:
  /// `rows_a_share` is the largest number of rows in a share. Throws Error for no sources, or if
  /// only some have normals.
  explicit JoinedPoints(std::vector<PointSource*> sources, std::size_t rows_a_share = kAllRows);

  static constexpr std::size_t kAllRows = std::numeric_limits<std::size_t>::max();

  std::optional<std::size_t> count() const override;
  bool has_normals() const override { return sources_.front()->has_normals(); }
  const std::vector<PointAttribute>& attributes() const override { return attributes_; }
  bool is_double() const override;
  std::vector<std::string> warnings() const override;
  void rewind() override;
  bool read(std::size_t most, PointBatch* batch) override;
  /// Number of shares of all sources, at least one per source.
  std::size_t share_count() const { return shares_.size(); }
  /// Restricts the cloud to one share, whose points are as in the whole.
  void choose_share(std::size_t share);

 private:
  // A range of rows, or the whole source if its rows are unknown.
  struct Share {
    std::size_t source;
    std::size_t begin = 0;
    std::optional<std::size_t> end;
  };

  // Origin of a cloud's attribute in a source.
  struct Column {
    std::optional<std::size_t> from;
    bool is_byte = false;  // in the source
  };

  void add_shares(std::size_t source, std::size_t rows_a_share);
  void begin(const Share& share);
  std::vector<float> convert_attributes(std::size_t source, const std::vector<float>& values,
                                        std::size_t points) const;

  std::vector<PointSource*> sources_;
  std::vector<PointAttribute> attributes_;
  std::vector<std::vector<Column>> columns_;  // of each source, one per attribute
  std::vector<Share> shares_;
  std::size_t first_ = 0;  // first chosen share
  std::size_t end_ = 0;
  std::size_t current_ = 0;
  bool is_begun_ = false;
};

}  // namespace prefilter
