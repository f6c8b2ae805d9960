// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/joined_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/images/transfer.h"
#include "prefilter/points/array_source.h"

namespace prefilter {
namespace {

// `count` points on the x axis, starting at `first`; attribute k of a point at x is 10 x + k.
class Scan {
 public:
  Scan(double first, std::size_t count, std::vector<PointAttribute> names, bool is_double = false)
      : names_(std::move(names)), is_double_(is_double) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = first + static_cast<double>(i);
      points_.push_back({x, 0.0, 0.0});
      normals_.push_back({0.0, 0.0, 1.0});
      for (std::size_t k = 0; k < names_.size(); ++k) {
        attributes_.push_back(static_cast<float>(10.0 * x) + static_cast<float>(k));
      }
    }
  }
  ArraySource source() const { return {points_, normals_, {}, attributes_, names_, is_double_}; }

 private:
  std::vector<Vector3> points_;
  std::vector<Vector3> normals_;
  std::vector<float> attributes_;
  std::vector<PointAttribute> names_;
  bool is_double_;
};

struct Read {
  std::vector<double> x;
  std::vector<float> attributes;
};

Read all_of(PointSource* source, std::size_t most) {
  Read read;
  PointBatch batch;
  source->rewind();
  while (source->read(most, &batch)) {
    EXPECT_LE(batch.positions.size(), most);
    EXPECT_EQ(batch.normals.size(), batch.positions.size());
    for (const Vector3& p : batch.positions) read.x.push_back(p[0]);
    read.attributes.insert(read.attributes.end(), batch.attributes.begin(), batch.attributes.end());
  }
  return read;
}

TEST(JoinedPoints, HaveAllSourcesInOrder) {
  const Scan first(0.0, 5, {});
  const Scan none(5.0, 0, {});
  const Scan last(5.0, 3, {}, true);
  ArraySource sources[] = {first.source(), none.source(), last.source()};
  JoinedPoints joined({&sources[0], &sources[1], &sources[2]});
  EXPECT_EQ(joined.count(), 8U);
  EXPECT_TRUE(joined.is_double());
  EXPECT_FALSE(JoinedPoints({&sources[0], &sources[1]}).is_double());
  const std::vector<double> expected = {0, 1, 2, 3, 4, 5, 6, 7};
  for (const std::size_t most : {1U, 2U, 100U}) EXPECT_EQ(all_of(&joined, most).x, expected);
}

TEST(JoinedPoints, CanBeReadInShares) {
  const Scan first(0.0, 5, {{"k", false}});
  const Scan none(5.0, 0, {{"k", false}});
  const Scan last(5.0, 4, {{"k", false}});
  ArraySource sources[] = {first.source(), none.source(), last.source()};
  JoinedPoints joined({&sources[0], &sources[1], &sources[2]}, 2);
  const std::vector<std::vector<double>> shares = {{0, 1}, {2, 3}, {4}, {}, {5, 6}, {7, 8}};
  ASSERT_EQ(joined.share_count(), shares.size());
  EXPECT_EQ(joined.count(), 9U);
  for (const std::size_t most : {1U, 2U, 100U}) {
    EXPECT_EQ(all_of(&joined, most).x, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  }
  PointBatch batch;
  std::vector<std::size_t> clouds;
  joined.rewind();
  while (joined.read(100, &batch)) clouds.push_back(batch.cloud);
  EXPECT_EQ(clouds, (std::vector<std::size_t>{0, 1, 2, 4, 5}));
  // In any order, and repeatedly.
  for (const std::size_t share : {5U, 0U, 3U, 2U, 1U, 4U, 4U}) {
    joined.choose_share(share);
    EXPECT_EQ(joined.count(), shares[share].size());
    const Read read = all_of(&joined, 1);
    EXPECT_EQ(read.x, shares[share]);
    for (std::size_t i = 0; i < read.x.size(); ++i) {
      EXPECT_EQ(read.attributes[i], static_cast<float>(10.0 * read.x[i]));
    }
    EXPECT_EQ(all_of(&joined, 100).x, shares[share]);
  }
  EXPECT_EQ(JoinedPoints({&sources[0]}, 5).share_count(), 1U);
}

TEST(JoinedPoints, HaveAttributesByName) {
  const Scan one(0.0, 2, {{"intensity", false}, {"age", false}});
  const Scan two(2.0, 1, {{"age", false}, {"red", true}, {"Paint.alpha", false}});
  ArraySource sources[] = {one.source(), two.source()};
  JoinedPoints joined({&sources[0], &sources[1]});
  std::vector<std::string> names;
  for (const PointAttribute& each : joined.attributes()) names.push_back(each.name);
  EXPECT_EQ(names, (std::vector<std::string>{"intensity", "age", "red", "Paint.alpha"}));
  // Missing attributes are 0, or white.
  EXPECT_EQ(all_of(&joined, 10).attributes,
            (std::vector<float>{0, 1, 255, 1, 10, 11, 255, 1, 0, 20, 21, 22}));
}

TEST(JoinedPoints, TakeTheRepresentationOfTheFirstSource) {
  const Scan bytes(1.0, 1, {{"red", true}, {"alpha", true}, {"class", true}});
  const Scan floats(0.02, 1, {{"red", false}, {"alpha", false}, {"class", false}});
  ArraySource a = bytes.source();
  ArraySource b = floats.source();
  JoinedPoints joined({&a, &b});
  const std::vector<float> as_bytes = all_of(&joined, 10).attributes;
  EXPECT_FLOAT_EQ(as_bytes[3], 255.0F * linear_to_srgb(0.2F));
  EXPECT_FLOAT_EQ(as_bytes[4], 255.0F * 1.2F);
  EXPECT_FLOAT_EQ(as_bytes[5], 2.2F);
  JoinedPoints other({&b, &a});
  const std::vector<float> as_floats = all_of(&other, 10).attributes;
  EXPECT_FLOAT_EQ(as_floats[3], srgb_to_linear(10.0F / 255.0F));
  EXPECT_FLOAT_EQ(as_floats[4], 11.0F / 255.0F);
  EXPECT_FLOAT_EQ(as_floats[5], 12.0F);
  EXPECT_FALSE(other.attributes()[0].is_byte);
}

// Scanned points without normals.
class Seen final : public PointSource {
 public:
  explicit Seen(std::optional<Vector3> viewpoint) : viewpoint_(viewpoint) {}
  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool has_normals() const override { return false; }
  const std::vector<PointAttribute>& attributes() const override { return none_; }
  std::optional<Vector3> viewpoint() const override { return viewpoint_; }
  void rewind() override { is_done_ = false; }
  bool read(std::size_t /*most*/, PointBatch* batch) override {
    batch->clear();
    if (is_done_) return false;
    batch->positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    is_done_ = true;
    return true;
  }

 private:
  std::optional<Vector3> viewpoint_;
  std::vector<PointAttribute> none_;
  bool is_done_ = false;
};

TEST(JoinedPoints, HaveTheViewpointOfEachSource) {
  Seen near({{0.0, 0.0, 1.0}});
  Seen far({{0.0, 0.0, 9.0}});
  JoinedPoints joined({&near, &far});
  EXPECT_EQ(joined.count(), std::nullopt);
  PointBatch batch;
  joined.rewind();
  for (const double z : {1.0, 9.0}) {
    ASSERT_TRUE(joined.read(10, &batch));
    EXPECT_EQ(batch.viewpoints, std::vector<Vector3>(2, {0.0, 0.0, z}));
  }
  EXPECT_FALSE(joined.read(10, &batch));
}

TEST(JoinedPoints, NeedSourcesThatAllHaveNormalsOrNone) {
  EXPECT_THROW(JoinedPoints({}), Error);
  const Scan scan(0.0, 2, {});
  ArraySource with = scan.source();
  Seen without({});
  EXPECT_THROW(JoinedPoints({&with, &without}), Error);
}

}  // namespace
}  // namespace prefilter
