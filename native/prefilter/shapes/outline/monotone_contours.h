// SPDX-License-Identifier: GPL-3.0-or-later

// Contours cut into pieces that are monotone in x and in y.
#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

#include "prefilter/base/curve.h"
#include "prefilter/base/outline.h"

namespace prefilter {

/// Part of a segment, or the line that closes an open contour.
struct MonotonePiece {
  static constexpr std::uint32_t kClosing = UINT32_MAX;

  std::uint32_t segment = kClosing;  // of its contour
  double from = 0.0;                 // the segment's parameters
  double to = 1.0;
  std::span<const Point2> controls;  // of the part; their hull contains it
};

/// Consecutive pieces that are monotone in the same directions.
struct MonotoneRun {
  const Point2* joints = nullptr;  // the pieces + 1 ends
  std::uint32_t pieces = 0;
  std::uint32_t contour = 0;
  std::uint32_t first_piece = 0;

  const Point2& begin() const { return joints[0]; }
  const Point2& end() const { return joints[pieces]; }
};

/// The contours of several outlines, which must outlive it. Contours without an extent are left
/// out.
class MonotoneContours {
 public:
  explicit MonotoneContours(std::span<const Outline* const> outlines);

  struct Contour {
    const Outline* outline = nullptr;
    std::uint32_t layer = 0;  // the outline's index
    std::uint32_t index = 0;  // in the outline
    std::uint32_t pieces = 0;
    const Point2* joints = nullptr;             // pieces + 1; the last equals the first
    const MonotonePiece* cut_pieces = nullptr;  // null if all pieces are the contour's own lines
    std::uint32_t first_run = 0;
    std::uint32_t runs = 0;
  };

  std::span<const Contour> contours() const { return contours_; }
  std::span<const MonotoneRun> runs() const { return runs_; }
  const Box2& box() const { return box_; }

  MonotonePiece piece(const Contour& contour, std::uint32_t index) const {
    if (contour.cut_pieces != nullptr) return contour.cut_pieces[index];
    const bool closing = index == contour.outline->contour(contour.index).size();
    return {closing ? MonotonePiece::kClosing : index, 0.0, 1.0, {contour.joints + index, 2}};
  }
  /// The whole segment that contains a piece.
  Curve curve(const Contour& contour, const MonotonePiece& piece) const {
    if (piece.segment == MonotonePiece::kClosing) return {piece.controls, 0.0};
    return curve_of(*contour.outline, contour.outline->contour(contour.index)[piece.segment]);
  }

 private:
  void add(Contour contour);
  void cut(Contour* contour);
  void cut_segment(const Curve& curve, std::uint32_t segment);
  bool add_runs(Contour* contour);
  template <typename T>
  T* keep(std::span<const T> values);

  std::unique_ptr<std::pmr::monotonic_buffer_resource> arena_;
  std::vector<Contour> contours_;
  std::vector<MonotoneRun> runs_;
  Box2 box_;
  std::vector<MonotonePiece> cut_;
  std::vector<Point2> joints_;
  std::vector<double> turns_;
};

}  // namespace prefilter
