// SPDX-License-Identifier: GPL-3.0-or-later

// UDIM: a texture in tiles, each an image of its own.
#pragma once

#include "prefilter/geometry/surface.h"

namespace prefilter {

constexpr int kFirstUdimTile = 1001;
constexpr int kLastUdimTile = 9999;

/// The part of a surface that lies in UDIM tile `number`, moved to the unit square. The tile covers
/// u from c to c + 1 and v from r to r + 1, where number = 1001 + c + 10 r and c < 10.
///
/// Triangles are cut exactly at the tile's edges; a part has its share of the triangle's area, also
/// where texture coordinates are degenerate. A triangle that is a line or a point in the texture
/// and lies just on an edge between tiles belongs to the tile right of or above it. Parts of
/// neighbors share the vertices that were cut into their common edge. The result has no triangle
/// where nothing lies in the tile.
///
/// Throws Error for a number that is not in 1001 to 9999.
Surface udim_tile(const Surface& surface, int number);

}  // namespace prefilter
