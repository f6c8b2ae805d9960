// SPDX-License-Identifier: GPL-3.0-or-later

// Sampling tables built for a filter (section 6.2).
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

struct BuildTableOptions {
  TableShape shape;
  bool certify = false;  // whether to prove how far from the best its sets are at the most
  Progress progress;
  int threads = 0;
};

/// The sets with the least errors that exchanges of texels find from fixed starts, and the weights
/// that minimize equation 6.4, with what TableShape::ramp_weight adds to it. Throws Error for a
/// shape that is out of range, or where a section has fewer candidates than texels.
SamplingTable build_sampling_table(const BuildTableOptions& options);

/// The integral of equation 6.3 over the domain of a section, of the table's over trilinear
/// interpolation's. Where that has no error to speak of, as it has none for the box and the tent at
/// one level: 0 if the table has none either, else infinity.
double error_ratio(const TableSection& section);

}  // namespace prefilter
