// SPDX-License-Identifier: GPL-3.0-or-later

// Builds sampling tables for a filter (section 6.2).
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

struct BuildTableOptions {
  TableShape shape;
  bool certify = false;  // whether to prove a bound on the distance of the sets from the optimum
  Run run;
};

/// Searches, by exchanging texels from fixed starts, for the sets and weights with the lowest error
/// of equation 6.4, plus the term of TableShape::ramp_weight. Throws Error for a shape that is out
/// of range, or if a section has fewer candidates than texels.
SamplingTable build_sampling_table(const BuildTableOptions& options);

/// Error of a section relative to trilinear interpolation: the ratio of the integrals of equation
/// 6.3 over the domain. If trilinear interpolation has no error, as for the box and the tent at one
/// level: 0 if the table has none either, else infinity.
double error_ratio(const TableSection& section);

}  // namespace prefilter
