// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices moved onto the surface of the samples around them.
//
// Beyond the text: the contour says where the surface is to a fraction of a cell, and how its parts
// hang together; where it runs the samples know better.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/sample_index.h"

namespace prefilter {

/// The surface of the samples within a cell's side of a point, as seen from there; in cells.
struct LocalSurface {
  Vector3 normal{};       // of length 1
  double distance = 0.0;  // of the point from the surface, along the normal
  double spread = 0.0;    // of that distance by the samples of each cell: standard deviation
  double weight = 0.0;    // of as many samples as would have the same noise, all weighted alike
  double cells = 0.0;     // as many of these, likewise
  double trust = 1.0;     // how much the distance counts beside the function's: trust_in
};

/// None where there are no samples, or their normals cancel each other, or with a `normal_trust` of
/// 0 the means of their cells are nearly on a line. With weights w = (1 - r^2)^2 for samples r
/// cells away, the distance is the mean of that from the plane through the mean sample, across the
/// mean normal, and that from the samples' own planes. Where the surface curves, the first is too
/// large by as much as the second is too small. Less `normal_trust` than 1 takes the normal more
/// and more from the plane that fits the samples' positions, and the distance from that plane
/// alone.
std::optional<LocalSurface> local_surface(const SampleIndex& index, const Vector3& point,
                                          double normal_trust);

/// What a cloud's samples are like, in finest cells.
struct SampleNoise {
  double distance = 0.0;      // of a sample from the surface: the standard deviation
  double normal_trust = 1.0;  // 1 where normals of one cell agree, 0 where they hardly do
  double mean_weight = 1.0;   // of a sample
};

/// How much the samples' distance counts beside the function's, from 0 to 1: by the variance of the
/// one, from how much its cells differ and, where they are few, from the cloud's noise in cells of
/// the surface's depth, and by that of the other.
double trust_in(const LocalSurface& surface, double noise, double mean_weight);

/// Of some cells of one depth, from the surface of the samples within two of their sides;
/// `coarser` has the samples of the depth above. `mean_weight` is that of a sample.
SampleNoise measure_noise(std::span<const SampleCell> cells, const SampleIndex& coarser,
                          double mean_weight);

/// Where a point may move: to start + t * direction, t from `low` up to `high`.
struct FitLine {
  Vector3 start{};
  Vector3 direction{};
  double low = 0.0;
  double high = 1.0;
};

/// Moves points onto the surface of the samples around them, where these agree on it: where noise
/// or scans that are off part them, the function that was solved for tells better.
class SampleFit {
 public:
  /// `index_of(k)` gives the samples of depth k; `finest` is the largest.
  using IndexOf = std::function<const SampleIndex&(int)>;
  SampleFit(IndexOf index_of, int finest, const SampleNoise& noise)
      : index_of_(std::move(index_of)), finest_(finest), noise_(noise) {}

  /// Of a point in finest cells, next to leaves of this depth. A contour whose vertices stay on the
  /// lines between the cells that they part does not fold. Without a line it moves along the
  /// normal, up to a cell of the samples at a time, for a function that was not solved for.
  void move(int depth, const FitLine* line, Vector3* point) const;

  /// The surface as seen from such a point, in cells of that depth.
  std::optional<LocalSurface> surface_near(int depth, const Vector3& point) const;

  const SampleIndex& samples(int depth) const { return index_of_(depth); }

 private:
  IndexOf index_of_;
  int finest_;
  SampleNoise noise_;
};

/// The attributes of the samples within a cell's side, weighted likewise; false where there are
/// none.
bool blend_attributes(const SampleIndex& index, const Vector3& point, std::span<float> attributes);

}  // namespace prefilter
