// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/align_to_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/points/cloud/moved_scan.h"

namespace prefilter {
namespace {

constexpr int kSide = 40;

double height(double x, double y) {
  return 0.2 * std::sin(4.0 * x) * std::cos(3.0 * y) + 0.3 * x * y;
}

// A bent sheet over the unit square, with open borders.
struct Sheet {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

Sheet sheet(const Vector3& offset) {
  Sheet made;
  for (int i = 0; i <= kSide; ++i) {
    for (int j = 0; j <= kSide; ++j) {
      const double x = 1.0 * i / kSide;
      const double y = 1.0 * j / kSide;
      made.positions.push_back(Vector3{x, y, height(x, y)} + offset);
    }
  }
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const std::int32_t a = i * (kSide + 1) + j;
      const std::int32_t b = a + kSide + 1;
      made.triangles.push_back({a, b, b + 1});
      made.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return made;
}

struct Scan {
  std::vector<Vector3> positions;
  std::vector<Vector3> normals;
  ScanView view() const { return {positions, normals}; }
};

// Points on the triangles of a sheet, moved.
Scan scan_of(const Sheet& from, const RigidMotion& away, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Scan scan;
  for (const auto& [a, b, c] : from.triangles) {
    const auto at = [&](std::int32_t v) { return from.positions[static_cast<std::size_t>(v)]; };
    const double u = uniform(random);
    const double v = (1.0 - u) * uniform(random);
    const Vector3 p = at(a) + u * (at(b) - at(a)) + v * (at(c) - at(a));
    scan.positions.push_back(moved(away, p));
    scan.normals.push_back(turned(away, cross(at(b) - at(a), at(c) - at(a))));
  }
  return scan;
}

double farthest(const Scan& scan, const RigidMotion& motion, const Scan& expected) {
  double most = 0.0;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    most = std::max(most, length(moved(motion, scan.positions[i]) - expected.positions[i]));
  }
  return most;
}

TEST(AlignToSurface, MovesScansBackOntoIt) {
  for (const Vector3& offset : {Vector3{}, Vector3{5e5, 4e6, 100.0}}) {
    const Sheet surface = sheet(offset);
    const Vector3 middle = offset + Vector3{0.5, 0.5, 0.1};
    const RigidMotion away = small_motion({0.02, -0.01, 0.015}, {0.01, 0.005, -0.012}, middle);
    const Scan still = scan_of(surface, {}, 1);
    const Scan expected = scan_of(surface, {}, 2);
    const Scan off = scan_of(surface, away, 2);
    const ScanView scans[] = {still.view(), off.view()};
    const RigidMotion none[2];
    const Alignment found =
        align_to_surface(scans, none, {surface.positions, surface.triangles}, {});
    EXPECT_LT(farthest(off, found.motions[1], expected), 1e-3);
    EXPECT_GT(farthest(off, {}, expected), 0.02);
    EXPECT_LT(found.after, 0.01 * found.before);
    EXPECT_GT(found.pairs[1], off.positions.size() * 9 / 10);
  }
}

TEST(AlignToSurface, TheFirstStaysWhereItWas) {
  // Only the first is off, so all are moved as one.
  const Sheet surface = sheet({});
  const RigidMotion away = small_motion({0.01, 0.0, 0.01}, {0.01, 0.0, 0.005}, {0.5, 0.5, 0.0});
  const Scan off = scan_of(surface, away, 1);
  const Scan other = scan_of(surface, {}, 2);
  const Scan expected = scan_of(surface, away, 2);
  const ScanView scans[] = {off.view(), other.view()};
  const RigidMotion none[2];
  const Alignment found = align_to_surface(scans, none, {surface.positions, surface.triangles}, {});
  EXPECT_EQ(found.motions[0].rows, none[0].rows);
  EXPECT_EQ(found.motions[0].shift, none[0].shift);
  EXPECT_LT(farthest(other, found.motions[1], expected), 1e-3);
}

TEST(AlignToSurface, StartsFromGivenMotions) {
  const Sheet surface = sheet({});
  const RigidMotion away = small_motion({0.0, 0.5, 0.0}, {3.0, 0.0, 0.0}, {});
  RigidMotion back = small_motion({0.0, -0.5, 0.0}, {}, {});
  back.shift = turned(back, Vector3{-3.0, 0.0, 0.0});
  const Scan still = scan_of(surface, {}, 1);
  const Scan far = scan_of(surface, away, 2);
  const Scan expected = scan_of(surface, {}, 2);
  const ScanView scans[] = {still.view(), far.view()};
  const RigidMotion motions[] = {RigidMotion(), back};
  const Alignment found =
      align_to_surface(scans, motions, {surface.positions, surface.triangles}, {});
  EXPECT_LT(farthest(far, found.motions[1], expected), 1e-3);
}

TEST(AlignToSurface, IgnoresPointsThatFaceAwayOrAreFar) {
  const Sheet surface = sheet({});
  Scan back = scan_of(surface, {}, 1);
  for (Vector3& normal : back.normals) normal = Vector3{} - normal;
  const Scan above = scan_of(sheet({0.0, 0.0, 2.0}), {}, 2);
  const Scan beside = scan_of(sheet({1.5, 0.0, 0.0}), {}, 3);
  Scan odd = scan_of(surface, {}, 4);
  for (Vector3& p : odd.positions) p[1] = std::numeric_limits<double>::quiet_NaN();
  const ScanView scans[] = {back.view(), above.view(), beside.view(), odd.view(), {}};
  const RigidMotion none[5];
  const Alignment found = align_to_surface(scans, none, {surface.positions, surface.triangles}, {});
  for (std::size_t s = 0; s < 5; ++s) {
    EXPECT_EQ(found.pairs[s], 0U);
    EXPECT_EQ(found.motions[s].shift, Vector3{});
  }
  EXPECT_EQ(found.before, 0.0);
}

TEST(AlignToSurface, Refuses) {
  const Sheet surface = sheet({});
  const Scan scan = scan_of(surface, {}, 1);
  const ScanView scans[] = {scan.view()};
  const RigidMotion none[2];
  const InputMesh mesh{surface.positions, surface.triangles};
  EXPECT_THROW(align_to_surface({}, {}, mesh, {}), Error);
  EXPECT_THROW(align_to_surface(scans, none, mesh, {}), Error);
  EXPECT_THROW(align_to_surface(scans, std::span(none, 1), {}, {}), Error);
  AlignOptions options;
  options.run = prefilter::Run([](double) { return false; });
  EXPECT_THROW(align_to_surface(scans, std::span(none, 1), mesh, options), Error);
}

}  // namespace
}  // namespace prefilter
