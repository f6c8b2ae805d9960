// Points to sums of samples in cells.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/reconstruct/sample_grid.h"
#include "prefilter/reconstruct/sample_store.h"
#include "prefilter/scan/point_source.h"

namespace prefilter {

/// What a first look at a cloud finds.
struct CloudExtent {
  Box box = kEmptyBox;      // around the points that count
  std::size_t points = 0;   // that there are
  std::size_t dropped = 0;  // that are not finite, have no normal or a weight that is not positive
  double weight = 0.0;      // of the points that count
};

/// Reads the source once.
CloudExtent measure_cloud(PointSource* source, const Progress& progress, int threads);

/// Reads the source again, and puts all points that count into cells. The same to rounding for
/// points in any order, and to the last bit for any number of threads.
void gather_samples(PointSource* source, const SampleGrid& grid, const Progress& progress,
                    int threads, SampleStore* store);

}  // namespace prefilter
