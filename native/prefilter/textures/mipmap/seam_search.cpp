// SPDX-License-Identifier: GPL-3.0-or-later

// The error rises with the weight w, as w^2 at first and then more slowly, so a secant in the
// logarithms of both needs few fits; each of them starts from the one before.
#include "prefilter/textures/mipmap/seam_search.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

constexpr int kMostTries = 8;
// A budget between two weights that are this close is met well enough between their fits.
constexpr double kCloseWeights = 2.0;
constexpr double kFarthestStep = 16.0;
// What is aimed at, so that the fit that comes out is within the budget.
constexpr double kAim = 0.975;
// Of the logarithm of what is spent by that of the weight: where only one point is known, and what
// it may be between two.
constexpr double kTypicalSlope = 0.8;
constexpr double kFlattest = 0.25;
constexpr double kSteepest = 2.0;
// Errors are differences of sums of floats, which are as large as the square of the image.
constexpr double kRounding = 1e-7;
// Of the budget, between two fits.
constexpr double kAlmostAll = 0.999;
constexpr double kLeastStep = 1e-3;
constexpr double kBackOff = 0.9;

}  // namespace

WeightSearch::WeightSearch(double first) : weight_(std::clamp(first, 1e-6, kMostWeight)) {}

void WeightSearch::found(double spent) {
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
    done_ = tries_ >= kMostTries || (between && high_ <= kCloseWeights * low_);
  } else {
    done_ = tries_ >= kMostTries || spent >= kCloseEnough || weight_ >= kMostWeight;
  }
  if (done_) return;
  double slope = kTypicalSlope;
  if (between && low_spent_ > 0.0) {
    slope = std::clamp(elementary::log(high_spent_ / low_spent_) / elementary::log(high_ / low_),
                       kFlattest, kSteepest);
  }
  double step = over_ ? 1.0 / kFarthestStep : kFarthestStep;
  if (spent > 0.0 && std::isfinite(spent)) {
    step =
        std::clamp(elementary::pow(kAim / spent, 1.0 / slope), 1.0 / kFarthestStep, kFarthestStep);
  }
  double next = weight_ * step;
  if (between) {
    // Not closer to either end than a tenth of the way.
    const double margin = elementary::pow(high_ / low_, 0.1);
    next = std::clamp(next, low_ * margin, high_ / margin);
  }
  weight_ = std::min(next, kMostWeight);
}

double allowed_rise(const SeamBudget& budget, double squared_error, double square) {
  return budget.share * (2.0 + budget.share) * (squared_error - kRounding * square);
}

template <typename Entry>
double draw_back(const std::vector<LaneValues>& within, const std::function<double()>& spent,
                 NinePointSystem<Entry>* system) {
  const auto size = static_cast<std::ptrdiff_t>(system->size());
  std::vector<LaneValues> beyond(system->size());
  for (std::ptrdiff_t i = 0; i < size; ++i) beyond[i] = system->texel(i);
  const auto spent_at = [&](double f) {
    const auto share = static_cast<float>(f);
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      system->texel(i).v = within[i].v + share * (beyond[i].v - within[i].v);
    }
    return spent();
  };
  // The parabola through both ends and the middle.
  const double last = spent();
  const double first = spent_at(0.0);
  const double curve = 2.0 * (last + first - 2.0 * spent_at(0.5));
  const double slope = last - first - curve;
  const double left = kAlmostAll - first;
  const double root = std::sqrt(std::max(slope * slope + 4.0 * curve * left, 0.0));
  double f = std::clamp(2.0 * left / (slope + root), 0.0, 1.0);
  if (!(left > 0.0 && slope + root > 0.0)) f = 0.0;
  while (f > 0.0 && !(spent_at(f) <= 1.0)) f = f > kLeastStep ? kBackOff * f : 0.0;
  if (f == 0.0) spent_at(0.0);
  return f;
}

template <typename Entry>
void fit_within(double square, const LinkedFit& fit, const Progress& progress,
                NinePointSystem<Entry>* system, SeamBudget* budget) {
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
  double done = 0.0;
  while (!search.done()) {
    const double next = 0.5 * (done + 1.0);
    budget->weight = search.weight();
    fit.solve(budget->weight, progress.part(done, next));
    done = next;
    search.found(spent());
    if (!search.is_over()) keep(budget->weight);
  }
  if (!search.is_over()) return;
  const double share = draw_back(kept, spent, system);
  budget->weight = kept_weight > 0.0
                       ? kept_weight * elementary::pow(budget->weight / kept_weight, share)
                       : share * budget->weight;
}

template void fit_within(double, const LinkedFit&, const Progress&, NinePointSystem<float>*,
                         SeamBudget*);
template void fit_within(double, const LinkedFit&, const Progress&, NinePointSystem<LaneValues>*,
                         SeamBudget*);
template double draw_back(const std::vector<LaneValues>&, const std::function<double()>&,
                          NinePointSystem<float>*);

}  // namespace prefilter
