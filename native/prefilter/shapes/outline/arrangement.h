// SPDX-License-Identifier: GPL-3.0-or-later

// Arrangement of contours: they are cut into chains at their intersections, and the winding numbers
// on both sides of each chain are counted.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/shapes/outline/curve_intersections.h"
#include "prefilter/shapes/outline/monotone_contours.h"
#include "prefilter/shapes/outline/run_tree.h"

namespace prefilter {

/// Precisions to try in turn, relative to the size of the outlines.
inline constexpr double kArrangementPrecisions[] = {0x1p-36, 0x1p-30};

/// Part of a contour between consecutive intersections, or the whole contour if it has none.
struct OutlineChain {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  std::uint32_t contour = 0;
  std::uint32_t begin_cut = kNone;  // kNone: the whole contour
  std::uint32_t end_cut = kNone;
};

/// A chain as part of a boundary; `reversed` if the boundary runs against it.
struct BoundaryChain {
  std::uint32_t chain = 0;
  bool reversed = false;
};

/// Limits on the work done for an arrangement.
enum class ArrangementEffort : std::uint8_t {
  kUnbounded,  // no limit; quadratic, or more, in the number of curves if all of them cross
  /// Linear in the number of curves, which suffices for outlines that rarely cross.
  kBounded,
};

/// Result of cutting contours at their intersections; kUnclear if rounding makes it ambiguous.
enum class CutOutcome : std::uint8_t { kCut, kUnclear, kTooMany };

class Arrangement {
 public:
  /// Outline i is layer i. Points closer than `precision` times the size of the outlines count as
  /// one. The outlines must outlive the arrangement.
  Arrangement(std::span<const Outline* const> outlines, double precision);
  Arrangement(const Arrangement&) = delete;
  Arrangement& operator=(const Arrangement&) = delete;

  /// Cuts the contours at their intersections, within the limits of `effort`.
  CutOutcome cut(ArrangementEffort effort, const Run& run = {});
  /// Largest number of steps for the work after `cut`.
  std::size_t max_steps(ArrangementEffort effort) const;

  /// Whether no contour meets another one or itself; valid after `cut`.
  bool has_no_cuts() const { return cuts_.empty(); }
  std::size_t chain_count() const { return chains_.size(); }

  /// Receives a chain and the winding numbers to its right and to its left. Only one of several
  /// overlapping chains is visited.
  using Visitor =
      std::function<void(std::uint32_t, const LayerWindings& right, const LayerWindings& left)>;
  /// Calls the visitor for chains of [first, last), in order.
  void visit(std::size_t first, std::size_t last, const Visitor& visitor) const;

  /// Appends the closed contours formed by the chains. Returns false if the chains do not close.
  bool trace(std::span<const BoundaryChain> boundary, Outline* outline) const;

 private:
  struct Cut {
    PieceId id;
    double parameter = 0.0;
    std::uint32_t vertex = 0;
  };
  struct Part {
    std::uint32_t piece_index = 0;
    MonotonePiece piece;
    double from = 0.0;
    double to = 1.0;
  };
  struct Reach;
  struct Site;
  class SiteList;
  class Tracer;

  CurvePiece curve_piece(const MonotonePiece& piece, std::uint32_t contour) const;
  bool follows(const PieceId& a, const PieceId& b) const;
  CutOutcome collect_sites(std::size_t max_steps, const Run& run, SiteList* list) const;
  Site site_at(const PieceId& id, const MonotonePiece& piece, double parameter,
               const Point2& point) const;
  void merge_sites(CancelCheck* cancel_check, SiteList* list);
  void make_chains(CancelCheck* cancel_check);
  void group_chains(CancelCheck* cancel_check);
  bool is_negligible(const OutlineChain& chain) const;
  std::optional<Part> only_part(const OutlineChain& chain) const;
  std::optional<Reach> farthest_part(const OutlineChain& chain) const;
  template <typename Visit>
  void visit_parts(const OutlineChain& chain, const Visit& visit) const;

  MonotoneContours contours_;
  double precision_;
  RunTree tree_;
  std::size_t layers_;
  std::vector<Cut> cuts_;  // by contour, piece and parameter
  std::vector<Point2> vertices_;
  std::vector<OutlineChain> chains_;
  std::vector<std::uint32_t> group_of_;  // each chain's group of overlapping chains, or kNone
  std::vector<std::vector<std::uint32_t>> groups_;  // of two chains or more
};

// Calls `visit` for each piece, or part of one, along a chain until it returns false.
template <typename Visit>
void Arrangement::visit_parts(const OutlineChain& chain, const Visit& visit) const {
  const auto& contour = contours_.contours()[chain.contour];
  if (chain.begin_cut == OutlineChain::kNone) {
    for (std::uint32_t i = 0; i < contour.pieces; ++i) {
      const MonotonePiece piece = contours_.piece(contour, i);
      if (!visit(Part{i, piece, piece.from, piece.to})) return;
    }
    return;
  }
  const Cut& end = cuts_[chain.end_cut];
  std::uint32_t index = cuts_[chain.begin_cut].id.piece;
  double from = cuts_[chain.begin_cut].parameter;
  bool wraps = chain.end_cut <= chain.begin_cut;
  while (true) {
    const MonotonePiece piece = contours_.piece(contour, index);
    if (index == end.id.piece && !wraps) {
      if (end.parameter > from) visit(Part{index, piece, from, end.parameter});
      return;
    }
    if (!visit(Part{index, piece, from, piece.to})) return;
    if (++index == contour.pieces) {
      index = 0;
      wraps = false;
    }
    from = contours_.piece(contour, index).from;
  }
}

}  // namespace prefilter
