// SPDX-License-Identifier: GPL-3.0-or-later

// Sets of few texels with low errors, by exchanging one texel at a time.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {

/// The best set of `texels` candidates that exchanges lead to, from a greedy start and from random
/// ones that are the same in every run: no exchange of one of its texels for another lowers its
/// error. The system has at least that many candidates; the set has fewer where all others are sums
/// of its own.
FittedSet find_set(const SubdomainSystem& system, int texels, const Progress& progress);

}  // namespace prefilter
