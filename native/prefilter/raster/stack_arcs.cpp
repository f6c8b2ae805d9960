// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/stack_arcs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace prefilter {
namespace {

// Of arcs of one layer in a cell, those that are equal become one where there are more than so
// many: a contour that is there many times is no more work than once.
constexpr std::ptrdiff_t kManyArcs = 16;

// Fewer are sorted in place.
constexpr std::size_t kFewArcs = 48;

std::uint64_t key_of(const StackArc& arc) {
  std::uint64_t key = 0;
  for (const double value : {arc.low.x, arc.low.y, arc.high.x, arc.high.y}) {
    key = (key ^ std::bit_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15u;
    key ^= key >> 29;
  }
  return key;
}

bool is_before(const StackArc& a, const StackArc& b) { return a.column < b.column; }

}  // namespace

void StackArcs::begin_band(const LayerStack& stack, const CellFilter& filter, int width,
                           int first_row, int end_row) {
  window_ = {filter.first_cell(0), filter.first_cell(width - 1) + filter.taps,
             filter.first_cell(first_row), filter.first_cell(end_row - 1) + filter.taps};
  layers_.clear();
  pieces_.clear();
  const double low = filter.to_pixel(window_.first_row);
  const double high = filter.to_pixel(window_.end_row);
  for (std::size_t i = stack.layers.size(); i-- > 0;) {
    const EdgeList& edges = stack.layers[i].edges;
    if (edges.high() < low || edges.low() > high) continue;
    const std::size_t first = pieces_.size();
    edges.for_pieces_between(
        window_.first_row, window_.end_row, filter, [&](const MonotoneCurve& piece, bool backward) {
          if (piece.begin.y == piece.end.y) return;
          const Point2 way = piece.end - piece.begin;
          pieces_.push_back({piece, backward ? 1 : -1, way.x / way.y, kNoRow, {}});
        });
    if (pieces_.size() > first) {
      layers_.push_back({static_cast<std::uint32_t>(i), first, pieces_.size()});
    }
  }
}

void StackArcs::begin_row(int row) {
  row_ = {window_.first_column, window_.end_column, row, row + 1};
  curves_.clear();
}

void StackArcs::append_left(double y_begin, double y_end, int sign,
                            std::vector<StackArc>* arcs) const {
  const double center = row_.first_row + 0.5;
  if (y_begin > y_end) {
    std::swap(y_begin, y_end);
    sign = -sign;
  }
  arcs->push_back({{0.0, y_begin - center}, {0.0, y_end - center}, -1, sign, StackArc::kLine});
}

// Where a piece passes a height that it has inside.
StackArcs::Place StackArcs::passing(const Piece& piece, double y) const {
  const MonotoneCurve& curve = piece.curve;
  if (curve.curve.kind == CurveKind::kLine) {
    return {0.0, {curve.begin.x + (y - curve.begin.y) * piece.slope, y}};
  }
  const double t = crossing(curve, 1, y, curve.t_begin);
  const auto [left, right] = std::minmax(curve.begin.x, curve.end.x);
  return {t, {std::clamp(curve.curve.at(t).x, left, right), y}};
}

// Rows come from below, so that a piece comes into one where it came out of the last.
void StackArcs::take_part(std::uint32_t index) {
  Piece& piece = pieces_[index];
  Place low{piece.curve.t_begin, piece.curve.begin};
  Place high{piece.curve.t_end, piece.curve.end};
  if (low.point.y > high.point.y) std::swap(low, high);
  const int row = row_.first_row;
  if (high.point.y <= row || low.point.y >= row_.end_row) return;
  if (low.point.y < row) low = piece.entered_row == row ? piece.entered : passing(piece, row);
  if (high.point.y > row_.end_row) {
    high = passing(piece, row_.end_row);
    piece.entered_row = row_.end_row;
    piece.entered = high;
  }
  const auto column_of = [this](double x) {
    const double last = row_.end_column - 1;
    return static_cast<int>(std::floor(std::clamp<double>(x, row_.first_column, last))) -
           row_.first_column;
  };
  const auto [left, right] = std::minmax(low.point.x, high.point.x);
  parts_.push_back({index, low, high, column_of(left - 1e-6), column_of(right + 1e-6) + 1});
}

// Returns whether some of the layer may be in columns that are open.
bool StackArcs::take_parts(const Layer& layer, const OpenColumns& open) {
  parts_.clear();
  int first = row_.end_column - row_.first_column;
  int end = 0;
  for (std::size_t i = layer.first_piece; i < layer.end_piece; ++i) {
    const std::size_t count = parts_.size();
    take_part(static_cast<std::uint32_t>(i));
    if (parts_.size() == count) continue;
    first = std::min(first, parts_.back().first_column);
    end = std::max(end, parts_.back().end_column);
  }
  return first < end && open.next(first, end) < end;
}

// Of a piece in cells that are not seen only the heights count. Returns false where it passes
// others.
bool StackArcs::append_hidden(const RowPart& part, const OpenColumns& open,
                              std::vector<StackArc>* arcs) const {
  if (open.next(part.first_column, part.end_column) < part.end_column) return false;
  if (std::max(part.low.point.x, part.high.point.x) >= row_.end_column) return false;
  const Piece& piece = pieces_[part.piece];
  const bool rises = piece.curve.begin.y < piece.curve.end.y;
  append_left(part.low.point.y, part.high.point.y, rises ? piece.sign : -piece.sign, arcs);
  arcs->back().column = part.first_column;
  return true;
}

void StackArcs::append_line(const Piece& piece, std::vector<StackArc>* arcs) const {
  const auto add_line = [&](int column, int row, Point2 begin, Point2 end) {
    const Point2 center{column + 0.5, row + 0.5};
    arcs->push_back(
        {begin - center, end - center, column - row_.first_column, piece.sign, StackArc::kLine});
  };
  const auto add_left = [&](int, double y_begin, double y_end) {
    append_left(y_begin, y_end, piece.sign, arcs);
  };
  cut_line_to_cells(piece.curve.begin, piece.curve.end, row_, add_line, add_left);
}

void StackArcs::append_curve(const RowPart& part, std::vector<StackArc>* arcs) {
  const Piece& piece = pieces_[part.piece];
  const bool rises = piece.curve.begin.y < piece.curve.end.y;
  const auto add_arc = [&](int column, int row, const CellArc& arc) {
    if (arc.begin.y == arc.end.y) return;
    const Point2 center{column + 0.5, row + 0.5};
    StackArc made{arc.begin - center, arc.end - center, column - row_.first_column, piece.sign,
                  static_cast<std::uint32_t>(curves_.size())};
    if (!rises) {
      std::swap(made.low, made.high);
      made.winding = -piece.sign;
    }
    arcs->push_back(made);
    curves_.push_back({part.piece, arc.t_begin, arc.t_end});
  };
  const Place& begin = rises ? part.low : part.high;
  const Place& end = rises ? part.high : part.low;
  if (part.first_column + 1 == part.end_column &&
      std::min(begin.point.x, end.point.x) >= row_.first_column &&
      std::max(begin.point.x, end.point.x) <= row_.end_column) {
    add_arc(part.first_column + row_.first_column, row_.first_row,
            {begin.t, end.t, begin.point, end.point});
    return;
  }
  MonotoneCurve in_row = piece.curve;
  in_row.t_begin = begin.t;
  in_row.begin = begin.point;
  in_row.t_end = end.t;
  in_row.end = end.point;
  const auto add_left = [&](int, double y_begin, double y_end) {
    append_left(y_begin, y_end, piece.sign, arcs);
  };
  cut_to_cells(in_row, row_, add_arc, add_left);
}

void StackArcs::append(const Layer& layer, const OpenColumns& open, std::vector<StackArc>* arcs) {
  if (!take_parts(layer, open)) return;
  const std::size_t first = arcs->size();
  for (const RowPart& part : parts_) {
    if (append_hidden(part, open, arcs)) continue;
    const Piece& piece = pieces_[part.piece];
    if (piece.curve.curve.kind == CurveKind::kLine) {
      append_line(piece, arcs);
    } else {
      append_curve(part, arcs);
    }
  }
  sort_by_columns(first, arcs);
  merge_equal(first, arcs);
}

void StackArcs::sort_by_columns(std::size_t first, std::vector<StackArc>* arcs) {
  const auto begin = arcs->begin() + static_cast<std::ptrdiff_t>(first);
  const auto own = std::span(*arcs).subspan(first);
  if (std::is_sorted(begin, arcs->end(), is_before)) return;
  if (own.size() <= kFewArcs) {
    std::stable_sort(begin, arcs->end(), is_before);
    return;
  }
  first_.assign(static_cast<std::size_t>(row_.end_column - row_.first_column) + 2, 0);
  for (const StackArc& arc : own) ++first_[static_cast<std::size_t>(arc.column + 2)];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(own.size());
  for (const StackArc& arc : own) sorted_[first_[static_cast<std::size_t>(arc.column + 1)]++] = arc;
  std::copy(sorted_.begin(), sorted_.end(), begin);
}

bool StackArcs::are_different(std::span<const StackArc> arcs) {
  keys_.clear();
  for (const StackArc& arc : arcs) keys_.push_back(key_of(arc));
  std::sort(keys_.begin(), keys_.end());
  return std::adjacent_find(keys_.begin(), keys_.end()) == keys_.end();
}

StackArcs::Places StackArcs::places_of(const StackArc& arc) const {
  Places numbers = {arc.low.y, arc.low.x, arc.high.y, arc.high.x};
  if (arc.curve == StackArc::kLine) return numbers;
  const StackCurve& of = curve(arc);
  const ParametricCurve& whole = piece(of).curve;
  const bool is_told = whole.kind != CurveKind::kBezier;
  numbers[4] = is_told ? 1.0 : 2.0 + arc.curve;
  numbers[5] = of.t_end - of.t_begin;
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = 0.25 * static_cast<double>(i + 1);
    const Point2 point = whole.at(of.t_begin + share * (of.t_end - of.t_begin));
    numbers[6 + 2 * i] = point.x;
    numbers[7 + 2 * i] = point.y;
  }
  return numbers;
}

bool StackArcs::are_equal(const StackArc& a, const StackArc& b) const {
  return a.winding == b.winding && a.low == b.low && a.high == b.high &&
         places_of(a) == places_of(b);
}

void StackArcs::merge(std::vector<StackArc>::iterator begin, std::vector<StackArc>::iterator end,
                      std::vector<StackArc>::iterator* out) const {
  struct Told {
    Places places;
    StackArc arc;
  };
  std::vector<Told> told;
  for (auto arc = begin; arc != end; ++arc) told.push_back({places_of(*arc), *arc});
  std::stable_sort(told.begin(), told.end(),
                   [](const Told& a, const Told& b) { return a.places < b.places; });
  for (std::size_t i = 0; i < told.size();) {
    const std::size_t first = i;
    StackArc sum = told[first].arc;
    while (++i < told.size() && told[i].places == told[first].places) {
      sum.winding += told[i].arc.winding;
    }
    if (sum.winding != 0) *(*out)++ = sum;
  }
}

void StackArcs::merge_equal(std::size_t first, std::vector<StackArc>* arcs) {
  auto out = arcs->begin() + static_cast<std::ptrdiff_t>(first);
  for (auto begin = out; begin != arcs->end();) {
    auto end = begin;
    while (end != arcs->end() && end->column == begin->column) ++end;
    if (end - begin <= kManyArcs || are_different({begin, end})) {
      out = out == begin ? end : std::move(begin, end, out);
    } else {
      merge(begin, end, &out);
    }
    begin = end;
  }
  arcs->erase(out, arcs->end());
}

}  // namespace prefilter
