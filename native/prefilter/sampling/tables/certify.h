// SPDX-License-Identifier: GPL-3.0-or-later

// Proves the optimality of sets of texels by branch and bound.
#pragma once

#include <cstdint>

#include "prefilter/base/run.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {

struct CertifyOptions {
  std::int64_t nodes = 0;  // limit of nodes in the search tree, after which the proof is abandoned
  Run run;
};

struct CertifiedSet {
  FittedSet set;
  double gap = 0.0;  // bound on the relative improvement by any other set; 0 if proven optimal
};

/// Searches for the best set with as many candidates as `start`. Returns `start` unless another set
/// with an error lower by more than 1e-9 of it is found. Sets whose weights have a root mean square
/// above 10, and sets with linearly dependent texels, are not considered.
CertifiedSet certify_set(const SubdomainSystem& system, const FittedSet& start,
                         const CertifyOptions& options);

}  // namespace prefilter
