// SPDX-License-Identifier: GPL-3.0-or-later

// The error rises with the weight w, first as w^2 and then more slowly. A secant search on the
// logarithms of both therefore needs few fits; each starts from the previous one.
#include "prefilter/textures/mipmap/seam_search.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

constexpr int kMaxTries = 8;
// If the weights within and over budget are within this factor, interpolating the fits is enough.
constexpr double kCloseWeights = 2.0;
constexpr double kMaxStep = 16.0;  // factor of the weight
// Share of the budget to aim at, so that the resulting fit is within the budget.
constexpr double kAim = 0.975;
// d log(error) / d log(weight): the slope assumed while only one point is known, and the range it
// is clamped to between two.
constexpr double kTypicalSlope = 0.8;
constexpr double kFlattest = 0.25;
constexpr double kSteepest = 2.0;
// Relative rounding error: errors are differences of float sums as large as the squared image.
constexpr double kErrorRounding = 1e-7;
// Share of the budget to reach by interpolating two fits.
constexpr double kInterpolatedAim = 0.999;
constexpr double kMinFraction = 1e-3;  // of the way between two fits
constexpr double kBackOff = 0.9;

}  // namespace

WeightSearch::WeightSearch(double first) : weight_(std::clamp(first, 1e-6, kMaxWeight)) {}

void WeightSearch::report(double spent) {
  ++tries_;
  over_ = !(spent <= 1.0);
  if (over_) {
    high_ = weight_;
    high_spent_ = spent;
  } else {
    low_ = weight_;
    low_spent_ = spent;
  }
  const bool between = low_ > 0.0 && high_ > 0.0;
  if (over_) {
    done_ = tries_ >= kMaxTries || (between && high_ <= kCloseWeights * low_);
  } else {
    done_ = tries_ >= kMaxTries || spent >= kCloseEnough || weight_ >= kMaxWeight;
  }
  if (done_) return;
  double slope = kTypicalSlope;
  if (between && low_spent_ > 0.0) {
    slope = std::clamp(elementary::log(high_spent_ / low_spent_) / elementary::log(high_ / low_),
                       kFlattest, kSteepest);
  }
  double step = over_ ? 1.0 / kMaxStep : kMaxStep;
  if (spent > 0.0 && std::isfinite(spent)) {
    step = std::clamp(elementary::pow(kAim / spent, 1.0 / slope), 1.0 / kMaxStep, kMaxStep);
  }
  double next = weight_ * step;
  if (between) {
    // At least a tenth of the way from either end.
    const double margin = elementary::pow(high_ / low_, 0.1);
    next = std::clamp(next, low_ * margin, high_ / margin);
  }
  weight_ = std::min(next, kMaxWeight);
}

double allowed_rise(const SeamBudget& budget, double squared_error, double square) {
  return budget.share * (2.0 + budget.share) * (squared_error - kErrorRounding * square);
}

template <typename Entry>
double step_back_within(const std::vector<LaneValues>& within, const std::function<double()>& spent,
                        NinePointSystem<Entry>* system) {
  const auto size = static_cast<std::ptrdiff_t>(system->size());
  std::vector<LaneValues> original(system->size());
  for (std::ptrdiff_t i = 0; i < size; ++i) original[i] = system->texel(i);
  const auto spent_at = [&](double f) {
    const auto share = static_cast<float>(f);
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      system->texel(i).v = within[i].v + share * (original[i].v - within[i].v);
    }
    return spent();
  };
  // The parabola through both ends and the middle.
  const double last = spent();
  const double first = spent_at(0.0);
  const double curve = 2.0 * (last + first - 2.0 * spent_at(0.5));
  const double slope = last - first - curve;
  const double left = kInterpolatedAim - first;
  const double root = std::sqrt(std::max(slope * slope + 4.0 * curve * left, 0.0));
  double f = std::clamp(2.0 * left / (slope + root), 0.0, 1.0);
  if (!(left > 0.0 && slope + root > 0.0)) f = 0.0;
  while (f > 0.0 && !(spent_at(f) <= 1.0)) f = f > kMinFraction ? kBackOff * f : 0.0;
  if (f == 0.0) spent_at(0.0);
  return f;
}

template <typename Entry>
void fit_within(double square, const LinkedFit& fit, const Run& run, NinePointSystem<Entry>* system,
                SeamBudget* budget) {
  const auto size = static_cast<std::ptrdiff_t>(system->size());
  const double least = fit.error();
  const double rise = allowed_rise(*budget, least, square);
  if (!(rise > 0.0)) return;
  const auto spent = [&] { return (fit.error() - least) / rise; };
  std::vector<LaneValues> kept(system->size());  // the texels of the best fit within the budget
  double kept_weight = 0.0;
  const auto keep = [&](double weight) {
    for (std::ptrdiff_t i = 0; i < size; ++i) kept[i] = system->texel(i);
    kept_weight = weight;
  };
  keep(0.0);
  WeightSearch search(budget->weight);
  double fraction = 0.0;
  while (!search.done()) {
    const double next = 0.5 * (fraction + 1.0);
    budget->weight = search.weight();
    fit.solve(budget->weight, run.part(fraction, next));
    fraction = next;
    search.report(spent());
    if (!search.is_over()) keep(budget->weight);
  }
  if (!search.is_over()) return;
  const double share = step_back_within(kept, spent, system);
  budget->weight = kept_weight > 0.0
                       ? kept_weight * elementary::pow(budget->weight / kept_weight, share)
                       : share * budget->weight;
}

template void fit_within(double, const LinkedFit&, const Run&, NinePointSystem<float>*,
                         SeamBudget*);
template void fit_within(double, const LinkedFit&, const Run&, NinePointSystem<LaneValues>*,
                         SeamBudget*);
template double step_back_within(const std::vector<LaneValues>&, const std::function<double()>&,
                                 NinePointSystem<float>*);

}  // namespace prefilter
