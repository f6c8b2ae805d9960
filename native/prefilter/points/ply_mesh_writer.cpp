// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles wait in a temporary file, as PLY requires all vertices first. The header has room for
// the final counts, in a comment padded with blanks.
#include "prefilter/points/ply_mesh_writer.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/io/staged_file.h"
#include "prefilter/base/io/temporary_file.h"

namespace prefilter {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBufferSize = std::size_t{1} << 20;
constexpr std::size_t kMaxVertices = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kTriangleSize = 1 + 3 * sizeof(std::uint32_t);
// Digits of the largest count.
constexpr std::size_t kCountDigits = 20;

template <typename T>
std::byte* put(T value, std::byte* to) {
  std::memcpy(to, &value, sizeof value);
  return to + sizeof value;
}

// Turns attribute names into valid and distinct PLY property names.
std::vector<PointAttribute> as_properties(std::vector<PointAttribute> attributes) {
  std::set<std::string> taken = {"x", "y", "z"};
  for (PointAttribute& each : attributes) {
    for (char& c : each.name) {
      if (c <= ' ' || c > '~') c = '_';
    }
    while (each.name.empty() || !taken.insert(each.name).second) each.name += '_';
  }
  return attributes;
}

std::uint8_t to_byte(float value) {
  return value >= 0.0F ? static_cast<std::uint8_t>(std::lround(std::min(value, 255.0F))) : 0;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

}  // namespace

/// The staged target file and the temporary file of triangles.
class PlyMeshWriter::Files {
 public:
  Files(const std::string& path, std::vector<PointAttribute> attributes, bool is_double);

  void add_vertices(std::span<const Vector3> positions, std::span<const float> attributes);
  void add_triangles(std::span<const std::array<std::int64_t, 3>> triangles);
  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t triangle_count() const { return triangle_count_; }
  void finish(const Run& run);

 private:
  std::string header(std::size_t size) const;
  void write_vertices();
  void write_triangles();

  StagedFile staged_;
  TemporaryFile triangles_;
  std::vector<PointAttribute> attributes_;
  bool is_double_;
  std::size_t vertex_count_ = 0;
  std::size_t triangle_count_ = 0;
  std::size_t header_size_;     // initialized from the members above
  std::uint64_t vertices_end_;  // position in the file
  // Not written yet.
  std::vector<std::byte> vertex_buffer_;
  std::vector<std::byte> triangle_buffer_;
};

PlyMeshWriter::Files::Files(const std::string& path, std::vector<PointAttribute> attributes,
                            bool is_double)
    : staged_(path),
      triangles_(staged_.folder()),
      attributes_(as_properties(std::move(attributes))),
      is_double_(is_double),
      header_size_(header(0).size() + 2 * kCountDigits),
      vertices_end_(header_size_) {}

// The header, padded to `size` bytes by blanks at the end of its comment if it is shorter.
std::string PlyMeshWriter::Files::header(std::size_t size) const {
  const char* const type = is_double_ ? "double" : "float";
  std::string rest = "element vertex " + std::to_string(vertex_count_) + "\n";
  for (const char* axis : {"x", "y", "z"}) {
    rest += std::string("property ") + type + " " + axis + "\n";
  }
  for (const PointAttribute& each : attributes_) {
    rest += std::string("property ") + (each.is_byte ? "uchar " : "float ") + each.name + "\n";
  }
  const bool is_signed = vertex_count_ <= std::numeric_limits<std::int32_t>::max();
  rest += "element face " + std::to_string(triangle_count_) + "\nproperty list uchar " +
          (is_signed ? "int" : "uint") + " vertex_indices\nend_header\n";
  const std::string start = "ply\nformat binary_little_endian 1.0\ncomment Prefilter";
  const std::size_t least = start.size() + 1 + rest.size();
  return start + std::string(size > least ? size - least : 0, ' ') + "\n" + rest;
}

void PlyMeshWriter::Files::add_vertices(std::span<const Vector3> positions,
                                        std::span<const float> attributes) {
  const std::size_t count = positions.size();
  const std::size_t width = attributes_.size();
  assert(attributes.size() == count * width);
  if (count > kMaxVertices - vertex_count_) {
    throw_invalid(staged_.file().name() +
                  ": a mesh of more than 4294967295 vertices; PLY files cannot "
                  "number more");
  }
  std::size_t size = 3 * (is_double_ ? sizeof(double) : sizeof(float));
  for (const PointAttribute& each : attributes_) size += each.is_byte ? 1 : sizeof(float);
  const std::size_t before = vertex_buffer_.size();
  vertex_buffer_.resize(before + count * size);
  std::byte* to = vertex_buffer_.data() + before;
  for (std::size_t i = 0; i < count; ++i) {
    for (const double coordinate : positions[i]) {
      to = is_double_ ? put(coordinate, to) : put(static_cast<float>(coordinate), to);
    }
    for (std::size_t a = 0; a < width; ++a) {
      const float value = attributes[i * width + a];
      to = attributes_[a].is_byte ? put(to_byte(value), to) : put(value, to);
    }
  }
  vertex_count_ += count;
  if (vertex_buffer_.size() >= kBufferSize) write_vertices();
}

void PlyMeshWriter::Files::add_triangles(std::span<const std::array<std::int64_t, 3>> triangles) {
  const std::size_t before = triangle_buffer_.size();
  triangle_buffer_.resize(before + triangles.size() * kTriangleSize);
  std::byte* to = triangle_buffer_.data() + before;
  for (const auto& triangle : triangles) {
    to = put(std::uint8_t{3}, to);
    for (const std::int64_t vertex : triangle) {
      assert(vertex >= 0 && static_cast<std::size_t>(vertex) < vertex_count_);
      to = put(static_cast<std::uint32_t>(vertex), to);
    }
  }
  triangle_count_ += triangles.size();
  if (triangle_buffer_.size() >= kBufferSize) write_triangles();
}

void PlyMeshWriter::Files::write_vertices() {
  staged_.file().write_at(vertices_end_, vertex_buffer_);
  vertices_end_ += vertex_buffer_.size();
  vertex_buffer_.clear();
}

void PlyMeshWriter::Files::write_triangles() {
  triangles_.write(triangle_buffer_);
  triangle_buffer_.clear();
}

void PlyMeshWriter::Files::finish(const Run& run) {
  write_vertices();
  write_triangles();
  std::vector<std::byte> block(kBufferSize);
  for (std::uint64_t done = 0; done < triangles_.size();) {
    run.report(static_cast<double>(done) / static_cast<double>(triangles_.size()));
    const std::uint64_t left = triangles_.size() - done;
    const auto some = std::span(block).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(left, kBufferSize)));
    triangles_.read_at(done, some);
    staged_.file().write_at(vertices_end_ + done, some);
    done += some.size();
  }
  staged_.file().write_at(0, bytes_of(header(header_size_)));
  run.report(1.0);
  staged_.commit();
}

PlyMeshWriter::PlyMeshWriter(const std::string& path, std::vector<PointAttribute> attributes,
                             bool is_double)
    : files_(std::make_unique<Files>(path, std::move(attributes), is_double)) {}

PlyMeshWriter::~PlyMeshWriter() = default;

void PlyMeshWriter::add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) {
  files_->add_vertices(positions, attributes);
}

void PlyMeshWriter::add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) {
  files_->add_triangles(triangles);
}

std::size_t PlyMeshWriter::vertex_count() const { return files_->vertex_count(); }
std::size_t PlyMeshWriter::triangle_count() const { return files_->triangle_count(); }

void PlyMeshWriter::finish(const Run& run) { files_->finish(run); }

}  // namespace prefilter
