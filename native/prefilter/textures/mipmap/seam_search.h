// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the weight of seam links that makes a fit's error rise by exactly its budget.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"

namespace prefilter {

/// A number per channel; 0 for channels that do not exist.
using ChannelSums = std::array<double, kMaxChannels>;

/// Searches for the link weight at which a fit uses up its error budget. Errors grow with the
/// weight, up to a weight at which the links' differences are nearly 0.
class WeightSearch {
 public:
  static constexpr double kMaxWeight = 64.0;
  /// A fit that uses at least this share of the budget is accepted.
  static constexpr double kCloseEnough = 0.95;

  /// Starts with the weight `first`, above 0.
  explicit WeightSearch(double first);

  /// The weight of the next fit.
  double weight() const { return weight_; }
  /// Reports the share of the budget that the fit with that weight uses; above 1 is over budget.
  void report(double spent);
  /// Whether the search has ended: the last fit is accepted, the budget is bracketed closely, or
  /// tries have run out.
  bool done() const { return done_; }
  bool is_over() const { return over_; }

 private:
  double weight_;
  double low_ = 0.0;  // the largest weight within the budget, and the share it uses
  double low_spent_ = 0.0;
  double high_ = 0.0;  // the smallest weight over budget; 0 if unknown
  double high_spent_ = 0.0;
  int tries_ = 0;
  bool done_ = false;
  bool over_ = false;
};

/// The error that seams may cost in a level.
struct SeamBudget {
  double share = 0.0;     // allowed relative increase of the root of the squared error
  int first_channel = 0;  // errors of earlier channels are ignored
  double weight = WeightSearch::kMaxWeight;  // start of the search; set to its result
};

/// A fit with links. Its result is the texels of a system.
struct LinkedFit {
  /// Moves the texels from their current values to the fit with this weight.
  std::function<void(double, const Run&)> solve;
  /// Squared error of the current texels.
  std::function<double()> error;
};

/// Fits with the largest weight whose error is within the budget, starting from the fit without
/// links in the system. If the tried weights bracket the budget, the result interpolates the two
/// fits: the error is convex, so it stays within the budget. `square` is the error of all-zero
/// texels, which bounds rounding errors.
template <typename Entry>
void fit_within(double square, const LinkedFit& fit, const Run& run, NinePointSystem<Entry>* system,
                SeamBudget* budget);

/// Moves the texels of a system toward `within`, texels within the budget, just far enough to be
/// within it too. `spent` returns the share of the budget that the current texels use. Returns the
/// remaining fraction of the way from `within` to the original texels.
template <typename Entry>
double step_back_within(const std::vector<LaneValues>& within, const std::function<double()>& spent,
                        NinePointSystem<Entry>* system);

/// The allowed increase of a squared error.
double allowed_rise(const SeamBudget& budget, double squared_error, double square);

}  // namespace prefilter
