// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts outlines along the finest cells of a strip of rows, and sums their fluxes per brick.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/geometry/moments/monotone_polynomials.h"
#include "prefilter/wavelet/plane_flux.h"

namespace prefilter {

/// Cells of a brick along an axis: 2^kPlaneBrickDepth.
inline constexpr int kPlaneBrickDepth = 3;
inline constexpr int kPlaneBrickSide = 1 << kPlaneBrickDepth;

/// The cells of interest, [0, width) x [0, height) of the root, a square of 2^depth cells per side.
struct PlaneGrid {
  static constexpr int kMostDepth = 24;

  PlaneGrid() = default;
  /// Width and height are from 1 to 2^kMostDepth.
  PlaneGrid(int width_, int height_);

  int width = 1;
  int height = 1;
  int depth = kPlaneBrickDepth;  // at least
};

/// The coefficients in a brick of cells that curves pass through.
struct PlaneBrick {
  /// The brick's low corner, in bricks.
  int x = 0;
  int y = 0;
  /// Bit i: curves affect the i-th cell in Morton order.
  std::uint64_t touched = 0;
  /// Coefficients of the brick, its 4 quadrants, and their 16 quadrants, in Morton order.
  std::array<QuadrantSteps<float>, 21> steps;
};

/// The result for a strip: bricks in unspecified order, and their fluxes.
struct StripBricks {
  std::vector<PlaneBrick> bricks;
  std::vector<PlaneFlux> fluxes;
  /// Flux of the parts outside the grid, moved to the root's sides, in cell coordinates.
  PlaneFlux at_sides;
};

/// Accumulates curves at arbitrary positions. Parts outside the grid are moved to its nearest
/// points, which does not change winding numbers inside.
///
/// Coordinates, and the integrals of arcs, are rounded to 2^-26 of a cell. So sums are exact in any
/// order, and closed contours contribute exactly 0 to cells that they do not pass.
class OutlineStrip {
 public:
  /// Starts rows [first_row, end_row) of the grid, both multiples of a brick's side unless the grid
  /// ends there.
  void begin(const PlaneGrid& grid, int first_row, int end_row);

  /// Adds a curve in cell coordinates; the region on its left counts `sign` times.
  void add(const MonotoneCurve& piece, double sign);
  void add_line(const Point2& begin, const Point2& end, double sign);

  /// Returns the result since the beginning or the last call.
  StripBricks take();

 private:
  struct CellBrick {
    std::array<PlaneFlux, kPlaneBrickSide * kPlaneBrickSide> cells;  // in Morton order
  };
  struct BrickPlace {
    int x = 0;
    int y = 0;
  };
  // The crossings of a piece with grid lines along one axis, in order.
  struct Crossings {
    std::vector<double> s;
    std::vector<double> other;  // coordinate along the other axis
    std::vector<double> area;
    int count = 0;

    template <bool kIsCubic>
    void find(const MonotonePolynomials& piece, int axis, int first, int step, int count_);
  };

  PlaneFlux& cell(int column, int row);
  int new_brick(int x, int y);
  bool is_inside(const Point2& a, const Point2& b) const;
  template <typename Pass, typename Inside>
  void clip(const MonotoneCurve& piece, double sign, const Pass& pass, const Inside& inside);
  void add_at_sides(const Point2& a, const Point2& b, double sign);
  void add_inner_line(const Point2& begin, const Point2& end, double sign);
  void add_inner_curve(const MonotoneCurve& piece, double sign);
  template <bool kIsCubic>
  void add_inner_polynomials(const MonotoneCurve& piece, double sign);
  void add_chord(int column, int row, Point2 begin, Point2 end, double sign);

  PlaneGrid grid_;
  int first_row_ = 0;
  int end_row_ = 0;
  int bricks_across_ = 0;
  std::vector<std::int32_t> slots_;  // per brick of the strip: its index in pool_, or -1
  std::vector<CellBrick> pool_;
  std::vector<BrickPlace> places_;
  PlaneFlux at_sides_;
  Crossings columns_;
  Crossings rows_;
};

}  // namespace prefilter
