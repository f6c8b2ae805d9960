// SPDX-License-Identifier: GPL-3.0-or-later

// Proofs that sets of texels are the best, by branch and bound.
#pragma once

#include <cstdint>

#include "prefilter/base/progress.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {

struct CertifyOptions {
  std::int64_t nodes = 0;  // of the search tree: where it ends if there is no proof by then
  Progress progress;
  int threads = 0;
};

struct CertifiedSet {
  FittedSet set;
  double gap = 0.0;  // how much lower the error of another set may still be, as a share of it; 0
                     // is a proof
};

/// The best set of as many candidates as `start` has, or the best that was found: `start`, unless
/// another one has an error lower by more than a billionth. Of sets whose weights have a root mean
/// square above 10, and of those that have a texel that others make up, nothing is said.
CertifiedSet certify_set(const SubdomainSystem& system, const FittedSet& start,
                         const CertifyOptions& options);

}  // namespace prefilter
