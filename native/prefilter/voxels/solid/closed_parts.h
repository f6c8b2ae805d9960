// SPDX-License-Identifier: GPL-3.0-or-later

// Checks whether a mesh is a solid without any repair.
#pragma once

#include <cstddef>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Whether each edge is traversed as often in one direction as in the other, by hashing: false
/// positives have a probability of 2^-128. Uses constant memory. Precondition: check_mesh.
bool is_balanced(const InputMesh& mesh, const Run& run);

/// Whether edges are balanced, no triangle is duplicated, no part (connected by vertices) equals
/// another, each part is oriented outward or is a cavity of one that is, and none is thinner than
/// `thickness` on average. Sets the number of parts. Precondition: check_mesh.
bool is_solid(const InputMesh& mesh, double thickness, const Run& run, std::size_t* part_count);

}  // namespace prefilter
