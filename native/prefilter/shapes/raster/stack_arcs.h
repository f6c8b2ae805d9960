// SPDX-License-Identifier: GPL-3.0-or-later

// The arcs of a stack's outlines in the cells of a band, row by row.
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

/// Part of a monotone curve in a cell, from its lower end. Coordinates are relative to the cell's
/// center.
struct StackArc {
  static constexpr std::uint32_t kLine = UINT32_MAX;

  Point2 low;
  Point2 high;
  std::int32_t column = 0;      // relative to the window's first
  std::int32_t winding = 1;     // winding number to its right minus that to its left
  std::uint32_t curve = kLine;  // index for StackArcs::curve()
  double bend = 0.0;            // see Parabola, if curves are represented by parabolas
};

/// Parameter range of an arc on its piece.
struct StackCurve {
  std::uint32_t piece = 0;
  double t_begin = 0.0;  // along the piece, which may fall
  double t_end = 1.0;
};

class StackArcs {
 public:
  /// A layer's part of the row.
  struct Layer {
    std::uint32_t layer = 0;
    std::size_t first_part = 0;
    std::size_t end_part = 0;
    // Columns it may touch, relative to the window's first.
    int first_column = 0;
    int end_column = 0;
  };

  /// Marks require the box filter and that only columns with marks will be open. `has_parabolas`
  /// represents curves by parabolas.
  void begin_band(const LayerStack& stack, const CellFilter& filter, int width, int first_row,
                  int end_row, bool has_parabolas = false, const CompositedRows* marks = nullptr);
  const GridWindow& window() const { return window_; }

  void begin_row(int row);
  /// Whether a layer may be in an open column.
  bool is_open(const Layer& layer, const OpenColumns& open) const;
  /// The layers of the row, from the highest.
  std::span<const Layer> layers() const { return layers_; }
  /// Appends the arcs of a layer in the row, sorted by column. Arcs left of the window are in
  /// column -1; arcs in closed columns are in any of them.
  void append(const Layer& layer, const OpenColumns& open, std::vector<StackArc>* arcs);
  const StackCurve& curve(const StackArc& arc) const { return curves_[arc.curve]; }
  /// Whether two arcs are equal, as far as five points show.
  bool are_equal(const StackArc& a, const StackArc& b) const;
  /// The piece of an arc, in cell coordinates.
  const MonotoneCurve& piece(const StackCurve& curve) const { return pieces_[curve.piece].curve; }

 private:
  struct Piece {
    MonotoneCurve curve;
    int sign = 1;
    std::uint32_t layer = 0;
  };
  // A point of a part.
  struct ArcPoint {
    double t = 0.0;  // along the piece
    Point2 point;
  };
  // Part of a piece: one of its parabolas, or the chord of the whole piece.
  struct Part {
    Parabola parabola;
    std::uint32_t piece = 0;
    // Where it left the row below.
    int entered_row = kNoRow;
    ArcPoint entered;
  };
  // Section of a part within the row.
  struct RowPart {
    std::uint32_t part = 0;
    ArcPoint low;
    ArcPoint high;
    // relative to the window's first, and inside the window
    int first_column = 0;
    int end_column = 0;
  };
  static constexpr int kNoRow = INT32_MIN;
  // Coordinates at five points that identify an arc: enough for curves up to degree 3 and conics.
  using ArcSignature = std::array<double, 12>;

  ArcSignature signature_of(const StackArc& arc) const;
  void add_piece(const MonotoneCurve& piece, int sign, std::uint32_t layer, const IsSeen& is_seen);
  void sort_by_rows();
  int winding_of(const Part& part) const;
  ArcPoint point_at_height(const Part& part, double y) const;
  RowPart in_row(std::uint32_t index);
  bool append_hidden(const RowPart& in_row, const OpenColumns& open,
                     std::vector<StackArc>* arcs) const;
  void append_line(const Part& part, std::vector<StackArc>* arcs) const;
  void append_curve(const RowPart& in_row, std::vector<StackArc>* arcs);
  void append_parabola(const Part& part, std::vector<StackArc>* arcs);
  void append_left_of_window(double y_begin, double y_end, int sign,
                             std::vector<StackArc>* arcs) const;
  void sort_by_columns(std::size_t first, std::vector<StackArc>* arcs);
  void merge_equal(std::size_t first, std::vector<StackArc>* arcs);
  bool are_all_different(std::span<const StackArc> arcs);
  void merge(std::vector<StackArc>::iterator begin, std::vector<StackArc>::iterator end,
             std::vector<StackArc>::iterator* out) const;

  GridWindow window_;
  std::vector<Piece> pieces_;
  std::vector<Part> parts_;
  std::vector<Parabola> parabolas_;
  std::vector<std::uint32_t> sorted_parts_;  // sorted by row, in the order of parts_ within a row
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
