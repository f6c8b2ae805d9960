// SPDX-License-Identifier: GPL-3.0-or-later

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

// Where a contour passes the middle of a row.
struct Passage {
  int row = 0;
  int column = 0;  // the first pixel whose center is not left of it
  int winding = 1;
};

// Pixels [begin, end) of the rows from `first_row` on.
struct Run {
  int begin = 0;
  int end = 0;
  int first_row = 0;
};

// What transforms are rounded by should not count where edges are at centers of pixels.
double settled(double coordinate) { return std::round(coordinate * 65536.0) / 65536.0; }

int limited(double index) {
  return static_cast<int>(std::clamp(index, double{-kMostCrispPixels}, double{kMostCrispPixels}));
}

void append_passages(const MonotoneCurve& piece, bool backward, std::vector<Passage>* passages) {
  const bool rises = piece.begin.y < piece.end.y;
  const auto [low, high] = std::minmax(piece.begin.y, piece.end.y);
  // Rows whose middle is above the lower end, and not above the higher one.
  const int first = limited(std::floor(settled(low) - 0.5) + 1.0);
  const int end = limited(std::floor(settled(high) - 0.5) + 1.0);
  for (int row = first; row < end; ++row) {
    const double y = std::clamp(row + 0.5, low, high);
    double x = piece.begin.x;
    if (y == piece.end.y) {
      x = piece.end.x;
    } else if (y != piece.begin.y) {
      x = piece.curve.at(crossing(piece, 1, y, piece.t_begin)).x;
    }
    const int column = limited(std::ceil(settled(x) - 0.5));
    passages->push_back({row, column, rises != backward ? 1 : -1});
  }
}

void append_box(const Run& run, int end_row, Outline* outline) {
  const double left = run.begin;
  const double right = run.end;
  outline->move_to({left, static_cast<double>(run.first_row)});
  outline->line_to({right, static_cast<double>(run.first_row)});
  outline->line_to({right, static_cast<double>(end_row)});
  outline->line_to({left, static_cast<double>(end_row)});
  outline->close();
}

// Runs go on from row to row for as long as they are the same.
class RunJoiner {
 public:
  explicit RunJoiner(Outline* outline) : outline_(outline) {}

  void add(int row, int begin, int end) {
    if (row != row_) next_row(row);
    Run run{begin, end, row};
    const auto same = std::find_if(before_.begin(), before_.end(), [&](const Run& each) {
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
    for (const Run& run : before_) append_box(run, row_, outline_);
    before_ = std::move(runs_);
    runs_.clear();
    if (row != row_ + 1) {
      for (const Run& run : before_) append_box(run, row_ + 1, outline_);
      before_.clear();
    }
    row_ = row;
  }

  Outline* outline_;
  int row_ = 0;
  std::vector<Run> before_;  // of the row before, which have not come to an end
  std::vector<Run> runs_;
};

}  // namespace

Outline pixel_outline(const Outline& outline, FillRule rule) {
  for (const Point2& point : outline.points()) {
    if (!(std::abs(point.x) <= kFarthestPixel && std::abs(point.y) <= kFarthestPixel)) {
      throw_invalid("outline: has a point that is not finite, or farther than 1e9 pixels away");
    }
  }
  EdgeList edges;
  edges.add(outline);
  std::vector<Passage> passages;
  if (!edges.empty()) {
    const int low = limited(std::floor(edges.low()) - 1.0);
    const int high = limited(std::ceil(edges.high()) + 1.0);
    edges.for_pieces_between(low, high, *find_cell_filter("box"),
                             [&](const MonotoneCurve& piece, bool backward) {
                               append_passages(piece, backward, &passages);
                             });
  }
  std::sort(passages.begin(), passages.end(), [](const Passage& a, const Passage& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  Outline pixels;
  RunJoiner joiner(&pixels);
  for (std::size_t i = 0; i < passages.size();) {
    const int row = passages[i].row;
    int winding = 0;
    int begin = 0;
    for (; i < passages.size() && passages[i].row == row;) {
      const int column = passages[i].column;
      const bool was_filled = is_filled(winding, rule);
      for (; i < passages.size() && passages[i].row == row && passages[i].column == column; ++i) {
        winding += passages[i].winding;
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
