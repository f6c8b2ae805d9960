// SPDX-License-Identifier: GPL-3.0-or-later

// Rows of isotropic probes that approximate elliptical filters (figure 6.12).
#pragma once

#include <span>

#include "prefilter/sampling/anisotropic.h"
#include "prefilter/sampling/footprint.h"
#include "prefilter/sampling/pyramid_sampler.h"
#include "prefilter/sampling/sample_places.h"

namespace prefilter {

/// Isotropic Gaussians along the major axis of an ellipse, centered on it, whose weighted sum
/// approximates the elliptical Gaussian. Probe k is (k - (count - 1) / 2) * spacing from the
/// center, and has the weight exp(-falloff * distance^2) up to a common factor.
struct ProbeRow {
  int count = 1;
  double width = 1.0;    // the scale of each [texels of level 0]
  double spacing = 0.0;  // [texels of level 0]
  double falloff = 0.0;  // [1 / texels^2]
};

/// At most `max_probes`, from 1 to kMaxProbes. The probes are as wide as the ellipse's minor axis,
/// but at least 2 / (max_probes + 1) of the major axis, to cover it with the allowed number. A
/// single probe thus has the width of the major axis.
ProbeRow probe_row(const Footprint& footprint, int max_probes);

/// Throws Error unless max_probes is in range.
void check_probe_count(int max_probes);

/// A pyramid to be sampled with probes, by any number of threads concurrently.
struct ProbedPyramid {
  const PyramidSampler& sampler;
  int width;  // texels of level 0
  int height;
  int levels;
  int channels;
  int max_probes;

  /// Writes samples at finite coordinates with finite Jacobians, with interleaved channels.
  void sample(std::span<const TexturePlace> coordinates, std::span<const TextureJacobian> jacobians,
              float* result) const;
};

}  // namespace prefilter
