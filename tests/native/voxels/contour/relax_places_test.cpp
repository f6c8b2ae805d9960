// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/relax_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace prefilter {
namespace {

constexpr int kAround = 96;
constexpr int kAcross = 40;
constexpr double kRadius = 1.0;
constexpr double kTube = 0.4;
constexpr double kPi = 3.14159265358979323846;

int wrapped(int i, int count) { return (i % count + count) % count; }

std::int32_t number(int i, int j) {
  return static_cast<std::int32_t>(wrapped(i, kAround) * kAcross + wrapped(j, kAcross));
}

// A point of a torus around z, in steps around the axis and across the tube.
struct Place {
  double around;
  double across;

  Vector3 normal() const {
    const double a = 2.0 * kPi * around / kAround;
    const double b = 2.0 * kPi * across / kAcross;
    return {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
  }
  Vector3 position() const {
    const double a = 2.0 * kPi * around / kAround;
    const Vector3 middle = {kRadius * std::cos(a), kRadius * std::sin(a), 0.0};
    return middle + kTube * normal();
  }
};

double distance(const Vector3& p) {
  return std::abs(std::hypot(std::hypot(p[0], p[1]) - kRadius, p[2]) - kTube);
}

// Loops of four vertices each, in rows around a torus, with random offsets.
struct Torus {
  DualLoops loops;
  std::vector<Vector3> positions;
  std::vector<Vector3> normals;
  DualPlaces places;

  std::vector<Place> corners;

  explicit Torus(unsigned seed) {
    std::mt19937 random(seed);
    const auto off = [&](double most) {
      return most * (2.0 * static_cast<double>(random() % 1000) / 999.0 - 1.0);
    };
    loops.begins.push_back(0);
    for (int i = 0; i < kAround; ++i) {
      for (int j = 0; j < kAcross; ++j) {
        // The vertex (i, j) is between the loops (i - 1, j - 1) and (i, j).
        corners.push_back({i - 0.5 + off(0.3), j - 0.5 + off(0.3)});
        positions.push_back(corners.back().position());
        normals.push_back(corners.back().normal());
        loops.quads.push_back(
            {number(i - 1, j - 1), number(i, j - 1), number(i, j), number(i - 1, j)});
        for (const std::int32_t v :
             {number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)}) {
          loops.corners.push_back(v);
        }
        loops.begins.push_back(static_cast<std::uint32_t>(loops.corners.size()));
      }
    }
    for (int i = 0; i < kAround; ++i) {
      for (int j = 0; j < kAcross; ++j) places.positions.push_back(middle(i, j).position());
    }
    places.is_sharp.assign(places.positions.size(), 0);
    places.is_corner.assign(places.positions.size(), 0);
  }

  // Mean of the corners of a loop.
  Place middle(int i, int j) const {
    Place sum = {0.0, 0.0};
    for (const auto& [a, b] :
         {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
      const Place& corner = corners[static_cast<std::size_t>(number(i + a, j + b))];
      // Indices wrap around.
      sum.around += 0.25 * (corner.around + (i + a == kAround ? kAround : 0));
      sum.across += 0.25 * (corner.across + (j + b == kAcross ? kAcross : 0));
    }
    return sum;
  }

  void relax(int threads = 1) {
    relax_places(loops, positions, normals, prefilter::Run(threads), &places);
  }

  // Mean distance, along the surface, of vertices from the mean of their neighbors, in steps across
  // the tube.
  double unevenness() const {
    double sum = 0.0;
    for (int i = 0; i < kAround; ++i) {
      for (int j = 0; j < kAcross; ++j) {
        const auto at = [&](int a, int b) -> const Vector3& {
          return places.positions[static_cast<std::size_t>(number(a, b))];
        };
        Vector3 off = 0.25 * (at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1)) - at(i, j);
        const Vector3 up = Place{static_cast<double>(i), static_cast<double>(j)}.normal();
        off = off - dot(off, up) * up;
        sum += length(off);
      }
    }
    return sum / (kAround * kAcross) / (2.0 * kPi * kTube / kAcross);
  }

  double farthest() const {
    double most = 0.0;
    for (const Vector3& p : places.positions) most = std::max(most, distance(p));
    return most;
  }
};

TEST(RelaxPlaces, EvensOutAndStaysOnTheSurface) {
  Torus torus(1);
  const double before = torus.unevenness();
  torus.relax();
  EXPECT_LT(torus.unevenness(), 0.25 * before);
  // Largest distance of the chord of one step across the tube from the tube.
  const double step = 2.0 * kPi / kAcross;
  const double chord = kTube * (1.0 - std::cos(0.5 * step));
  EXPECT_LT(torus.farthest(), 0.05 * chord);
}

TEST(RelaxPlaces, KeepsSharpVertices) {
  Torus torus(2);
  const std::vector<Vector3> before = torus.places.positions;
  for (std::size_t i = 0; i < before.size(); i += 7) torus.places.is_sharp[i] = 1;
  torus.relax();
  std::size_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool is_there = torus.places.positions[i] == before[i];
    if (i % 7 == 0) {
      EXPECT_TRUE(is_there) << i;
    }
    moved += is_there ? 0 : 1;
  }
  EXPECT_EQ(moved, before.size() - (before.size() + 6) / 7);
}

TEST(RelaxPlaces, KeepsSteepLoopsAndLoopsThatTurnBack) {
  Torus torus(3);
  const std::vector<Vector3> before = torus.places.positions;
  const auto steep = static_cast<std::size_t>(number(5, 5));
  torus.normals[static_cast<std::size_t>(torus.loops.corners[4 * steep])] = {};
  const auto turned = static_cast<std::size_t>(number(20, 20));
  std::swap(torus.loops.corners[4 * turned], torus.loops.corners[4 * turned + 1]);
  torus.relax();
  EXPECT_EQ(torus.places.positions[steep], before[steep]);
  EXPECT_EQ(torus.places.positions[turned], before[turned]);
}

// A vertex that all its neighbors pull in one direction stays within its loop.
TEST(RelaxPlaces, KeepsVerticesWithinTheirLoops) {
  Torus torus(4);
  torus.places.is_sharp.assign(torus.places.is_sharp.size(), 1);
  const auto one = static_cast<std::size_t>(number(30, 3));
  torus.places.is_sharp[one] = 0;
  for (const auto& [a, b] :
       {std::pair(29, 3), std::pair(31, 3), std::pair(30, 2), std::pair(30, 4)}) {
    torus.places.positions[static_cast<std::size_t>(number(a, b))] = Place{32.0, 3.0}.position();
  }
  const double before = length(torus.places.positions[one] - Place{32.0, 3.0}.position());
  torus.relax();
  const Vector3& moved = torus.places.positions[one];
  const double step = length(Place{30.0, 3.0}.position() - Place{31.0, 3.0}.position());
  EXPECT_LT(length(moved - Place{32.0, 3.0}.position()), before);
  EXPECT_LT(length(moved - Place{30.0, 3.0}.position()), 0.6 * step);
}

TEST(RelaxPlaces, DoesNotDependOnThreads) {
  Torus one(5);
  Torus other(5);
  one.relax(1);
  other.relax(3);
  EXPECT_EQ(one.places.positions, other.places.positions);
}

}  // namespace
}  // namespace prefilter
