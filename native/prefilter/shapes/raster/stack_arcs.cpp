// SPDX-License-Identifier: GPL-3.0-or-later

// Pieces are sorted by rows, and cut to the cells of one row at a time.
#include "prefilter/shapes/raster/stack_arcs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "prefilter/shapes/raster/composited_rows.h"

namespace prefilter {
namespace {

// Above this number of arcs of one layer in a cell, equal arcs are merged, so that a repeated
// contour costs no more than one.
constexpr std::ptrdiff_t kMaxUnmergedArcs = 16;

// Fewer arcs are sorted in place, more by counting.
constexpr std::size_t kMaxInPlaceSortArcs = 48;

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
                           int first_row, int end_row, bool has_parabolas,
                           const CompositedRows* marks) {
  has_parabolas_ = has_parabolas;
  const IsSeen is_seen = [&](const Point2& begin, const Point2& end) {
    return has_parabolas && (marks == nullptr || marks->has_marks_within(begin, end));
  };
  window_ = {filter.first_cell(0), filter.first_cell(width - 1) + filter.taps,
             filter.first_cell(first_row), filter.first_cell(end_row - 1) + filter.taps};
  pieces_.clear();
  parts_.clear();
  const double low = filter.to_pixel(window_.first_row);
  const double high = filter.to_pixel(window_.end_row);
  for (std::size_t i = stack.layers.size(); i-- > 0;) {
    const EdgeList& edges = stack.layers[i].edges;
    if (edges.high() < low || edges.low() > high) continue;
    edges.for_pieces_between(
        window_.first_row, window_.end_row, filter, [&](const MonotoneCurve& piece, bool backward) {
          add_piece(piece, backward ? 1 : -1, static_cast<std::uint32_t>(i), is_seen);
        });
  }
  sort_by_rows();
}

void StackArcs::add_piece(const MonotoneCurve& piece, int sign, std::uint32_t layer,
                          const IsSeen& is_seen) {
  const auto [low, high] = std::minmax(piece.begin.y, piece.end.y);
  if (high <= window_.first_row || low >= window_.end_row) return;
  parabolas_.clear();
  append_parabolas(piece, is_seen, &parabolas_);
  if (parabolas_.empty()) return;
  const auto index = static_cast<std::uint32_t>(pieces_.size());
  pieces_.push_back({piece, sign, layer});
  for (const Parabola& parabola : parabolas_) parts_.push_back({parabola, index, kNoRow, {}});
}

// Lists the parts of each row.
void StackArcs::sort_by_rows() {
  const auto for_rows = [&](const Part& part, const auto& use) {
    const double last = window_.end_row - 1;
    const double low = std::floor(part.parabola.low.y);
    const double high = std::ceil(part.parabola.high.y) - 1.0;
    const auto first = static_cast<int>(std::max<double>(low, window_.first_row));
    for (int row = first; row <= static_cast<int>(std::min(high, last)); ++row) {
      use(static_cast<std::size_t>(row - window_.first_row));
    }
  };
  first_of_row_.assign(static_cast<std::size_t>(window_.end_row - window_.first_row) + 2, 0);
  for (const Part& part : parts_) {
    for_rows(part, [&](std::size_t row) { ++first_of_row_[row + 2]; });
  }
  for (std::size_t i = 1; i < first_of_row_.size(); ++i) first_of_row_[i] += first_of_row_[i - 1];
  sorted_parts_.resize(first_of_row_.back());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for_rows(parts_[i], [&](std::size_t row) {
      sorted_parts_[first_of_row_[row + 1]++] = static_cast<std::uint32_t>(i);
    });
  }
}

void StackArcs::begin_row(int row) {
  row_ = {window_.first_column, window_.end_column, row, row + 1};
  curves_.clear();
  layers_.clear();
  row_parts_.clear();
  const auto index = static_cast<std::size_t>(row - window_.first_row);
  for (std::size_t i = first_of_row_[index]; i < first_of_row_[index + 1]; ++i) {
    const RowPart part = in_row(sorted_parts_[i]);
    const std::uint32_t number = pieces_[parts_[part.part].piece].layer;
    if (layers_.empty() || layers_.back().layer != number) {
      layers_.push_back(
          {number, row_parts_.size(), row_parts_.size(), part.first_column, part.end_column});
    }
    row_parts_.push_back(part);
    Layer& layer = layers_.back();
    layer.end_part = row_parts_.size();
    layer.first_column = std::min(layer.first_column, part.first_column);
    layer.end_column = std::max(layer.end_column, part.end_column);
  }
}

bool StackArcs::is_open(const Layer& layer, const OpenColumns& open) const {
  return open.next(layer.first_column, layer.end_column) < layer.end_column;
}

// A falling piece changes winding numbers in the opposite direction.
int StackArcs::winding_of(const Part& part) const {
  const int sign = pieces_[part.piece].sign;
  return part.parabola.t_low < part.parabola.t_high ? sign : -sign;
}

// Point of a part at a height strictly inside it.
StackArcs::ArcPoint StackArcs::point_at_height(const Part& part, double y) const {
  const Parabola& parabola = part.parabola;
  const MonotoneCurve& curve = pieces_[part.piece].curve;
  if (has_parabolas_ || curve.curve.kind == CurveKind::kLine) {
    return {parabola.t_at(y), {parabola.x_at(y), y}};
  }
  const double t = crossing(curve, 1, y, curve.t_begin);
  const auto [left, right] = std::minmax(curve.begin.x, curve.end.x);
  return {t, {std::clamp(curve.curve.at(t).x, left, right), y}};
}

// Rows are visited from the lowest, so a part enters a row where it left the one before.
StackArcs::RowPart StackArcs::in_row(std::uint32_t index) {
  Part& part = parts_[index];
  const Parabola& parabola = part.parabola;
  ArcPoint low{parabola.t_low, parabola.low};
  ArcPoint high{parabola.t_high, parabola.high};
  const int row = row_.first_row;
  if (low.point.y < row) low = part.entered_row == row ? part.entered : point_at_height(part, row);
  if (high.point.y > row_.end_row) {
    high = point_at_height(part, row_.end_row);
    part.entered_row = row_.end_row;
    part.entered = high;
  }
  const auto column_of = [this](double x) {
    const double last = row_.end_column - 1;
    return static_cast<int>(std::floor(std::clamp<double>(x, row_.first_column, last))) -
           row_.first_column;
  };
  const auto [left, right] = std::minmax(low.point.x, high.point.x);
  return {index, low, high, column_of(left - 1e-6), column_of(right + 1e-6) + 1};
}

void StackArcs::append_left_of_window(double y_begin, double y_end, int sign,
                                      std::vector<StackArc>* arcs) const {
  const double center = row_.first_row + 0.5;
  if (y_begin > y_end) {
    std::swap(y_begin, y_end);
    sign = -sign;
  }
  arcs->push_back({{0.0, y_begin - center}, {0.0, y_end - center}, -1, sign, StackArc::kLine, 0.0});
}

// Appends the part to one column if none of its cells is open: then only heights matter. Returns
// false otherwise.
bool StackArcs::append_hidden(const RowPart& in_row, const OpenColumns& open,
                              std::vector<StackArc>* arcs) const {
  if (open.next(in_row.first_column, in_row.end_column) < in_row.end_column) return false;
  if (std::max(in_row.low.point.x, in_row.high.point.x) >= row_.end_column) return false;
  append_left_of_window(in_row.low.point.y, in_row.high.point.y, winding_of(parts_[in_row.part]),
                        arcs);
  arcs->back().column = in_row.first_column;
  return true;
}

void StackArcs::append_line(const Part& part, std::vector<StackArc>* arcs) const {
  const int sign = winding_of(part);
  const auto add_line = [&](int column, int row, Point2 begin, Point2 end) {
    const Point2 center{column + 0.5, row + 0.5};
    arcs->push_back(
        {begin - center, end - center, column - row_.first_column, sign, StackArc::kLine, 0.0});
  };
  const auto add_left = [&](int, double y_begin, double y_end) {
    append_left_of_window(y_begin, y_end, sign, arcs);
  };
  cut_line_to_cells(part.parabola.low, part.parabola.high, row_, add_line, add_left);
}

void StackArcs::append_curve(const RowPart& in_row, std::vector<StackArc>* arcs) {
  const std::uint32_t index = parts_[in_row.part].piece;
  const Piece& piece = pieces_[index];
  const bool rises = piece.curve.begin.y < piece.curve.end.y;
  const auto add_arc = [&](int column, int row, const CellArc& arc) {
    if (arc.begin.y == arc.end.y) return;
    const Point2 center{column + 0.5, row + 0.5};
    StackArc stack_arc{arc.begin - center,
                       arc.end - center,
                       column - row_.first_column,
                       piece.sign,
                       static_cast<std::uint32_t>(curves_.size()),
                       0.0};
    if (!rises) {
      std::swap(stack_arc.low, stack_arc.high);
      stack_arc.winding = -piece.sign;
    }
    arcs->push_back(stack_arc);
    curves_.push_back({index, arc.t_begin, arc.t_end});
  };
  const ArcPoint& begin = rises ? in_row.low : in_row.high;
  const ArcPoint& end = rises ? in_row.high : in_row.low;
  if (in_row.first_column + 1 == in_row.end_column &&
      std::min(begin.point.x, end.point.x) >= row_.first_column &&
      std::max(begin.point.x, end.point.x) <= row_.end_column) {
    add_arc(in_row.first_column + row_.first_column, row_.first_row,
            {begin.t, end.t, begin.point, end.point});
    return;
  }
  MonotoneCurve curve = piece.curve;
  curve.t_begin = begin.t;
  curve.begin = begin.point;
  curve.t_end = end.t;
  curve.end = end.point;
  const auto add_left = [&](int, double y_begin, double y_end) {
    append_left_of_window(y_begin, y_end, piece.sign, arcs);
  };
  cut_to_cells(curve, row_, add_arc, add_left);
}

void StackArcs::append_parabola(const Part& part, std::vector<StackArc>* arcs) {
  const Parabola& parabola = part.parabola;
  const int sign = winding_of(part);
  const auto add_arc = [&](int column, int row, Point2 low, Point2 high) {
    if (!(low.y < high.y)) return;
    const Point2 center{column + 0.5, row + 0.5};
    arcs->push_back({low - center, high - center, column - row_.first_column, sign,
                     static_cast<std::uint32_t>(curves_.size()), parabola.bend});
    const double t_low = parabola.t_at(low.y);
    const double t_high = parabola.t_at(high.y);
    curves_.push_back({part.piece, std::min(t_low, t_high), std::max(t_low, t_high)});
  };
  const auto add_left = [&](int, double y_begin, double y_end) {
    append_left_of_window(y_begin, y_end, sign, arcs);
  };
  cut_rising_to_cells(
      parabola.low, parabola.high, [&](double y) { return parabola.x_at(y); },
      [&](double x) { return parabola.y_at(x); }, row_, add_arc, add_left);
}

void StackArcs::append(const Layer& layer, const OpenColumns& open, std::vector<StackArc>* arcs) {
  const std::size_t first = arcs->size();
  for (std::size_t i = layer.first_part; i < layer.end_part; ++i) {
    const RowPart& in_row = row_parts_[i];
    if (append_hidden(in_row, open, arcs)) continue;
    const Part& part = parts_[in_row.part];
    if (pieces_[part.piece].curve.curve.kind == CurveKind::kLine) {
      append_line(part, arcs);
    } else if (has_parabolas_) {
      append_parabola(part, arcs);
    } else {
      append_curve(in_row, arcs);
    }
  }
  sort_by_columns(first, arcs);
  merge_equal(first, arcs);
}

void StackArcs::sort_by_columns(std::size_t first, std::vector<StackArc>* arcs) {
  const auto begin = arcs->begin() + static_cast<std::ptrdiff_t>(first);
  const auto own = std::span(*arcs).subspan(first);
  if (std::is_sorted(begin, arcs->end(), is_before)) return;
  if (own.size() <= kMaxInPlaceSortArcs) {
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

bool StackArcs::are_all_different(std::span<const StackArc> arcs) {
  keys_.clear();
  for (const StackArc& arc : arcs) keys_.push_back(key_of(arc));
  std::sort(keys_.begin(), keys_.end());
  return std::adjacent_find(keys_.begin(), keys_.end()) == keys_.end();
}

StackArcs::ArcSignature StackArcs::signature_of(const StackArc& arc) const {
  ArcSignature numbers = {arc.low.y, arc.low.x, arc.high.y, arc.high.x};
  if (arc.curve == StackArc::kLine) return numbers;
  const StackCurve& of = curve(arc);
  const ParametricCurve& whole = piece(of).curve;
  const bool has_few_parameters = whole.kind != CurveKind::kBezier;
  numbers[4] = has_few_parameters ? 1.0 : 2.0 + arc.curve;
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
         signature_of(a) == signature_of(b);
}

void StackArcs::merge(std::vector<StackArc>::iterator begin, std::vector<StackArc>::iterator end,
                      std::vector<StackArc>::iterator* out) const {
  struct SignedArc {
    ArcSignature signature;
    StackArc arc;
  };
  std::vector<SignedArc> signed_arcs;
  for (auto arc = begin; arc != end; ++arc) signed_arcs.push_back({signature_of(*arc), *arc});
  std::stable_sort(
      signed_arcs.begin(), signed_arcs.end(),
      [](const SignedArc& a, const SignedArc& b) { return a.signature < b.signature; });
  for (std::size_t i = 0; i < signed_arcs.size();) {
    const std::size_t first = i;
    StackArc sum = signed_arcs[first].arc;
    while (++i < signed_arcs.size() && signed_arcs[i].signature == signed_arcs[first].signature) {
      sum.winding += signed_arcs[i].arc.winding;
    }
    if (sum.winding != 0) *(*out)++ = sum;
  }
}

void StackArcs::merge_equal(std::size_t first, std::vector<StackArc>* arcs) {
  auto out = arcs->begin() + static_cast<std::ptrdiff_t>(first);
  for (auto begin = out; begin != arcs->end();) {
    auto end = begin;
    while (end != arcs->end() && end->column == begin->column) ++end;
    if (end - begin <= kMaxUnmergedArcs || are_all_different({begin, end})) {
      out = out == begin ? end : std::move(begin, end, out);
    } else {
      merge(begin, end, &out);
    }
    begin = end;
  }
  arcs->erase(out, arcs->end());
}

}  // namespace prefilter
