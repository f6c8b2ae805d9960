// SPDX-License-Identifier: GPL-3.0-or-later

// The table of formats by extension.
#include "prefilter/points/open_points.h"

#include <algorithm>

#include "prefilter/base/error.h"
#include "prefilter/base/io/path_text.h"
#include "prefilter/points/scan/obj_points.h"
#include "prefilter/points/scan/pcd_points.h"
#include "prefilter/points/scan/ply_points.h"
#include "prefilter/points/scan/ptx_points.h"
#include "prefilter/points/scan/text_points.h"

namespace prefilter {
namespace {

struct Format {
  const char* ending;
  std::unique_ptr<PointSource> (*open)(const std::string& path);
};
constexpr Format kFormats[] = {
    {".ply", open_ply_points},  {".pcd", open_pcd_points},   {".pts", open_text_points},
    {".xyz", open_text_points}, {".xyzn", open_text_points}, {".asc", open_text_points},
    {".txt", open_text_points}, {".csv", open_text_points},  {".ptx", open_ptx_points},
    {".obj", open_obj_points},
};

}  // namespace

std::unique_ptr<PointSource> open_points(const std::string& path) {
  std::string ending = to_text(to_path(path).extension());
  // Independent of the locale.
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  for (const Format& format : kFormats) {
    if (ending == format.ending) return format.open(path);
  }
  std::string endings;
  for (const std::string& each : point_extensions())
    endings += (endings.empty() ? "" : ", ") + each;
  throw_invalid("'" + path + "': unsupported extension '" + ending + "'; use " + endings);
}

std::unique_ptr<PointSource> open_ply(const UnpackedFile& file) {
  return open_ply_points(ByteReader(file.file()));
}

std::vector<std::string> point_extensions() {
  std::vector<std::string> extensions;
  for (const Format& format : kFormats) extensions.emplace_back(format.ending);
  return extensions;
}

}  // namespace prefilter
