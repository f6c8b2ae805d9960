// SPDX-License-Identifier: GPL-3.0-or-later

// Collapses a vertex of a patch onto a neighbor.
#pragma once

#include "prefilter/voxels/remesh/collapse_check.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_links.h"

namespace prefilter {

/// Moves the ring's triangles to the neighbor, with creases, points and errors. The two triangles
/// that disappear get the neighbor for all corners.
void collapse(const Ring& ring, const Collapse& which, const CollapseOutcome& outcome, Patch* patch,
              PatchLinks* links);

}  // namespace prefilter
