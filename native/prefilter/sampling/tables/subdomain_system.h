// SPDX-License-Identifier: GPL-3.0-or-later

// Equation 6.4 for a subdomain, as a linear system for the weights of its texels.
//
// The inner integral is over the plane for white images. For natural images it is over the
// correlations between all positions, see filter_products.h. The objective adds
// TableShape::ramp_weight times the squared distance between the sample and the weighted center of
// its texels, integrated over the subdomain. This distance is a weighted sum too, since weights sum
// to 1, so products and right sides include both.
//
// In polynomials that are orthonormal over the subdomain, the equations decouple: there is one
// right side per polynomial, and the matrix of texel products is the same for all.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/sampling/sampling_table.h"
#include "prefilter/sampling/tables/subdomain.h"

namespace prefilter {

/// The optimal weights of a set of texels, and the objective. Infinite and without weights if
/// texels of the set are linearly dependent.
struct FittedSet {
  std::vector<int> members;     // candidates, in increasing order
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
  /// The sum of the weights in each polynomial: the integral of 1 times the polynomial.
  double weight_sum(int polynomial) const { return polynomial == 0 ? unit : 0.0; }

  /// Equation 6.4 alone, for a fitted set.
  double filter_error(const FittedSet& set) const;

  OrthonormalBasis basis;
  double unit = 1.0;                // square root of the subdomain's volume
  std::vector<TexelOffset> texels;  // texels that the filter overlaps somewhere in the subdomain
  std::vector<double> products;     // [i][j]: of texels i and j, in the plane
  std::vector<double> right_sides;  // [i][p]: product with the filter of a sample, times
                                    // polynomial p, integrated over the subdomain
  double filter_square = 0.0;       // product of the filter with itself, integrated as well
  double trilinear_error = 0.0;     // of equation 6.4 alone

 private:
  void add_ramps(const Subdomain& subdomain, double weight);

  double ramp_weight_;
  std::vector<Point2> centers_;            // of texels, in cells from the subdomain's center
  std::array<Point2, kMaxTerms> ramps_{};  // integrals of a sample's x and y times polynomial p
};

FittedSet fit_set(const SubdomainSystem& system, std::span<const int> members);

}  // namespace prefilter
