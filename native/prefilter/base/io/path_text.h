// SPDX-License-Identifier: GPL-3.0-or-later

// Paths as texts: UTF-8 on Windows, and elsewhere the bytes that the system has.
#pragma once

#include <filesystem>
#include <string>

namespace prefilter {

std::filesystem::path to_path(const std::string& text);
std::string to_text(const std::filesystem::path& path);

}  // namespace prefilter
