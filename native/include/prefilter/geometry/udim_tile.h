// SPDX-License-Identifier: GPL-3.0-or-later

// UDIM: textures composed of tiles, each a separate image.
#pragma once

#include "prefilter/geometry/surface.h"

namespace prefilter {

constexpr int kFirstUdimTile = 1001;
constexpr int kLastUdimTile = 9999;

/// The part of a surface in UDIM tile `number`, moved to the unit square. The tile covers u from c
/// to c + 1 and v from r to r + 1, where number = 1001 + c + 10 r and c < 10.
///
/// Triangles are cut exactly at the tile's edges. Each part has its share of the triangle's area,
/// even if texture coordinates are degenerate. A triangle that is a line or point on the edge
/// between two tiles belongs to the right or upper one. Neighboring parts share the vertices on
/// their common edge. The result is empty if nothing lies in the tile.
///
/// Throws Error for a number outside 1001 to 9999.
Surface udim_tile(const Surface& surface, int number);

}  // namespace prefilter
