// SPDX-License-Identifier: GPL-3.0-or-later

// Overlaps resolved where that takes no longer than drawing does.
#pragma once

#include <optional>

#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Writes what `resolved` returns to `changed`, or returns false: for outlines of which so much
/// crosses that it would take more steps than some for every curve, and for those that rounding
/// leaves unclear.
bool resolve_soon(const Outline& outline, FillRule rule, const Progress& progress,
                  std::optional<Outline>* changed);

}  // namespace prefilter
