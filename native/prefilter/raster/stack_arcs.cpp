// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/stack_arcs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace prefilter {
namespace {

// Of arcs of one layer in a cell, those that are equal become one where there are more than so
// many: a contour that is there many times is no more work than once.
constexpr std::size_t kManyArcs = 16;

// What tells an arc from others: where it is at five places. Curves up to degree 3, and conics, are
// told by so many.
struct ArcPlaces {
  std::array<double, 12> numbers{};
  StackArc arc;
};

}  // namespace

void StackArcs::gather(const LayerStack& stack, const CellFilter& filter, int width, int first_row,
                       int end_row) {
  window_ = {filter.first_cell(0), filter.first_cell(width - 1) + filter.taps,
             filter.first_cell(first_row), filter.first_cell(end_row - 1) + filter.taps};
  rows_.resize(window_.end_row - window_.first_row);
  for (auto& arcs : rows_) arcs.clear();
  curves_.clear();
  pieces_.clear();
  const double low = filter.to_pixel(window_.first_row);
  const double high = filter.to_pixel(window_.end_row);
  for (std::size_t i = stack.layers.size(); i-- > 0;) {
    const EdgeList& edges = stack.layers[i].edges;
    if (edges.high() < low || edges.low() > high) continue;
    edges.for_pieces_between(window_.first_row, window_.end_row, filter,
                             [&](const MonotoneCurve& piece, bool backward) {
                               add(piece, backward ? 1 : -1, static_cast<std::uint32_t>(i));
                             });
  }
}

void StackArcs::add(const MonotoneCurve& piece, int sign, std::uint32_t layer) {
  const int left = window_.first_column - 1;
  const auto add_left = [&](int row_index, double y_begin, double y_end) {
    const double center = row_index + 0.5;
    const bool rises = y_begin < y_end;
    row(row_index).push_back({{0.0, (rises ? y_begin : y_end) - center},
                              {0.0, (rises ? y_end : y_begin) - center},
                              layer,
                              left,
                              rises ? sign : -sign,
                              StackArc::kLine});
  };
  if (piece.curve.kind == CurveKind::kLine) {
    const auto add_line = [&](int column, int row_index, Point2 begin, Point2 end) {
      const Point2 center{column + 0.5, row_index + 0.5};
      row(row_index).push_back(
          {begin - center, end - center, layer, column, sign, StackArc::kLine});
    };
    cut_line_to_cells(piece.begin, piece.end, window_, add_line, add_left);
    return;
  }
  const std::size_t known = curves_.size();
  const auto add_arc = [&](int column, int row_index, const CellArc& arc) {
    if (arc.begin.y == arc.end.y) return;
    const Point2 center{column + 0.5, row_index + 0.5};
    StackArc made{arc.begin - center,
                  arc.end - center,
                  layer,
                  column,
                  sign,
                  static_cast<std::uint32_t>(curves_.size())};
    if (made.low.y > made.high.y) {
      std::swap(made.low, made.high);
      made.winding = -sign;
    }
    row(row_index).push_back(made);
    curves_.push_back({static_cast<std::uint32_t>(pieces_.size()), arc.t_begin, arc.t_end});
  };
  cut_to_cells(piece, window_, add_arc, add_left);
  if (curves_.size() > known) pieces_.push_back(piece);
}

// Returns their end.
StackArcs::Arcs::iterator StackArcs::merge_equal(Arcs::iterator begin, Arcs::iterator end) const {
  std::vector<ArcPlaces> places;
  for (auto arc = begin; arc != end; ++arc) {
    places.push_back({{arc->low.y, arc->low.x, arc->high.y, arc->high.x}, *arc});
    if (arc->curve == StackArc::kLine) continue;
    auto& numbers = places.back().numbers;
    const StackCurve& of = curve(*arc);
    const ParametricCurve& whole = piece(of).curve;
    const bool is_told = whole.kind != CurveKind::kBezier;
    numbers[4] = is_told ? 1.0 : 2.0 + arc->curve;
    numbers[5] = of.t_end - of.t_begin;
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = 0.25 * static_cast<double>(i + 1);
      const Point2 point = whole.at(of.t_begin + share * (of.t_end - of.t_begin));
      numbers[6 + 2 * i] = point.x;
      numbers[7 + 2 * i] = point.y;
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const ArcPlaces& a, const ArcPlaces& b) { return a.numbers < b.numbers; });
  auto out = begin;
  for (std::size_t i = 0; i < places.size();) {
    const std::size_t first = i;
    StackArc sum = places[first].arc;
    while (++i < places.size() && places[i].numbers == places[first].numbers) {
      sum.winding += places[i].arc.winding;
    }
    if (sum.winding != 0) *out++ = sum;
  }
  return out;
}

std::span<const StackArc> StackArcs::in_row(int row_index) {
  const Arcs& arcs = row(row_index);
  const int left = window_.first_column - 1;
  first_.assign(window_.end_column - left + 1, 0);
  for (const StackArc& arc : arcs) ++first_[arc.column - left + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(arcs.size());
  for (const StackArc& arc : arcs) sorted_[first_[arc.column - left]++] = arc;
  auto out = sorted_.begin();
  for (auto begin = sorted_.begin(); begin != sorted_.end();) {
    auto end = begin;
    while (end != sorted_.end() && end->column == begin->column && end->layer == begin->layer) {
      ++end;
    }
    const bool are_many = static_cast<std::size_t>(end - begin) > kManyArcs;
    const auto own_end = are_many ? merge_equal(begin, end) : end;
    out = std::move(begin, own_end, out);
    begin = end;
  }
  sorted_.erase(out, sorted_.end());
  return sorted_;
}

}  // namespace prefilter
