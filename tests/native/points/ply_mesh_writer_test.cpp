// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/ply_mesh_writer.h"

#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/stat.h>
#include <sys/wait.h>
#endif

#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "base/io/files.h"
#include "prefilter/base/error.h"
#include "prefilter/points/open_points.h"

namespace prefilter {
namespace {

using Triangles = std::vector<std::array<std::int64_t, 3>>;

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream all;
  all << file.rdbuf();
  return all.str();
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

template <typename T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The header without its comment, and the data.
std::pair<std::string, std::string> header_and_body(const std::string& path) {
  const std::string all = contents(path);
  const std::size_t end = all.find("end_header\n") + 11;
  std::istringstream lines(all.substr(0, end));
  std::string header;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("comment")) header += line + "\n";
  }
  return {header, all.substr(end)};
}

TEST(PlyMeshWriter, RoundTripsAMesh) {
  const TestFolder folder;
  const std::string path = folder.path("mesh.ply");
  {
    PlyMeshWriter writer(path, {{"red", true}, {"dB (far)", false}, {"x", true}}, false);
    writer.add_vertices({{1, 2, 3}, {4, 5, 0.1}}, {10.4F, 0.5F, -1, 10.5F, 1e10F, 1});
    writer.add_triangles({});
    writer.add_vertices({{-1, 0, 7}}, {300, -2, NAN});
    writer.add_triangles({{0, 1, 2}});
    writer.add_triangles({{2, 1, 0}});
    EXPECT_EQ(folder.file_count(), folder.names_while_written());
    writer.finish(prefilter::Run());
    EXPECT_EQ(writer.vertex_count(), 3U);
    EXPECT_EQ(writer.triangle_count(), 2U);
  }
  EXPECT_EQ(folder.file_count(), 1U);
  const auto [header, body] = header_and_body(path);
  EXPECT_EQ(header,
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
            "property float y\nproperty float z\nproperty uchar red\nproperty float dB_(far)\n"
            "property uchar x_\nelement face 2\nproperty list uchar int vertex_indices\n"
            "end_header\n");
  ASSERT_EQ(body.size(), 3U * 18 + 2U * 13);
  EXPECT_EQ(value_at<float>(body, 18 + 8), 0.1F);
  EXPECT_EQ(value_at<float>(body, 36), -1.0F);
  EXPECT_EQ(value_at<std::uint8_t>(body, 12), 10);
  EXPECT_EQ(value_at<std::uint8_t>(body, 18 + 12), 11);
  EXPECT_EQ(value_at<std::uint8_t>(body, 36 + 12), 255);
  EXPECT_EQ(value_at<float>(body, 18 + 13), 1e10F);
  EXPECT_EQ(value_at<std::uint8_t>(body, 17), 0);
  EXPECT_EQ(value_at<std::uint8_t>(body, 36 + 17), 0);
  EXPECT_EQ(value_at<std::uint8_t>(body, 54), 3);
  EXPECT_EQ(value_at<std::int32_t>(body, 54 + 1 + 8), 2);
  EXPECT_EQ(value_at<std::int32_t>(body, 54 + 13 + 1), 2);
}

TEST(PlyMeshWriter, WritesAnEmptyMesh) {
  const TestFolder folder;
  PlyMeshWriter writer(folder.path("mesh.ply"), {}, true);
  writer.finish(prefilter::Run());
  const auto [header, body] = header_and_body(folder.path("mesh.ply"));
  EXPECT_TRUE(header.find("element vertex 0\nproperty double x\n") != std::string::npos);
  EXPECT_EQ(body, "");
}

// The header has room for two counts of 20 digits, whatever its memory held before.
TEST(PlyMeshWriter, HeadersHaveTheRoomForCounts) {
  const TestFolder folder;
  const std::string path = folder.path("mesh.ply");
  for (const char filling : {'\0', '\x7f'}) {
    std::vector<std::string> held;
    for (std::size_t size = 16; size < 4096; size += 16) held.emplace_back(size, filling);
    held.clear();
    PlyMeshWriter writer(path, {}, false);
    writer.add_vertices({{1, 2, 3}}, {});
    writer.finish(prefilter::Run());
    const std::string header = header_and_body(path).first;
    const std::size_t comment = std::strlen("comment Prefilter\n");
    EXPECT_EQ(contents(path).size(), header.size() + comment + 2 * 20 + 3 * sizeof(float));
  }
}

// More than the buffers hold, in pieces of any size.
void add_grid(std::size_t vertices, std::size_t triangles, PlyMeshWriter* writer) {
  std::size_t piece = 1;
  for (std::size_t done = 0; done < vertices; done += piece, piece = (7 * piece + 1) % 9973) {
    piece = std::min(piece, vertices - done);
    std::vector<Vector3> positions;
    std::vector<float> attributes;
    for (std::size_t i = done; i < done + piece; ++i) {
      positions.push_back({static_cast<double>(i), 1.0 / static_cast<double>(i + 1), 0.0});
      attributes.push_back(static_cast<float>(i % 256));
    }
    writer->add_vertices(positions, attributes);
  }
  for (std::size_t done = 0; done < triangles; done += piece, piece = (7 * piece + 1) % 9973) {
    piece = std::min(piece, triangles - done);
    Triangles some;
    for (std::size_t i = done; i < done + piece; ++i) {
      const auto a = static_cast<std::int64_t>(i % (vertices - 2));
      some.push_back({a, a + 1, a + 2});
    }
    writer->add_triangles(some);
  }
}

TEST(PlyMeshWriter, WritesInPieces) {
  constexpr std::size_t kVertices = 200000;
  constexpr std::size_t kTriangles = 190000;
  const TestFolder folder;
  const std::string path = folder.path("mesh.ply");
  PlyMeshWriter writer(path, {{"gray", true}}, true);
  add_grid(kVertices, kTriangles, &writer);
  EXPECT_EQ(folder.file_count(), folder.names_while_written());
  writer.finish(prefilter::Run());
  const std::string body = header_and_body(path).second;
  ASSERT_EQ(body.size(), kVertices * 25 + kTriangles * 13);
  for (std::size_t i = 0; i < kVertices; ++i) {
    ASSERT_EQ(value_at<double>(body, 25 * i), static_cast<double>(i));
    ASSERT_EQ(value_at<double>(body, 25 * i + 8), 1.0 / static_cast<double>(i + 1));
    ASSERT_EQ(value_at<std::uint8_t>(body, 25 * i + 24), i % 256);
  }
  for (std::size_t i = 0; i < kTriangles; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(value_at<std::uint32_t>(body, kVertices * 25 + 13 * i + 1 + 4 * k), i + k);
    }
  }
  // The vertices of a mesh can be read as points.
  const std::unique_ptr<PointSource> points = open_points(path);
  PointBatch batch;
  ASSERT_TRUE(points->read(kVertices + 1, &batch));
  EXPECT_EQ(batch.positions.size(), kVertices);
  EXPECT_FALSE(points->read(1, &batch));
  EXPECT_TRUE(points->is_double());
}

TEST(PlyMeshWriter, LeavesTheTargetUntilFinished) {
  const TestFolder folder;
  const std::string path = folder.path("mesh.ply");
  write_text(path, "before");
  {
    PlyMeshWriter writer(path, {{"gray", true}}, false);
    add_grid(100000, 100000, &writer);
    const prefilter::Run stop([](double) { return false; });
    EXPECT_THROW(writer.finish(stop), Error);
  }
  EXPECT_EQ(contents(path), "before");
  EXPECT_EQ(folder.file_count(), 1U);
}

#ifndef _WIN32
TEST(PlyMeshWriter, ReplacesTheTargetOfALinkAndKeepsItsMode) {
  const TestFolder folder;
  write_text(folder.path("real.ply"), "before");
  ::chmod(folder.path("real.ply").c_str(), 0640);
  std::filesystem::create_symlink("real.ply", folder.path("link.ply"));
  PlyMeshWriter writer(folder.path("link.ply"), {}, false);
  writer.finish(prefilter::Run());
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.ply")));
  EXPECT_EQ(contents(folder.path("real.ply")).substr(0, 4), "ply\n");
  struct stat status {};
  ::stat(folder.path("real.ply").c_str(), &status);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
  EXPECT_EQ(folder.file_count(), 2U);
}
#endif

TEST(PlyMeshWriter, RefusesInvalidTargets) {
  const TestFolder folder;
  const auto message = [](const std::string& path) {
    try {
      PlyMeshWriter writer(path, {}, false);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kFile);
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string none = folder.path("none/mesh.ply");
  EXPECT_EQ(message(none), "'" + none + "': cannot be created: No such file or directory");
  EXPECT_EQ(message(folder.path()),
            "'" + folder.path() + "' is a folder; a regular file, or a new one, is needed");
#ifndef _WIN32
  EXPECT_EQ(message("/dev/null"),
            "'/dev/null' is a device or pipe; a regular file, or a new one, is needed");
#endif
}

#ifndef _WIN32
TEST(PlyMeshWriter, ReportsAFullDiskAndLeavesNothing) {
  const TestFolder folder;
  const std::string path = folder.path("mesh.ply");
  write_text(path, "before");
  // Full while vertices are written, while triangles are, and while both are joined.
  for (const rlim_t limit : {2000000, 3500000, 5000000}) {
    const FileSizeLimit full(limit);
    try {
      PlyMeshWriter writer(path, {{"gray", true}}, false);
      add_grid(limit < 3000000 ? 200000 : 100000, 300000, &writer);
      writer.finish(prefilter::Run());
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kFile);
      const std::string name =
          limit == 3500000 ? "temporary file in '" + folder.path() + "'" : "'" + path + "'";
      const std::string wanted = name + ": cannot write ";
      EXPECT_EQ(std::string(error.what()).substr(0, wanted.size()), wanted);
      const std::string where = " bytes at byte " + std::to_string(limit) + ": File too large";
      EXPECT_TRUE(std::string(error.what()).ends_with(where)) << error.what();
    }
  }
  EXPECT_EQ(contents(path), "before");
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(PlyMeshWriter, LeavesNothingWhenItIsKilled) {
  const TestFolder folder;
  if (!folder.has_unnamed_files()) GTEST_SKIP() << "files need names in " << folder.path();
  const pid_t child = fork();
  if (child == 0) {
    PlyMeshWriter writer(folder.path("mesh.ply"), {{"gray", true}}, false);
    add_grid(100000, 100000, &writer);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_EQ(folder.file_count(), 0U);
}
#endif

}  // namespace
}  // namespace prefilter
