// SPDX-License-Identifier: GPL-3.0-or-later

// Anisotropic samples of a pyramid: isotropic ones in a row (section 6.3, figure 6.12).
#pragma once

#include <span>

#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

inline constexpr int kMostProbes = 256;

struct AnisotropicOptions : SampleOptions {
  int max_probes = 16;  // 1 to kMostProbes
};

/// As `sample`, with the Jacobian of each sample in the place of its scale.
///
/// Throws Error as `sample` does, for Jacobians that check_jacobians refuses, and for max_probes
/// out of range.
void sample_anisotropically(const Pyramid& pyramid, const SamplingTable* table,
                            std::span<const TexturePlace> coordinates,
                            std::span<const TextureJacobian> jacobians,
                            const AnisotropicOptions& options, std::span<float> result);

}  // namespace prefilter
