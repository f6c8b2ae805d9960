// SPDX-License-Identifier: GPL-3.0-or-later

// The encoders and their libraries.
#pragma once

#include <memory>

#include "prefilter/textures/blocks/block_encoder.h"

namespace prefilter {

/// libsquish: kBc1, kBc1Rgb, kBc3, kBc4, kBc5.
std::unique_ptr<ByteEncoder> make_squish_encoder(const BlockOptions& options);

/// The closer result of libsquish and Convection Texture Tools for separate channels: the alpha of
/// kBc3, kBc4, kBc5.
std::unique_ptr<ByteEncoder> make_channel_encoder(const BlockOptions& options);

/// kBc7, by the following three.
std::unique_ptr<ByteEncoder> make_bc7_encoder(BlockEffort effort);

/// BC7F of Basis Universal: kBc7. Opaque texels stay opaque.
std::unique_ptr<ByteEncoder> make_bc7f_encoder(BlockEffort effort);

/// bc7enc: kBc7. Opaque texels stay opaque.
std::unique_ptr<ByteEncoder> make_bc7enc_encoder(BlockEffort effort);

/// Convection Texture Tools: kBc7. Opaque texels may become slightly transparent.
std::unique_ptr<ByteEncoder> make_cvtt_bc7_encoder();

/// Convection Texture Tools: kBc6h.
std::unique_ptr<HalfEncoder> make_cvtt_encoder(BlockEffort effort);

/// etcpak: kEtc2Rgb, kEtc2Rgba, kEacR11, kEacRg11.
std::unique_ptr<ByteEncoder> make_etcpak_encoder(const BlockOptions& options);

/// etcpak, and an exhaustive search of the ETC2 modes: kEtc2Rgb, kEtc2Rgba.
std::unique_ptr<ByteEncoder> make_etc2_encoder(const BlockOptions& options);

/// Basis Universal: kUastc.
std::unique_ptr<ByteEncoder> make_uastc_encoder(BlockEffort effort);

/// astcenc: kAstc4x4, kAstc6x6, kAstc8x8. Constructing it takes 2 to 10 ms.
std::unique_ptr<ByteEncoder> make_astc_encoder(const BlockOptions& options);

/// astcenc: kAstc4x4Hdr, kAstc6x6Hdr.
std::unique_ptr<HalfEncoder> make_astc_hdr_encoder(const BlockOptions& options);

}  // namespace prefilter
