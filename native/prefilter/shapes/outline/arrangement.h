// SPDX-License-Identifier: GPL-3.0-or-later

// Contours cut where they meet: chains of curves, and what lies on both sides of each.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/shapes/outline/meetings.h"
#include "prefilter/shapes/outline/monotone_contours.h"
#include "prefilter/shapes/outline/run_tree.h"

namespace prefilter {

/// What to try as the precision of an arrangement, one after the other.
inline constexpr double kPrecisions[] = {0x1p-36, 0x1p-30};

/// A contour from a place where it meets another one, or itself, to the next such place; or all of
/// it, where there is none.
struct OutlineChain {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  std::uint32_t contour = 0;
  std::uint32_t begin_cut = kNone;  // kNone: the whole contour
  std::uint32_t end_cut = kNone;
};

/// A chain as a part of a boundary, against its own direction or along it.
struct BoundaryChain {
  std::uint32_t chain = 0;
  bool reversed = false;
};

/// Steps that an arrangement may take.
enum class ArrangementEffort : std::uint8_t {
  kAny,  // the square of the number of curves, and more, where all of them cross
  /// In proportion to that number: what outlines take that mostly lie beside each other.
  kBounded,
};

/// Whether contours could be cut where they meet.
enum class CutOutcome : std::uint8_t { kCut, kUnclear, kTooMany };

class Arrangement {
 public:
  /// Points closer than `precision` times the size of the outlines, whose layers their indices are,
  /// count as one. The outlines must outlive it.
  Arrangement(std::span<const Outline* const> outlines, double precision);
  Arrangement(const Arrangement&) = delete;
  Arrangement& operator=(const Arrangement&) = delete;

  /// Cuts contours where they meet, if that can be told within the effort.
  CutOutcome cut(ArrangementEffort effort, const Progress& progress = {});
  /// How many steps what follows a cut may take.
  std::size_t most_steps(ArrangementEffort effort) const;

  /// Whether all contours are apart from each other and from themselves, after `cut`.
  bool all_whole() const { return cuts_.empty(); }
  std::size_t chain_count() const { return chains_.size(); }

  /// Is given a chain, and the winding numbers to its right and to its left. Of chains that run
  /// along each other it gets one.
  using Visitor =
      std::function<void(std::uint32_t, const LayerWindings& right, const LayerWindings& left)>;
  /// Calls the visitor for chains of [first, last), in order.
  void visit(std::size_t first, std::size_t last, const Visitor& visitor) const;

  /// Appends the closed contours that chains make up. Returns false where they do not.
  bool trace(std::span<const BoundaryChain> boundary, Outline* outline) const;

 private:
  struct Cut {
    PieceId place;
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
  CutOutcome collect_sites(std::size_t most_steps, const Progress& progress, SiteList* list) const;
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
  std::vector<std::uint32_t> group_of_;             // a chain's; those along each other have one
  std::vector<std::vector<std::uint32_t>> groups_;  // of two chains or more
};

// Calls visit for the parts of pieces that a chain consists of, until that returns false.
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
  std::uint32_t index = cuts_[chain.begin_cut].place.piece;
  double from = cuts_[chain.begin_cut].parameter;
  bool wraps = chain.end_cut <= chain.begin_cut;
  while (true) {
    const MonotonePiece piece = contours_.piece(contour, index);
    if (index == end.place.piece && !wraps) {
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
