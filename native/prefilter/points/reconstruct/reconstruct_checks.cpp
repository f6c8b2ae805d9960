// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/reconstruct_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

constexpr double kLargestIsovalue = 1e30;
constexpr double kLargestTrim = 1e6;
constexpr double kLargestAdaptivity = 1e6;

void check_adaptivity(double adaptivity) {
  if (adaptivity >= 0.0 && adaptivity <= kLargestAdaptivity) return;
  throw_invalid("adaptivity: found " + to_text(adaptivity) + "; allowed are 0 to " +
                to_text(kLargestAdaptivity));
}

}  // namespace

void check_options(const ReconstructOptions& options) {
  if (options.depth) check_depth(*options.depth, 1, "depth");
  if (options.cell_size && !(*options.cell_size > 0.0 && std::isfinite(*options.cell_size))) {
    throw_invalid("cell_size: " + to_text(*options.cell_size) +
                  "; a length above 0 is needed, or none");
  }
  if (options.isovalue == Isovalue::kGiven &&
      !(std::abs(options.given_isovalue) <= kLargestIsovalue)) {
    throw_invalid("isovalue: " + to_text(options.given_isovalue) +
                  "; a finite number of at most 1e30 is needed");
  }
  if (options.trim && !(*options.trim > 0.0 && *options.trim <= kLargestTrim)) {
    throw_invalid("trim: " + to_text(*options.trim) +
                  "; a number of cells above 0 and up to 1e6 is needed, or none");
  }
  check_adaptivity(options.adaptivity);
}

void check_cloud(const CloudExtent& extent) {
  if (extent.part.points < 3) {
    std::string count = extent.points == 0 ? "none" : std::to_string(extent.part.points);
    if (extent.dropped.sum() > 0) {
      count += " of " + std::to_string(extent.points) +
               " count, as the others have no finite position below 1e30, no normal or no weight";
    }
    throw_invalid("points: " + count + "; at least 3 are needed");
  }
  const Box& box = extent.part.box;
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  if (!(longest > 0.0)) throw_invalid("points: all coincide; a cloud with an extent is needed");
}

void check_mesh(const ReconstructOptions& options, const ReconstructReport& report) {
  if (report.triangles > 0) return;
  if (options.trim) {
    throw_invalid("trim: " + to_text(*options.trim) +
                  " cells leave no triangle; more are needed, or none");
  }
  if (report.trimmed.cut > 0.0) {
    throw_invalid("watertight: no point is near the surface; it must be closed");
  }
  if (options.isovalue == Isovalue::kGiven) {
    throw_invalid("isovalue: " + to_text(options.given_isovalue) +
                  " is nowhere; values are about 0 outside and 1 inside");
  }
  throw_invalid("points: the function is nowhere half full; use isovalue \"auto\"");
}

}  // namespace prefilter
