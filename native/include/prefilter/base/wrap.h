// SPDX-License-Identifier: GPL-3.0-or-later

// Wrap modes: the texels that a lookup reads outside the image.
#pragma once

#include <algorithm>

#include "prefilter/base/names.h"

namespace prefilter {

enum class Wrap {
  kClamp,   // the nearest texel of the image
  kRepeat,  // the image tiled
  kBorder,  // zero; points outside the unit square have no weight
};

inline constexpr Named<Wrap> kWraps[] = {
    {"clamp", Wrap::kClamp}, {"repeat", Wrap::kRepeat}, {"border", Wrap::kBorder}};

/// Wrap modes along u and v.
struct WrapModes {
  Wrap u = Wrap::kClamp;
  Wrap v = Wrap::kClamp;
};

/// The texel that index i along an axis of `size` texels reads, or -1 for the border.
inline int wrap_index(int i, int size, Wrap mode) {
  if (i >= 0 && i < size) return i;
  switch (mode) {
    case Wrap::kClamp:
      return std::clamp(i, 0, size - 1);
    case Wrap::kRepeat: {
      const int remainder = i % size;
      return remainder < 0 ? remainder + size : remainder;
    }
    case Wrap::kBorder:
      break;
  }
  return -1;
}

}  // namespace prefilter
