// SPDX-License-Identifier: GPL-3.0-or-later

// The decoders, one library each.
#pragma once

#include <memory>

#include "prefilter/textures/blocks/block_decoder.h"

namespace prefilter {

/// bcdec: kBc1, kBc1Rgb, kBc3, kBc4, kBc5, kBc7.
std::unique_ptr<ByteDecoder> make_bcdec_decoder(const DecodeOptions& options);

/// bcdec: kBc6h.
std::unique_ptr<HalfDecoder> make_bcdec_half_decoder();

/// etcpak: kEtc2Rgb, kEtc2Rgba, kEacR11, kEacRg11.
std::unique_ptr<ByteDecoder> make_etcpak_decoder(const DecodeOptions& options);

/// Basis Universal: kUastc.
std::unique_ptr<ByteDecoder> make_uastc_decoder();

/// astcenc: kAstc4x4, kAstc6x6, kAstc8x8.
std::unique_ptr<ByteDecoder> make_astc_decoder(const DecodeOptions& options);

/// astcenc: kAstc4x4Hdr, kAstc6x6Hdr.
std::unique_ptr<HalfDecoder> make_astc_hdr_decoder(const DecodeOptions& options);

}  // namespace prefilter
