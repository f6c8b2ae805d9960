// SPDX-License-Identifier: GPL-3.0-or-later

// Moments of a measure on a grid cell, and their transfer to larger cells.
//
// The measure is the surface's area mapped to the texture; the cell is [0, 1]^2 in its own
// coordinates. Moments up to degree 2 along each axis suffice for products of two bilinear
// functions (section 7.3). A cell's moments are a fixed linear combination of those of its
// four quarters.
#pragma once

#include <array>
#include <cstddef>

namespace prefilter {

/// Integrals of x^a y^b over the cell, a and b in {0, 1, 2}, at [3 * b + a].
using WeightMoments = std::array<double, 9>;

/// Integrals of I x^a y^b for one channel of an image I, a and b in {0, 1}, at [2 * b + a].
using ImageMoments = std::array<double, 4>;

/// The moments of the uniform measure 1 on the whole cell.
inline constexpr WeightMoments kUniformMoments = {
    1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 2.0, 1.0 / 4.0, 1.0 / 6.0, 1.0 / 3.0, 1.0 / 6.0, 1.0 / 9.0};

/// Image moments of C channels.
template <int C>
using ChannelMoments = std::array<ImageMoments, C>;

/// Weight moments, and image moments of C channels.
template <int C>
struct CellMoments {
  WeightMoments weight{};
  ChannelMoments<C> image{};

  bool empty() const { return weight[0] == 0.0; }
};

/// The position of a cell in another one along an axis: coordinate x in the cell is offset + scale
/// * x in the other.
struct Placement {
  double offset = 0.0;
  double scale = 1.0;
};

namespace internal {

/// Transfers moments along one axis from a child's to its parent's coordinates.
template <int kDegrees>
inline void lift(const double* child, int stride, const Placement& place, double* parent) {
  const double m0 = child[0];
  const double m1 = child[stride];
  parent[0] = m0;
  parent[1] = place.scale * m1 + place.offset * m0;
  if constexpr (kDegrees == 3) {
    parent[2] = place.scale * (place.scale * child[2 * stride] + 2.0 * place.offset * m1) +
                place.offset * place.offset * m0;
  }
}

}  // namespace internal

/// Adds the image moments of a child cell to its parent's.
template <std::size_t C>
void add_image_child(const std::array<ImageMoments, C>& child, const Placement& in_x,
                     const Placement& in_y, std::array<ImageMoments, C>* parent) {
  for (std::size_t c = 0; c < C; ++c) {
    double lines[4];
    for (int b = 0; b < 2; ++b) internal::lift<2>(&child[c][2 * b], 1, in_x, lines + 2 * b);
    for (int a = 0; a < 2; ++a) {
      double column[2];
      internal::lift<2>(lines + a, 2, in_y, column);
      for (int b = 0; b < 2; ++b) (*parent)[c][2 * b + a] += column[b];
    }
  }
}

/// Adds the moments of a child cell to its parent's.
template <int C>
void add_child(const CellMoments<C>& child, const Placement& in_x, const Placement& in_y,
               CellMoments<C>* parent) {
  double rows[9];
  for (int b = 0; b < 3; ++b) internal::lift<3>(&child.weight[3 * b], 1, in_x, rows + 3 * b);
  for (int a = 0; a < 3; ++a) {
    double column[3];
    internal::lift<3>(rows + a, 3, in_y, column);
    for (int b = 0; b < 3; ++b) parent->weight[3 * b + a] += column[b];
  }
  add_image_child(child.image, in_x, in_y, &parent->image);
}

}  // namespace prefilter
