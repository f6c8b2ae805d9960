// SPDX-License-Identifier: GPL-3.0-or-later

// Moves vertices onto the surface defined by the samples around them.
//
// Not in the dissertation: the contour locates the surface to a fraction of a cell and fixes its
// topology, but the samples locate it more precisely.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/sample_index.h"

namespace prefilter {

/// The surface defined by samples within one cell side of a point, relative to that point; lengths
/// in cells.
struct LocalSurface {
  Vector3 normal{};       // unit length
  double distance = 0.0;  // signed distance of the point from the surface, along the normal
  double spread = 0.0;    // standard deviation of that distance over the cells' samples
  // effective number of samples (Kish): as many equally weighted ones have the same noise
  double weight = 0.0;
  double cells = 0.0;  // effective number of cells
  double trust = 1.0;  // weight of the distance against the function's: trust_in
};

/// Returns none where there are no samples, where their normals cancel, or, for a `normal_trust` of
/// 0, where the cells' means are nearly on a line. With weights w = (1 - r^2)^2 for samples r cells
/// away, the distance is the average of two estimates: from the plane through the mean sample
/// across the mean normal, and from the samples' own planes. On a curved surface the first is too
/// large by as much as the second is too small. A `normal_trust` below 1 blends the normal toward
/// that of the plane fitted to the samples' positions, and the distance toward that plane's.
std::optional<LocalSurface> local_surface(const SampleIndex& index, const Vector3& point,
                                          double normal_trust);

/// Noise of a cloud's samples; lengths in finest cells.
struct SampleNoise {
  double distance = 0.0;      // standard deviation of a sample's distance from the surface
  double normal_trust = 1.0;  // 1 where normals within a cell agree, 0 where they hardly do
  double mean_weight = 1.0;   // mean weight of a sample
};

/// Weight of the samples' distance against the function's, from 0 to 1. It compares the variance of
/// the samples' estimate with that of the function. The former follows from the spread of the cells
/// and, where they are few, from the cloud's noise in cells of the surface's depth.
double trust_in(const LocalSurface& surface, double noise, double mean_weight);

/// Measures the noise of some cells of one depth against the surface of the samples within two of
/// their sides. `coarser` holds the samples one depth up; `mean_weight` is the mean weight of a
/// sample.
SampleNoise measure_noise(std::span<const SampleCell> cells, const SampleIndex& coarser,
                          double mean_weight);

/// Line on which a point may move: start + t * direction, with t from `low` to `high`.
struct FitLine {
  Vector3 start{};
  Vector3 direction{};
  double low = 0.0;
  double high = 1.0;
};

/// Moves points onto the surface of the samples around them where these agree. Where noise or
/// misaligned scans spread them, the solved function is more accurate.
class SampleFit {
 public:
  /// `index_of(k)` returns the samples of depth k; `finest` is the largest depth.
  using IndexOf = std::function<const SampleIndex&(int)>;
  SampleFit(IndexOf index_of, int finest, const SampleNoise& noise)
      : index_of_(std::move(index_of)), finest_(finest), noise_(noise) {}

  /// Moves a point, in finest cells, next to leaves of depth `depth`. Vertices that stay on the
  /// lines between the centers of adjacent cells keep the contour free of folds. Without a line the
  /// point moves along the normal, by up to one sample cell per iteration; this is for functions
  /// that were not solved for.
  void move(int depth, const FitLine* line, Vector3* point) const;

  /// The surface relative to such a point, in cells of depth `depth`.
  std::optional<LocalSurface> surface_near(int depth, const Vector3& point) const;

  const SampleIndex& samples(int depth) const { return index_of_(depth); }

 private:
  IndexOf index_of_;
  int finest_;
  SampleNoise noise_;
};

/// Averages the attributes of the samples within one cell side, with the same weights; returns
/// false where there are none.
bool blend_attributes(const SampleIndex& index, const Vector3& point, std::span<float> attributes);

}  // namespace prefilter
