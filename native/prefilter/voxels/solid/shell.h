// SPDX-License-Identifier: GPL-3.0-or-later

// Sheets with a thickness.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// Adds a closed shell around some triangles of `mesh` to `target`: what is within `half` of them
/// along their normals, either way. Which way around they are does not matter. `target` gets its
/// own vertices.
///
/// Each triangle becomes a prism, whose walls cancel where the next one goes on. Corners are moved
/// along the mean normal around them; where that would fold a prism over, along its own triangle's.
void add_shell(const MeshView<std::int32_t>& mesh, std::span<const std::int64_t> origins,
               std::span<const std::uint32_t> triangles, double half, WorkMesh* target);

}  // namespace prefilter
