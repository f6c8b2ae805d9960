// SPDX-License-Identifier: GPL-3.0-or-later

// Dashes by arc length: adaptive Gauss-Legendre quadrature, inverted by bisection.
#include "prefilter/shapes/outline/dashes.h"

#include <array>
#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

// Gauss-Legendre quadrature with eight nodes.
double gauss_length(const Curve& curve, double from, double to) {
  constexpr std::array<double, 4> kNodes = {0.1834346424956498, 0.5255324099163290,
                                            0.7966664774136267, 0.9602898564975363};
  constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873,
                                              0.2223810344533745, 0.1012285362903763};
  const double middle = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    sum += kWeights[i] * (length(derivative_at(curve, middle - half * kNodes[i])) +
                          length(derivative_at(curve, middle + half * kNodes[i])));
  }
  return half * sum;
}

double refined_length(const Curve& curve, double from, double to, double whole, int depth) {
  const double middle = 0.5 * (from + to);
  const double first = gauss_length(curve, from, middle);
  const double second = gauss_length(curve, middle, to);
  if (depth == 0 || std::fabs(first + second - whole) <= 1e-10 * (first + second)) {
    return first + second;
  }
  return refined_length(curve, from, middle, first, depth - 1) +
         refined_length(curve, middle, to, second, depth - 1);
}

// The parameter at an arc length from `from`; `rest_length` is the arc length from `from` to 1.
double parameter_after(const Curve& curve, double from, double distance, double rest_length) {
  if (curve.degree() == 1) return from + (1.0 - from) * (distance / rest_length);
  double low = from;
  double high = 1.0;
  double passed = 0.0;  // arc length up to low
  double left = rest_length;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    const double first = arc_length(curve, low, middle);
    if (passed + first <= distance) {
      passed += first;
      left -= first;
      low = middle;
    } else {
      left = first;
      high = middle;
    }
  }
  return left > 0.0 ? std::min(high, low + (high - low) * ((distance - passed) / left)) : low;
}

// Walks along a path through alternating dashes and gaps.
class Dasher {
 public:
  Dasher(std::span<const double> pattern, double offset, std::vector<StrokePath>* dashes)
      : pattern_(pattern), dashes_(dashes) {
    while (offset > 0.0 && offset >= pattern_[step_]) {
      offset -= pattern_[step_];
      step_ = (step_ + 1) % pattern_.size();
    }
    left_ = pattern_[step_] - offset;
  }

  void walk(const StrokePath& path) {
    const std::size_t first = dashes_->size();
    const bool begins_drawn = is_drawn();
    if (begins_drawn) begin(path.curves.front().curve(), 0.0);
    for (const PartOfCurve& part : path.curves) {
      const Curve curve = part.curve();
      double from = 0.0;
      double ahead = arc_length(curve, 0.0, 1.0);
      while (left_ < ahead) {
        const double to = parameter_after(curve, from, left_, ahead);
        if (is_drawn() && to > from) open().curves.emplace_back(curve, from, to);
        ahead -= left_;
        from = to;
        step_ = (step_ + 1) % pattern_.size();
        left_ = pattern_[step_];
        if (is_drawn()) begin(curve, from);
      }
      if (is_drawn() && from < 1.0) open().curves.emplace_back(curve, from, 1.0);
      left_ -= ahead;
    }
    if (path.is_closed && begins_drawn && is_drawn()) join_ends(first);
  }

 private:
  bool is_drawn() const { return step_ % 2 == 0; }
  StrokePath& open() { return dashes_->back(); }

  void begin(const Curve& curve, double at) {
    StrokePath dash;
    dash.point = point_at(curve, at);
    const Point2 direction = derivative_at(curve, at);
    if (length(direction) > 0.0) dash.direction = (1.0 / length(direction)) * direction;
    dashes_->push_back(std::move(dash));
  }

  void join_ends(std::size_t first) {
    if (dashes_->size() - first == 1) {
      dashes_->back().is_closed = true;
      return;
    }
    StrokePath& last = dashes_->back();
    const StrokePath& begin = (*dashes_)[first];
    last.curves.insert(last.curves.end(), begin.curves.begin(), begin.curves.end());
    std::swap((*dashes_)[first], last);
    dashes_->pop_back();
  }

  std::span<const double> pattern_;
  std::vector<StrokePath>* dashes_;
  std::size_t step_ = 0;
  double left_ = 0.0;
};

}  // namespace

double arc_length(const Curve& curve, double from, double to) {
  if (curve.degree() == 1) return (to - from) * length(curve.end() - curve.begin());
  return refined_length(curve, from, to, gauss_length(curve, from, to), 12);
}

void append_dashes(const StrokePath& path, std::span<const double> pattern, double offset,
                   std::vector<StrokePath>* dashes) {
  Dasher(pattern, offset, dashes).walk(path);
}

}  // namespace prefilter
