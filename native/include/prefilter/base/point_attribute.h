// SPDX-License-Identifier: GPL-3.0-or-later

// Additional attributes of points and vertices.
#pragma once

#include <string>

namespace prefilter {

/// An attribute of points other than position and normal; a color consists of three of these.
struct PointAttribute {
  std::string name;      // of the PLY property: "red", "intensity"
  bool is_byte = false;  // stored as a byte, 0 to 255: rounded and clamped when written
};

}  // namespace prefilter
