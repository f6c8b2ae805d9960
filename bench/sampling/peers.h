// SPDX-License-Identifier: GPL-3.0-or-later

// Samplers to compare with, of RGBA texels that repeat.
#pragma once

#include <memory>

#include "bench/sampling/scenes.h"

namespace prefilter::bench {

class Peer {
 public:
  virtual ~Peer() = default;
  /// Writes four floats a sample, on one thread.
  virtual void sample(const Samples& samples, float* result) = 0;
};

/// Trilinear interpolation, written straightforwardly.
std::unique_ptr<Peer> written_trilinear(const Texture& texture, bool bytes);

/// OpenImageIO's TextureSystem; trilinear, from a tiled file that its cache holds.
std::unique_ptr<Peer> openimageio(const Texture& texture, bool bytes);

}  // namespace prefilter::bench
