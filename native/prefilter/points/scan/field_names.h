// SPDX-License-Identifier: GPL-3.0-or-later

// What programs call the values of a point.
#pragma once

#include <string>
#include <string_view>

namespace prefilter {

/// The name that a value has here, whatever program has written it: "x" for "X", "red" for
/// "diffuse_red", "classification" for "scalar_Classification", "return_number" for
/// "ReturnNumber". Of any other value the name as it is.
std::string field_name(std::string_view name);

/// The same, or nothing for any other value.
std::string_view known_field_name(std::string_view name);

}  // namespace prefilter
