// SPDX-License-Identifier: GPL-3.0-or-later

// Several scans as one cloud.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points of sources, one after the other; the sources must outlive it.
///
/// It has all attributes of all sources, by name, each in the form that it has in the first source
/// that has it. Points of a source without an attribute get 0; colors ("red", "green", "blue" and
/// "alpha", or these behind a name and a dot) get white. Bytes of colors are encoded by the sRGB
/// curve, but for alpha; as floats they are linear, 1 for 255.
///
/// Sources that have `rows` can be cut into shares, and each is a cloud by itself: what is summed
/// up of it is the same whether it is read with the others or alone.
class JoinedPoints final : public PointSource {
 public:
  /// `rows_a_share` is how many rows a share has at the most. Throws Error for no sources, or where
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
  /// Shares of all sources, one at least of each.
  std::size_t share_count() const { return shares_.size(); }
  /// From now on, has the points of one share alone, as they are in the whole.
  void choose_share(std::size_t share);

 private:
  // All rows of a source where these are not known.
  struct Share {
    std::size_t source;
    std::size_t begin = 0;
    std::optional<std::size_t> end;
  };

  // Where an attribute of the cloud comes from in a source.
  struct Column {
    std::optional<std::size_t> from;
    bool is_byte = false;  // there
  };

  void add_shares(std::size_t source, std::size_t rows_a_share);
  void begin(const Share& share);
  std::vector<float> carried(std::size_t source, const std::vector<float>& values,
                             std::size_t points) const;

  std::vector<PointSource*> sources_;
  std::vector<PointAttribute> attributes_;
  std::vector<std::vector<Column>> columns_;  // of each source, one for each attribute
  std::vector<Share> shares_;
  std::size_t first_ = 0;  // of the shares that are chosen
  std::size_t end_ = 0;
  std::size_t current_ = 0;
  bool is_begun_ = false;
};

}  // namespace prefilter
