// SPDX-License-Identifier: GPL-3.0-or-later

// Several scans as one cloud.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/scan/point_source.h"

namespace prefilter {

/// The points of sources, one after the other; the sources must outlive it.
///
/// It has all attributes of all sources, by name, each in the form that it has in the first source
/// that has it. Points of a source without an attribute get 0; colors ("red", "green", "blue" and
/// "alpha", or these behind a name and a dot) get white. Bytes of colors are encoded by the sRGB
/// curve, but for alpha; as floats they are linear, 1 for 255.
class JoinedPoints final : public PointSource {
 public:
  /// Throws Error for no sources, or where only some have normals.
  explicit JoinedPoints(std::vector<PointSource*> sources);

  std::optional<std::size_t> count() const override;
  bool has_normals() const override { return sources_.front()->has_normals(); }
  const std::vector<PointAttribute>& attributes() const override { return attributes_; }
  bool is_double() const override;
  void rewind() override;
  bool read(std::size_t most, PointBatch* batch) override;
  /// From now on, has the points of one source alone, as they are in the whole.
  void choose(std::size_t source);

 private:
  // Where an attribute of the cloud comes from in a source.
  struct Column {
    std::optional<std::size_t> from;
    bool is_byte = false;  // there
  };

  std::vector<float> carried(const std::vector<float>& values, std::size_t points) const;

  std::vector<PointSource*> sources_;
  std::vector<PointAttribute> attributes_;
  std::vector<std::vector<Column>> columns_;  // of each source, one for each attribute
  std::size_t first_ = 0;
  std::size_t end_;
  std::size_t current_ = 0;
};

}  // namespace prefilter
