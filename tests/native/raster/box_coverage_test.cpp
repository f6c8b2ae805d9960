// The box filter's own way against a fine sampling of the outline, and its laws.
#include "prefilter/raster/box_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/raster/moment_cells.h"
#include "prefilter/raster/moment_rows.h"

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

// By the way that serves all filters.
std::vector<double> general_coverage(const Outline& outline, Size size) {
  const CellFilter& filter = *find_cell_filter("box");
  EdgeList edges;
  edges.add(outline);
  MomentCells<0> cells;
  cells.begin_band(filter, size.width, 0, size.height);
  edges.for_pieces_between(0, size.height, filter, [&](const MonotoneCurve& piece, bool backwards) {
    cells.add(piece, backwards ? 1 : -1);
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

// On a grid of 1/4 now and then, so that lines between pixels are met.
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

TEST_P(BoxKinds, AgreesWithTheGeneralWay) {
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

TEST_P(BoxKinds, TheOtherWayRoundLeavesNothing) {
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

INSTANTIATE_TEST_SUITE_P(All, BoxKinds,
                         testing::Values(Kind::kLines, Kind::kQuadratics, Kind::kCubics,
                                         Kind::kConics, Kind::kHigh, Kind::kMixed));

}  // namespace
}  // namespace prefilter
