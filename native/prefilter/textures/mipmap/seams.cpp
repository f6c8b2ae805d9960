// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/seams.h"

#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/mipmap/seam_links.h"

namespace prefilter {

std::vector<double> seam_contrast(const std::vector<ImageView>& levels,
                                  const std::vector<const Surface*>& surfaces, WrapModes wrap,
                                  const Run& run) {
  if (levels.empty()) throw_invalid("levels: none were given; at least one is needed");
  if (surfaces.empty()) throw_invalid("surface: none was given; at least one is needed");
  const int channels = levels[0].channels;
  const auto check_view = [channels](const ImageView& view, const std::string& name) {
    check_channels(view, "levels");
    if (view.channels != channels) {
      throw_invalid(name + " has " + std::to_string(view.channels) + " channels and level 0 " +
                    std::to_string(channels) + "; they must have the same");
    }
  };
  for (std::size_t k = 0; k < levels.size(); ++k) {
    check_view(levels[k], "levels: level " + std::to_string(k));
  }
  const std::vector<SeamEdge> seams = find_seams(surfaces, run.part(0.0, 0.0));
  std::vector<double> contrasts;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const Run part = run.part(static_cast<double>(k) / static_cast<double>(levels.size()),
                              static_cast<double>(k + 1) / static_cast<double>(levels.size()));
    double squares = 0.0;
    double length = 0.0;
    for (std::size_t i = 0; i < seams.size(); ++i) {
      part.report(static_cast<double>(i) / static_cast<double>(seams.size()));
      length += seams[i].length;
      squares += seams[i].length * mean_square_across(seams[i], levels[k], wrap);
    }
    if (!std::isfinite(squares)) {
      throw_invalid("levels: a seam reads a texel that is not finite in level " +
                    std::to_string(k));
    }
    contrasts.push_back(length > 0.0 ? std::sqrt(squares / (length * channels)) : 0.0);
  }
  run.report(1.0);
  return contrasts;
}

}  // namespace prefilter
