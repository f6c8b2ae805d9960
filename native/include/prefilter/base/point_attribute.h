// SPDX-License-Identifier: GPL-3.0-or-later

// What points and vertices carry besides where they are.
#pragma once

#include <string>

namespace prefilter {

/// A value that points carry besides their normals; a color is three of these.
struct PointAttribute {
  std::string name;      // of the PLY property: "red", "intensity"
  bool is_byte = false;  // stored as a byte, 0 to 255: rounded and clamped where it is written
};

}  // namespace prefilter
