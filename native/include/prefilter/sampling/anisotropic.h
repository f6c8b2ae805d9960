// SPDX-License-Identifier: GPL-3.0-or-later

// Anisotropic samples of a pyramid, as rows of isotropic probes (section 6.3, figure 6.12).
#pragma once

#include <span>

#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

inline constexpr int kMaxProbes = 256;

struct AnisotropicOptions : SampleOptions {
  int max_probes = 16;  // 1 to kMaxProbes
};

/// Like `sample`, with a Jacobian instead of a scale for each sample.
///
/// Throws Error like `sample`, for Jacobians that check_jacobians rejects, and if max_probes is out
/// of range.
void sample_anisotropically(const Pyramid& pyramid, const SamplingTable* table,
                            std::span<const TexturePlace> coordinates,
                            std::span<const TextureJacobian> jacobians,
                            const AnisotropicOptions& options, std::span<float> result);

}  // namespace prefilter
