// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/normals/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace prefilter {
namespace {

// Points on a line orthogonal to all normals, so that the agreement of two normals is the cosine of
// their angle.
struct Row {
  explicit Row(const std::vector<double>& degrees) {
    for (const double angle : degrees) {
      const double a = angle * 3.14159265358979 / 180.0;
      positions.push_back({static_cast<double>(positions.size()), 0.0, 0.0});
      normals.push_back({0.0, std::cos(a), std::sin(a)});
      areas.push_back(1.0);
      linked.emplace_back();
    }
  }

  // Joined by this many pairs.
  void link(std::size_t i, std::size_t j, int times) {
    linked[i].insert(linked[i].end(), static_cast<std::size_t>(times),
                     static_cast<std::uint32_t>(j));
  }

  std::vector<Vector3> oriented() const {
    std::size_t degree = 1;
    for (const auto& each : linked) degree = std::max(degree, each.size());
    std::vector<std::uint32_t> links;
    for (std::size_t i = 0; i < linked.size(); ++i) {
      links.insert(links.end(), linked[i].begin(), linked[i].end());
      // A point's link to itself carries no information.
      links.resize((i + 1) * degree, static_cast<std::uint32_t>(i));
    }
    std::vector<Vector3> result = normals;
    orient_normals({positions, areas, degree, links}, NormalSide::kOutward, prefilter::Run(1),
                   &result);
    return result;
  }

  std::vector<Vector3> positions;
  std::vector<Vector3> normals;
  std::vector<double> areas;
  std::vector<std::vector<std::uint32_t>> linked;
};

// A fan of normals that turn by 9 degrees from each to the next, which is unambiguous, and one
// normal beside it. Two pairs vote with 0.9 each for the direction of the first, and sixty with 0.3
// each for the opposite of the last. The two win by fourth powers, 1.3 to 0.5; by cubes the sixty
// would win, 1.62 to 1.46, and by squares even more clearly.
TEST(Orientation, FewClearPairsOutweighManyDoubtfulOnes) {
  std::vector<double> degrees = {0.0};
  for (int i = 0; i < 10; ++i) degrees.push_back(26.0 + 9.0 * i);
  for (const bool is_turned : {false, true}) {
    Row row(degrees);
    if (is_turned) row.normals[0] = Vector3{} - row.normals[0];
    for (std::size_t i = 1; i + 1 < degrees.size(); ++i) row.link(i, i + 1, 1);
    row.link(0, 1, 2);
    row.link(0, 10, 60);
    const std::vector<Vector3> found = row.oriented();
    EXPECT_GT(dot(found[0], found[1]), 0.0);
    for (std::size_t i = 1; i + 1 < found.size(); ++i) EXPECT_GT(dot(found[i], found[i + 1]), 0.9);
  }
}

// Enough doubtful pairs do count: 200 with 0.3 make 1.6.
TEST(Orientation, ManyDoubtfulPairsCountTogether) {
  std::vector<double> degrees = {0.0};
  for (int i = 0; i < 10; ++i) degrees.push_back(26.0 + 9.0 * i);
  Row row(degrees);
  for (std::size_t i = 1; i + 1 < degrees.size(); ++i) row.link(i, i + 1, 1);
  row.link(0, 1, 2);
  row.link(0, 10, 200);
  const std::vector<Vector3> found = row.oriented();
  EXPECT_LT(dot(found[0], found[1]), 0.0);
}

}  // namespace
}  // namespace prefilter
