// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace prefilter {
namespace {

// Maximum miter length, in thicknesses.
constexpr double kMaxMiterRatio = 2.0;
// Minimum thickness of a prism at its corners, as a share of the full thickness.
constexpr double kMinThicknessShare = 0.5;

Vector3 area_vector(const std::array<Vector3, 3>& p) {
  return 0.5 * cross(p[1] - p[0], p[2] - p[0]);
}

// A vertex of the sheet and its two offset copies.
struct SheetVertex {
  std::size_t vertex = 0;
  Vector3 normal{};        // sum of area vectors, flipped to the same side of the sheet
  double area = 0.0;       // sum of areas
  double along = 0.0;      // sum of area components along the normal
  Vector3 offset{};        // from the vertex to the first copy; the second is opposite
  std::int32_t first = 0;  // index of the first copy; the second follows
};

class Shell {
 public:
  Shell(const MeshView<std::int32_t>& mesh, std::span<const std::int64_t> origins, double half,
        WorkMesh* target)
      : mesh_(mesh), origins_(origins), half_(half), target_(target) {}

  void add(std::span<const std::uint32_t> triangles) {
    for (const std::uint32_t t : triangles) collect(t);
    for (const std::uint32_t t : triangles) measure(t);
    for (SheetVertex& vertex : vertices_) place(&vertex);
    for (const std::uint32_t t : triangles) add_prism(t);
    add_walls();
  }

 private:
  // A triangle on the side of a prism, which the adjacent prism may cancel.
  struct Wall {
    std::array<std::int32_t, 3> sorted;
    std::array<std::int32_t, 3> corners;
    bool is_even;
    std::int64_t origin;

    bool operator<(const Wall& other) const {
      return sorted != other.sorted ? sorted < other.sorted : is_even < other.is_even;
    }
  };

  SheetVertex& vertex_of(std::int32_t vertex) {
    const auto [it, is_new] =
        numbers_.try_emplace(vertex, static_cast<std::uint32_t>(vertices_.size()));
    if (is_new) {
      vertices_.emplace_back();
      vertices_.back().vertex = static_cast<std::size_t>(vertex);
    }
    return vertices_[it->second];
  }

  void collect(std::uint32_t t) {
    const Vector3 area = area_vector(mesh_.corners(t));
    for (const std::int32_t corner : mesh_.triangles[t]) {
      SheetVertex& vertex = vertex_of(corner);
      vertex.normal = dot(vertex.normal, area) < 0.0 ? vertex.normal - area : vertex.normal + area;
      vertex.area += length(area);
    }
  }

  void measure(std::uint32_t t) {
    const Vector3 area = area_vector(mesh_.corners(t));
    for (const std::int32_t corner : mesh_.triangles[t]) {
      SheetVertex& vertex = vertex_of(corner);
      const double size = length(vertex.normal);
      if (size > 0.0) vertex.along += std::abs(dot(vertex.normal, area)) / size;
    }
  }

  void place(SheetVertex* vertex) {
    const double size = length(vertex->normal);
    if (size > 0.0) {
      const double miter = std::min(vertex->area / vertex->along, kMaxMiterRatio);
      vertex->offset = (half_ * miter / size) * vertex->normal;
    }
    const Vector3& middle = mesh_.positions[vertex->vertex];
    vertex->first = add_position(middle + vertex->offset);
    add_position(middle - vertex->offset);
  }

  std::int32_t add_position(const Vector3& position) {
    target_->positions.push_back(position);
    return static_cast<std::int32_t>(target_->positions.size() - 1);
  }

  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c, std::int64_t origin) {
    target_->triangles.push_back({a, b, c});
    target_->origins.push_back(origin);
  }

  void add_wall(std::int32_t a, std::int32_t b, std::int32_t c, std::int64_t origin) {
    Wall wall{{a, b, c}, {a, b, c}, (a < b) + (b < c) + (c < a) == 2, origin};
    std::sort(wall.sorted.begin(), wall.sorted.end());
    walls_.push_back(wall);
  }

  // Adds the four corners of a side in order; `from` and `to` are the same sheet vertices from
  // either prism, and so is the diagonal.
  void add_side(std::int32_t from, std::int32_t to, std::int32_t to_top, std::int32_t from_top,
                bool is_first, std::int64_t origin) {
    if (is_first) {
      add_wall(from, to, to_top, origin);
      add_wall(from, to_top, from_top, origin);
    } else {
      add_wall(from, to, from_top, origin);
      add_wall(to, to_top, from_top, origin);
    }
  }

  void add_prism(std::uint32_t t) {
    const std::array<Vector3, 3> corners = mesh_.corners(t);
    const Vector3 area = area_vector(corners);
    const double size = length(area);
    if (!(size > 0.0)) return;
    const Vector3 normal = (1.0 / size) * area;
    std::array<std::int32_t, 3> top{};
    std::array<std::int32_t, 3> bottom{};
    std::array<Vector3, 3> high{};
    std::array<Vector3, 3> low{};
    bool fits = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const SheetVertex& vertex = vertex_of(mesh_.triangles[t][i]);
      const double along = dot(vertex.offset, normal);
      fits = fits && std::abs(along) >= kMinThicknessShare * half_;
      top[i] = along < 0.0 ? vertex.first + 1 : vertex.first;
      bottom[i] = along < 0.0 ? vertex.first : vertex.first + 1;
      high[i] = target_->positions[static_cast<std::size_t>(top[i])];
      low[i] = target_->positions[static_cast<std::size_t>(bottom[i])];
    }
    fits = fits && dot(area_vector(high), normal) > 0.0 && dot(area_vector(low), normal) > 0.0;
    if (!fits) {
      for (std::size_t i = 0; i < 3; ++i) {
        top[i] = add_position(corners[i] + half_ * normal);
        bottom[i] = add_position(corners[i] - half_ * normal);
      }
    }
    const std::int64_t origin = origins_[t];
    add_triangle(top[0], top[1], top[2], origin);
    add_triangle(bottom[0], bottom[2], bottom[1], origin);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      // The diagonal with the lowest vertex index.
      const bool is_first = std::min(bottom[i], top[j]) < std::min(bottom[j], top[i]);
      add_side(bottom[i], bottom[j], top[j], top[i], is_first, origin);
    }
  }

  // Adds the walls that are not canceled.
  void add_walls() {
    std::stable_sort(walls_.begin(), walls_.end());
    for (std::size_t i = 0; i < walls_.size();) {
      std::size_t end = i;
      std::array<std::size_t, 2> counts{};
      for (; end < walls_.size() && walls_[end].sorted == walls_[i].sorted; ++end) {
        ++counts[walls_[end].is_even ? 1 : 0];
      }
      const std::size_t way = counts[1] > counts[0] ? 1 : 0;
      std::size_t left = counts[way] - counts[1 - way];
      for (std::size_t k = i; k < end && left > 0; ++k) {
        if ((walls_[k].is_even ? 1U : 0U) != way) continue;
        const auto& [a, b, c] = walls_[k].corners;
        add_triangle(a, b, c, walls_[k].origin);
        --left;
      }
      i = end;
    }
  }

  const MeshView<std::int32_t>& mesh_;
  std::span<const std::int64_t> origins_;
  double half_;
  WorkMesh* target_;
  std::unordered_map<std::int32_t, std::uint32_t> numbers_;
  std::vector<SheetVertex> vertices_;
  std::vector<Wall> walls_;
};

}  // namespace

void add_shell(const MeshView<std::int32_t>& mesh, std::span<const std::int64_t> origins,
               std::span<const std::uint32_t> triangles, double half, WorkMesh* target) {
  Shell(mesh, origins, half, target).add(triangles);
}

}  // namespace prefilter
