// The encoders, a library each.
#pragma once

#include <memory>

#include "prefilter/blocks/block_encoder.h"

namespace prefilter {

/// libsquish: kBc1, kBc3, kBc4, kBc5.
std::unique_ptr<ByteEncoder> make_squish_encoder(const BlockOptions& options);

}  // namespace prefilter
