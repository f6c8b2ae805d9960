// SPDX-License-Identifier: GPL-3.0-or-later

// UV seams: edges that are one line on the surface, but two in the texture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// An edge between two triangles that map it to different positions in the texture.
struct SeamEdge {
  std::array<TextureCoordinate, 2> left;   // its end points in the texture on one side
  std::array<TextureCoordinate, 2> right;  // the same end points on the other side
  double length = 0.0;                     // in space
  // Ratio of the surface's areas to those of its mesh; above 1 if it stands for several poses or
  // instances.
  double area_scale = 1.0;
};

/// Finds the seams of a surface. Vertices at the same position are identified. Edges of zero
/// length, edges whose two triangles agree, and edges with more than two triangles are not seams.
/// This and the functions below check for cancellation now and then, without progress; they throw
/// Error(kCancelled).
std::vector<SeamEdge> find_seams(const Surface& surface, const Run& run);
std::vector<SeamEdge> find_seams(const std::vector<const Surface*>& surfaces, const Run& run);

/// Mean along a seam, summed over the channels, of the squared difference between the bilinear
/// lookups on both sides.
double mean_square_across(const SeamEdge& seam, const ImageView& image, WrapModes wrap);

/// The difference of the lookups on both sides of a seam, as a linear combination of texels. It
/// ought to be 0, as in an image without visible seams.
struct SeamLink {
  static constexpr int kMaxLinkTexels = 8;
  std::array<std::int32_t, kMaxLinkTexels> x;
  std::array<std::int32_t, kMaxLinkTexels> y;
  std::array<float, kMaxLinkTexels> shares;
  int count = 0;
  double strip_area = 0.0;  // area of the surface along this part of the seam, one texel wide
};

/// Sets the area_scale of seams to 0 if the image itself differs on their sides, as where two
/// materials meet. The scale falls from 1 to 0 while the root mean square difference along a seam
/// grows from 0.1 to 0.12 standard deviations of the image, estimated from some thousand points.
void weigh_seams(const ImageView& image, const std::vector<const Surface*>& surfaces,
                 WrapModes wrap, const Run& run, std::vector<SeamEdge>* seams);

/// Links along all seams for a level of width x height texels. Their sum of squares, times length,
/// is the exact integral: three-point Gauss rule between the points where either side crosses a
/// texel center, between which lookups are quadratic.
std::vector<SeamLink> link_seams(const std::vector<SeamEdge>& seams, int width, int height,
                                 WrapModes wrap, const Run& run);

/// Converts links to the texel indices of a level's system, each weighted by its strip's area times
/// `weight`.
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
