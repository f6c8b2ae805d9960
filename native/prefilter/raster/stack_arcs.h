// SPDX-License-Identifier: GPL-3.0-or-later

// What the outlines of a stack leave in the cells of a band, row by row.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/moments/cell_cutter.h"
#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/layer_stack.h"
#include "prefilter/raster/open_columns.h"

namespace prefilter {

/// Part of a monotone curve in a cell, from its lower end. Coordinates are from the cell's center.
struct StackArc {
  static constexpr std::uint32_t kLine = UINT32_MAX;

  Point2 low;
  Point2 high;
  std::int32_t column = 0;      // from the window's first
  std::int32_t winding = 1;     // what the number to its right is higher by than that to its left
  std::uint32_t curve = kLine;  // one of StackArcs::curve()
};

/// Where on a curve an arc is.
struct StackCurve {
  std::uint32_t piece = 0;
  double t_begin = 0.0;  // along the piece, which may fall
  double t_end = 1.0;
};

class StackArcs {
 public:
  /// The pieces of a layer in the band.
  struct Layer {
    std::uint32_t layer = 0;
    std::size_t first_piece = 0;
    std::size_t end_piece = 0;
  };

  void begin_band(const LayerStack& stack, const CellFilter& filter, int width, int first_row,
                  int end_row);
  const GridWindow& window() const { return window_; }
  /// Those of the band, from the highest.
  std::span<const Layer> layers() const { return layers_; }

  void begin_row(int row);
  /// Appends the arcs of a layer in the row, by columns. What lies left of the window is in column
  /// -1, and what lies in columns that are not open is in any of those. Of a layer that is in none
  /// that are open there are no arcs.
  void append(const Layer& layer, const OpenColumns& open, std::vector<StackArc>* arcs);
  const StackCurve& curve(const StackArc& arc) const { return curves_[arc.curve]; }
  /// Whether they are the same, as far as five places tell.
  bool are_equal(const StackArc& a, const StackArc& b) const;
  /// In coordinates of cells.
  const MonotoneCurve& piece(const StackCurve& curve) const { return pieces_[curve.piece].curve; }

 private:
  // Where a piece is at a height.
  struct Place {
    double t = 0.0;
    Point2 point;
  };
  struct Piece {
    MonotoneCurve curve;
    int sign = 1;
    double slope = 0.0;  // of lines: x by y
    // Where it came out of the row below.
    int entered_row = kNoRow;
    Place entered;
  };
  // What is in the row of a piece.
  struct RowPart {
    std::uint32_t piece = 0;
    Place low;
    Place high;
    // From the window's first, and within the window.
    int first_column = 0;
    int end_column = 0;
  };
  static constexpr int kNoRow = INT32_MIN;
  // What tells an arc from others: where it is at five places. Curves up to degree 3, and conics,
  // are told by so many.
  using Places = std::array<double, 12>;

  Places places_of(const StackArc& arc) const;
  Place passing(const Piece& piece, double y) const;
  void take_part(std::uint32_t index);
  bool take_parts(const Layer& layer, const OpenColumns& open);
  bool append_hidden(const RowPart& part, const OpenColumns& open,
                     std::vector<StackArc>* arcs) const;
  void append_line(const Piece& piece, std::vector<StackArc>* arcs) const;
  void append_curve(const RowPart& part, std::vector<StackArc>* arcs);
  void append_left(double y_begin, double y_end, int sign, std::vector<StackArc>* arcs) const;
  void sort_by_columns(std::size_t first, std::vector<StackArc>* arcs);
  void merge_equal(std::size_t first, std::vector<StackArc>* arcs);
  bool are_different(std::span<const StackArc> arcs);
  void merge(std::vector<StackArc>::iterator begin, std::vector<StackArc>::iterator end,
             std::vector<StackArc>::iterator* out) const;

  GridWindow window_;
  std::vector<Layer> layers_;
  std::vector<Piece> pieces_;
  GridWindow row_;
  std::vector<RowPart> parts_;
  std::vector<StackCurve> curves_;
  std::vector<StackArc> sorted_;
  std::vector<std::uint32_t> first_;  // of each column
  std::vector<std::uint64_t> keys_;
};

}  // namespace prefilter
