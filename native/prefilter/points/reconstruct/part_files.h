// SPDX-License-Identifier: GPL-3.0-or-later

// Parts of a surface in files.
#pragma once

#include <cstddef>

#include "prefilter/base/io/archive.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"

namespace prefilter {

void write_part(const SlabMesh& part, ArchiveWriter* file);

/// Its vertices have so many attributes. Throws Error(kFile) for what is no part.
SlabMesh read_part(std::size_t width, ArchiveReader* file);

}  // namespace prefilter
