// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/outline/visible_pieces.h"

#include <gtest/gtest.h>

#include "prefilter/base/error.h"
#include "prefilter/shapes/set_operations.h"
#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

Outline blob(std::mt19937* random) {
  std::uniform_real_distribution<double> place(0.0, 100.0);
  Outline outline;
  outline.move_to({place(*random), place(*random)});
  for (int i = 0; i < 4; ++i) {
    outline.curve_to(std::vector<Point2>{{place(*random), place(*random)},
                                         {place(*random), place(*random)},
                                         {place(*random), place(*random)}});
  }
  outline.close();
  return outline;
}

// Visibility of each layer at a point: from the top down, and by adding pieces.
using Weights = std::vector<double>;

class Scene {
 public:
  void add(const Outline& outline, FillRule rule = FillRule::kNonzero, double opacity = 1.0) {
    outlines_.push_back(outline);
    rules_.push_back(rule);
    opacities_.push_back(opacity);
    all_.append(outline);
  }

  std::vector<CoveringLayer> layers() const {
    std::vector<CoveringLayer> layers;
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
      layers.push_back({&outlines_[i], rules_[i], opacities_[i] >= 1.0});
    }
    return layers;
  }

  Weights expected(const Point2& point) const {
    Weights weights(outlines_.size(), 0.0);
    double transmittance = 1.0;
    for (std::size_t i = outlines_.size(); i-- > 0;) {
      if (!filled(winding(chains_[i], point), rules_[i])) continue;
      weights[i] = transmittance;
      transmittance *= 1.0 - opacities_[i];
    }
    return weights;
  }

  void expect_pieces(double clearance = 1e-2) {
    for (const Outline& outline : outlines_) chains_.push_back(fine_chains(outline, 150));
    const std::vector<VisiblePiece> pieces =
        visible_pieces(layers(), ArrangementEffort::kUnbounded, prefilter::Run(2)).value();
    std::vector<std::vector<Chain>> piece_chains;
    for (const VisiblePiece& piece : pieces)
      piece_chains.push_back(fine_chains(piece.outline, 150));
    for (const Point2& point : random_points(all_, 200, clearance, 5)) {
      Weights found(outlines_.size(), 0.0);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        const int inside = winding(piece_chains[i], point);
        ASSERT_TRUE(inside == 0 || inside == 1) << inside;
        double transmittance = inside;
        for (const std::uint32_t overlay : pieces[i].overlays)
          transmittance *= 1.0 - opacities_[overlay];
        found[pieces[i].layer] += transmittance;
      }
      const Weights wanted = expected(point);
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        ASSERT_NEAR(found[i], wanted[i], 1e-12)
            << "layer " << i << " " << point.x << " " << point.y;
      }
    }
  }

 private:
  std::vector<Outline> outlines_;
  std::vector<FillRule> rules_;
  std::vector<double> opacities_;
  std::vector<std::vector<Chain>> chains_;
  Outline all_;
};

TEST(VisiblePieces, AddUpToTheVisibleLayers) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Scene scene;
    for (unsigned i = 0; i < 5; ++i) {
      scene.add(blob(&random), i % 2 == 0 ? FillRule::kNonzero : FillRule::kEvenOdd,
                seed % 2 == 0 ? 1.0 : 0.25 + 0.15 * i);
    }
    scene.expect_pieces();
  }
}

TEST(VisiblePieces, NestedAndEqualLayers) {
  Scene scene;
  scene.add(circle({0, 0}, 10.0));
  scene.add(circle({2, 0}, 3.0), FillRule::kNonzero, 0.5);
  scene.add(reversed(circle({2, 0}, 3.0)), FillRule::kNonzero, 0.5);
  scene.add(polygon({{-5, -5}, {0, -5}, {0, 0}, {-5, 0}}));
  scene.add(polygon({{0, -5}, {5, -5}, {5, 0}, {0, 0}}));  // beside the previous one
  scene.add(circle({2, 0}, 3.0), FillRule::kEvenOdd, 0.0);
  scene.add(Outline());
  scene.expect_pieces();
}

TEST(VisiblePieces, LeaveOutCoveredShapes) {
  const Outline small = circle({0, 0}, 1.0);
  const Outline large = circle({0.1, 0}, 2.0);
  const std::vector<CoveringLayer> layers = {{&small}, {&large}};
  const std::vector<VisiblePiece> pieces =
      visible_pieces(layers, ArrangementEffort::kUnbounded).value();
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(pieces[0].layer, 1u);
  EXPECT_TRUE(pieces[0].overlays.empty());
  ASSERT_EQ(pieces[0].outline.points().size(), large.points().size());
  EXPECT_TRUE(
      std::equal(large.points().begin(), large.points().end(), pieces[0].outline.points().begin()));
  EXPECT_TRUE(visible_pieces({}, ArrangementEffort::kUnbounded).value().empty());
}

// A contour that ends close to its start has a closing line as short as rounding, across an edge of
// another shape that ends there.
TEST(VisiblePieces, ClosingLinesAsShortAsRoundingMeetNothingFarAway) {
  for (const bool is_vertical : {true, false}) {
    for (const double above : {0.0, 0x1p-48, -0x1p-48}) {
      const auto at = [&](double x, double y) { return is_vertical ? Point2{x, y} : Point2{y, x}; };
      Outline body;
      body.move_to(at(48.0, 22.0));
      for (const Point2& point : {at(36.0, 22.0), at(36.0, 50.0), at(48.0, 50.0)}) {
        body.line_to(point);
      }
      body.close();
      Outline lid;
      lid.move_to(at(48.0, 22.0));
      for (const auto& points : {std::vector<Point2>{at(48.0, 25.0), at(36.0, 25.0)},
                                 std::vector<Point2>{at(24.0, 25.0), at(24.0, 22.0)},
                                 std::vector<Point2>{at(24.0, 18.0), at(36.0, 18.0)},
                                 std::vector<Point2>{at(48.0, 18.0), at(48.0, 22.0 + above)}}) {
        lid.curve_to(points);
      }
      lid.close();
      Scene scene;
      scene.add(body);
      scene.add(lid);
      scene.expect_pieces();
    }
  }
}

TEST(VisiblePieces, AreTheSameForAnyNumberOfThreads) {
  std::mt19937 random(9);
  std::vector<Outline> outlines;
  for (int i = 0; i < 20; ++i) outlines.push_back(blob(&random));
  std::vector<CoveringLayer> layers;
  for (const Outline& outline : outlines) layers.push_back({&outline});
  const auto one = visible_pieces(layers, ArrangementEffort::kUnbounded, prefilter::Run(1)).value();
  const auto four =
      visible_pieces(layers, ArrangementEffort::kUnbounded, prefilter::Run(4)).value();
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(std::equal(one[i].outline.points().begin(), one[i].outline.points().end(),
                           four[i].outline.points().begin(), four[i].outline.points().end()));
  }
  EXPECT_THROW(visible_pieces(layers, ArrangementEffort::kUnbounded,
                              prefilter::Run(2, [](double) { return false; })),
               Error);
}

TEST(SetOperations, AreasAddUp) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(100 + seed);
    const Outline a = blob(&random);
    const Outline b = blob(&random);
    constexpr FillRule kRule = FillRule::kNonzero;
    const auto area_of = [&](const Outline& first, const Outline& second,
                             OutlineOperation operation) {
      return area(combine(first, kRule, second, kRule, operation));
    };
    const double whole = area(resolve(a, kRule));
    const double both = area_of(a, b, OutlineOperation::kIntersection);
    EXPECT_NEAR(area_of(a, b, OutlineOperation::kDifference) + both, whole, 1e-6 * whole);
    EXPECT_NEAR(area_of(a, b, OutlineOperation::kUnion) + both, whole + area(resolve(b, kRule)),
                1e-6 * whole);
    EXPECT_NEAR(both, area_of(b, a, OutlineOperation::kIntersection), 1e-6 * whole);
    EXPECT_EQ(area_of(a, a, OutlineOperation::kDifference), 0.0);
    EXPECT_NEAR(area_of(a, a, OutlineOperation::kIntersection), whole, 1e-6 * whole);
  }
}

}  // namespace
}  // namespace prefilter
