// SPDX-License-Identifier: GPL-3.0-or-later

// How much seams may count in a fit whose error may rise by so much and no more.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"

namespace prefilter {

/// A number for each channel, those that there are not 0.
using ChannelSums = std::array<double, kMaxChannels>;

/// The search for the weight of links at which a fit spends its budget. The more they weigh the
/// more it spends, up to a weight at which next to nothing is left of them.
class WeightSearch {
 public:
  static constexpr double kMostWeight = 64.0;
  /// A fit that spends this share of the budget, or more, is close enough.
  static constexpr double kCloseEnough = 0.95;

  /// Begins with the weight `first`, above 0.
  explicit WeightSearch(double first);

  /// What to fit with next.
  double weight() const { return weight_; }
  /// Says what share of the budget the fit with that weight spends: above 1 is too much.
  void found(double spent);
  /// Whether nothing is left to try: the last fit is close enough, or the budget is between what it
  /// and an earlier one spend.
  bool done() const { return done_; }
  bool is_over() const { return over_; }

 private:
  double weight_;
  double low_ = 0.0;  // the largest weight that is within the budget, and what it spends
  double low_spent_ = 0.0;
  double high_ = 0.0;  // the least that is not; 0 where none is known
  double high_spent_ = 0.0;
  int tries_ = 0;
  bool done_ = false;
  bool over_ = false;
};

/// What seams may cost in a level.
struct SeamBudget {
  double share = 0.0;                         // by which the root of its squared error may rise
  int first_channel = 0;                      // whose error counts; those before it do not
  double weight = WeightSearch::kMostWeight;  // where a search begins; becomes what it found
};

/// A fit with links, whose texels are those of a system.
struct LinkedFit {
  /// Moves the texels to the fit with this weight, from where they are.
  std::function<void(double, const Progress&)> solve;
  /// The squared error of the texels as they are.
  std::function<double()> error;
};

/// Fits with the largest weight at which the error rises by no more than the budget allows; the
/// system has the texels of the fit without links. Where the weights tried are above and below it,
/// the texels become those between the two fits: the error is convex, so they are within it too.
/// `square` is what the error would be without texels: some of it is lost to rounding.
template <typename Entry>
void fit_within(double square, const LinkedFit& fit, const Progress& progress,
                NinePointSystem<Entry>* system, SeamBudget* budget);

/// Moves the texels of a system back to others, `within` a budget, as far as it takes for theirs to
/// be within it; `spent` tells what share of it they spend. Returns how much of the way between
/// the two is left.
template <typename Entry>
double draw_back(const std::vector<LaneValues>& within, const std::function<double()>& spent,
                 NinePointSystem<Entry>* system);

/// How much a squared error may rise for a budget.
double allowed_rise(const SeamBudget& budget, double squared_error, double square);

}  // namespace prefilter
