// SPDX-License-Identifier: GPL-3.0-or-later

// Compares D4 with its definition: the refinement relation, and equation 4.2 summed over all
// samples.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "prefilter/wavelet/d4_transform.h"
#include "prefilter/wavelet/daubechies.h"

namespace prefilter::d4 {
namespace {

// Evaluates the refinement relation itself, exact for dyadic t.
double phi(double t) {
  if (t <= 0.0 || t >= 3.0) return 0.0;
  if (t == 1.0) return (1.0 + kSqrt3) / 2.0;
  if (t == 2.0) return (1.0 - kSqrt3) / 2.0;
  double sum = 0.0;
  for (int l = 0; l < 4; ++l) sum += kLow[static_cast<std::size_t>(l)] * phi(2.0 * t - l);
  return sum;
}

TEST(Daubechies, TablesKeepTheLawsOfTheBasis) {
  double integral = 0.0;
  double square = 0.0;
  double shifted = 0.0;
  double moment = 0.0;
  constexpr int kCount = 1 << 12;
  for (int i = 0; i < kCount; ++i) {
    const auto f = static_cast<float>((i + 0.5) / kCount);
    const Values v = values_at(f);
    EXPECT_NEAR(v.phi[0] + v.phi[1] + v.phi[2], 1.0F, 1e-5F);
    EXPECT_NEAR(v.lambda[0] + v.lambda[1] + v.lambda[2] + v.lambda[3], 1.0F, 1e-5F);
    for (std::size_t k = 0; k < 3; ++k) {
      integral += static_cast<double>(v.phi[k]) / kCount;
      moment += static_cast<double>(v.phi[k]) * (static_cast<double>(f) + static_cast<double>(k)) /
                kCount;
      square += static_cast<double>(v.phi[k] * v.phi[k]) / kCount;
    }
    shifted += static_cast<double>(v.phi[0] * v.phi[1] + v.phi[1] * v.phi[2]) / kCount;
  }
  EXPECT_NEAR(integral, 1.0, 1e-6);
  EXPECT_NEAR(moment, (3.0 - kSqrt3) / 2.0, 1e-3);
  EXPECT_NEAR(square, 1.0, 1e-2);  // linear between multiples of 1/64
  EXPECT_NEAR(shifted, 0.0, 1e-2);
}

TEST(Daubechies, TablesAreExactAtTheirNodes) {
  for (int i = 0; i <= 64; ++i) {
    const Values v = values_at(static_cast<float>(i) / 64.0F);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(static_cast<double>(v.phi[static_cast<std::size_t>(k)]), phi(i / 64.0 + k), 2e-6);
    }
  }
}

// lambda'(t) = phi(t) - phi(t - 1), so lambda is the integral of phi over [t - 1, t], computed from
// its refinement.
double lambda(double t, int steps) {
  if (t <= 0.0 || t >= 4.0) return 0.0;
  if (steps == 0)
    return values_at(static_cast<float>(t - std::floor(t))).lambda[static_cast<std::size_t>(t)];
  double sum = 0.0;
  for (int l = 0; l < 4; ++l) {
    const double at = 2.0 * t - l;
    sum += kLow[static_cast<std::size_t>(l)] *
           (lambda(at, steps - 1) + lambda(at - 1.0, steps - 1)) / 2.0;
  }
  return sum;
}

TEST(Daubechies, IntegralsRefine) {
  for (int i = 1; i < 128; ++i) EXPECT_NEAR(lambda(i / 32.0, 0), lambda(i / 32.0, 1), 2e-6);
}

struct Sample {
  Vector3 point;  // in the root
  std::array<float, 3> area;
};

// Samples at table nodes of depth `depth`, where the tables are exact.
std::vector<Sample> random_samples(int depth, int count) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> place(8, (64 << depth) - 8);
  std::normal_distribution<float> normal;
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    Sample s;
    for (double& x : s.point) x = std::ldexp(place(random), -depth - 6);
    for (float& x : s.area) x = normal(random);
    samples.push_back(s);
  }
  return samples;
}

double high(double t) {  // psi
  double sum = 0.0;
  for (int l = 0; l < 4; ++l) sum += kHigh[static_cast<std::size_t>(l)] * phi(2.0 * t - (l - 2));
  return sum;
}

// The integral of psi, from integrals of phi.
double high_integral(double t) {
  const auto integral = [](double x) {
    double sum = 0.0;
    for (; x > 0.0; x -= 1.0) {
      if (x < 4.0) {
        // The integral of phi below x: lambda at x, x - 1, ...
        double y = x;
        double total = 0.0;
        for (; y > 0.0; y -= 1.0) total += lambda(y, 0);
        return total;
      }
      if (x >= 4.0) return 1.0;
    }
    return sum;
  };
  double sum = 0.0;
  for (int l = 0; l < 4; ++l) {
    sum += kHigh[static_cast<std::size_t>(l)] * integral(2.0 * t - (l - 2)) / 2.0;
  }
  return sum;
}

// Equation 4.2 for depth j, with the F of section 4.2.
double coefficient(const std::vector<Sample>& samples, int j, std::size_t e,
                   const std::array<int, 3>& k) {
  double sum = 0.0;
  int axes = 0;
  for (std::size_t a = 0; a < 3; ++a) axes += static_cast<int>((e >> a) & 1);
  for (const Sample& s : samples) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (((e >> a) & 1) == 0) continue;
      double term = static_cast<double>(s.area[a]) / axes;
      for (std::size_t b = 0; b < 3; ++b) {
        const double t = std::ldexp(s.point[b], j) - k[b];
        term *= b == a ? high_integral(t) : ((e >> b) & 1) != 0 ? high(t) : phi(t);
      }
      sum += term * std::ldexp(1.0, 2 * j);
    }
  }
  return sum;
}

// The means of the next depth are determined by the means and the details, so the details can be
// computed from them, as <s, psi> with psi of equation 3.2.
TEST(D4Transform, DetailsAreThePrintedSums) {
  constexpr int kDepth = 3;
  const std::vector<Sample> samples = random_samples(kDepth, 40);
  std::vector<Differences> differences;
  std::vector<std::vector<BrickPosition>> needed(kDepth + 1);
  for (int k = 0; k <= kDepth; ++k) differences.emplace_back(k, kShardBits);
  for (const Sample& s : samples) {
    std::array<float, 3> area;
    for (std::size_t a = 0; a < 3; ++a) area[a] = s.area[a] * static_cast<float>(1 << (2 * kDepth));
    add_sample({s.point[0] * 8, s.point[1] * 8, s.point[2] * 8}, area, &differences.back());
  }
  for (int z = -2; z < 4; ++z) {
    for (int y = -2; y < 4; ++y) {
      for (int x = -2; x < 4; ++x) needed[kDepth].push_back({x, y, z});
    }
  }
  const std::vector<Means> means = transform(std::move(differences), needed, prefilter::Run(1));
  for (int j = 0; j < kDepth; ++j) {
    for (const std::array<int, 3>& k :
         {std::array{0, 0, 0}, {-1, 0, 1}, {1, 1, 0}, {(1 << j) - 1, 0, -1}}) {
      std::array<float, 216> window;
      means[static_cast<std::size_t>(j) + 1].window<6>({2 * k[0] - 2, 2 * k[1] - 2, 2 * k[2] - 2},
                                                       &window);
      for (std::size_t e = 1; e < 8; ++e) {
        double found = 0.0;
        for (std::size_t w = 0; w < 6; ++w) {
          for (std::size_t v = 0; v < 6; ++v) {
            for (std::size_t u = 0; u < 6; ++u) {
              double weight = 1.0;
              const std::array<std::size_t, 3> p = {u, v, w};
              for (std::size_t a = 0; a < 3; ++a) {
                const bool is_high = ((e >> a) & 1) != 0;
                const std::size_t first = is_high ? 0 : 2;
                const bool is_in = p[a] >= first && p[a] < first + 4;
                weight *= is_in ? (is_high ? kHigh : kLow)[p[a] - first] / 2.0 : 0.0;
              }
              found += weight * static_cast<double>(window[(w * 6 + v) * 6 + u]);
            }
          }
        }
        const double expected = coefficient(samples, j, e, k);
        EXPECT_NEAR(found, expected, 1e-3 * (1.0 + std::abs(expected))) << j << " " << e;
      }
    }
  }
}

}  // namespace
}  // namespace prefilter::d4
