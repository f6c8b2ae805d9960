// SPDX-License-Identifier: GPL-3.0-or-later

// A textured surface of any size for the benchmarks.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/geometry/surface.h"

namespace prefilter::bench {

/// 8 x 8 square charts, each turned by its own angle in its own cell of the texture, with gaps
/// between them: they cover half of it. A texel's share of the surface differs by up to 16 between
/// charts and by up to 3 inside of one. Has about `triangle_count` triangles, at least 128.
Surface charts(int triangle_count);

/// Detail at every scale down to the texel, in [0, 1]; the fourth channel is 1.
Image detailed_picture(int size);

}  // namespace prefilter::bench
