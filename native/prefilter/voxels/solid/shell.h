// SPDX-License-Identifier: GPL-3.0-or-later

// Thickens sheets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// Adds to `target` a closed shell around triangles of `mesh`: all points within `half` along their
/// normals, on both sides. The triangles' orientation does not matter. `target` gets new vertices.
///
/// Each triangle becomes a prism; walls shared by adjacent prisms cancel. Corners are offset along
/// the mean normal around them, or along the triangle's own where the prism would fold over.
void add_shell(const MeshView<std::int32_t>& mesh, std::span<const std::int64_t> origins,
               std::span<const std::uint32_t> triangles, double half, WorkMesh* target);

}  // namespace prefilter
