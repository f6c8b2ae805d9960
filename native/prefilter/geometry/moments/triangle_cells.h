// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts triangles with a mass along a unit grid, the basic operation of every surface-weighted
// filter.
//
// A triangle's mass (its area in space) is spread uniformly over it in barycentric coordinates.
// Even if its image in the grid is a segment or a point, its mass is complete (section 7.2:
// integrate over the triangles, not over their images, so that no Jacobian is ever inverted).
#pragma once

#include <array>
#include <cmath>

#include "prefilter/geometry/moments/cell_moments.h"

namespace prefilter {

struct GridPoint {
  double x, y;
};

/// A triangle in grid units, in either orientation, with its mass.
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

/// A convex piece of a triangle, clipped to a cell or a window of cells.
struct CellPiece {
  // A triangle cut by four half-planes has at most seven corners.
  static constexpr int kMaxCorners = 7;
  std::array<GridPoint, kMaxCorners> corners;
  // The corners in two barycentric coordinates of the triangle, if `is_barycentric`.
  std::array<GridPoint, kMaxCorners> sources;
  int count = 0;
  // Mass per area, in the grid or, if `is_barycentric`, in barycentric coordinates.
  double mass_per_area = 0.0;
  // Whether the mass cannot be computed from the corners in the grid, because the piece is nearly
  // flat there or its corners were moved.
  bool is_barycentric = false;

  double mass() const;
  /// Adds mass and moments of the piece, in coordinates of the unit cell with the given low corner.
  void add_moments(double cell_x, double cell_y, WeightMoments* moments) const;
};

/// Receives the parts of a triangle in the cells of a window.
class CellSink {
 public:
  /// The cells [x0, x1) of row y lie inside the triangle; each receives `density`, its mass per
  /// area.
  virtual void add_full(int y, int x0, int x1, double density) = 0;
  /// A piece of the triangle with positive mass lies in cell (x, y).
  virtual void add_piece(int x, int y, const CellPiece& piece) = 0;

 protected:
  ~CellSink() = default;
};

/// Cuts a triangle along the cells of a window. Cells are half-open for geometry exactly on grid
/// lines, so each piece belongs to exactly one cell, and over a grid of windows the masses sum to
/// the triangle's.
void cut_to_cells(const MassTriangle& triangle, const CellWindow& window, CellSink* sink);

/// The cells that overlap [low, high]: from floor(low) to the last cell with interior points in it,
/// or for low == high the one cell that contains the point.
struct CellSpan {
  int first = 0;
  int last = 0;  // inclusive
};
CellSpan cell_span(double low, double high);

/// Splits a convex polygon at x (axis 0) or y (axis 1) = value. Points on the line belong to both
/// parts.
void split_piece(const CellPiece& piece, int axis, double value, CellPiece* low, CellPiece* high);

/// The whole triangle as a piece; barycentric if it is nearly flat or if requested.
CellPiece whole_piece(const MassTriangle& triangle, bool is_barycentric = false);

}  // namespace prefilter
