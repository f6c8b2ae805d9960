#include "prefilter/remesh/clean_up.h"

#include <gtest/gtest.h>

#include "contour/mesh_checks.h"
#include "prefilter/contour/grid_contour.h"

namespace prefilter {
namespace {

using testing::fault_of;
using testing::volume_of;

TEST(CleanUp, KeepsTheShapeAndWidensAngles) {
  constexpr int kSize = 24;
  std::vector<float> values;
  for (int i = 0; i < kSize * kSize * kSize; ++i) {
    const double distance =
        std::hypot(i / (kSize * kSize) - 11.7, i / kSize % kSize - 12.1, i % kSize - 11.4);
    values.push_back(static_cast<float>(std::clamp(9.0 - distance + 0.5, 0.0, 1.0)));
  }
  const TriangleMesh before = contour_grid({values.data(), {kSize, kSize, kSize}}, {}, {});
  const TriangleMesh after = clean_up(before, Progress(), 1);
  EXPECT_EQ(fault_of(after), "");
  EXPECT_NEAR(volume_of(after), volume_of(before), 0.005 * volume_of(before));
  const auto thin_share = [](const TriangleMesh& mesh) {
    int thin = 0;
    for (const auto& t : mesh.triangles) {
      Vector3 sides;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& p = mesh.positions[static_cast<std::size_t>(t[i])];
        const auto& q = mesh.positions[static_cast<std::size_t>(t[(i + 1) % 3])];
        sides[i] = length(p - q);
      }
      const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
      if (*least < 0.2 * *most) ++thin;
    }
    return thin / static_cast<double>(mesh.triangles.size());
  };
  EXPECT_GT(thin_share(before), 0.1);
  EXPECT_LT(thin_share(after), thin_share(before) / 10.0);
}

TEST(CleanUp, LeavesATetrahedronAlone) {
  TriangleMesh thin;
  thin.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0.01, 0}, {0.5, 0, 1}};
  thin.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(clean_up(thin, Progress(), 1).triangles, thin.triangles);
}

}  // namespace
}  // namespace prefilter
