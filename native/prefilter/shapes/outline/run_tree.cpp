// SPDX-License-Identifier: GPL-3.0-or-later

// A bounding volume hierarchy over contours sorted along a Morton curve. Winding numbers are
// counted by casting a ray and finding the crossed piece of each monotone run by binary search.
#include "prefilter/shapes/outline/run_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace prefilter {
namespace {

constexpr std::uint32_t kLeafRuns = 4;

using Pairs = std::vector<std::pair<PieceId, PieceId>>;

Box2 box_of(const Point2& a, const Point2& b) {
  return {{std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}};
}

bool meet(const Box2& a, const Box2& b, double precision) {
  return a.low.x <= b.high.x + precision && b.low.x <= a.high.x + precision &&
         a.low.y <= b.high.y + precision && b.low.y <= a.high.y + precision;
}

Box2 unite(const Box2& a, const Box2& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

// Spreads 16 bits to the even bits of 32, for a Morton code.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 8) & 0x00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0fu;
  bits = (bits | bits << 2) & 0x33333333u;
  return (bits | bits << 1) & 0x55555555u;
}

// Part of a run between joints `first` and `last`.
struct Span {
  const MonotoneRun* run;
  std::uint32_t first;
  std::uint32_t last;

  Box2 box() const { return box_of(run->joints[first], run->joints[last]); }
  bool is_piece() const { return last - first == 1; }
  PieceId id() const { return {run->contour, run->first_piece + first}; }
  std::pair<Span, Span> halves() const {
    const std::uint32_t middle = first + (last - first) / 2;
    return {{run, first, middle}, {run, middle, last}};
  }
};

// Whether two pieces whose boxes share at most part of one side cannot intersect away from their
// joint: each has at most one end on that side.
bool cannot_intersect(const Span& a, const Span& b, double precision, double Point2::*axis) {
  const Point2& a_begin = a.run->joints[a.first];
  const Point2& a_end = a.run->joints[a.last];
  const Point2& b_begin = b.run->joints[b.first];
  const Point2& b_end = b.run->joints[b.last];
  const double width =
      std::min(std::fabs(a_begin.*axis - a_end.*axis), std::fabs(b_begin.*axis - b_end.*axis));
  if (width <= 8.0 * precision) return false;
  const bool a_rises = a_begin.*axis < a_end.*axis;
  const bool b_rises = b_begin.*axis < b_end.*axis;
  const Point2& a_low = a_rises ? a_begin : a_end;
  const Point2& a_high = a_rises ? a_end : a_begin;
  const Point2& b_low = b_rises ? b_begin : b_end;
  const Point2& b_high = b_rises ? b_end : b_begin;
  const bool a_first = a_high.*axis == b_low.*axis;
  if (!a_first && !(b_high.*axis == a_low.*axis)) return false;
  if (!(a_first ? a_high == b_low : b_high == a_low)) return true;
  return &a_end == &b_begin || &b_end == &a_begin;
}

void append_span_pairs(const Span& a, const Span& b, double precision, Pairs* pairs) {
  if (!meet(a.box(), b.box(), precision)) return;
  if (a.is_piece() && b.is_piece()) {
    if (cannot_intersect(a, b, precision, &Point2::x) ||
        cannot_intersect(a, b, precision, &Point2::y))
      return;
    pairs->emplace_back(a.id(), b.id());
  } else if (a.last - a.first >= b.last - b.first) {
    const auto [low, high] = a.halves();
    append_span_pairs(low, b, precision, pairs);
    append_span_pairs(high, b, precision, pairs);
  } else {
    const auto [low, high] = b.halves();
    append_span_pairs(a, low, precision, pairs);
    append_span_pairs(a, high, precision, pairs);
  }
}

void append_run_pairs(const MonotoneRun& a, const MonotoneRun& b, double precision, Pairs* pairs) {
  append_span_pairs({&a, 0, a.pieces}, {&b, 0, b.pieces}, precision, pairs);
}

// Boxes of a leaf's runs, as each is tested against several others.
std::array<Box2, kLeafRuns> boxes_of(std::span<const MonotoneRun> runs) {
  std::array<Box2, kLeafRuns> boxes;
  std::transform(runs.begin(), runs.end(), boxes.begin(),
                 [](const MonotoneRun& run) { return box_of(run.begin(), run.end()); });
  return boxes;
}

template <RayAxis axis>
double along(const Point2& point) {
  return axis == RayAxis::kX ? point.x : point.y;
}
template <RayAxis axis>
double across(const Point2& point) {
  return axis == RayAxis::kX ? point.y : point.x;
}

// 1 for a point to the left of a control hull, seen along its chord, -1 to its right, and 0 if the
// hull is too wide to tell.
int side_of_hull(std::span<const Point2> controls, const Point2& point) {
  const Point2& begin = controls.front();
  const Point2 chord = controls.back() - begin;
  const double offset = cross(chord, point - begin);
  double low = 0.0;
  double high = 0.0;
  for (const Point2& control : controls.subspan(1, controls.size() - 2)) {
    const double other = cross(chord, control - begin);
    low = std::min(low, other);
    high = std::max(high, other);
  }
  // Exceeds the rounding error of the products.
  const double margin = 1e-14 * (std::fabs(chord.x) + std::fabs(chord.y)) *
                        (std::fabs(point.x - begin.x) + std::fabs(point.y - begin.y));
  if (offset > high + margin) return 1;
  return offset < low - margin ? -1 : 0;
}

// Coordinate along the axis at which a monotone piece reaches `level` across it.
template <RayAxis axis>
double along_at(const Curve& curve, double from, double to, const Point2& begin, const Point2& end,
                double level) {
  const double rise = across<axis>(end) - across<axis>(begin);
  if (curve.degree() == 1) {
    const double t = (level - across<axis>(begin)) / rise;
    return (1.0 - t) * along<axis>(begin) + t * along<axis>(end);
  }
  // Regula falsi (Illinois variant), with a bisection every third step.
  double low = across<axis>(begin) - level;
  double high = across<axis>(end) - level;
  Point2 point = begin;
  const double close = 1e-15 * std::max(std::fabs(low), std::fabs(high));
  for (int i = 0; i < 60 && from < to; ++i) {
    double t = i % 3 == 2 ? 0.5 * (from + to) : from + (to - from) * (low / (low - high));
    if (!(t > from && t < to)) t = 0.5 * (from + to);
    point = point_at(curve, t);
    const double value = across<axis>(point) - level;
    if (std::fabs(value) <= close || t <= from || t >= to) break;
    if ((value < 0.0) == (rise > 0.0)) {
      from = t;
      low = value;
    } else {
      to = t;
      high = value;
    }
  }
  return along<axis>(point);
}

}  // namespace

RunTree::RunTree(const MonotoneContours& contours, double precision)
    : contours_(contours), precision_(precision) {
  const auto runs = contours.runs();
  if (runs.empty()) return;
  const Box2& whole = contours.box();
  const Point2 size = whole.high - whole.low;
  const double kMaxMortonStep = 65535.0;
  const double scale_x = size.x > 0.0 ? kMaxMortonStep / size.x : 0.0;
  const double scale_y = size.y > 0.0 ? kMaxMortonStep / size.y : 0.0;
  // Differences of distant points can overflow.
  const auto step_at = [kMaxMortonStep](double place) {
    return place > 0.0 ? static_cast<std::uint32_t>(std::min(place, kMaxMortonStep)) : 0U;
  };
  std::vector<std::uint64_t> keys;
  keys.reserve(contours.contours().size());
  for (std::size_t c = 0; c < contours.contours().size(); ++c) {
    const auto& contour = contours.contours()[c];
    Box2 box;
    for (std::uint32_t r = 0; r < contour.runs; ++r) {
      box.include(runs[contour.first_run + r].begin());
    }
    const Point2 center = 0.5 * (box.low + box.high) - whole.low;
    const std::uint32_t key =
        spread(step_at(center.x * scale_x)) | spread(step_at(center.y * scale_y)) << 1;
    keys.push_back(static_cast<std::uint64_t>(key) << 32 | c);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const std::uint64_t key : keys) order.push_back(static_cast<std::uint32_t>(key));
  nodes_.reserve(2 * order.size() + runs.size());
  build_contours(order);
}

std::uint32_t RunTree::build_contours(std::span<const std::uint32_t> order) {
  if (order.size() == 1) {
    const auto& contour = contours_.contours()[order[0]];
    return build_runs(contour.first_run, contour.runs, true);
  }
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const std::size_t half = (order.size() + 1) / 2;
  const std::uint32_t first = build_contours(order.first(half));
  const std::uint32_t second = build_contours(order.subspan(half));
  Node& node = nodes_[index];
  node.box = unite(nodes_[first].box, nodes_[second].box);
  node.count = nodes_[first].count + nodes_[second].count;
  node.second_child = second;
  node.has_whole_contours = true;
  return index;
}

std::uint32_t RunTree::build_runs(std::uint32_t first, std::uint32_t count, bool is_whole) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.first = first;
  node.count = count;
  node.has_whole_contours = is_whole;
  if (count <= kLeafRuns) {
    for (std::uint32_t i = first; i < first + count; ++i) {
      const MonotoneRun& run = contours_.runs()[i];
      node.box = unite(node.box, box_of(run.begin(), run.end()));
    }
  } else {
    const std::uint32_t half = (count + 1) / 2;
    const std::uint32_t first_child = build_runs(first, half, false);
    node.second_child = build_runs(first + half, count - half, false);
    node.box = unite(nodes_[first_child].box, nodes_[node.second_child].box);
  }
  nodes_[index] = node;
  return index;
}

// Search for pairs that stops after `most` pairs or `most` tests.
struct RunTree::PairSearch {
  Pairs* pairs = nullptr;
  std::size_t most = 0;
  std::size_t tests = 0;

  bool may_test() { return ++tests <= most && pairs->size() <= most; }
};

bool RunTree::append_pairs(std::size_t most, Pairs* pairs) const {
  PairSearch search = {pairs, most};
  if (!nodes_.empty()) pairs_within(0, &search);
  return search.tests <= most && pairs->size() <= most;
}

void RunTree::pairs_within(std::uint32_t index, PairSearch* search) const {
  const Node& node = nodes_[index];
  if (node.second_child != 0) {
    pairs_within(index + 1, search);
    pairs_within(node.second_child, search);
    pairs_between(index + 1, node.second_child, search);
    return;
  }
  const auto runs = contours_.runs().subspan(node.first, node.count);
  const auto boxes = boxes_of(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (std::size_t j = i + 1; j < runs.size() && search->may_test(); ++j) {
      if (!meet(boxes[i], boxes[j], precision_)) continue;
      append_run_pairs(runs[i], runs[j], precision_, search->pairs);
    }
  }
}

void RunTree::pairs_between(std::uint32_t a, std::uint32_t b, PairSearch* search) const {
  const Node& first = nodes_[a];
  const Node& second = nodes_[b];
  if (!meet(first.box, second.box, precision_) || !search->may_test()) return;
  if (first.second_child == 0 && second.second_child == 0) {
    const auto runs = contours_.runs().subspan(first.first, first.count);
    const auto others = contours_.runs().subspan(second.first, second.count);
    const auto boxes = boxes_of(runs);
    const auto other_boxes = boxes_of(others);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t j = 0; j < others.size() && search->may_test(); ++j) {
        if (!meet(boxes[i], other_boxes[j], precision_)) continue;
        append_run_pairs(runs[i], others[j], precision_, search->pairs);
      }
    }
  } else if (second.second_child == 0 || (first.second_child != 0 && first.count >= second.count)) {
    pairs_between(a + 1, b, search);
    pairs_between(first.second_child, b, search);
  } else {
    pairs_between(a, b + 1, search);
    pairs_between(a, second.second_child, search);
  }
}

void RunTree::add_windings(const Point2& point, RayAxis axis, std::span<const PieceId> excluded,
                           LayerWindings* windings) const {
  if (nodes_.empty()) return;
  if (axis == RayAxis::kX) {
    add_on_ray<RayAxis::kX>(point, excluded, windings);
  } else {
    add_on_ray<RayAxis::kY>(point, excluded, windings);
  }
}

template <RayAxis axis>
void RunTree::add_on_ray(const Point2& point, std::span<const PieceId> excluded,
                         LayerWindings* windings) const {
  std::array<std::uint32_t, 64> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::uint32_t index = stack[--height];
    const Node& node = nodes_[index];
    if (across<axis>(point) < across<axis>(node.box.low) ||
        across<axis>(point) >= across<axis>(node.box.high) ||
        along<axis>(point) > along<axis>(node.box.high)) {
      continue;
    }
    // A contour does not wind around points beside it. (A point on a contour may be rounded off
    // it.)
    if (node.has_whole_contours && along<axis>(point) + precision_ < along<axis>(node.box.low))
      continue;
    if (node.second_child != 0) {
      stack[height++] = node.second_child;
      stack[height++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const MonotoneRun& run = contours_.runs()[i];
      windings->add(contours_.contours()[run.contour].layer,
                    run_winding<axis>(run, point, excluded));
    }
  }
}

// A piece includes its lower end and excludes its upper end, so that joints count once.
template <RayAxis axis>
int RunTree::run_winding(const MonotoneRun& run, const Point2& point,
                         std::span<const PieceId> excluded) const {
  const double level = across<axis>(point);
  const bool rises = across<axis>(run.end()) > across<axis>(run.begin());
  const Point2& lower = rises ? run.begin() : run.end();
  const Point2& upper = rises ? run.end() : run.begin();
  if (level < across<axis>(lower) || level >= across<axis>(upper)) return 0;
  if (along<axis>(point) > std::max(along<axis>(run.begin()), along<axis>(run.end()))) return 0;
  // A piece that crosses a ray along +y toward -x turns counter-clockwise around its origin.
  const int sign = (rises ? 1 : -1) * (axis == RayAxis::kX ? 1 : -1);

  const Point2* joints = run.joints;
  const Point2* joint_after =
      rises ? std::partition_point(joints, joints + run.pieces + 1,
                                   [&](const Point2& p) { return across<axis>(p) <= level; })
            : std::partition_point(joints, joints + run.pieces + 1,
                                   [&](const Point2& p) { return across<axis>(p) > level; });
  const auto index = static_cast<std::uint32_t>(joint_after - joints) - 1;
  const Point2& begin = joints[index];
  const Point2& end = joints[index + 1];
  const PieceId id = {run.contour, run.first_piece + index};
  if (std::find(excluded.begin(), excluded.end(), id) != excluded.end()) return 0;
  if (along<axis>(point) < std::min(along<axis>(begin), along<axis>(end))) return sign;
  if (along<axis>(point) > std::max(along<axis>(begin), along<axis>(end))) return 0;
  const auto& contour = contours_.contours()[run.contour];
  const MonotonePiece piece = contours_.piece(contour, id.piece);
  const int side = side_of_hull(piece.controls, point);
  if (side != 0) {
    // The ray crosses the piece if the point is to its left while it rises in y, or falls in x.
    return (side > 0) == (rises == (axis == RayAxis::kX)) ? sign : 0;
  }
  const Curve curve = contours_.curve(contour, piece);
  const double at = along_at<axis>(curve, piece.from, piece.to, begin, end, level);
  return at > along<axis>(point) ? sign : 0;
}

}  // namespace prefilter
