// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines cut along the finest cells of a strip of rows, and their fluxes summed up to bricks.
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

/// The cells that count: [0, width) x [0, height) of the root, a square of 2^depth cells a side.
struct PlaneGrid {
  static constexpr int kMostDepth = 24;

  PlaneGrid() = default;
  /// Width and height from 1 to 2^kMostDepth.
  PlaneGrid(int width_, int height_);

  int width = 1;
  int height = 1;
  int depth = kPlaneBrickDepth;  // at least that
};

/// The coefficients within a brick of cells that curves pass through.
struct PlaneBrick {
  /// Of which the brick's low corner is (x, y) times the side of a brick.
  int x = 0;
  int y = 0;
  /// Bit i: curves leave something in the i-th cell along the Morton curve.
  std::uint64_t touched = 0;
  /// Of the brick, of its 4 quadrants, and of their 16, along the Morton curve.
  std::array<QuadrantSteps<float>, 21> steps;
};

/// What the curves in a strip leave: bricks in no set order, with their fluxes.
struct StripBricks {
  std::vector<PlaneBrick> bricks;
  std::vector<PlaneFlux> fluxes;
  /// Of what is outside of the grid and was moved to the root's sides, in coordinates of cells.
  PlaneFlux at_sides;
};

/// Takes curves that lie where they may; those parts that are outside of the grid are moved to its
/// nearest points, by which no winding number in it changes.
///
/// Coordinates are rounded to 2^-26 of a cell, and the integrals of an arc too, so that sums are
/// exact whatever their order, and closed contours leave exactly nothing where they do not pass.
class OutlineStrip {
 public:
  /// For the rows [first_row, end_row) of the grid, both multiples of a brick's side unless the
  /// grid ends there.
  void begin(const PlaneGrid& grid, int first_row, int end_row);

  /// Adds a curve in coordinates of cells; the region on its left counts `sign` times.
  void add(const MonotoneCurve& piece, double sign);
  void add_line(const Point2& begin, const Point2& end, double sign);

  /// What has been added since it began or was last asked.
  StripBricks take();

 private:
  struct CellBrick {
    std::array<PlaneFlux, kPlaneBrickSide * kPlaneBrickSide> cells;  // along the Morton curve
  };
  struct BrickPlace {
    int x = 0;
    int y = 0;
  };
  // Where a piece passes lines of the grid along one axis, in its order.
  struct Passes {
    std::vector<double> s;
    std::vector<double> other;  // the coordinate along the other axis
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
  std::vector<std::int32_t> slots_;  // of each brick of the strip: its place in pool_, or -1
  std::vector<CellBrick> pool_;
  std::vector<BrickPlace> places_;
  PlaneFlux at_sides_;
  Passes columns_;
  Passes rows_;
};

}  // namespace prefilter
