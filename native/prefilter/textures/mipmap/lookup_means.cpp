// SPDX-License-Identifier: GPL-3.0-or-later

// Gauss quadrature with 2 x 2 points in each quarter of a texel.
#include "prefilter/textures/mipmap/lookup_means.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// A normal and a roughness.
using Values = std::array<float, 4>;

Values mixed(const Values& from, const Values& to, float share) {
  Values result;
  for (std::size_t c = 0; c < result.size(); ++c) result[c] = from[c] + share * (to[c] - from[c]);
  return result;
}

// Distances from the center toward a neighbor, in texels: 1/4 -+ 1/4 / sqrt(3).
constexpr std::array<float, 2> kQuarterGaussPoints = {0.10566243F, 0.39433757F};

void add(const Values& lookup, float least_length, std::array<double, 4>* sums) {
  const double x = lookup[0];
  const double y = lookup[1];
  const double z = lookup[2];
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(length < least_length)) {
    (*sums)[0] += x / length;
    (*sums)[1] += y / length;
    // No cancellation near (0, 0, 1), where most normals are.
    (*sums)[2] += z > 0.0 ? -(x * x + y * y) / (length * (length + z)) : z / length - 1.0;
  }
  const double square = static_cast<double>(lookup[3]) * lookup[3];
  (*sums)[3] += square * square;
}

void check(const ImageView& normals, const ImageView& roughness) {
  if (normals.channels != 3 || roughness.channels != 1) {
    throw_invalid("normals, roughness: " + std::to_string(normals.channels) + " and " +
                  std::to_string(roughness.channels) + " channels; 3 and 1 are needed");
  }
  if (normals.width != roughness.width || normals.height != roughness.height) {
    throw_invalid("roughness: " + std::to_string(roughness.width) + " x " +
                  std::to_string(roughness.height) + " texels; the " +
                  std::to_string(normals.width) + " x " + std::to_string(normals.height) +
                  " of the normals are needed");
  }
}

}  // namespace

Image lookup_means(const ImageView& normals, const ImageView& roughness, WrapModes wrap,
                   float least_length, const Run& run) {
  check(normals, roughness);
  Image means(normals.width, normals.height, 4);
  const auto read = [&](int x, int y) {
    const int in_x = wrap_index(x, normals.width, wrap.u);
    const int in_y = wrap_index(y, normals.height, wrap.v);
    if (in_x < 0 || in_y < 0) return Values{};
    const float* const normal = normals.texel(in_x, in_y);
    return Values{normal[0], normal[1], normal[2], *roughness.texel(in_x, in_y)};
  };
  parallel_for(normals.height, run, [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < normals.width; ++x) {
      std::array<std::array<Values, 3>, 3> around;
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) around[j][i] = read(x + i - 1, y + j - 1);
      }
      std::array<double, 4> sums{};
      for (const int up : {0, 2}) {
        for (const float share_y : kQuarterGaussPoints) {
          std::array<Values, 3> line;
          for (int i = 0; i < 3; ++i) line[i] = mixed(around[1][i], around[up][i], share_y);
          for (const int right : {0, 2}) {
            for (const float share_x : kQuarterGaussPoints) {
              add(mixed(line[1], line[right], share_x), least_length, &sums);
            }
          }
        }
      }
      float* const mean = means.texel(x, y);
      for (int c = 0; c < 4; ++c) mean[c] = static_cast<float>(sums[c] / 16.0);
    }
  });
  return means;
}

}  // namespace prefilter
