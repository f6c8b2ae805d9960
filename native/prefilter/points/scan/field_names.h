// SPDX-License-Identifier: GPL-3.0-or-later

// Standard names for the values of a point.
#pragma once

#include <string>
#include <string_view>

namespace prefilter {

/// The standard name of a value, whatever program wrote it: "x" for "X", "red" for "diffuse_red",
/// "classification" for "scalar_Classification", "return_number" for "ReturnNumber". Other names
/// are returned unchanged.
std::string field_name(std::string_view name);

/// The standard name of a value; empty if it has none.
std::string_view known_field_name(std::string_view name);

}  // namespace prefilter
