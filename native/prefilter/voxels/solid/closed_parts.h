// SPDX-License-Identifier: GPL-3.0-or-later

// Whether a mesh is a solid as it is.
#pragma once

#include <cstddef>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Whether each edge is run through as often one way as the other: by sums that are 0 then, and
/// otherwise with a chance of 2^-128. Holds nothing. Precondition: check_mesh.
bool is_balanced(const InputMesh& mesh, const Progress& progress, int threads);

/// Whether each edge is run through as often one way as the other, no triangle is there twice the
/// same way, no part (what hangs together by vertices) is the same as another, each is right side
/// out or a cavity of one that is, and none is thinner than `thickness` on average. Sets the number
/// of parts. Precondition: check_mesh.
bool is_solid(const InputMesh& mesh, double thickness, const Progress& progress, int threads,
              std::size_t* part_count);

}  // namespace prefilter
