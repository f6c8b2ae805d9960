// SPDX-License-Identifier: GPL-3.0-or-later

// A vertex of a patch collapsed onto a neighbor.
#pragma once

#include "prefilter/voxels/remesh/collapse_check.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_links.h"

namespace prefilter {

/// Moves the ring's triangles to the neighbor, but for the two that go, whose corners are all there
/// then: with creases, points and errors.
void collapse(const Ring& ring, const Collapse& which, const Outcome& outcome, Patch* patch,
              PatchLinks* links);

}  // namespace prefilter
