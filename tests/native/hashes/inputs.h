// SPDX-License-Identifier: GPL-3.0-or-later

// Inputs of the hashed functions, made by arithmetic alone, so that they are the same everywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/image.h"
#include "prefilter/base/outline.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/points/point_source.h"

namespace prefilter::hashes {

/// Numbers as good as random.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// In [low, high).
  double between(double low, double high);

 private:
  std::uint64_t state_;
};

/// Ramps, edges and noise in [0, 1]; the last of four channels is coverage.
Image picture(int width, int height, int channels);

/// Tiles for encoders of blocks, RGBA: of one color, ramps, two colors, steps, gray, and noise of
/// any size, each with an alpha that is full, none, or any of these; in [0, 1], also the ends.
Image tiles(int size);

/// The same of half floats that are finite: from the least to the greatest, and negative ones; an
/// alpha in [0, 1].
std::vector<std::uint16_t> half_tiles(int size);

/// Unit vectors, each component c stored as (c + 1) / 2.
Image normal_map(int width, int height);

struct Torus {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<double> uvs;  // triangles x 3 corners x 2

  InputMesh mesh() const { return {positions, triangles}; }
};

/// A bumpy torus around an axis that leans by so much, of radius 2 and 0.7.
Torus torus(int around, int across, double lean);

/// A surface for baking: the torus with its UV map.
Surface surface_of(const Torus& torus);

/// Points with normals on that torus, off by a little.
class TorusPoints : public PointSource {
 public:
  explicit TorusPoints(std::size_t count);

  std::optional<std::size_t> count() const override { return batch_.positions.size(); }
  bool has_normals() const override { return true; }
  const std::vector<PointAttribute>& attributes() const override { return attributes_; }
  void rewind() override { next_ = 0; }
  bool read(std::size_t most, PointBatch* batch) override;

  const std::vector<Vector3>& positions() const { return batch_.positions; }

 private:
  PointBatch batch_;
  std::vector<PointAttribute> attributes_;
  std::size_t next_ = 0;
};

/// Letters, as it were: lines, curves and conics, which cross.
Outline drawing(double size);

}  // namespace prefilter::hashes
