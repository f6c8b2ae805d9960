// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>

#include "base/io/files.h"
#include "prefilter/base/error.h"
#include "prefilter/points/chosen_points.h"
#include "prefilter/points/moved_points.h"
#include "prefilter/points/open_points.h"
#include "prefilter/points/ply_faces.h"

namespace prefilter {
namespace {

template <typename T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\nobj_info num_cols 2\nobj_info num_rows 1\nelement camera 1\n"
         "property list uchar short some\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty list char uchar tags\nelement range_grid 2\n"
         "property list uchar int vertex_indices\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply() {
  const std::string point =
      bytes_of<float>({1, 2, 3, 0, 0, 1}) + bytes_of<std::uint8_t>({200, 2, 7, 8});
  return ply_header("binary_little_endian") + bytes_of<std::uint8_t>({2, 0, 1, 0, 2}) + point +
         point + '\1' + bytes_of<int>({1}) + '\0' + '\3' + bytes_of<int>({0, 1, 0});
}

std::string pcd(const std::string& data, const std::string& points) {
  return "VERSION 0.7\nFIELDS x y z rgb _ normal_x normal_y normal_z\nSIZE 4 4 4 4 1 4 4 4\n"
         "TYPE F F F F U F F F\nCOUNT 1 1 1 1 3 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\n"
         "POINTS 2\nDATA " +
         data + "\n" + points;
}

std::string splats() {
  std::string header = "ply\nformat ascii 1.0\nelement vertex 2\n";
  for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1",
                           "rot_2", "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2"}) {
    header += std::string("property float ") + name + "\n";
  }
  return header + "end_header\n1 2 3 -4 -5 -6 1 0 0 0 2 0 0 0\n4 5 6 -6 -5 -4 0 0 0 0 nan 9 -9 1\n";
}

struct ExampleFile {
  std::string name;
  std::string contents;
};

std::vector<ExampleFile> examples() {
  std::string record = bytes_of<float>({1, 2, 3, 5});
  record.append("abc").append(bytes_of<float>({0, 0, 1}));
  // 62 bytes: zeros after the first, as one literal and one copy.
  const std::string packed =
      bytes_of<std::uint32_t>({5, 62}) + bytes_of<std::uint8_t>({0, 0, 7 << 5, 52, 0});
  return {
      {"text.ply", ply_header("ascii") + "2 1 2\n1 2 3 0 0 1 200 2 7 8\n1 2 3 0 0 1 200 0\n1 1\n0\n"
                                         "3 0 1 0\n"},
      {"binary.ply", binary_ply()},
      {"text.pcd", pcd("ascii", "1 2 3 4.2e-39 0 0 0 0 0 1\n1 2 3 nan 0 0 0 0 0 1\n")},
      {"binary.pcd", pcd("binary", record + record)},
      {"packed.pcd", pcd("binary_compressed", packed)},
      {"counted.pts", "2\n1 2 3 -100 0 10 255\n4 5 6 7 8 9 10\n"},
      {"plain.xyz", "# x y z nx ny nz\n1,2,3,0,0,1\n1\t2 3;0 -1 0\n"},
      {"vertices.obj", "v 1 2 3 0.5 0 1\nv 4 5 6 0 0 0\nvn 0 0 1\nvn 0 1 0\nf 1 2 1\n"},
      {"splats.ply", splats()},
  };
}

std::size_t read_all(const std::string& path) {
  const std::unique_ptr<PointSource> source = open_points(path);
  PointBatch batch;
  std::size_t points = 0;
  for (const std::size_t most : {std::size_t{1}, std::size_t{1000}}) {
    source->rewind();
    points = 0;
    while (source->read(most, &batch)) {
      points += batch.positions.size();
      EXPECT_TRUE(batch.normals.size() == (source->has_normals() ? batch.positions.size() : 0));
      EXPECT_EQ(batch.attributes.size(), batch.positions.size() * source->attributes().size());
    }
  }
  return points;
}

void write(const std::string& path, const std::string& contents) {
  std::ofstream(path, std::ios::binary) << contents;
}

TEST(OpenPoints, ReadsAllFormats) {
  const TestFolder folder;
  for (const ExampleFile& example : examples()) {
    write(folder.path(example.name), example.contents);
    EXPECT_EQ(read_all(folder.path(example.name)), 2U) << example.name;
  }
  const std::optional<RangeGrid> grid =
      read_range_grid(folder.path("binary.ply"), prefilter::Run());
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(grid->points, (std::vector<std::int64_t>{1, -1}));
  // Its only face repeats a corner, so it has no triangle.
  EXPECT_TRUE(read_faces(folder.path("binary.ply"), prefilter::Run()).empty());
  EXPECT_EQ(open_points(folder.path("binary.pcd"))->viewpoint(), (Vector3{1, 2, 3}));
}

// Damaged files are read or refused; the sanitizers find more.
TEST(OpenPoints, ReadsOrRefusesDamagedFiles) {
  const TestFolder folder;
  std::mt19937 random(1);
  for (const ExampleFile& example : examples()) {
    const std::string path = folder.path(example.name);
    std::size_t refused = 0;
    constexpr std::size_t kTries = 100;
    for (std::size_t k = 0; k < kTries; ++k) {
      std::string damaged = example.contents;
      for (std::size_t changes = random() % 3 + 1; changes > 0 && !damaged.empty(); --changes) {
        const std::size_t at = random() % damaged.size();
        const std::size_t kind = random() % 4;
        if (kind == 0) damaged.resize(at);
        if (kind == 1) damaged[at] = static_cast<char>(random());
        if (kind == 2) damaged.erase(at, random() % 5);
        if (kind == 3) damaged.insert(at, 1, "09-e. \n\377"[random() % 8]);
      }
      write(path, damaged);
      try {
        read_all(path);
        if (path.ends_with(".ply")) {
          read_range_grid(path, prefilter::Run());
          read_faces(path, prefilter::Run());
        }
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
        EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(refused, kTries / 10) << example.name;
  }
}

TEST(OpenPoints, SplatsAreFlatAlongTheirShortestAxis) {
  const TestFolder folder;
  write(folder.path("splats.ply"), splats());
  const std::unique_ptr<PointSource> source = open_points(folder.path("splats.ply"));
  PointBatch batch;
  ASSERT_TRUE(source->read(10, &batch));
  EXPECT_FALSE(source->are_normals_directed());
  EXPECT_EQ(batch.normals[0], (std::array<float, 3>{0.0F, 0.0F, 1.0F}));
  EXPECT_EQ(batch.normals[1], (std::array<float, 3>{0.0F, 0.0F, 0.0F}));
  EXPECT_EQ(batch.weights[1], 0.0F);
  EXPECT_EQ(batch.attributes, (std::vector<float>{128, 128, 128, 255, 0, 199}));
}

TEST(OpenPoints, PointsAreChosenAndMoved) {
  const TestFolder folder;
  write(folder.path("a.csv"),
        "x,y,z,classification,return_number,number_of_returns\n1,2,3,2,1,1\n4,5,6,2,1,2\n"
        "7,8,9,3,0,0\n");
  const std::unique_ptr<PointSource> source = open_points(folder.path("a.csv"));
  PointChoice choice;
  choice.classes.emplace().set(2);
  choice.returns = Returns::kLast;
  choice.box = Box{{0, 0, 0}, {4, 5, 6}};
  ChosenPoints chosen(source.get(), choice, "a");
  RigidMotion motion;
  motion.shift = {10, 0, 0};
  MovedPoints moved(&chosen, motion);
  PointBatch batch;
  ASSERT_TRUE(moved.read(10, &batch));
  EXPECT_EQ(batch.positions, (std::vector<Vector3>{{11, 2, 3}}));
  EXPECT_EQ(batch.attributes.size(), 3U);
  EXPECT_FALSE(moved.read(10, &batch));
}

}  // namespace
}  // namespace prefilter
