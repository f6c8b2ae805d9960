// SPDX-License-Identifier: GPL-3.0-or-later

// A scanline algorithm: crossings with the middle of each row are sorted, filled runs are
// collected, and equal runs of adjacent rows are merged to rectangles.
#include "prefilter/shapes/pixel_outline.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/shapes/outline/fill_rule.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/edge_list.h"

namespace prefilter {
namespace {

// Crossing of a contour with the middle of a row.
struct RowCrossing {
  int row = 0;
  int column = 0;  // the first pixel whose center is not left of the crossing
  int winding = 1;
};

// Pixels [begin, end) of the rows from `first_row` on.
struct PixelRun {
  int begin = 0;
  int end = 0;
  int first_row = 0;
};

// Rounds a coordinate so that errors of transforms do not matter for edges through pixel centers.
double round_coordinate(double coordinate) { return std::round(coordinate * 65536.0) / 65536.0; }

int clamp_index(double index) {
  return static_cast<int>(std::clamp(index, double{-kMaxOutlinePixel}, double{kMaxOutlinePixel}));
}

void append_crossings(const MonotoneCurve& piece, bool backward,
                      std::vector<RowCrossing>* crossings) {
  const bool rises = piece.begin.y < piece.end.y;
  const auto [low, high] = std::minmax(piece.begin.y, piece.end.y);
  // The rows whose middle is above the lower end, and not above the upper end.
  const int first = clamp_index(std::floor(round_coordinate(low) - 0.5) + 1.0);
  const int end = clamp_index(std::floor(round_coordinate(high) - 0.5) + 1.0);
  for (int row = first; row < end; ++row) {
    const double y = std::clamp(row + 0.5, low, high);
    double x = piece.begin.x;
    if (y == piece.end.y) {
      x = piece.end.x;
    } else if (y != piece.begin.y) {
      x = piece.curve.at(crossing(piece, 1, y, piece.t_begin)).x;
    }
    const int column = clamp_index(std::ceil(round_coordinate(x) - 0.5));
    crossings->push_back({row, column, rises != backward ? 1 : -1});
  }
}

void append_box(const PixelRun& run, int end_row, Outline* outline) {
  const double left = run.begin;
  const double right = run.end;
  outline->move_to({left, static_cast<double>(run.first_row)});
  outline->line_to({right, static_cast<double>(run.first_row)});
  outline->line_to({right, static_cast<double>(end_row)});
  outline->line_to({left, static_cast<double>(end_row)});
  outline->close();
}

// Extends runs over rows for as long as they are equal.
class RunJoiner {
 public:
  explicit RunJoiner(Outline* outline) : outline_(outline) {}

  void add(int row, int begin, int end) {
    if (row != row_) next_row(row);
    PixelRun run{begin, end, row};
    const auto same = std::find_if(before_.begin(), before_.end(), [&](const PixelRun& each) {
      return each.begin == begin && each.end == end;
    });
    if (same != before_.end()) {
      run.first_row = same->first_row;
      before_.erase(same);
    }
    runs_.push_back(run);
  }
  void finish() { next_row(row_ + 2); }

 private:
  void next_row(int row) {
    for (const PixelRun& run : before_) append_box(run, row_, outline_);
    before_ = std::move(runs_);
    runs_.clear();
    if (row != row_ + 1) {
      for (const PixelRun& run : before_) append_box(run, row_ + 1, outline_);
      before_.clear();
    }
    row_ = row;
  }

  Outline* outline_;
  int row_ = 0;
  std::vector<PixelRun> before_;  // open runs of the previous row
  std::vector<PixelRun> runs_;
};

}  // namespace

Outline pixel_outline(const Outline& outline, FillRule rule) {
  for (const Point2& point : outline.points()) {
    if (!(std::abs(point.x) <= kMaxPixelCoordinate && std::abs(point.y) <= kMaxPixelCoordinate)) {
      throw_invalid("outline: has a point that is not finite, or farther than 1e9 pixels away");
    }
  }
  EdgeList edges;
  edges.add(outline);
  std::vector<RowCrossing> crossings;
  if (!edges.empty()) {
    const int low = clamp_index(std::floor(edges.low()) - 1.0);
    const int high = clamp_index(std::ceil(edges.high()) + 1.0);
    edges.for_pieces_between(low, high, *find_cell_filter("box"),
                             [&](const MonotoneCurve& piece, bool backward) {
                               append_crossings(piece, backward, &crossings);
                             });
  }
  std::sort(crossings.begin(), crossings.end(), [](const RowCrossing& a, const RowCrossing& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  Outline pixels;
  RunJoiner joiner(&pixels);
  for (std::size_t i = 0; i < crossings.size();) {
    const int row = crossings[i].row;
    int winding = 0;
    int begin = 0;
    for (; i < crossings.size() && crossings[i].row == row;) {
      const int column = crossings[i].column;
      const bool was_filled = is_filled(winding, rule);
      for (; i < crossings.size() && crossings[i].row == row && crossings[i].column == column;
           ++i) {
        winding += crossings[i].winding;
      }
      if (is_filled(winding, rule) == was_filled) continue;
      if (was_filled) {
        joiner.add(row, begin, column);
      } else {
        begin = column;
      }
    }
  }
  joiner.finish();
  return pixels;
}

}  // namespace prefilter
