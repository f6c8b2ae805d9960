// SPDX-License-Identifier: GPL-3.0-or-later

// Size of a mesh.
#pragma once

#include <cstddef>

namespace prefilter {

struct MeshCounts {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

}  // namespace prefilter
