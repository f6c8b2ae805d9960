// SPDX-License-Identifier: GPL-3.0-or-later

// Measures how well samples support the surface: the distance of a point from them, relative to
// their spacing, which distinguishes holes in dense parts of a scan from thin parts.
//
// Samples support only surfaces that face the same way: the back that closes a sheet is far from
// all of them.
//
// Samples count at the depth of their leaf, the finest at which others are around them, so the
// leaf's side approximates their spacing; the area per sample gives it more exactly.
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
  std::array<float, 3> position{};  // mean sample, in finest cells from the root's corner
  std::array<float, 3> normal{};    // zero: matches all directions
  float reach = 1.0F;               // radius of surface that a sample represents, in finest cells
  float spacing = 1.0F;             // between samples, in finest cells
};

/// Appends the cells of depth `k` of a slab, at the given heights, with samples that count at
/// exactly that depth, in order of their keys. The slab must be at kLeaves; `finest` is the depth
/// of finest cells.
void add_support(const SampleSlab& slab, int k, const HeightRange& heights, int finest,
                 double mean_weight, std::vector<SupportCell>* cells);

/// A point of a surface, in finest cells, and a normal of any length.
struct OrientedPoint {
  Vector3 position;
  Vector3 normal;
};

/// Support of a point by the samples near it.
struct Support {
  float distance = 0.0F;  // to the nearest sample, in units of its reach
  float spacing = 1.0F;   // between the nearest samples, in finest cells
};

/// The cells of one depth at some heights, indexed by rows.
class SupportLevel {
 public:
  /// Cells must be in order of their keys, and at these heights, which must lie within the root.
  SupportLevel(int depth, const HeightRange& heights, std::vector<SupportCell> cells);

  bool is_empty() const { return cells_.empty(); }
  /// Lowers `best` to the support of a point by cells within `reach` cells.
  void lower_to_nearest(const OrientedPoint& point, double side, int reach, Support* best) const;

 private:
  template <typename Visit>
  void for_near(const CellPosition& at, int reach, const Visit& visit) const;
  void begin_rows();

  int side_;
  int low_;
  int high_;
  std::vector<SupportCell> cells_;
  std::vector<std::uint32_t> rows_;  // offset of each row's first cell
};

/// Support of the surface in one slab. The adjacent slabs must be at kLeaves.
class SupportField {
 public:
  /// `sign` is -1 where the samples' normals point inward.
  SupportField(const Slabs& slabs, double sign, int s);

  /// Support of a point next to leaves of depth `k`. Distances are measured to the mean samples of
  /// cells; beyond kExact reaches they are only accurate to about 1/10.
  Support at(OrientedPoint point, int k);

  // Distance, in reaches, up to which the nearest sample is found.
  static constexpr double kExact = 4.0;

 private:
  SupportLevel level_of(int k) const;
  SupportLevel crossed_level_of(int k) const;
  Support far_support(const OrientedPoint& point);
  double side(int k) const;
  // Heights at depth `k` of the slab and `reach` cells around it.
  HeightRange heights_around(int k, int reach) const;

  const Slabs& slabs_;
  double sign_;
  int s_;
  std::vector<SupportLevel> levels_;
  std::vector<std::optional<SupportLevel>> crossed_;  // all samples at a depth, built on demand
};

}  // namespace prefilter
