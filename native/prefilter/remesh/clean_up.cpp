// In rounds: the shortest edges first, and in each round none whose surroundings have changed in
// it, so that the neighbours of all vertices are found once a round.
#include "prefilter/remesh/clean_up.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr int kMostRounds = 8;
// Of the longest edge of a triangle: edges shorter than this are candidates.
constexpr double kShort = 0.3;
constexpr double kLeastCosine = 0.7071067811865476;
constexpr std::size_t kProgressStep = 1U << 14;
// Of a round's time, about: finding the triangles around vertices; finding and sorting short edges.
constexpr double kLinking = 0.2;
constexpr double kSorting = 0.5;

using Triangle = std::array<std::int32_t, 3>;

struct Edge {
  double squared_length;
  std::int32_t from;
  std::int32_t to;

  bool operator<(const Edge& other) const {
    if (squared_length != other.squared_length) return squared_length < other.squared_length;
    return from != other.from ? from < other.from : to < other.to;
  }
};

class Collapser {
 public:
  Collapser(TriangleMesh* mesh, int threads) : mesh_(*mesh), threads_(threads) {}

  // Returns whether any edge was collapsed.
  bool round(const Progress& progress) {
    link(progress.part(0.0, kLinking));
    const std::vector<Edge> edges = short_edges(progress.part(kLinking, kSorting));
    const Progress collapsing = progress.part(kSorting, 1.0);
    is_touched_.assign(mesh_.positions.size(), 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      report(collapsing, i, edges.size());
      count += try_collapse(edges[i].from, edges[i].to) ? 1U : 0U;
    }
    drop_collapsed();
    return count > 0;
  }

  // Leaves out the vertices that no triangle has.
  void drop_vertices() {
    std::vector<std::int32_t> places(mesh_.positions.size(), -1);
    for (const Triangle& triangle : mesh_.triangles) {
      for (const std::int32_t vertex : triangle) places[static_cast<std::size_t>(vertex)] = 0;
    }
    std::int32_t next = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (places[v] < 0) continue;
      places[v] = next;
      mesh_.positions[static_cast<std::size_t>(next++)] = mesh_.positions[v];
    }
    mesh_.positions.resize(static_cast<std::size_t>(next));
    for (Triangle& triangle : mesh_.triangles) {
      for (std::int32_t& vertex : triangle) vertex = places[static_cast<std::size_t>(vertex)];
    }
  }

 private:
  const Vector3& point(std::int32_t vertex) const {
    return mesh_.positions[static_cast<std::size_t>(vertex)];
  }

  static void report(const Progress& progress, std::size_t done, std::size_t all) {
    if (done % kProgressStep == 0) {
      progress.report(static_cast<double>(done) / static_cast<double>(all));
    }
  }

  // The triangles of each vertex.
  void link(const Progress& progress) {
    const Progress counting = progress.part(0.0, 0.4);
    const Progress placing = progress.part(0.4, 1.0);
    const std::size_t count = mesh_.triangles.size();
    firsts_.assign(mesh_.positions.size() + 1, 0);
    for (std::size_t t = 0; t < count; ++t) {
      report(counting, t, count);
      for (const std::int32_t vertex : mesh_.triangles[t]) {
        ++firsts_[static_cast<std::size_t>(vertex) + 1];
      }
    }
    for (std::size_t v = 1; v < firsts_.size(); ++v) firsts_[v] += firsts_[v - 1];
    around_.resize(3 * count);
    std::vector<std::size_t> next(firsts_.begin(), firsts_.end() - 1);
    for (std::size_t t = 0; t < count; ++t) {
      report(placing, t, count);
      for (const std::int32_t vertex : mesh_.triangles[t]) {
        around_[next[static_cast<std::size_t>(vertex)]++] = static_cast<std::uint32_t>(t);
      }
    }
  }

  std::span<const std::uint32_t> triangles_of(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(around_).subspan(firsts_[v], firsts_[v + 1] - firsts_[v]);
  }

  std::vector<Edge> short_edges(const Progress& progress) const {
    const Progress finding = progress.part(0.0, 0.5);
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      report(finding, t, mesh_.triangles.size());
      const Triangle& triangle = mesh_.triangles[t];
      Vector3 squares;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vector3 side = point(triangle[(i + 1) % 3]) - point(triangle[i]);
        squares[i] = dot(side, side);
      }
      const double longest = *std::max_element(squares.begin(), squares.end());
      for (std::size_t i = 0; i < 3; ++i) {
        if (squares[i] >= kShort * kShort * longest) continue;
        const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
        edges.push_back({squares[i], low, high});
      }
    }
    sort_in_parallel(&edges, progress.part(0.5, 1.0), threads_);
    return edges;
  }

  void find_ring(std::int32_t vertex, std::vector<std::int32_t>* ring) const {
    ring->clear();
    for (const std::uint32_t t : triangles_of(vertex)) {
      for (const std::int32_t other : mesh_.triangles[t]) {
        if (other != vertex) ring->push_back(other);
      }
    }
    std::sort(ring->begin(), ring->end());
    ring->erase(std::unique(ring->begin(), ring->end()), ring->end());
  }

  bool has_touched(const std::vector<std::int32_t>& ring) const {
    return std::any_of(ring.begin(), ring.end(), [&](std::int32_t vertex) {
      return is_touched_[static_cast<std::size_t>(vertex)] != 0;
    });
  }

  // How thin the worst triangle is (1: equilateral, 0: flat) when `gone` has moved to `kept`; -1
  // where one would turn too far.
  double worst_after(std::int32_t gone, std::int32_t kept) const {
    double worst = 1.0;
    for (const std::uint32_t t : triangles_of(gone)) {
      const Triangle& triangle = mesh_.triangles[t];
      if (std::find(triangle.begin(), triangle.end(), kept) != triangle.end()) continue;
      std::array<Vector3, 3> before;
      std::array<Vector3, 3> after;
      for (std::size_t i = 0; i < 3; ++i) {
        before[i] = point(triangle[i]);
        after[i] = triangle[i] == gone ? point(kept) : before[i];
      }
      const Vector3 old_normal = cross(before[1] - before[0], before[2] - before[0]);
      const Vector3 normal = cross(after[1] - after[0], after[2] - after[0]);
      const double lengths = std::sqrt(dot(old_normal, old_normal) * dot(normal, normal));
      // A sliver's own normal says little; it may turn.
      const double sides = dot(before[1] - before[0], before[1] - before[0]) +
                           dot(before[2] - before[1], before[2] - before[1]) +
                           dot(before[0] - before[2], before[0] - before[2]);
      const bool is_sliver = std::sqrt(dot(old_normal, old_normal)) < 0.05 * sides;
      const double least = is_sliver ? 0.0 : kLeastCosine;
      if (!(dot(old_normal, normal) > least * lengths)) return -1.0;
      const double after_sides = dot(after[1] - after[0], after[1] - after[0]) +
                                 dot(after[2] - after[1], after[2] - after[1]) +
                                 dot(after[0] - after[2], after[0] - after[2]);
      constexpr double kEquilateral = 3.4641016151377544;  // sides over twice the area: 2 sqrt(3)
      worst = std::min(worst, kEquilateral * std::sqrt(dot(normal, normal)) / after_sides);
    }
    return worst;
  }

  bool try_collapse(std::int32_t a, std::int32_t b) {
    find_ring(a, &ring_a_);
    find_ring(b, &ring_b_);
    if (is_touched_[static_cast<std::size_t>(a)] != 0 ||
        is_touched_[static_cast<std::size_t>(b)] != 0 || has_touched(ring_a_) ||
        has_touched(ring_b_)) {
      return false;
    }
    // The link condition: the two have just the two neighbours in common that share a triangle with
    // them both. Those keep at least three triangles, and so does the vertex that remains.
    common_.clear();
    std::set_intersection(ring_a_.begin(), ring_a_.end(), ring_b_.begin(), ring_b_.end(),
                          std::back_inserter(common_));
    if (common_.size() != 2 || ring_a_.size() + ring_b_.size() < 7) return false;
    for (const std::int32_t vertex : common_) {
      if (triangles_of(vertex).size() < 4) return false;
    }
    const double onto_a = worst_after(b, a);
    const double onto_b = worst_after(a, b);
    if (onto_a < 0.0 && onto_b < 0.0) return false;
    const auto [gone, kept] = onto_a >= onto_b ? std::pair(b, a) : std::pair(a, b);
    for (const std::uint32_t t : triangles_of(gone)) {
      for (std::int32_t& vertex : mesh_.triangles[t]) {
        if (vertex == gone) vertex = kept;
      }
    }
    for (const auto* ring : {&ring_a_, &ring_b_}) {
      for (const std::int32_t vertex : *ring) is_touched_[static_cast<std::size_t>(vertex)] = 1;
    }
    return true;
  }

  // A collapsed triangle has a corner twice.
  void drop_collapsed() {
    std::erase_if(mesh_.triangles,
                  [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  }

  TriangleMesh& mesh_;
  int threads_;
  std::vector<std::size_t> firsts_;
  std::vector<std::uint32_t> around_;
  std::vector<std::uint8_t> is_touched_;
  std::vector<std::int32_t> ring_a_;
  std::vector<std::int32_t> ring_b_;
  std::vector<std::int32_t> common_;
};
}  // namespace

TriangleMesh clean_up(TriangleMesh mesh, const Progress& progress, int threads) {
  Collapser collapser(&mesh, threads);
  for (int i = 0; i < kMostRounds; ++i) {
    const double begin = static_cast<double>(i) / kMostRounds;
    if (!collapser.round(progress.part(begin, begin + 1.0 / kMostRounds))) break;
  }
  collapser.drop_vertices();
  progress.report(1.0);
  return mesh;
}

}  // namespace prefilter
