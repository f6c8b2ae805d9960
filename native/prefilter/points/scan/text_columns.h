// SPDX-License-Identifier: GPL-3.0-or-later

// Interprets the columns of text files.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/points/scan/point_fields.h"

namespace prefilter {

/// Statistics of a column in the lines examined.
struct TextColumn {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool is_whole = true;
  bool is_double = false;
  bool begins_unit = true;  // whether it and the next two columns hold unit vectors

  void include(double value);
};

/// Whether three numbers are a unit vector, as far as text files round them.
bool is_unit(const double* vector);

/// Names and types of unnamed columns, guessed from their values; x, y, z come first.
std::vector<ScanField> guessed_fields(std::span<const TextColumn> columns);

/// Fields of columns named by a line, in any order, including x, y and z. Empty if the number of
/// names differs from the number of columns.
std::vector<ScanField> named_fields(std::span<const TextColumn> columns,
                                    std::span<const std::string> names);

/// The names in a line, separated by commas, semicolons or tabs, otherwise by blanks, as standard
/// names in lower case.
std::vector<std::string> names_in(std::string_view line);

}  // namespace prefilter
