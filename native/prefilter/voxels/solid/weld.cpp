// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/weld.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/buckets.h"
#include "prefilter/voxels/solid/edge_table.h"

namespace prefilter {
namespace {

constexpr std::int64_t kSlotsPerTask = 1 << 14;
// Maximum welding distance, as a share of the shortest edge at a vertex, so that no triangle
// collapses.
constexpr double kMaxShareOfEdge = 1.0 / 3.0;

std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 30U;
  x *= 0xBF58476D1CE4E5B9U;
  x ^= x >> 27U;
  x *= 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

// Equal for equal positions, including 0 and -0.
std::uint64_t hash_of(const Vector3& p) {
  std::uint64_t hash = 0;
  for (const double x : p) hash = mixed(hash + std::bit_cast<std::uint64_t>(x + 0.0));
  return hash;
}

// Renames the corners of all triangles. Returns the number of used vertices that were renamed.
std::size_t rename(const std::vector<std::int32_t>& names, WorkMesh* mesh) {
  std::vector<bool> is_renamed(names.size(), false);
  std::size_t count = 0;
  for (auto& triangle : mesh->triangles) {
    for (std::int32_t& vertex : triangle) {
      const auto v = static_cast<std::size_t>(vertex);
      if (names[v] == vertex) continue;
      if (!is_renamed[v]) ++count;
      is_renamed[v] = true;
      vertex = names[v];
    }
  }
  return count;
}

// Points in a hash grid, added incrementally, for neighbor queries.
class NearbyPoints {
 public:
  NearbyPoints(std::size_t count, double distance)
      : side_(2.0 * distance), heads_(std::bit_ceil(2 * count + 1), kNone), next_(count, kNone) {}

  void add(std::uint32_t item, const Vector3& p) {
    const std::size_t slot = slot_of({cell(p[0]), cell(p[1]), cell(p[2])});
    next_[item] = heads_[slot];
    heads_[slot] = item;
  }

  /// Visits at least all items within the distance, possibly some twice.
  template <typename Visit>
  void visit(const Vector3& p, const Visit& visit_item) const {
    Vector3 near;
    Vector3 other;
    for (std::size_t a = 0; a < 3; ++a) {
      near[a] = cell(p[a]);
      other[a] = near[a] + (p[a] / side_ - near[a] < 0.5 ? -1.0 : 1.0);
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vector3 at;
      for (std::size_t a = 0; a < 3; ++a) at[a] = ((corner >> a) & 1U) != 0U ? other[a] : near[a];
      for (std::uint32_t i = heads_[slot_of(at)]; i != kNone; i = next_[i]) visit_item(i);
    }
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  double cell(double x) const { return std::floor(x / side_); }
  std::size_t slot_of(const Vector3& cell) const { return hash_of(cell) & (heads_.size() - 1); }

  double side_;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
};

// An edge with a single triangle, in the direction in which the triangle traverses it.
struct BorderEdge {
  std::uint32_t triangle;
  std::uint32_t from;
  std::uint32_t to;
};

std::vector<BorderEdge> border_edges(const WorkMesh& mesh, const Run& run) {
  const EdgeTable edges(mesh.view(), run);
  std::vector<BorderEdge> result;
  for (std::size_t low = 0; low < edges.vertex_count(); ++low) {
    edges.for_edges_from(low, [&](std::size_t high, std::span<const std::uint64_t> uses) {
      if (uses.size() != 1) return;
      const EdgeUse use = EdgeTable::use(uses[0]);
      result.push_back({use.triangle, static_cast<std::uint32_t>(use.is_down ? high : low),
                        static_cast<std::uint32_t>(use.is_down ? low : high)});
    });
  }
  return result;
}

// The ends of edges, sorted and unique.
std::vector<std::uint32_t> ends_of(const std::vector<BorderEdge>& edges, std::size_t vertex_count) {
  std::vector<bool> is_end(vertex_count, false);
  for (const BorderEdge& edge : edges) {
    is_end[edge.from] = true;
    is_end[edge.to] = true;
  }
  std::vector<std::uint32_t> vertices;
  for (std::size_t v = 0; v < is_end.size(); ++v) {
    if (is_end[v]) vertices.push_back(static_cast<std::uint32_t>(v));
  }
  return vertices;
}

// A vertex on a side of a triangle; `side` is the corner at which the side begins.
struct SplitPoint {
  std::uint32_t triangle;
  std::uint32_t side;
  double along;
  std::int32_t vertex;

  bool operator<(const SplitPoint& other) const {
    return std::tie(triangle, side, along, vertex) <
           std::tie(other.triangle, other.side, other.along, other.vertex);
  }
};

// Replaces a triangle by triangles between the vertices on its sides.
void split_triangle(std::uint32_t t, std::span<const SplitPoint> points, WorkMesh* mesh) {
  const std::array<std::int32_t, 3> whole = mesh->triangles[t];
  const std::int64_t origin = mesh->origins[t];
  bool is_first = true;
  const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    if (is_first) {
      mesh->triangles[t] = {a, b, c};
    } else {
      mesh->triangles.push_back({a, b, c});
      mesh->origins.push_back(origin);
    }
    is_first = false;
  };
  // The vertices of a side, including both ends.
  const auto side = [&](std::uint32_t i) {
    std::vector<std::int32_t> vertices = {whole[i]};
    for (const SplitPoint& point : points) {
      if (point.side == i) vertices.push_back(point.vertex);
    }
    vertices.push_back(whole[(i + 1) % 3]);
    return vertices;
  };
  const auto fan = [&](const std::vector<std::int32_t>& vertices, std::int32_t tip) {
    for (std::size_t k = 0; k + 1 < vertices.size(); ++k) add(tip, vertices[k], vertices[k + 1]);
  };
  // A fan over the first split side; its outer triangles absorb the other two sides.
  const std::uint32_t i = points.front().side;
  const std::vector<std::int32_t> base = side(i);
  for (std::size_t k = 1; k + 2 < base.size(); ++k) {
    add(whole[(i + 2) % 3], base[k], base[k + 1]);
  }
  fan(side((i + 1) % 3), base[base.size() - 2]);
  fan(side((i + 2) % 3), base[1]);
}

double squared_length(const Vector3& a) { return dot(a, a); }

using WeldCorners = std::array<std::int32_t, 3>;

bool is_degenerate(const WeldCorners& corners) {
  const auto& [a, b, c] = corners;
  return a == b || b == c || c == a;
}

WeldCorners sorted(WeldCorners corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

// Whether the corners ascend when starting at the lowest.
bool is_ascending(const WeldCorners& corners) {
  const auto& [a, b, c] = corners;
  return (a < b) + (b < c) + (c < a) == 2;
}

struct Face {
  WeldCorners corners;  // sorted
  std::uint64_t triangle;
  bool operator<(const Face& other) const {
    return corners != other.corners ? corners < other.corners : triangle < other.triangle;
  }
};

// Marks, among triangles with the same three corners, the first of the more frequent direction, or
// the first of all in case of a tie. `faces` is scratch space.
void keep_one_of_each(const std::vector<WeldCorners>& triangles,
                      std::span<const std::uint64_t> candidates, std::vector<Face>* faces,
                      std::vector<std::uint8_t>* is_kept) {
  faces->clear();
  for (const std::uint64_t t : candidates) faces->push_back({sorted(triangles[t]), t});
  std::sort(faces->begin(), faces->end());
  for (auto first = faces->begin(); first != faces->end();) {
    std::array<std::size_t, 2> counts{};
    std::array<std::uint64_t, 2> firsts{};  // of the descending and of the ascending direction
    auto face = first;
    for (; face != faces->end() && face->corners == first->corners; ++face) {
      const std::size_t way = is_ascending(triangles[face->triangle]) ? 1 : 0;
      if (counts[way]++ == 0) firsts[way] = face->triangle;
    }
    const bool is_up =
        counts[0] != counts[1] ? counts[1] > counts[0] : is_ascending(triangles[first->triangle]);
    (*is_kept)[firsts[is_up ? 1 : 0]] = 1;
    first = face;
  }
}

}  // namespace

std::vector<std::int32_t> first_at_position(const PositionView& positions, const Run& run) {
  const std::size_t slots = std::bit_ceil(positions.size() / 2 + 1);
  const Stages stages(run, {4, 1});
  const Buckets buckets(
      slots, positions.size(),
      [&](std::size_t begin, std::size_t end, const auto& put) {
        for (std::size_t v = begin; v < end; ++v) put(hash_of(positions[v]) & (slots - 1), v);
      },
      stages[0]);
  std::vector<std::int32_t> names(positions.size());
  parallel_ranges(static_cast<std::int64_t>(slots), kSlotsPerTask, stages[1],
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto slot = static_cast<std::size_t>(begin);
                         slot < static_cast<std::size_t>(end); ++slot) {
                      const std::span<const std::uint64_t> vertices = buckets[slot];
                      for (std::size_t i = 0; i < vertices.size(); ++i) {
                        std::size_t first = 0;
                        while (positions[vertices[first]] != positions[vertices[i]]) ++first;
                        names[vertices[i]] = static_cast<std::int32_t>(vertices[first]);
                      }
                    }
                  });
  return names;
}

std::size_t weld_equal(WorkMesh* mesh, const Run& run) {
  const std::size_t count = rename(first_at_position(mesh->positions, run.part(0.0, 0.9)), mesh);
  run.report(1.0);
  return count;
}

std::size_t weld_borders(WorkMesh* mesh, double distance, const Run& run) {
  const std::vector<Vector3>& positions = mesh->positions;
  const std::vector<std::uint32_t> vertices =
      ends_of(border_edges(*mesh, run.part(0.0, 0.5)), positions.size());
  if (vertices.empty()) return 0;
  // Squared welding distance of each vertex.
  std::vector<double> reaches(positions.size(), distance * distance);
  for (const auto& triangle : mesh->triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(triangle[i]);
      const auto b = static_cast<std::size_t>(triangle[(i + 1) % 3]);
      const double reach =
          kMaxShareOfEdge * kMaxShareOfEdge * squared_length(positions[b] - positions[a]);
      reaches[a] = std::min(reaches[a], reach);
      reaches[b] = std::min(reaches[b], reach);
    }
  }
  std::vector<std::int32_t> names(positions.size());
  for (std::size_t v = 0; v < names.size(); ++v) names[v] = static_cast<std::int32_t>(v);
  NearbyPoints kept(vertices.size(), distance);
  const Run welding = run.part(0.5, 0.9);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (i % 4096 == 0)
      welding.report(static_cast<double>(i) / static_cast<double>(vertices.size()));
    const std::uint32_t v = vertices[i];
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t name = v;
    kept.visit(positions[v], [&](std::uint32_t other) {
      const std::uint32_t w = vertices[other];
      const double squared = squared_length(positions[w] - positions[v]);
      if (squared > std::min(reaches[v], reaches[w])) return;
      if (squared > nearest || (squared == nearest && w >= name)) return;
      nearest = squared;
      name = w;
    });
    names[v] = static_cast<std::int32_t>(name);
    if (name == v) kept.add(i, positions[v]);
  }
  const std::size_t count = rename(names, mesh);
  run.report(1.0);
  return count;
}

std::size_t split_borders(WorkMesh* mesh, double distance, const Run& run) {
  const std::vector<Vector3>& positions = mesh->positions;
  const std::vector<BorderEdge> edges = border_edges(*mesh, run.part(0.0, 0.5));
  if (edges.empty()) return 0;
  const std::vector<std::uint32_t> vertices = ends_of(edges, positions.size());
  double sum = 0.0;
  for (const BorderEdge& edge : edges) sum += length(positions[edge.to] - positions[edge.from]);
  const double reach = std::max(distance, sum / static_cast<double>(edges.size()));
  NearbyPoints points(vertices.size(), reach);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) points.add(i, positions[vertices[i]]);
  const Run splitting = run.part(0.5, 0.9);
  std::vector<SplitPoint> splits;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (e % 4096 == 0) splitting.report(static_cast<double>(e) / static_cast<double>(edges.size()));
    const auto& [t, from, to] = edges[e];
    const Vector3 way = positions[to] - positions[from];
    const double squared = squared_length(way);
    if (!(squared > 4.0 * distance * distance)) continue;
    std::uint32_t side = 0;
    while (mesh->triangles[t][side] != static_cast<std::int32_t>(from)) ++side;
    const auto tip = static_cast<std::uint32_t>(mesh->triangles[t][(side + 2) % 3]);
    const double parts = std::ceil(std::sqrt(squared) / reach);
    for (double part = 0.0; part < parts; part += 1.0) {
      Vector3 at = positions[from];
      for (std::size_t a = 0; a < 3; ++a) at[a] += way[a] * ((part + 0.5) / parts);
      points.visit(at, [&](std::uint32_t i) {
        const std::uint32_t v = vertices[i];
        if (v == from || v == to || v == tip) return;
        const Vector3 offset = positions[v] - positions[from];
        const double along = dot(offset, way) / squared;
        if (!(along > 0.0 && along < 1.0)) return;
        const double off_line = squared_length(offset) - along * along * squared;
        const double from_end = std::min(along, 1.0 - along);
        const double limit = distance * distance;
        if (off_line > limit || from_end * from_end * squared <= limit) return;
        splits.push_back({t, side, along, static_cast<std::int32_t>(v)});
      });
    }
  }
  std::sort(splits.begin(), splits.end());
  const auto is_same = [](const SplitPoint& a, const SplitPoint& b) {
    return a.triangle == b.triangle && a.side == b.side && a.vertex == b.vertex;
  };
  splits.erase(std::unique(splits.begin(), splits.end(), is_same), splits.end());
  for (std::size_t i = 0; i < splits.size();) {
    std::size_t end = i + 1;
    while (end < splits.size() && splits[end].triangle == splits[i].triangle) ++end;
    split_triangle(splits[i].triangle, std::span(splits).subspan(i, end - i), mesh);
    i = end;
  }
  run.report(1.0);
  return splits.size();
}

std::size_t drop_duplicates(WorkMesh* mesh, const Run& run) {
  auto& triangles = mesh->triangles;
  const Buckets buckets(
      mesh->positions.size(), triangles.size(),
      [&](std::size_t begin, std::size_t end, const auto& put) {
        for (std::size_t t = begin; t < end; ++t) {
          if (is_degenerate(triangles[t])) continue;
          put(static_cast<std::size_t>(sorted(triangles[t])[0]), t);
        }
      },
      run.part(0.0, 0.6));
  std::vector<std::uint8_t> is_kept(triangles.size(), 0);
  parallel_ranges(static_cast<std::int64_t>(buckets.size()), kSlotsPerTask, run.part(0.6, 0.9),
                  [&](std::int64_t begin, std::int64_t end) {
                    std::vector<Face> faces;
                    for (auto b = static_cast<std::size_t>(begin);
                         b < static_cast<std::size_t>(end); ++b) {
                      keep_one_of_each(triangles, buckets[b], &faces, &is_kept);
                    }
                  });
  std::size_t count = 0;
  std::size_t duplicates = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (is_kept[t] == 0) {
      if (!is_degenerate(triangles[t])) ++duplicates;
      continue;
    }
    triangles[count] = triangles[t];
    mesh->origins[count++] = mesh->origins[t];
  }
  triangles.resize(count);
  mesh->origins.resize(count);
  run.report(1.0);
  return duplicates;
}

}  // namespace prefilter
