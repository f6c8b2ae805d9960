// SPDX-License-Identifier: GPL-3.0-or-later

// Equation 6.4 for a subdomain: which of its texels, with which weights.
//
// Its inner integral is over the plane for white images, and for natural ones over the correlations
// between all places of it, see filter_products.h. What is minimized is that, plus
// TableShape::ramp_weight times the squared distance between the
// sample and the weighted center of its texels, integrated over the subdomain. As weights sum to 1
// the distance is a weighted sum too, and products and right sides hold both.
//
// In polynomials that are orthonormal over the subdomain the weights' equations come apart: one
// right side for each polynomial, and the same products of texels for all.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/sampling/sampling_table.h"
#include "prefilter/sampling/tables/subdomain.h"

namespace prefilter {

/// The best weights of a set of texels, and what is minimized. Infinite, without weights, where
/// texels of the set make up another one of it.
struct FittedSet {
  std::vector<int> members;     // candidates, in rising order
  std::vector<double> weights;  // [member][polynomial]
  double error = std::numeric_limits<double>::infinity();
};

struct SubdomainSystem {
  SubdomainSystem(const TableShape& shape, const TableSection& section, int index);

  int candidates() const { return static_cast<int>(texels.size()); }
  int polynomials() const { return basis.count; }
  const double* products_of(int i) const {
    return products.data() + static_cast<std::size_t>(i) * texels.size();
  }
  const double* right_side_of(int i) const {
    return right_sides.data() + static_cast<std::size_t>(i) * basis.count;
  }
  /// What the weights sum to, in each polynomial: the integral of 1 times it.
  double weight_sum(int polynomial) const { return polynomial == 0 ? unit : 0.0; }

  /// Equation 6.4 alone, for a set that was fitted.
  double filter_error(const FittedSet& set) const;

  OrthonormalBasis basis;
  double unit = 1.0;                // square root of the subdomain's volume
  std::vector<TexelOffset> texels;  // that the filter overlaps somewhere in the subdomain
  std::vector<double> products;     // [i][j]: of texels i and j, over the plane
  std::vector<double> right_sides;  // [i][p]: with the filter of a sample, times polynomial p,
                                    // integrated over the subdomain
  double filter_square = 0.0;       // the filter's with itself, integrated likewise
  double trilinear_error = 0.0;     // by equation 6.4 alone

 private:
  void add_ramps(const Subdomain& subdomain, double weight);

  double ramp_weight_;
  std::vector<Point2> centers_;             // of texels, in cells from the subdomain's middle
  std::array<Point2, kMostTerms> ramps_{};  // x and y of a sample times polynomial p, likewise
};

FittedSet fit_set(const SubdomainSystem& system, std::span<const int> members);

}  // namespace prefilter
