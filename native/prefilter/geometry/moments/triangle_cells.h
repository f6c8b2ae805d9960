// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles that carry a mass, cut along a unit grid: the primitive under every surface-weighted
// filter.
//
// A triangle's mass (its area in space) is spread evenly over it, in barycentric space. Its image
// in the grid may be a segment or a point, and the mass is still all there (section 7.2: integrate
// over the triangles, not over their images, so that no Jacobian is ever inverted).
#pragma once

#include <array>
#include <cmath>

#include "prefilter/geometry/moments/cell_moments.h"

namespace prefilter {

struct GridPoint {
  double x, y;
};

/// A triangle in grid units with a mass. Any winding.
struct MassTriangle {
  std::array<GridPoint, 3> corners;
  double mass = 0.0;
};

/// The cells [x0, x1) x [y0, y1).
struct CellWindow {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

/// A convex piece of a triangle, cut to a cell or to a window of cells.
struct CellPiece {
  // A triangle cut by four half-planes has at most seven corners.
  static constexpr int kMaxCorners = 7;
  std::array<GridPoint, kMaxCorners> corners;
  // Where they are in the triangle, in two barycentric coordinates, if `is_barycentric`.
  std::array<GridPoint, kMaxCorners> sources;
  int count = 0;
  // Mass by area, in the grid or, if `is_barycentric`, in those coordinates.
  double mass_per_area = 0.0;
  // Its corners in the grid do not tell its mass: it is all but flat there, or they were moved.
  bool is_barycentric = false;

  double mass() const;
  /// Adds the mass and moments of the piece in the coordinates of the unit cell whose low corner is
  /// given.
  void add_moments(double cell_x, double cell_y, WeightMoments* moments) const;
};

/// What a triangle leaves in the cells of a window.
class CellSink {
 public:
  /// The cells [x0, x1) of row y lie inside of the triangle; each takes `density`, which is mass by
  /// area.
  virtual void add_full(int y, int x0, int x1, double density) = 0;
  /// A piece of the triangle, of positive mass, lies in cell (x, y).
  virtual void add_piece(int x, int y, const CellPiece& piece) = 0;

 protected:
  ~CellSink() = default;
};

/// Cuts a triangle along the cells of a window. Cells are half-open for what lies exactly on a grid
/// line, so every piece goes to exactly one cell, and over a grid of windows the masses add up to
/// the triangle's.
void cut_to_cells(const MassTriangle& triangle, const CellWindow& window, CellSink* sink);

/// The span of cells that [low, high] meets: floor(low) to the last cell with some of its inside in
/// it, or for low == high the one cell that owns the point.
struct CellSpan {
  int first = 0;
  int last = 0;  // inclusive
};
CellSpan cell_span(double low, double high);

/// Corners of a convex polygon cut in two along x (axis 0) or y (axis 1) = value. Points on the
/// line belong to both sides. Exposed for the cuts along texture tiles.
void split_piece(const CellPiece& piece, int axis, double value, CellPiece* low, CellPiece* high);

/// The piece that is the whole triangle: barycentric where it is all but flat, or where asked for.
CellPiece whole_piece(const MassTriangle& triangle, bool is_barycentric = false);

}  // namespace prefilter
