// SPDX-License-Identifier: GPL-3.0-or-later

// Mipmaps of a textured mesh, and how far they are from the texture on it.
//
// The mesh is a globe, the texture bright at its poles. These take up much of the image and little
// of the globe: a filter that does not know the mesh makes coarse levels too bright.
#include "prefilter/textures/mipmaps.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmap_error.h"

namespace {

constexpr int kColumns = 128;
constexpr int kRows = 64;
constexpr double kPi = std::numbers::pi;

/// A globe of radius 1, unrolled to the unit square.
prefilter::Surface globe() {
  std::vector<prefilter::Vector3> positions;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const double longitude = 2.0 * kPi * column / kColumns;
      const double latitude = kPi * row / kRows - kPi / 2.0;
      positions.push_back({std::cos(latitude) * std::cos(longitude),
                           std::cos(latitude) * std::sin(longitude), std::sin(latitude)});
    }
  }
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<double> uvs;  // of each corner of each triangle: u, v
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
        std::array<std::int32_t, 3>& triangle = triangles.emplace_back();
        for (int c = 0; c < 3; ++c) {
          const int right = column + corners[c][0];
          const int up = row + corners[c][1];
          triangle[c] = up * (kColumns + 1) + right;
          uvs.insert(uvs.end(), {double(right) / kColumns, double(up) / kRows});
        }
      };
      add({{{0, 0}, {1, 0}, {1, 1}}});
      add({{{0, 0}, {1, 1}, {0, 1}}});
    }
  }
  prefilter::TexturedMesh mesh;
  mesh.mesh = {positions, triangles};
  mesh.uvs = uvs.data();
  return prefilter::make_surface(mesh);
}

/// The squared sine of the latitude.
prefilter::Image bright_poles() {
  prefilter::Image image(256, 128, 1);
  for (int y = 0; y < image.height; ++y) {
    const double sine = std::sin(kPi * (y + 0.5) / image.height - kPi / 2.0);
    for (int x = 0; x < image.width; ++x) *image.texel(x, y) = static_cast<float>(sine * sine);
  }
  return image;
}

}  // namespace

int main() {
  const prefilter::Surface surface = globe();
  const prefilter::Image image = bright_poles();
  prefilter::MipmapOptions options;
  options.wrap = {prefilter::Wrap::kRepeat, prefilter::Wrap::kClamp};
  for (const char* name : {"box", "pam-bilinear"}) {
    options.filter = prefilter::mipmap_filter(name);
    const std::vector<prefilter::Image> levels =
        prefilter::mipmaps(image.view(), {&surface}, options);
    std::vector<prefilter::ImageView> views;
    std::vector<double> mip_values;
    for (const prefilter::Image& level : levels) {
      mip_values.push_back(static_cast<double>(views.size()));
      views.push_back(level.view());
    }
    const std::vector<double> errors = prefilter::mipmap_error(
        views, image.view(), {&surface}, mip_values, options.wrap, options.reader, options.run);
    for (std::size_t k = 1; k < levels.size(); ++k) {
      std::printf("%-12s level %zu, %3d x %2d texels: error %.5f\n", name, k, levels[k].width,
                  levels[k].height, errors[k]);
    }
    std::printf("%-12s last texel: %.5f\n", name, *levels.back().texel(0, 0));
  }
}
