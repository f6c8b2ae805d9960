// SPDX-License-Identifier: GPL-3.0-or-later

// What the outlines of a stack leave in the cells of a band, row by row.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/geometry/moments/cell_cutter.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/layer_stack.h"
#include "prefilter/shapes/raster/open_columns.h"
#include "prefilter/shapes/raster/parabolas.h"

namespace prefilter {

class CompositedRows;

/// Part of a monotone curve in a cell, from its lower end. Coordinates are from the cell's center.
struct StackArc {
  static constexpr std::uint32_t kLine = UINT32_MAX;

  Point2 low;
  Point2 high;
  std::int32_t column = 0;      // from the window's first
  std::int32_t winding = 1;     // what the number to its right is higher by than that to its left
  std::uint32_t curve = kLine;  // one of StackArcs::curve()
  double bend = 0.0;            // as that of a Parabola, where curves are told by these
};

/// Where on a curve an arc is.
struct StackCurve {
  std::uint32_t piece = 0;
  double t_begin = 0.0;  // along the piece, which may fall
  double t_end = 1.0;
};

class StackArcs {
 public:
  /// What is of a layer in the row.
  struct Layer {
    std::uint32_t layer = 0;
    std::size_t first_part = 0;
    std::size_t end_part = 0;
    // Of all columns that it has something in, from the window's first.
    int first_column = 0;
    int end_column = 0;
  };

  /// With marks, for the box filter, only columns that have one will be open. `has_parabolas` says
  /// whether curves are told by parabolas.
  void begin_band(const LayerStack& stack, const CellFilter& filter, int width, int first_row,
                  int end_row, bool has_parabolas = false, const CompositedRows* marks = nullptr);
  const GridWindow& window() const { return window_; }

  void begin_row(int row);
  /// Whether a layer may be in columns that are open.
  bool is_open(const Layer& layer, const OpenColumns& open) const;
  /// Those of the row, from the highest.
  std::span<const Layer> layers() const { return layers_; }
  /// Appends the arcs of a layer in the row, by columns. What lies left of the window is in column
  /// -1, and what lies in columns that are not open is in any of those.
  void append(const Layer& layer, const OpenColumns& open, std::vector<StackArc>* arcs);
  const StackCurve& curve(const StackArc& arc) const { return curves_[arc.curve]; }
  /// Whether they are the same, as far as five places tell.
  bool are_equal(const StackArc& a, const StackArc& b) const;
  /// In coordinates of cells.
  const MonotoneCurve& piece(const StackCurve& curve) const { return pieces_[curve.piece].curve; }

 private:
  struct Piece {
    MonotoneCurve curve;
    int sign = 1;
    std::uint32_t layer = 0;
  };
  // Where a part is at a height.
  struct Place {
    double t = 0.0;  // along the piece
    Point2 point;
  };
  // Of a piece; told by parabolas it has several, else one that is its chord.
  struct Part {
    Parabola parabola;
    std::uint32_t piece = 0;
    // Where it came out of the row below.
    int entered_row = kNoRow;
    Place entered;
  };
  // What is in the row of a part.
  struct RowPart {
    std::uint32_t part = 0;
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
  void add_piece(const MonotoneCurve& piece, int sign, std::uint32_t layer, const IsSeen& is_seen);
  void sort_by_rows();
  int winding_of(const Part& part) const;
  Place passing(const Part& part, double y) const;
  RowPart in_row(std::uint32_t index);
  bool append_hidden(const RowPart& in_row, const OpenColumns& open,
                     std::vector<StackArc>* arcs) const;
  void append_line(const Part& part, std::vector<StackArc>* arcs) const;
  void append_curve(const RowPart& in_row, std::vector<StackArc>* arcs);
  void append_parabola(const Part& part, std::vector<StackArc>* arcs);
  void append_left(double y_begin, double y_end, int sign, std::vector<StackArc>* arcs) const;
  void sort_by_columns(std::size_t first, std::vector<StackArc>* arcs);
  void merge_equal(std::size_t first, std::vector<StackArc>* arcs);
  bool are_different(std::span<const StackArc> arcs);
  void merge(std::vector<StackArc>::iterator begin, std::vector<StackArc>::iterator end,
             std::vector<StackArc>::iterator* out) const;

  GridWindow window_;
  std::vector<Piece> pieces_;
  std::vector<Part> parts_;
  std::vector<Parabola> parabolas_;
  std::vector<std::uint32_t> sorted_parts_;  // by rows, of one in the order of parts_
  std::vector<std::size_t> first_of_row_;
  bool has_parabolas_ = false;
  GridWindow row_;
  std::vector<RowPart> row_parts_;
  std::vector<Layer> layers_;
  std::vector<StackCurve> curves_;
  std::vector<StackArc> sorted_;
  std::vector<std::uint32_t> first_;  // of each column
  std::vector<std::uint64_t> keys_;
};

}  // namespace prefilter
