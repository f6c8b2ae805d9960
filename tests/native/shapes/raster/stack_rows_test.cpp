// SPDX-License-Identifier: GPL-3.0-or-later

// Stacks of layers against resolved outlines or, where too many curves cross, against brute-force
// sampling.
#include "prefilter/shapes/raster/stack_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include "prefilter/shapes/outline/arrangement.h"
#include "prefilter/shapes/outline/resolve_within_budget.h"
#include "prefilter/shapes/outline/visible_pieces.h"
#include "prefilter/shapes/raster/composited_rows.h"
#include "prefilter/shapes/raster/parabolas.h"
#include "prefilter/shapes/rasterize.h"
#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

constexpr ChannelValues kBackground = {0.25, 0.5, 0.125, 1.0};

struct Drawn {
  std::vector<double> values;  // of all channels
  StackWork work;
};

template <int N>
Drawn drawn(const std::vector<Shape>& shapes, std::string_view filter, int width, int height,
            std::size_t sweep_steps = StackRows<N>::kSweepSteps) {
  const LayerStack stack = make_stack(shapes);
  const int channels = shapes.front().paint.channels;
  StackRows<N> rows(stack, *find_cell_filter(filter), kBackground, channels, width, height,
                    sweep_steps);
  BandValues values;
  values.reset(width, height, channels, kBackground);
  rows.add_values(0, height, &values);
  Drawn out{{}, rows.work()};
  for (int row = 0; row < height; ++row) {
    const double* begin = values.row(row);
    out.values.insert(out.values.end(), begin, begin + width * channels);
  }
  return out;
}

Paint painted(std::mt19937* random, double alpha) {
  std::uniform_real_distribution<double> unit(0.0, alpha);
  Paint paint;
  paint.channels = 4;
  paint.constant = {unit(*random), unit(*random), unit(*random), alpha};
  return paint;
}

// Curves across a square.
Outline tangle(std::mt19937* random, int curves, double side) {
  std::uniform_real_distribution<double> place(-0.1 * side, 1.1 * side);
  const auto point = [&] { return Point2{place(*random), place(*random)}; };
  Outline outline;
  outline.move_to(point());
  for (int i = 0; i < curves; ++i) {
    switch (i % 3) {
      case 0:
        outline.line_to(point());
        break;
      case 1:
        outline.curve_to(std::vector<Point2>{point(), point(), point()});
        break;
      default:
        outline.conic_to(point(), 0.7, point());
        break;
    }
  }
  outline.close();
  return outline;
}

std::vector<Shape> tangles(int count, int curves, double side, double alpha, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Shape> shapes;
  for (int i = 0; i < count; ++i) {
    const FillRule rule = i % 2 == 0 ? FillRule::kNonzero : FillRule::kEvenOdd;
    shapes.push_back({tangle(&random, curves, side), rule, painted(&random, alpha)});
  }
  return shapes;
}

// The composited color at a point, by winding numbers from the top.
class Points {
 public:
  explicit Points(const std::vector<Shape>& shapes) : shapes_(shapes) {
    for (const Shape& shape : shapes) chains_.push_back(fine_chains(shape.outline, 60));
  }

  // Means over a pixel.
  ChannelValues means(int x, int y, int count) const {
    ChannelValues sums{};
    for (int i = 0; i < count; ++i) {
      // Not on rows and columns, which axis-aligned edges would pass all at once.
      const double u = (i + 0.5) / count;
      const double v = std::fmod(i * 0.6180339887498949 + 0.25, 1.0);
      const ChannelValues value = at({x + u, y + v});
      for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += value[c] / count;
    }
    return sums;
  }

 private:
  ChannelValues at(const Point2& point) const {
    ChannelValues value{};
    double transmittance = 1.0;
    for (std::size_t i = shapes_.size(); i-- > 0 && transmittance > 1e-9;) {
      if (!filled(winding(chains_[i], point), shapes_[i].fill_rule)) continue;
      const ChannelValues& color = shapes_[i].paint.constant;
      for (std::size_t c = 0; c < value.size(); ++c) value[c] += transmittance * color[c];
      transmittance *= 1.0 - color[3];
    }
    for (std::size_t c = 0; c < value.size(); ++c) value[c] += transmittance * kBackground[c];
    return value;
  }

  const std::vector<Shape>& shapes_;
  std::vector<std::vector<Chain>> chains_;
};

// The visible part of each shape, as outlines that are only added. Colors are opaque where they
// vary.
Image of_visible_pieces(const std::vector<Shape>& shapes, std::string_view filter, int side) {
  std::vector<CoveringLayer> layers;
  for (const Shape& shape : shapes) {
    layers.push_back({&shape.outline, shape.fill_rule, shape.paint.constant[3] >= 1.0});
  }
  const auto pieces = visible_pieces(layers, ArrangementEffort::kUnbounded);
  EXPECT_TRUE(pieces);
  std::vector<Shape> apart;
  for (const VisiblePiece& piece : *pieces) {
    double transmittance = 1.0;
    for (const std::uint32_t overlay : piece.overlays)
      transmittance *= 1.0 - shapes[overlay].paint.constant[3];
    Paint paint = shapes[piece.layer].paint;
    const double alpha = paint.constant[3];
    for (std::size_t c = 0; c < paint.constant.size(); ++c) {
      paint.constant[c] = transmittance * (paint.constant[c] - alpha * kBackground[c]);
    }
    apart.push_back({piece.outline, FillRule::kNonzero, paint, true});
  }
  RasterOptions options;
  options.width = side;
  options.height = side;
  options.filter = filter;
  options.overlap = Overlap::kAdd;
  Image image = rasterize(apart, options);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] += static_cast<float>(kBackground[i % 4]);
  }
  return image;
}

template <int N>
void expect_like_outlines(const std::vector<Shape>& shapes, std::string_view filter, int side,
                          double tolerance = 1e-6) {
  const Image expected = of_visible_pieces(shapes, filter, side);
  const Drawn found = drawn<N>(shapes, filter, side, side);
  EXPECT_EQ(found.work.sampled_cells, 0u);
  EXPECT_GT(found.work.swept_cells, 0u);
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    ASSERT_NEAR(found.values[i], expected.texel(0, 0)[i], tolerance) << filter << " " << i;
  }
}

TEST(StackRows, SweptCellsMatchResolvedOutlines) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const double alpha = seed % 2 == 0 ? 1.0 : 0.4;
    const std::vector<Shape> shapes = tangles(4, 6, 40.0, alpha, seed);
    expect_like_outlines<0>(shapes, "box", 40);
    expect_like_outlines<1>(shapes, "tent", 40);
    expect_like_outlines<3>(shapes, "mitchell", 40);
    expect_like_outlines<7>(shapes, "radial2", 40);
  }
}

TEST(StackRows, CurvesThatCrossTwiceInACell) {
  // x - y is 0.8 t (1 - t) along a curve and 0.1 along a line: they cross at 0.15 and 0.85.
  const auto closed = [](Outline outline) {
    outline.line_to({2.5, outline.points().back().y});
    outline.line_to({2.5, 1.05});
    outline.close();
    return outline;
  };
  std::mt19937 random(2);
  for (const double control : {0.3, 0.32, 0.28}) {
    Outline curve;
    curve.move_to({1.1, 1.1});
    curve.curve_to(std::vector<Point2>{{2.0 - control, 1.0 + control}, {1.9, 1.9}});
    Outline line;
    line.move_to({1.15, 1.05});
    line.line_to({1.95, 1.85});
    expect_like_outlines<0>({{closed(curve), FillRule::kNonzero, painted(&random, 0.5)},
                             {closed(line), FillRule::kNonzero, painted(&random, 0.5)}},
                            "box", 3);
  }
  for (unsigned seed = 1; seed <= 8; ++seed) {
    expect_like_outlines<0>(tangles(2, 5, 3.0, 0.5, seed), "box", 3);
  }
}

TEST(StackRows, LinearColorsAreExact) {
  std::vector<Shape> shapes = tangles(3, 5, 30.0, 1.0, 9);
  for (Shape& shape : shapes) {
    shape.paint.kind = Paint::Kind::kLinear;
    shape.paint.along_x = {0.01, -0.005, 0.002, 0.0};
    shape.paint.along_y = {-0.003, 0.004, 0.006, 0.0};
  }
  // Curves are approximated by parabolas.
  expect_like_outlines<0>(shapes, "box", 30, 1e-5);
  expect_like_outlines<3>(shapes, "mitchell", 30, 1e-5);
}

Outline box(const Point2& low, const Point2& high) {
  Outline outline;
  outline.move_to(low);
  outline.line_to({high.x, low.y});
  outline.line_to(high);
  outline.line_to({low.x, high.y});
  outline.close();
  return outline;
}

TEST(StackRows, HorizontalEdgesCrossManyCells) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> place(-2.0, 32.0);
  std::vector<Shape> shapes;
  for (int i = 0; i < 12; ++i) {
    Outline outline;
    for (int k = 0; k < 2; ++k) {
      const Point2 low{place(random), place(random)};
      const Point2 high{place(random), place(random)};
      outline.append(box(low, high));
    }
    const FillRule rule = i % 2 == 0 ? FillRule::kNonzero : FillRule::kEvenOdd;
    shapes.push_back({outline, rule, painted(&random, 0.7)});
  }
  expect_like_outlines<0>(shapes, "box", 30);
  expect_like_outlines<3>(shapes, "mitchell", 30);
}

// Boxes in random places, over curves, until nothing below is visible.
TEST(StackRows, HiddenLayersAreSkipped) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, 20.0);
  for (const double alpha : {1.0, 0.75}) {
    std::vector<Shape> shapes = tangles(4, 4, 30.0, 0.5, 6);
    for (int i = 0; i < 40; ++i) {
      const Point2 low{place(random) - 4.0, place(random) - 4.0};
      Outline outline = box(low, {low.x + 15.3, low.y + 14.6});
      if (i % 8 == 0) outline.append(tangle(&random, 2, 30.0));
      shapes.push_back({outline, FillRule::kNonzero, painted(&random, alpha)});
    }
    expect_like_outlines<0>(shapes, "box", 30);
    expect_like_outlines<1>(shapes, "tent", 30);
    Paint paint = painted(&random, 1.0);
    shapes.push_back({box({-50.0, -50.0}, {50.0, 50.0}), FillRule::kEvenOdd, paint});
    const Drawn found = drawn<0>(shapes, "box", 30, 30);
    EXPECT_EQ(found.work.swept_cells + found.work.sampled_cells, 0u);
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      ASSERT_NEAR(found.values[i], paint.constant[i % 4], 1e-6) << i;
    }
  }
}

TEST(StackRows, HidingEndsWithTheOpaqueLayer) {
  std::mt19937 random(6);
  const Paint behind = painted(&random, 1.0);
  std::vector<Shape> shapes = {{box({-5.0, -5.0}, {28.0, 40.0}), FillRule::kEvenOdd, behind}};
  for (int i = 0; i < 40; ++i) {
    const Paint paint = painted(&random, 0.75);
    shapes.push_back({box({-5.0, -5.0}, {10.0, 40.0}), FillRule::kEvenOdd, paint});
  }
  const Drawn found = drawn<0>(shapes, "box", 30, 30);
  for (int x = 11; x < 28; ++x) {
    EXPECT_NEAR(found.values[4 * (30 * 15 + x)], behind.constant[0], 1e-6) << x;
  }
}

// Deep inside a shape with a high winding number, other curves have no effect.
TEST(StackRows, HighWindingNumbersFillWholeCells) {
  std::mt19937 random(4);
  Outline outline;
  for (int i = 0; i < 9; ++i) outline.append(box({-3.5 - i, -3.5}, {33.5, 33.25 + i}));
  outline.append(tangle(&random, 9, 30.0));
  Paint paint;
  const Drawn found = drawn<0>({{outline, FillRule::kNonzero, paint}}, "box", 30, 30);
  EXPECT_EQ(found.work.swept_cells + found.work.sampled_cells, 0u);
  for (const double value : found.values) ASSERT_NEAR(value, 1.0, 1e-6);
}

// Composites by pixel coverage, and marked pixels cell by cell. If `are_known_to_wind_once`,
// outlines are known to wind once. Returns the values, and the number of swept cells.
Drawn composited(const std::vector<Shape>& shapes, int side, bool are_known_to_wind_once) {
  std::vector<Outline> outlines;
  for (const Shape& shape : shapes) {
    std::optional<Outline> changed;
    if (are_known_to_wind_once) {
      EXPECT_TRUE(resolve_within_budget(shape.outline, shape.fill_rule, {}, &changed));
    }
    outlines.push_back(changed ? *changed : shape.outline);
  }
  std::vector<StackShape> of_stack;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    of_stack.push_back(
        {&outlines[i], shapes[i].fill_rule, &shapes[i].paint, are_known_to_wind_once});
  }
  const LayerStack stack = make_stack(of_stack);
  BandValues values;
  values.reset(side, side, 4, kBackground);
  CompositedRows rows(stack, side, 4);
  StackRows<0> cells(stack, *find_cell_filter("box"), kBackground, 4, side, side);
  rows.composite_over(0, side, kBackground, &values);
  cells.add_marked(0, side, rows, &values);
  Drawn out{{}, cells.work()};
  for (int row = 0; row < side; ++row) {
    out.values.insert(out.values.end(), values.row(row), values.row(row) + side * 4);
  }
  return out;
}

void expect_composited_like_outlines(const std::vector<Shape>& shapes, int side) {
  const Image expected = of_visible_pieces(shapes, "box", side);
  for (const bool are_known_to_wind_once : {true, false}) {
    const Drawn found = composited(shapes, side, are_known_to_wind_once);
    EXPECT_EQ(found.work.sampled_cells, 0u);
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      ASSERT_NEAR(found.values[i], expected.data[i], 1e-6) << are_known_to_wind_once << " " << i;
    }
  }
}

TEST(CompositedRows, MatchResolvedOutlines) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const double alpha = seed % 2 == 0 ? 1.0 : 0.4;
    expect_composited_like_outlines(tangles(5, 6, 45.0, alpha, seed), 45);
  }
}

// Horizontal edges cause no differences along a row, and end beyond the image.
TEST(CompositedRows, LevelEdges) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-6.0, 36.0);
  for (const double alpha : {1.0, 0.7}) {
    std::vector<Shape> shapes;
    for (int i = 0; i < 10; ++i) {
      Outline outline = box({place(random), place(random)}, {place(random), place(random)});
      const double y = place(random);
      outline.append(box({-20.0, y}, {50.0, y + 7.5}));
      outline.append(box({-20.0, y + 0.25}, {50.0, y + 0.75}));
      const FillRule rule = i % 2 == 0 ? FillRule::kNonzero : FillRule::kEvenOdd;
      shapes.push_back({outline, rule, painted(&random, alpha)});
    }
    expect_composited_like_outlines(shapes, 30);
  }
}

TEST(CompositedRows, OnlyCellsWithSeveralOutlinesAreSwept) {
  std::mt19937 random(3);
  const auto shape = [&](const Outline& outline) {
    return Shape{outline, FillRule::kNonzero, painted(&random, 1.0)};
  };
  // Two edges of the second box are inside the first, and cross its edges in two cells.
  const Shape first = shape(box({2.5, 2.5}, {20.5, 20.5}));
  const Shape second = shape(box({10.5, 10.5}, {28.5, 28.5}));
  EXPECT_EQ(composited({first, second}, 30, true).work.swept_cells, 2u);
  // Under a full layer no cell is marked.
  const Shape third = shape(box({1.0, 1.0}, {29.0, 29.0}));
  EXPECT_EQ(composited({first, second, third}, 30, true).work.swept_cells, 0u);
}

TEST(Parabolas, StayCloseToCurves) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0.0, 30.0);
  double heights = 0.0;
  for (int i = 0; i < 200; ++i) {
    std::vector<Point2> controls;
    for (int k = 0; k < 3 + i % 3; ++k) controls.push_back({place(random), place(random)});
    const double weight = i % 6 == 0 ? 0.8 : 0.0;
    for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool) {
      std::vector<Parabola> parabolas;
      append_parabolas(
          piece, [](const Point2&, const Point2&) { return true; }, &parabolas);
      for (const Parabola& parabola : parabolas) {
        ASSERT_LT(parabola.low.y, parabola.high.y);
        for (const double share : {0.0, 0.3, 0.6, 1.0}) {
          const double t = (1.0 - share) * parabola.t_low + share * parabola.t_high;
          const Point2 point = piece.curve.at(t);
          const double height = std::min(1.0, parabola.high.y - parabola.low.y);
          const double x = parabola.x_at(point.y);
          ASSERT_LE(std::fabs(x - point.x) * height, kParabolaError) << i << " " << t;
          if (std::fabs(parabola.high.x - parabola.low.x) > 1e-3) {
            ASSERT_NEAR(parabola.x_at(parabola.y_at(x)), x, 1e-9) << i << " " << t;
          }
          ASSERT_NEAR(parabola.x_at(point.y), piece.curve.at(parabola.t_at(point.y)).x, 0.02);
        }
        heights += parabola.high.y - parabola.low.y;
      }
      heights -= std::fabs(piece.end.y - piece.begin.y);
      // Chords where the curve is not visible.
      parabolas.clear();
      append_parabolas(
          piece, [](const Point2&, const Point2&) { return false; }, &parabolas);
      ASSERT_LE(parabolas.size(), 1u);
    });
  }
  EXPECT_NEAR(heights, 0.0, 1e-9);
}

// The covered fraction of a cell by a half plane, and the fraction of covered samples. The half
// plane ends in one pixel, and extends far beyond it on the other sides.
Outline half_plane(const Point2& across, double height) {
  const Point2 along{-across.y, across.x};
  const Point2 center{0.5, 0.5};
  Outline outline;
  outline.move_to(center + height * across - 4.0 * along);
  outline.line_to(center + height * across + 4.0 * along);
  outline.line_to(center - 4.0 * across + 4.0 * along);
  outline.line_to(center - 4.0 * across - 4.0 * along);
  outline.close();
  return outline;
}

TEST(SampleBits, EdgeErrorsStayBelowOneByteStep) {
  double worst = 0.0;
  double squares = 0.0;
  int count = 0;
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  const auto compare = [&](double turn) {
    const Point2 across{std::cos(turn), std::sin(turn)};
    // The integral of a trapezoid: the length of a line in the cell at each height.
    const double a = std::max(1e-9, std::min(std::fabs(across.x), std::fabs(across.y)));
    const double b = std::max(std::fabs(across.x), std::fabs(across.y));
    const auto square = [](double x) { return x > 0.0 ? x * x : 0.0; };
    for (int i = 0; i < 60; ++i) {
      const double height = (a + b) * unit(random);
      const double up = height + 0.5 * (a + b);
      const double share =
          (square(up) - square(up - a) - square(up - b) + square(up - a - b)) / (2.0 * a * b);
      Paint white;
      white.constant = {1.0};
      const std::vector<Shape> shapes = {{half_plane(across, height), FillRule::kNonzero, white}};
      const Drawn found = drawn<0>(shapes, "box", 1, 1, 0);
      const double off = found.values[0] - kBackground[0] - share * (1.0 - kBackground[0]);
      worst = std::max(worst, std::fabs(off));
      squares += off * off;
      ++count;
    }
  };
  constexpr int kDirections = 360;
  for (int i = 0; i < kDirections; ++i) compare(i * 6.283185307179586 / kDirections);
  for (int i = -40; i <= 40; ++i) {
    compare(std::atan(i / 128.0));
    compare(std::atan(i / 128.0) + 1.5707963267948966);
  }
  // The error at full contrast is 4/3 of that.
  EXPECT_LE(worst / 0.75, 1.0 / 255.0);
  EXPECT_LE(std::sqrt(squares / count) / 0.75, 1.0 / 1500.0);
}

// Shapes for which cells are sampled, small enough for a sweep.
TEST(StackRows, SampledCellsMatchSweptCells) {
  constexpr std::size_t kAll = std::size_t{1} << 40;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const double alpha = seed % 2 == 0 ? 1.0 : 0.3;
    // Many of the curves within a pixel, and few.
    const double side = seed <= 3 ? 24.0 : 8.0;
    const std::vector<Shape> shapes = tangles(4, 8, side, alpha, seed);
    const int pixels = static_cast<int>(side);
    for (const std::string_view filter : {"box", "tent"}) {
      const auto draw = [&](std::size_t steps) {
        return filter == "box" ? drawn<0>(shapes, filter, pixels, pixels, steps)
                               : drawn<1>(shapes, filter, pixels, pixels, steps);
      };
      const Drawn swept = draw(kAll);
      const Drawn sampled = draw(0);
      EXPECT_EQ(swept.work.sampled_cells, 0u);
      EXPECT_GT(sampled.work.sampled_cells, 30u);
      for (std::size_t i = 0; i < swept.values.size(); ++i) {
        ASSERT_NEAR(swept.values[i], sampled.values[i], 1.0 / 255.0) << seed << filter << i;
      }
    }
  }
}

// Adjacent lines, almost along the rows of samples and almost across.
TEST(StackRows, SampledHatchesMatchSweptHatches) {
  for (const double slope : {0.001, 0.004, 0.03, 0.2}) {
    Outline along;
    Outline across;
    for (int i = 0; i < 20; ++i) {
      const double low = -1.0 + 0.31 * i;
      along.append(
          box({-1.0, low}, {6.0, low + 0.1}).transformed(AffineMap2{{1.0, slope}, {0.0, 1.0}}));
      across.append(
          box({low, -1.0}, {low + 0.1, 6.0}).transformed(AffineMap2{{1.0, 0.0}, {slope, 1.0}}));
    }
    Paint paint;
    for (const Outline& hatch : {along, across}) {
      const std::vector<Shape> shapes = {{hatch, FillRule::kNonzero, paint}};
      const Drawn swept = drawn<0>(shapes, "box", 5, 5, std::size_t{1} << 40);
      const Drawn sampled = drawn<0>(shapes, "box", 5, 5, 0);
      for (std::size_t i = 0; i < swept.values.size(); ++i) {
        EXPECT_NEAR(swept.values[i], sampled.values[i], 1.0 / 255.0) << slope << " " << i;
      }
    }
  }
}

// Translucent layers with one outline, which cells treat as one layer.
TEST(StackRows, EqualLayersAreMerged) {
  std::mt19937 random(7);
  const Outline once = tangle(&random, 5, 8.0);
  Paint paint = painted(&random, 0.1);
  Paint whole = paint;
  const double transmittance = std::pow(0.9, 300);
  for (int c = 0; c < 4; ++c) whole.constant[c] *= (1.0 - transmittance) / 0.1;
  const std::vector<Shape> many(300, Shape{once, FillRule::kNonzero, paint});
  const Drawn expected = drawn<0>({{once, FillRule::kNonzero, whole}}, "box", 8, 8);
  const Drawn found = drawn<0>(many, "box", 8, 8);
  EXPECT_GT(found.work.sampled_cells, 10u);
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    EXPECT_NEAR(found.values[i], expected.values[i], 1.0 / 255.0) << i;
  }
}

TEST(StackRows, SampledCellsAreCloseToPoints) {
  for (const double alpha : {1.0, 0.2}) {
    // All of them within a few pixels.
    const std::vector<Shape> shapes = tangles(60, 9, 3.0, alpha, 5);
    const Drawn found = drawn<0>(shapes, "box", 3, 3);
    EXPECT_GT(found.work.sampled_cells, 4u);
    const Points points(shapes);
    for (int i = 0; i < 9; ++i) {
      const ChannelValues means = points.means(i % 3, i / 3, 4096);
      for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(found.values[4 * i + c], means[c], 1.0 / 255.0)
            << alpha << " pixel " << i << " channel " << c;
      }
    }
  }
}

TEST(StackRows, SampledMomentsServeOtherFilters) {
  const std::vector<Shape> shapes = tangles(60, 9, 6.0, 0.6, 5);
  const Drawn box = drawn<0>(shapes, "box", 6, 6);
  const Drawn tent = drawn<1>(shapes, "tent", 6, 6);
  EXPECT_GT(tent.work.sampled_cells, 4u);
  double box_sum = 0.0;
  double tent_sum = 0.0;
  for (int y = 1; y < 5; ++y) {
    for (int x = 1; x < 5; ++x) {
      box_sum += box.values[4 * (6 * y + x)];
      tent_sum += tent.values[4 * (6 * y + x)];
    }
  }
  EXPECT_NEAR(box_sum / 16.0, tent_sum / 16.0, 0.02);
}

// The bounds are in steps, which do not depend on the machine.
TEST(StackRows, WorkIsBounded) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 64.0);
  for (const int count : {1000, 2000}) {
    Outline lines;
    for (int i = 0; i < count; ++i) {
      lines.move_to({place(random), place(random)});
      lines.line_to({place(random), place(random)});
      lines.line_to({place(random), place(random)});
      lines.close();
    }
    std::optional<Outline> changed;
    EXPECT_FALSE(resolve_within_budget(lines, FillRule::kNonzero, {}, &changed));
    Paint paint;
    const Drawn found = drawn<0>({{lines, FillRule::kNonzero, paint}}, "box", 64, 64);
    EXPECT_GT(found.work.sampled_cells, 100u);
    EXPECT_LT(found.work.swept_steps, std::size_t{1} << 29);
  }
}

// Few enough to be examined, but all of them cross: a grid of slices between curves and their
// chords.
TEST(StackRows, IntersectionsOfCurvesAreBounded) {
  Outline grid;
  for (int i = 0; i < 60; ++i) {
    grid.move_to({i + 0.5, 0.0});
    grid.curve_to(std::vector<Point2>{{i + 1.0, 32.0}, {i + 0.5, 64.0}});
    grid.close();
    grid.move_to({0.0, i + 0.5});
    grid.curve_to(std::vector<Point2>{{32.0, i + 1.0}, {64.0, i + 0.5}});
    grid.close();
  }
  const std::vector<const Outline*> outlines{&grid};
  Arrangement bounded(outlines, kArrangementPrecisions[0]);
  EXPECT_EQ(bounded.cut(ArrangementEffort::kBounded, {}), CutOutcome::kTooMany);
  Arrangement whole(outlines, kArrangementPrecisions[0]);
  EXPECT_EQ(whole.cut(ArrangementEffort::kUnbounded, {}), CutOutcome::kCut);
}

TEST(StackRows, EqualContoursAreMerged) {
  std::mt19937 random(8);
  const Outline once = tangle(&random, 5, 8.0);
  Outline many;
  for (int i = 0; i < 101; ++i) many.append(once);
  Paint paint;
  for (const FillRule rule : {FillRule::kNonzero, FillRule::kEvenOdd}) {
    const Drawn expected = drawn<0>({{once, rule, paint}}, "box", 8, 8);
    const Drawn found = drawn<0>({{many, rule, paint}}, "box", 8, 8);
    EXPECT_EQ(found.work.sampled_cells, 0u);
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      ASSERT_NEAR(found.values[i], expected.values[i], 1e-6);
    }
  }
}

TEST(StackRows, ThreadsDoNotMatter) {
  const std::vector<Shape> shapes = tangles(60, 9, 40.0, 0.5, 4);
  RasterOptions options;
  options.width = 40;
  options.height = 36;
  options.filter = "mitchell";
  options.run = prefilter::Run(1);
  const Image one = rasterize(shapes, options);
  options.run = prefilter::Run(5);
  const Image five = rasterize(shapes, options);
  for (int i = 0; i < 40 * 36 * 4; ++i) ASSERT_EQ(one.texel(0, 0)[i], five.texel(0, 0)[i]) << i;
}

TEST(LayerSet, FindsTheHighest) {
  LayerSet set(10000);
  EXPECT_EQ(set.highest_below(10000), LayerSet::kNone);
  for (const std::uint32_t layer : {0u, 63u, 64u, 4095u, 4096u, 9999u}) set.insert(layer);
  EXPECT_EQ(set.highest_below(10000), 9999u);
  EXPECT_EQ(set.highest_below(9999), 4096u);
  EXPECT_EQ(set.highest_below(4096), 4095u);
  set.erase(4095);
  EXPECT_EQ(set.highest_below(4096), 64u);
  EXPECT_EQ(set.highest_below(64), 63u);
  EXPECT_EQ(set.highest_below(63), 0u);
  EXPECT_EQ(set.highest_below(0), LayerSet::kNone);
}

}  // namespace
}  // namespace prefilter
