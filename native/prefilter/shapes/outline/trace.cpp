// SPDX-License-Identifier: GPL-3.0-or-later

// Joins the chains of an arrangement to closed boundaries.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/shapes/outline/arrangement.h"

namespace prefilter {
namespace {

// Part of a segment along a boundary.
struct Stretch {
  std::uint32_t contour = 0;
  std::uint32_t segment = 0;
  Curve curve;
  double from = 0.0;
  double to = 1.0;
  bool reversed = false;
  Point2 begin;
  Point2 end;
};

// Whether `b` continues the same segment where `a` ends.
bool goes_on(const Stretch& a, const Stretch& b) {
  return a.contour == b.contour && a.segment == b.segment && a.reversed == b.reversed &&
         (a.reversed ? a.from == b.to : a.to == b.from);
}

void extend(Stretch* a, const Stretch& b) {
  (a->reversed ? a->from : a->to) = a->reversed ? b.from : b.to;
  a->end = b.end;
}

void append(const Stretch& stretch, Outline* outline) {
  if (stretch.curve.degree() == 1 || (stretch.from == 0.0 && stretch.to == 1.0)) {
    append_curve(stretch.curve, stretch.reversed, stretch.end, outline);
  } else {
    const PartOfCurve part(stretch.curve, stretch.from, stretch.to);
    append_curve(part.curve(), stretch.reversed, stretch.end, outline);
  }
}

double angle_of(const Point2& direction) { return elementary::atan2(direction.y, direction.x); }

}  // namespace

class Arrangement::Tracer {
 public:
  Tracer(const Arrangement& arrangement, std::span<const BoundaryChain> boundary)
      : arrangement_(arrangement), boundary_(boundary) {}

  bool trace(Outline* outline) {
    if (!index_chains()) return false;
    for (std::uint32_t i = 0; i < boundary_.size(); ++i) {
      const OutlineChain& chain = arrangement_.chains_[boundary_[i].chain];
      if (chain.begin_cut == OutlineChain::kNone) {
        const auto& contour = arrangement_.contours_.contours()[chain.contour];
        append_contour(*contour.outline, contour.index, boundary_[i].reversed, outline);
      } else if (!used_[i]) {
        trace_loop(i, outline);
      }
    }
    return true;
  }

 private:
  // The vertex where a chain begins or ends when followed along the boundary.
  std::uint32_t vertex(std::uint32_t i, bool at_end) const {
    const OutlineChain& chain = arrangement_.chains_[boundary_[i].chain];
    const bool end_cut = at_end != boundary_[i].reversed;
    return arrangement_.cuts_[end_cut ? chain.end_cut : chain.begin_cut].vertex;
  }
  // Index in `vertices_`.
  std::size_t number_of(std::uint32_t vertex) const {
    return static_cast<std::size_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) -
                                    vertices_.begin());
  }

  // Groups the chains by their first vertex. Returns false unless as many chains end at each
  // vertex.
  bool index_chains() {
    used_.assign(boundary_.size(), false);
    for (std::uint32_t i = 0; i < boundary_.size(); ++i) {
      if (!is_whole(i)) vertices_.push_back(vertex(i, false));
    }
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    const std::size_t vertices = vertices_.size();
    first_.assign(vertices + 1, 0);
    std::vector<std::uint32_t> ends(vertices + 1, 0);
    for (std::uint32_t i = 0; i < boundary_.size(); ++i) {
      if (is_whole(i)) continue;
      ++first_[number_of(vertex(i, false)) + 1];
      const std::uint32_t end = vertex(i, true);
      const std::size_t number = number_of(end);
      if (number == vertices || vertices_[number] != end) return false;
      ++ends[number];
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      if (first_[v + 1] != ends[v]) return false;
    }
    for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
    leaving_.resize(first_[vertices]);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < boundary_.size(); ++i) {
      if (!is_whole(i)) leaving_[next[number_of(vertex(i, false))]++] = i;
    }
    return true;
  }

  bool is_whole(std::uint32_t i) const {
    return arrangement_.chains_[boundary_[i].chain].begin_cut == OutlineChain::kNone;
  }

  // Takes the sharpest left turn at each vertex, so that contours touch there instead of crossing.
  std::uint32_t next_of(std::uint32_t i) const {
    const std::size_t at = number_of(vertex(i, true));
    std::uint32_t best = OutlineChain::kNone;
    double best_turn = HUGE_VAL;
    double back = 0.0;
    bool several = false;
    for (std::uint32_t k = first_[at]; k < first_[at + 1]; ++k) {
      const std::uint32_t candidate = leaving_[k];
      if (used_[candidate]) continue;
      if (best == OutlineChain::kNone) {
        best = candidate;
        continue;
      }
      if (!several) {
        several = true;
        back = angle_of(direction(i, true));
        best_turn = clockwise(back, angle_of(direction(best, false)));
      }
      const double turn = clockwise(back, angle_of(direction(candidate, false)));
      if (turn < best_turn) {
        best_turn = turn;
        best = candidate;
      }
    }
    return best;
  }

  static double clockwise(double from, double to) {
    const double turn = from - to;
    return turn > 0.0 ? turn : turn + 2.0 * std::numbers::pi;
  }

  // Direction of a chain at its first or last vertex, pointing away from the vertex.
  Point2 direction(std::uint32_t i, bool at_end) const {
    const OutlineChain& chain = arrangement_.chains_[boundary_[i].chain];
    const bool last = at_end != boundary_[i].reversed;
    Part end_part;
    arrangement_.visit_parts(chain, [&](const Part& part) {
      end_part = part;
      return last;
    });
    const Curve whole = arrangement_.contours_.curve(
        arrangement_.contours_.contours()[chain.contour], end_part.piece);
    const PartOfCurve part(whole, end_part.from, end_part.to);
    const auto controls = part.curve().controls;
    const std::size_t count = controls.size();
    for (std::size_t k = 1; k < count; ++k) {
      const Point2 step =
          last ? controls[count - 1 - k] - controls[count - 1] : controls[k] - controls[0];
      if (!(step == Point2{})) return step;
    }
    return {};
  }

  void append_stretches(std::uint32_t i) {
    const OutlineChain& chain = arrangement_.chains_[boundary_[i].chain];
    const bool reversed = boundary_[i].reversed;
    const auto& contour = arrangement_.contours_.contours()[chain.contour];
    chain_stretches_.clear();
    arrangement_.visit_parts(chain, [&](const Part& part) {
      Stretch stretch;
      stretch.contour = chain.contour;
      stretch.segment = part.piece.segment;
      stretch.curve = arrangement_.contours_.curve(contour, part.piece);
      stretch.from = part.from;
      stretch.to = part.to;
      stretch.reversed = reversed;
      stretch.begin = contour.joints[part.piece_index];
      stretch.end = contour.joints[part.piece_index + 1];
      chain_stretches_.push_back(stretch);
      return true;
    });
    if (chain_stretches_.empty()) return;
    chain_stretches_.front().begin = arrangement_.vertices_[vertex(i, reversed)];
    chain_stretches_.back().end = arrangement_.vertices_[vertex(i, !reversed)];
    if (reversed) {
      std::reverse(chain_stretches_.begin(), chain_stretches_.end());
      for (Stretch& stretch : chain_stretches_) std::swap(stretch.begin, stretch.end);
    }
    for (const Stretch& stretch : chain_stretches_) {
      if (!loop_.empty() && goes_on(loop_.back(), stretch)) {
        extend(&loop_.back(), stretch);
      } else {
        loop_.push_back(stretch);
      }
    }
  }

  void trace_loop(std::uint32_t first, Outline* outline) {
    loop_.clear();
    const std::uint32_t start = vertex(first, false);
    std::uint32_t i = first;
    while (true) {
      used_[i] = true;
      append_stretches(i);
      if (vertex(i, true) == start) break;
      i = next_of(i);
      if (i == OutlineChain::kNone) break;
    }
    if (loop_.size() > 1 && goes_on(loop_.back(), loop_.front())) {
      extend(&loop_.back(), loop_.front());
      loop_.front() = loop_.back();
      loop_.pop_back();
    }
    if (loop_.empty()) return;
    outline->move_to(loop_.front().begin);
    for (const Stretch& stretch : loop_) append(stretch, outline);
    outline->close();
  }

  const Arrangement& arrangement_;
  std::span<const BoundaryChain> boundary_;
  std::vector<bool> used_;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint32_t> first_;  // of each of these, in leaving_
  std::vector<std::uint32_t> leaving_;
  std::vector<Stretch> chain_stretches_;
  std::vector<Stretch> loop_;
};

bool Arrangement::trace(std::span<const BoundaryChain> boundary, Outline* outline) const {
  return Tracer(*this, boundary).trace(outline);
}

}  // namespace prefilter
