#include "prefilter/contour/source_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 14;
constexpr double kSharpCosine = 0.9396926207859084;  // 20 degrees
constexpr double kTurnCosine = 0.8660254037844387;   // 30 degrees: of a border at a corner
constexpr double kPointedShare = 0.9;                // of a mean normal's length, at a tip
constexpr double kLeastRegion = 0.5;                 // of a cell's face
constexpr double kLeastRidge = 3.0;                  // cells
constexpr double kLargest = 1e150;

using Triangle = std::array<std::int32_t, 3>;

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : above_(count) {
    std::iota(above_.begin(), above_.end(), 0);
  }
  std::int32_t root(std::int32_t i) {
    while (above_[static_cast<std::size_t>(i)] != i) {
      std::int32_t& above = above_[static_cast<std::size_t>(i)];
      above = above_[static_cast<std::size_t>(above)];
      i = above;
    }
    return i;
  }
  // The lower root stays one, so that the outcome does not depend on the order of joining.
  void join(std::int32_t i, std::int32_t j) {
    const std::int32_t a = root(i);
    const std::int32_t b = root(j);
    above_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  // Numbers of the sets, in order of their first members.
  std::vector<std::int32_t> numbers(int* count) {
    std::vector<std::int32_t> result(above_.size());
    std::int32_t next = 0;
    for (std::size_t i = 0; i < above_.size(); ++i) {
      const auto at = static_cast<std::size_t>(root(static_cast<std::int32_t>(i)));
      result[i] = at == i ? next++ : result[at];
    }
    *count = next;
    return result;
  }

 private:
  std::vector<std::int32_t> above_;
};

// A side of a triangle; `half` is three times the triangle plus the corner where it begins.
struct HalfEdge {
  std::uint64_t ends;  // the lower vertex in the high bits
  std::uint32_t half;

  bool operator<(const HalfEdge& other) const {
    return ends != other.ends ? ends < other.ends : half < other.half;
  }
};

class RegionFinder {
 public:
  RegionFinder(double cell, int threads) : cell_(cell), threads_(threads) {}

  SourceRegions find(std::span<const SourceMesh> sources, const RootFrame& frame,
                     const Progress& progress) {
    gather(sources, frame, progress.part(0.0, 0.2));
    measure(progress.part(0.2, 0.3));
    pair_sides(progress.part(0.3, 0.7));
    join_smooth(sources);
    progress.report(0.8);
    join_small();
    progress.report(0.85);
    find_borders();
    progress.report(0.9);
    find_corners();
    progress.report(1.0);
    return std::move(found_);
  }

 private:
  void gather(std::span<const SourceMesh> sources, const RootFrame& frame,
              const Progress& progress) {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    for (const SourceMesh& source : sources) {
      check_mesh(source.mesh, kLargest);
      if (!source.groups.empty() && source.groups.size() != source.mesh.triangles.size()) {
        throw_invalid("sources: " + std::to_string(source.groups.size()) + " groups of " +
                      std::to_string(source.mesh.triangles.size()) +
                      " triangles; one each is needed");
      }
      vertices += source.mesh.positions.size();
      triangles += source.mesh.triangles.size();
    }
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() / 3;
    if (vertices > kMost || triangles > kMost) {
      throw_invalid("sources: " + std::to_string(std::max(vertices, triangles)) +
                    " vertices or triangles; at most " + std::to_string(kMost) + " are allowed");
    }
    found_.positions.reserve(vertices);
    found_.triangles.reserve(triangles);
    for (const SourceMesh& source : sources) {
      const auto first = static_cast<std::int64_t>(found_.positions.size());
      for (const Vector3& position : source.mesh.positions) {
        found_.positions.push_back(frame.from_space(position));
      }
      progress.report(0.5);
      for (const auto& triangle : source.mesh.triangles) {
        found_.triangles.push_back({static_cast<std::int32_t>(triangle[0] + first),
                                    static_cast<std::int32_t>(triangle[1] + first),
                                    static_cast<std::int32_t>(triangle[2] + first)});
      }
      source_ends_.push_back(found_.triangles.size());
    }
  }

  void measure(const Progress& progress) {
    normals_.resize(found_.triangles.size());
    areas_.resize(found_.triangles.size());
    const auto measure_some = [&](std::int64_t begin, std::int64_t end) {
      for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
        const Vector3 a = found_.corner(t, 0);
        const Vector3 twice = cross(found_.corner(t, 1) - a, found_.corner(t, 2) - a);
        const double size = length(twice);
        areas_[t] = size / 2.0;
        normals_[t] = size > 0.0 ? (1.0 / size) * twice : Vector3{};
      }
    };
    parallel_ranges(static_cast<std::int64_t>(found_.triangles.size()), kRowsPerTask, threads_,
                    progress, measure_some);
  }

  // Sorts the sides of triangles by their ends. Where some have no partner, vertices at one place
  // become one first.
  void pair_sides(const Progress& progress) {
    corners_ = found_.triangles;
    sort_sides(progress.part(0.0, 0.5));
    if (!has_single()) return;
    std::vector<std::int32_t> order(found_.positions.size());
    std::iota(order.begin(), order.end(), 0);
    const auto& positions = found_.positions;
    const auto less = [&](std::int32_t a, std::int32_t b) {
      const Vector3& p = positions[static_cast<std::size_t>(a)];
      const Vector3& q = positions[static_cast<std::size_t>(b)];
      return p != q ? p < q : a < b;
    };
    sort_in_parallel(&order, progress.part(0.5, 0.7), threads_, less);
    std::vector<std::int32_t> firsts(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto v = static_cast<std::size_t>(order[i]);
      const bool is_same =
          i > 0 && positions[v] == positions[static_cast<std::size_t>(order[i - 1])];
      firsts[v] = is_same ? firsts[static_cast<std::size_t>(order[i - 1])] : order[i];
    }
    for (std::size_t s = 0; s < source_ends_.size(); ++s) {
      const std::size_t begin = s == 0 ? 0 : source_ends_[s - 1];
      for (std::size_t t = begin; t < source_ends_[s]; ++t) {
        for (std::int32_t& vertex : corners_[t]) vertex = firsts[static_cast<std::size_t>(vertex)];
      }
    }
    sort_sides(progress.part(0.7, 1.0));
  }

  void sort_sides(const Progress& progress) {
    sides_.resize(3 * corners_.size());
    const auto list = [&](std::int64_t begin, std::int64_t end) {
      for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
          const auto [low, high] = std::minmax(corners_[t][i], corners_[t][(i + 1) % 3]);
          sides_[3 * t + i] = {
              (static_cast<std::uint64_t>(low) << 32U) | static_cast<std::uint32_t>(high),
              static_cast<std::uint32_t>(3 * t + i)};
        }
      }
    };
    parallel_ranges(static_cast<std::int64_t>(corners_.size()), kRowsPerTask, threads_,
                    progress.part(0.0, 0.1), list);
    sort_in_parallel(&sides_, progress.part(0.1, 1.0), threads_);
  }

  bool has_single() const {
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const bool before = i > 0 && sides_[i - 1].ends == sides_[i].ends;
      const bool after = i + 1 < sides_.size() && sides_[i + 1].ends == sides_[i].ends;
      if (!before && !after) return true;
    }
    return false;
  }

  static std::size_t triangle_of(const HalfEdge& side) { return side.half / 3; }
  bool runs_up(const HalfEdge& side) const {
    const Triangle& corners = corners_[triangle_of(side)];
    return corners[side.half % 3] < corners[(side.half + 1) % 3];
  }

  // Calls visit(i, j) for the sides of two triangles that meet there alone, both with an area and
  // seen from one side.
  template <typename Visit>
  void for_pairs(const Visit& visit) const {
    for (std::size_t i = 0; i < sides_.size();) {
      std::size_t end = i + 1;
      while (end < sides_.size() && sides_[end].ends == sides_[i].ends) ++end;
      if (end == i + 2 && runs_up(sides_[i]) != runs_up(sides_[i + 1]) &&
          areas_[triangle_of(sides_[i])] > 0.0 && areas_[triangle_of(sides_[i + 1])] > 0.0) {
        visit(sides_[i], sides_[i + 1]);
      }
      i = end;
    }
  }

  bool is_sharp(std::size_t t, std::size_t u) const {
    return dot(normals_[t], normals_[u]) < kSharpCosine;
  }

  void join_smooth(std::span<const SourceMesh> sources) {
    const auto group_of = [&](std::size_t t) -> std::int64_t {
      std::size_t s = 0;
      while (t >= source_ends_[s]) ++s;
      const std::size_t begin = s == 0 ? 0 : source_ends_[s - 1];
      return sources[s].groups.empty() ? 0 : sources[s].groups[t - begin];
    };
    DisjointSets regions(corners_.size());
    DisjointSets parts(corners_.size());
    for_pairs([&](const HalfEdge& a, const HalfEdge& b) {
      const std::size_t t = triangle_of(a);
      const std::size_t u = triangle_of(b);
      parts.join(static_cast<std::int32_t>(t), static_cast<std::int32_t>(u));
      if (!is_sharp(t, u) && group_of(t) == group_of(u)) {
        regions.join(static_cast<std::int32_t>(t), static_cast<std::int32_t>(u));
      }
    });
    found_.labels = regions.numbers(&region_count_);
    found_.parts = parts.numbers(&found_.part_count);
    groups_of_regions_.resize(static_cast<std::size_t>(region_count_));
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      groups_of_regions_[static_cast<std::size_t>(found_.labels[t])] = group_of(t);
    }
  }

  struct Shared {
    std::int32_t small;
    std::int32_t other;
    double length;
  };

  void join_small() {
    std::vector<double> sizes(static_cast<std::size_t>(region_count_), 0.0);
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      sizes[static_cast<std::size_t>(found_.labels[t])] += areas_[t];
    }
    const auto is_small = [&](std::int32_t label) {
      return sizes[static_cast<std::size_t>(label)] < kLeastRegion * cell_ * cell_;
    };
    std::vector<Shared> shared;
    for_pairs([&](const HalfEdge& a, const HalfEdge& b) {
      const std::int32_t p = found_.labels[triangle_of(a)];
      const std::int32_t q = found_.labels[triangle_of(b)];
      if (p == q || groups_of_regions_[static_cast<std::size_t>(p)] !=
                        groups_of_regions_[static_cast<std::size_t>(q)]) {
        return;
      }
      const double size = side_length(a);
      if (is_small(p)) shared.push_back({p, q, size});
      if (is_small(q)) shared.push_back({q, p, size});
    });
    std::sort(shared.begin(), shared.end(), [](const Shared& a, const Shared& b) {
      if (a.small != b.small) return a.small < b.small;
      return a.other != b.other ? a.other < b.other : a.length < b.length;
    });
    DisjointSets joined(static_cast<std::size_t>(region_count_));
    for (std::size_t i = 0; i < shared.size();) {
      const std::int32_t small = shared[i].small;
      std::int32_t best = -1;
      double longest = -1.0;
      while (i < shared.size() && shared[i].small == small) {
        const std::int32_t other = shared[i].other;
        double sum = 0.0;
        for (; i < shared.size() && shared[i].small == small && shared[i].other == other; ++i) {
          sum += shared[i].length;
        }
        if (sum > longest) {
          longest = sum;
          best = other;
        }
      }
      joined.join(small, best);
    }
    const std::vector<std::int32_t> numbers = joined.numbers(&region_count_);
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      std::int32_t& label = found_.labels[t];
      label = areas_[t] > 0.0 ? numbers[static_cast<std::size_t>(label)] : -1;
    }
  }

  double side_length(const HalfEdge& side) const {
    return length(found_.positions[side.ends >> 32U] - found_.positions[side.ends & 0xFFFFFFFFU]);
  }

  void find_borders() {
    std::vector<RegionBorder> within;
    for_pairs([&](const HalfEdge& a, const HalfEdge& b) {
      const std::size_t t = triangle_of(a);
      const std::size_t u = triangle_of(b);
      const std::int32_t p = found_.labels[t];
      const std::int32_t q = found_.labels[u];
      const RegionBorder border = {{static_cast<std::int32_t>(a.ends >> 32U),
                                    static_cast<std::int32_t>(a.ends & 0xFFFFFFFFU)},
                                   {p, q},
                                   {static_cast<std::int32_t>(t), static_cast<std::int32_t>(u)}};
      if (p != q) {
        found_.borders.push_back(border);
      } else if (is_sharp(t, u)) {
        within.push_back(border);
      }
    });
    DisjointSets chains(found_.positions.size());
    for (const RegionBorder& border : within) chains.join(border.ends[0], border.ends[1]);
    std::vector<std::pair<std::int32_t, double>> lengths;
    for (const RegionBorder& border : within) {
      lengths.emplace_back(chains.root(border.ends[0]),
                           length(found_.positions[static_cast<std::size_t>(border.ends[0])] -
                                  found_.positions[static_cast<std::size_t>(border.ends[1])]));
    }
    std::vector<double> sums(lengths.empty() ? 0 : found_.positions.size(), 0.0);
    for (const auto& [chain, size] : lengths) sums[static_cast<std::size_t>(chain)] += size;
    for (const RegionBorder& border : within) {
      if (sums[static_cast<std::size_t>(chains.root(border.ends[0]))] >= kLeastRidge * cell_) {
        found_.borders.push_back(border);
      }
    }
  }

  void find_corners() {
    struct End {
      std::int32_t vertex;
      std::int32_t other;
      std::array<std::int32_t, 2> labels;
    };
    std::vector<End> ends;
    for (const RegionBorder& border : found_.borders) {
      ends.push_back({border.ends[0], border.ends[1], border.labels});
      ends.push_back({border.ends[1], border.ends[0], border.labels});
    }
    std::stable_sort(ends.begin(), ends.end(),
                     [](const End& a, const End& b) { return a.vertex < b.vertex; });
    std::vector<std::uint8_t> has_border(found_.positions.size(), 0);
    for (std::size_t i = 0; i < ends.size();) {
      std::size_t end = i + 1;
      while (end < ends.size() && ends[end].vertex == ends[i].vertex) ++end;
      const std::int32_t vertex = ends[i].vertex;
      has_border[static_cast<std::size_t>(vertex)] = 1;
      bool is_corner = end - i != 2;
      if (!is_corner) {
        const Vector3 u = direction(vertex, ends[i].other);
        const Vector3 v = direction(vertex, ends[i + 1].other);
        is_corner = -dot(u, v) < kTurnCosine;
      }
      if (is_corner) {
        RegionCorner corner{vertex, {}};
        for (std::size_t k = i; k < end; ++k) {
          corner.labels.insert(corner.labels.end(), ends[k].labels.begin(), ends[k].labels.end());
        }
        std::sort(corner.labels.begin(), corner.labels.end());
        corner.labels.erase(std::unique(corner.labels.begin(), corner.labels.end()),
                            corner.labels.end());
        found_.corners.push_back(std::move(corner));
      }
      i = end;
    }
    std::vector<Vector3> sums(found_.positions.size(), Vector3{});
    std::vector<double> areas(found_.positions.size(), 0.0);
    std::vector<std::int32_t> labels(found_.positions.size(), -1);
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      for (const std::int32_t corner : corners_[t]) {
        const auto v = static_cast<std::size_t>(corner);
        sums[v] = sums[v] + areas_[t] * normals_[t];
        areas[v] += areas_[t];
        labels[v] = std::max(labels[v], found_.labels[t]);
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
      if (has_border[v] != 0 || !(areas[v] > kLeastRegion * cell_ * cell_)) continue;
      if (length(sums[v]) < kPointedShare * areas[v]) {
        found_.corners.push_back({static_cast<std::int32_t>(v), {labels[v]}});
      }
    }
  }

  Vector3 direction(std::int32_t from, std::int32_t to) const {
    const Vector3 d = found_.positions[static_cast<std::size_t>(to)] -
                      found_.positions[static_cast<std::size_t>(from)];
    const double size = length(d);
    return size > 0.0 ? (1.0 / size) * d : d;
  }

  double cell_;
  int threads_;
  SourceRegions found_;
  std::vector<std::size_t> source_ends_;
  std::vector<Vector3> normals_;
  std::vector<double> areas_;
  std::vector<Triangle> corners_;  // with one vertex a place
  std::vector<HalfEdge> sides_;
  int region_count_ = 0;
  std::vector<std::int64_t> groups_of_regions_;
};
}  // namespace

SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Progress& progress, int threads) {
  return RegionFinder(cell, threads).find(sources, frame, progress);
}

}  // namespace prefilter
