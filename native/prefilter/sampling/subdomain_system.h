// Equation 6.4 for a subdomain: which of its texels, with which weights.
//
// In polynomials that are orthonormal over the subdomain the weights' equations come apart: one
// right side for each polynomial, and the same products of texels for all.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "prefilter/filters/kernel.h"
#include "prefilter/sampling/sampling_table.h"
#include "prefilter/sampling/subdomain.h"

namespace prefilter {

struct SubdomainSystem {
  SubdomainSystem(const Kernel& kernel, const TableShape& shape, const TableSection& section,
                  int index);

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

  OrthonormalBasis basis;
  double unit = 1.0;                // square root of the subdomain's volume
  std::vector<TexelOffset> texels;  // that the filter overlaps somewhere in the subdomain
  std::vector<double> products;     // [i][j]: of texels i and j, over the plane
  std::vector<double> right_sides;  // [i][p]: with the filter of a sample, times polynomial p,
                                    // integrated over the subdomain
  double filter_square = 0.0;       // the filter's with itself, integrated likewise
  double trilinear_error = 0.0;
};

/// The best weights of a set of texels, and equation 6.4's value. Infinite, without weights, where
/// texels of the set make up another one of it.
struct FittedSet {
  std::vector<int> members;     // candidates, in rising order
  std::vector<double> weights;  // [member][polynomial]
  double error = std::numeric_limits<double>::infinity();
};
FittedSet fit_set(const SubdomainSystem& system, std::span<const int> members);

}  // namespace prefilter
