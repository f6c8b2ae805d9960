// SPDX-License-Identifier: GPL-3.0-or-later

// What reads bytes of others, as functions of any bytes: they return, whatever the bytes are, or
// throw anything but an Error, run into a sanitizer, or never end.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace prefilter {

struct FuzzTarget {
  std::string_view name;  // also that of the folder with its seeds
  void (*read)(std::span<const std::uint8_t> bytes);
};

std::span<const FuzzTarget> fuzz_targets();

// Files of points, by their ending.
void read_ply(std::span<const std::uint8_t> bytes);
void read_pcd(std::span<const std::uint8_t> bytes);
void read_ptx(std::span<const std::uint8_t> bytes);
void read_obj(std::span<const std::uint8_t> bytes);
void read_text(std::span<const std::uint8_t> bytes);

/// Blocks behind the number of their format, their width and their height, a byte each.
void read_blocks(std::span<const std::uint8_t> bytes);
/// Sixteen bits for each: endpoints, selectors, bytes of endpoints, of selectors, of tables and of
/// colors; width and height, a byte each; then these bytes, and the rest for alpha.
void read_etc1s(std::span<const std::uint8_t> bytes);
/// Frames of zstd behind the number of their bytes when unpacked, in 32 bits.
void read_zstd(std::span<const std::uint8_t> bytes);

/// SVG's path data.
void read_path(std::span<const std::uint8_t> bytes);
/// The same behind a byte of bits that say how it is drawn.
void draw_path(std::span<const std::uint8_t> bytes);

}  // namespace prefilter
