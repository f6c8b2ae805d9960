// SPDX-License-Identifier: GPL-3.0-or-later

// How well samples support the surface: how far a point is from them, measured by how far they are
// from one another. A hole in a dense part of a scan is told from a thin part by that.
//
// Samples support what faces the way that they do: the back of a sheet, which closes it, is far
// from all of them.
//
// A sample counts at the depth of its leaf, the finest at which there are others around it, so the
// side of that leaf is about their spacing; the area for which each stands tells it more exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/sample_cell.h"
#include "prefilter/points/reconstruct/sample_slab.h"
#include "prefilter/voxels/contour/height_range.h"

namespace prefilter {

class Slabs;

/// The samples of a cell that count at its depth.
struct SupportCell {
  CellKey key = 0;
  std::array<float, 3> position{};  // their mean, in finest cells from the root's corner
  std::array<float, 3> normal{};    // zero: they face all ways
  float reach = 1.0F;               // how far each stands for the surface, in finest cells
  float spacing = 1.0F;             // between samples, in finest cells
};

/// Adds the cells of depth `k` of a slab, at some heights, with samples that count at just that
/// depth, in the order of their keys. The slab has its leaves; `finest` is the depth of finest
/// cells.
void add_support(const SampleSlab& slab, int k, const HeightRange& heights, int finest,
                 double mean_weight, std::vector<SupportCell>* cells);

/// A point of a surface, in finest cells, and where that faces there, in any length.
struct FacingPoint {
  Vector3 position;
  Vector3 normal;
};

/// What samples near a point tell.
struct Support {
  float distance = 0.0F;  // from the nearest, each in its own reach
  float spacing = 1.0F;   // of those that are nearest, in finest cells
};

/// The cells of one depth at some heights, by rows.
class SupportLevel {
 public:
  /// Cells in the order of their keys, all at these heights, which are within the root.
  SupportLevel(int depth, const HeightRange& heights, std::vector<SupportCell> cells);

  bool is_empty() const { return cells_.empty(); }
  /// Lowers `best` to what cells up to `reach` cells away support of a point.
  void look(const FacingPoint& point, double side, int reach, Support* best) const;

 private:
  template <typename Visit>
  void for_near(const CellPosition& at, int reach, const Visit& visit) const;
  void begin_rows();

  int side_;
  int low_;
  int high_;
  std::vector<SupportCell> cells_;
  std::vector<std::uint32_t> rows_;  // where they begin
};

/// What supports the part of a surface in one slab. The slabs next to it have their leaves.
class SupportField {
 public:
  /// `sign` is -1 where normals of samples point inward.
  SupportField(const Slabs& slabs, double sign, int s);

  /// Of a point; `k` is the depth of the leaves around it. Up to kExact reaches the
  /// distance is that of the means of samples in cells; beyond, it is right by about a tenth.
  Support at(FacingPoint point, int k);

  static constexpr double kExact = 4.0;

 private:
  SupportLevel level_of(int k) const;
  SupportLevel met_level_of(int k) const;
  Support far_support(const FacingPoint& point);
  double side(int k) const;
  // Up to so many cells away from the slab.
  HeightRange heights_around(int k, int reach) const;

  const Slabs& slabs_;
  double sign_;
  int s_;
  std::vector<SupportLevel> levels_;
  std::vector<std::optional<SupportLevel>> met_;  // of all samples at a depth, as far as needed
};

}  // namespace prefilter
