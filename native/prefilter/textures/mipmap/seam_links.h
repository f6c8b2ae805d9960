// SPDX-License-Identifier: GPL-3.0-or-later

// UV seams, as the levels of a mipmap see them: one line on the surface with two in the texture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// An edge between two triangles that have it at different places of the texture.
struct SeamEdge {
  std::array<TextureCoordinate, 2> left;   // of its two ends
  std::array<TextureCoordinate, 2> right;  // of the same ends
  double length = 0.0;                     // in space
  // What the surface's areas are to those of its mesh: more where it stands for several poses or
  // instances.
  double area_scale = 1.0;
};

/// The seams of a surface. Vertices at the same position are one; edges of no length, or whose two
/// triangles agree, are none, and neither are those that more than two triangles share: nobody
/// knows which of them belong together. This and the functions below tell `progress` that they are
/// at its beginning, now and then; they throw Error(kCancelled).
std::vector<SeamEdge> find_seams(const Surface& surface, const Progress& progress);
std::vector<SeamEdge> find_seams(const std::vector<const Surface*>& surfaces,
                                 const Progress& progress);

/// The mean along a seam, summed over the channels, of the square of the difference between the
/// bilinear lookups on its two sides.
double mean_square_across(const SeamEdge& seam, const ImageView& image, WrapModes wrap);

/// A sum of texels, the difference of the lookups on the two sides of a seam, that ought to be that
/// of the image: it is 0 where the image shows no seam.
struct SeamLink {
  static constexpr int kMostTexels = 8;
  std::array<std::int32_t, kMostTexels> x;
  std::array<std::int32_t, kMostTexels> y;
  std::array<float, kMostTexels> shares;
  int count = 0;
  double strip_area = 0.0;  // of the surface along its part of the seam, as wide as a texel
};

/// Makes the area_scale of those seams 0 along which the image itself is not the same on the two
/// sides, such as where two materials meet: there is nothing to hide there. It falls from 1 to 0
/// while the root mean square of the difference along a seam grows from 0.1 to 0.12 of the image's
/// standard deviation over the surfaces, which some thousand points tell.
void weigh_seams(const ImageView& image, const std::vector<const Surface*>& surfaces,
                 WrapModes wrap, const Progress& progress, std::vector<SeamEdge>* seams);

/// Links along all of the seams for a level of width x height texels. Sums over them of
/// squares of differences, times length, are exact: Gauss's rule of three points between the places
/// where either side passes a texel's center, along which the lookups are quadratic.
std::vector<SeamLink> link_seams(const std::vector<SeamEdge>& seams, int width, int height,
                                 WrapModes wrap, const Progress& progress);

/// The links between the texels of a level's system, each with its strip's area times `weight`.
template <typename System>
std::vector<TexelLink> texel_links(const std::vector<SeamLink>& seams, const System& system,
                                   double weight) {
  std::vector<TexelLink> links(seams.size());
  for (std::size_t i = 0; i < seams.size(); ++i) {
    const SeamLink& seam = seams[i];
    TexelLink& link = links[i];
    link.count = seam.count;
    for (int k = 0; k < seam.count; ++k) {
      link.texels[k] = system.at(seam.x[k], seam.y[k]);
      link.shares[k] = seam.shares[k];
    }
    link.weight = static_cast<float>(weight * seam.strip_area);
  }
  return links;
}

}  // namespace prefilter
