#include "prefilter/scan/open_points.h"

#include <algorithm>
#include <filesystem>

#include "prefilter/base/error.h"
#include "prefilter/scan/ply_points.h"

namespace prefilter {

std::unique_ptr<PointSource> open_points(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  // No locale takes part in the names of formats.
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (ending == ".ply") return open_ply_points(path);
  throw_invalid("'" + path + "': unsupported extension '" + ending + "'; .ply is needed");
}

}  // namespace prefilter
