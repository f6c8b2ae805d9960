// SPDX-License-Identifier: GPL-3.0-or-later

// Resolves overlaps if that takes no longer than drawing.
#pragma once

#include <optional>

#include "prefilter/base/outline.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Writes the result of `resolved` to `changed`. Returns false if so many curves cross that the
/// work would exceed a constant number of steps per curve, or if rounding makes the result
/// ambiguous.
bool resolve_within_budget(const Outline& outline, FillRule rule, const Run& run,
                           std::optional<Outline>* changed);

}  // namespace prefilter
