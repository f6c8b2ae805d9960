// SPDX-License-Identifier: GPL-3.0-or-later

// Fill rules applied to winding numbers.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

inline bool is_filled(int winding, FillRule rule) {
  return rule == FillRule::kNonzero ? winding != 0 : winding % 2 != 0;
}

}  // namespace prefilter
