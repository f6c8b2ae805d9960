// SPDX-License-Identifier: GPL-3.0-or-later

// The box filter's fast path against fine sampling of the outline, and its laws.
#include "prefilter/shapes/raster/box_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/shapes/raster/moment_cells.h"
#include "prefilter/shapes/raster/moment_rows.h"

namespace prefilter {
namespace {

struct Size {
  int width;
  int height;
};

std::vector<std::uint32_t> box_steps(const std::vector<Outline>& outlines, Size size, int band) {
  std::vector<std::uint32_t> image(static_cast<std::size_t>(size.width) * size.height, 0);
  BoxCoverage coverage;
  for (int first = 0; first < size.height; first += band) {
    coverage.begin(size.width, first, std::min(first + band, size.height));
    for (const Outline& outline : outlines) EXPECT_TRUE(coverage.add(outline));
    coverage.take(
        [&](int row, int x, int count, const std::uint32_t* values) {
          std::copy_n(values, count, &image[static_cast<std::size_t>(row) * size.width + x]);
        },
        [&](int row, int begin, int end, std::uint32_t value) {
          std::fill(&image[static_cast<std::size_t>(row) * size.width + begin],
                    &image[static_cast<std::size_t>(row) * size.width + begin] + (end - begin),
                    value);
        });
  }
  return image;
}

std::vector<double> box_coverage(const std::vector<Outline>& outlines, Size size) {
  std::vector<double> values;
  for (const std::uint32_t steps : box_steps(outlines, size, 5)) {
    values.push_back(static_cast<std::int32_t>(steps) * kBoxUnit);
  }
  return values;
}

// Coverage by the path for all filters.
std::vector<double> general_coverage(const Outline& outline, Size size) {
  const CellFilter& filter = *find_cell_filter("box");
  EdgeList edges;
  edges.add(outline);
  MomentCells<0> cells;
  cells.begin_band(filter, size.width, 0, size.height);
  edges.for_pieces_between(0, size.height, filter, [&](const MonotoneCurve& piece, bool backward) {
    cells.add(piece, backward ? 1 : -1);
  });
  cells.finish();
  CoverageRows rows;
  rows.reset(size.width, size.height);
  MomentRows<0>(filter, size.width).add_coverage(cells, 0, size.height, &rows);
  std::vector<double> image(static_cast<std::size_t>(size.width) * size.height, 0.0);
  for (int row = 0; row < size.height; ++row) {
    const auto set = [&](int x, double value) {
      image[static_cast<std::size_t>(row) * size.width + x] = value;
    };
    rows.take(row, set, [&](int begin, int end, double value) {
      for (int x = begin; x < end; ++x) set(x, value);
    });
  }
  return image;
}

using Random = std::mt19937;

// Sometimes on a grid of 1/4, so that points fall on lines between pixels.
double coordinate(Random* random, double low, double high, bool on_grid) {
  const double value = std::uniform_real_distribution<double>(low, high)(*random);
  return on_grid ? std::round(4.0 * value) / 4.0 : value;
}

enum class Kind { kLines, kQuadratics, kCubics, kConics, kHigh, kMixed };

Outline random_outline(Random* random, Kind kind, int segments, double low, double high,
                       bool on_grid) {
  const auto point = [&]() -> Point2 {
    return {coordinate(random, low, high, on_grid), coordinate(random, low, high, on_grid)};
  };
  Outline outline;
  outline.move_to(point());
  for (int i = 0; i < segments; ++i) {
    const Kind here = kind == Kind::kMixed
                          ? static_cast<Kind>(std::uniform_int_distribution(0, 4)(*random))
                          : kind;
    std::array<Point2, 6> points;
    std::generate(points.begin(), points.end(), point);
    switch (here) {
      case Kind::kLines:
        outline.line_to(points[0]);
        break;
      case Kind::kQuadratics:
        outline.curve_to(std::span(points).first(2));
        break;
      case Kind::kCubics:
        outline.curve_to(std::span(points).first(3));
        break;
      case Kind::kConics:
        outline.conic_to(points[0], std::exp(coordinate(random, -1.0, 1.0, false)), points[1]);
        break;
      default:
        outline.curve_to(points);
        break;
    }
  }
  outline.close();
  return outline;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

class BoxKinds : public testing::TestWithParam<Kind> {};

TEST_P(BoxKinds, AgreesWithTheGeneralPath) {
  Random random(7);
  for (const auto& [low, high] :
       {std::pair(2.0, 20.0), std::pair(-30.0, 55.0), std::pair(9.0, 10.5), std::pair(-3e3, 3e3),
        std::pair(5.0, 5.5), std::pair(-40.0, 12.0)}) {
    for (int trial = 0; trial < 60; ++trial) {
      const Outline outline =
          random_outline(&random, GetParam(), 1 + trial % 7, low, high, trial % 3 == 0);
      const Size size{1 + trial % 37, 1 + trial % 23};
      // Each segment in a pixel is off by a unit or two.
      EXPECT_LT(largest_difference(box_coverage({outline}, size), general_coverage(outline, size)),
                4e-7)
          << low << " " << high << " " << trial;
    }
  }
}

Outline reversed(const Outline& outline) {
  Outline out;
  for (std::size_t contour = 0; contour < outline.contour_count(); ++contour) {
    const auto segments = outline.contour(contour);
    out.move_to(outline.controls(segments.back()).back());
    for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
      const auto controls = outline.controls(*segment);
      std::vector<Point2> turned(controls.rbegin() + 1, controls.rend());
      if (segment->weight != 0.0) {
        out.conic_to(turned[0], segment->weight, turned[1]);
      } else {
        out.curve_to(turned);
      }
    }
    out.close();
  }
  return out;
}

TEST_P(BoxKinds, ReversedOutlinesCancel) {
  Random random(8);
  for (int trial = 0; trial < 60; ++trial) {
    const double reach = trial % 2 == 0 ? 30.0 : 2.0;
    const Outline outline = random_outline(&random, GetParam(), 1 + trial % 7, 10.0 - reach,
                                           10.0 + reach, trial % 3 == 0);
    for (const std::uint32_t steps : box_steps({outline, reversed(outline)}, {21, 19}, 19)) {
      ASSERT_EQ(steps, 0U) << trial;
    }
  }
}

TEST_P(BoxKinds, BandsDoNotMatter) {
  Random random(9);
  for (int trial = 0; trial < 30; ++trial) {
    const Outline outline = random_outline(&random, GetParam(), 5, -20.0, 50.0, trial % 3 == 0);
    const Size size{33, 29};
    const auto whole = box_steps({outline}, size, size.height);
    EXPECT_EQ(whole, box_steps({outline}, size, 1));
    EXPECT_EQ(whole, box_steps({outline}, size, 7));
  }
}

std::vector<std::uint8_t> drawn_bytes(const Outline& outline, Size size, int stride) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(stride) * size.height, 0);
  BoxRasterizer rasterizer;
  rasterizer.draw(outline, {bytes.data(), size.width, size.height, stride});
  return bytes;
}

TEST_P(BoxKinds, BytesAreRounded) {
  Random random(10);
  for (int trial = 0; trial < 30; ++trial) {
    const Outline outline = random_outline(&random, GetParam(), 4, -5.0, 45.0, trial % 3 == 0);
    const Size size{1 + trial, 17};
    const int stride = size.width + trial % 3;
    const auto bytes = drawn_bytes(outline, size, stride);
    const auto steps = box_steps({outline}, size, size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < stride; ++x) {
        const auto byte = static_cast<double>(bytes[static_cast<std::size_t>(y) * stride + x]);
        if (x >= size.width) {
          ASSERT_EQ(byte, 0.0) << "beyond the row";
          continue;
        }
        const auto coverage =
            static_cast<std::int32_t>(steps[static_cast<std::size_t>(y) * size.width + x]) *
            kBoxUnit;
        ASSERT_NEAR(byte, std::clamp(255.0 * coverage, 0.0, 255.0), 0.5 + 1e-4);
      }
    }
  }
}

TEST(BoxCoverage, AnyOutlineByRuleAndThreads) {
  const Size size{600, 700};
  Outline star;  // its middle has winding number 2
  star.move_to({300.0, 650.0});
  for (const int corner : {2, 4, 1, 3}) {
    const double angle = 2.0 * std::numbers::pi * corner / 5;
    star.line_to({300.0 - 300.0 * std::sin(angle), 350.0 + 300.0 * std::cos(angle)});
  }
  star.close();
  const auto draw = [&](FillRule rule, int threads) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size.width) * size.height, 0);
    rasterize_coverage(star, rule, {bytes.data(), size.width, size.height, size.width},
                       prefilter::Run(threads));
    return bytes;
  };
  const std::size_t middle = 350U * 600U + 300U;
  EXPECT_EQ(draw(FillRule::kNonzero, 1)[middle], 255);
  EXPECT_EQ(draw(FillRule::kEvenOdd, 1)[middle], 0);
  EXPECT_EQ(draw(FillRule::kNonzero, 1), draw(FillRule::kNonzero, 3));
}

TEST(BoxCoverage, RefusesInvalidSizes) {
  BoxRasterizer rasterizer;
  EXPECT_THROW(rasterizer.draw({}, {nullptr, 0, 4, 0}), Error);
  EXPECT_THROW(rasterizer.draw({}, {nullptr, 4, -1, 4}), Error);
  EXPECT_THROW(rasterizer.draw({}, {nullptr, kMaxBoxImageSide + 1, 1, 0}), Error);
}

TEST(BoxCoverage, RefusesInvalidPoints) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), -1.1e9}) {
    for (const bool is_curve : {false, true}) {
      Outline outline;
      outline.move_to({1.0, 1.0});
      outline.line_to({2.0, 5.0});
      if (is_curve) outline.curve_to(std::array<Point2, 2>{Point2{3.0, bad}, Point2{4.0, 4.0}});
      if (!is_curve) outline.line_to({bad, 3.0});
      outline.close();
      EXPECT_THROW(drawn_bytes(outline, {8, 8}, 8), Error) << bad;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, BoxKinds,
                         testing::Values(Kind::kLines, Kind::kQuadratics, Kind::kCubics,
                                         Kind::kConics, Kind::kHigh, Kind::kMixed));

}  // namespace
}  // namespace prefilter
