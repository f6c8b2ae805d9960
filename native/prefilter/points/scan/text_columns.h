// SPDX-License-Identifier: GPL-3.0-or-later

// What the columns of a file of text are.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/points/scan/point_fields.h"

namespace prefilter {

/// What is known of a column from the lines that were looked at.
struct TextColumn {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool is_whole = true;
  bool is_double = false;
  bool begins_unit = true;  // whether it and the next two hold vectors of length 1

  void include(double value);
};

/// Whether three numbers are a vector of length 1, as files have it.
bool is_unit(const double* vector);

/// Names and types of columns, from what was seen in them: x, y, z come first.
std::vector<ScanField> guessed_fields(std::span<const TextColumn> columns);

/// Those of columns whose names a line has, in any order, x, y and z among them. None where there
/// are fewer or more.
std::vector<ScanField> named_fields(std::span<const TextColumn> columns,
                                    std::span<const std::string> names);

/// The names in a line, between commas, semicolons or tabs, or else blanks; as fields are called
/// here: in lower case, "red" for "R".
std::vector<std::string> names_in(std::string_view line);

}  // namespace prefilter
