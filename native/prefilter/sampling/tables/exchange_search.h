// SPDX-License-Identifier: GPL-3.0-or-later

// Searches for small sets of texels with a low error by exchanging single texels.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {

/// The best set of `texels` candidates reached by exchanges from a greedy start and from random
/// starts, which are the same in every run. It is a local minimum: no single exchange lowers its
/// error. The system must have at least that many candidates; the set is smaller if all others are
/// linear combinations of it.
FittedSet find_set(const SubdomainSystem& system, int texels, const Run& run);

}  // namespace prefilter
