// SPDX-License-Identifier: GPL-3.0-or-later

// Conversion of paths to and from text: UTF-8 on Windows, the native bytes elsewhere.
#pragma once

#include <filesystem>
#include <string>

namespace prefilter {

std::filesystem::path to_path(const std::string& text);
std::string to_text(const std::filesystem::path& path);

}  // namespace prefilter
