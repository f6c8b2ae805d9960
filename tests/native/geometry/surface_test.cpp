// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

struct Arrays {
  std::vector<Vector3> positions{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 5}};
  std::vector<std::array<std::int64_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  std::vector<double> uvs = std::vector<double>(12, 0.25);

  Surface make() const { return make_surface({{positions, triangles}, uvs.data()}); }
};

std::string message_of(const Arrays& arrays) {
  try {
    arrays.make();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MakeSurface, MeasuresAreas) {
  const Surface surface = Arrays().make();
  EXPECT_DOUBLE_EQ(surface.areas[0], 3.0);
  EXPECT_DOUBLE_EQ(surface.areas[1], 7.5);
  EXPECT_DOUBLE_EQ(surface.total_area(), 10.5);
}

TEST(MakeSurface, ErrorsNameTheArgument) {
  Arrays arrays;
  arrays.triangles.clear();
  EXPECT_EQ(message_of(arrays), "triangles: none; at least one is needed");

  arrays = {};
  arrays.triangles[1][1] = 9;
  EXPECT_EQ(message_of(arrays),
            "triangles: triangle 1 names vertex 9, but there are 4 vertices (0 to 3)");

  arrays = {};
  arrays.positions[2][1] = NAN;
  EXPECT_EQ(message_of(arrays), "positions: vertex 2 holds nan; all values must be finite");

  arrays = {};
  arrays.uvs[8] = INFINITY;
  EXPECT_EQ(message_of(arrays), "uvs: triangle 1 holds inf; all values must be finite");

  arrays = {};
  for (Vector3& position : arrays.positions) {
    for (double& value : position) value *= 1e250;
  }
  EXPECT_EQ(message_of(arrays),
            "positions: the area of triangle 0 is too large for a floating-point number");
}

}  // namespace
}  // namespace prefilter
