// SPDX-License-Identifier: GPL-3.0-or-later

// Reads and writes the parts of a surface.
#pragma once

#include <cstddef>

#include "prefilter/base/io/archive.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"

namespace prefilter {

void write_part(const SlabMesh& part, ArchiveWriter* file);

/// Reads a part whose vertices have `width` attributes. Throws Error(kFile) for invalid data.
SlabMesh read_part(std::size_t width, ArchiveReader* file);

}  // namespace prefilter
