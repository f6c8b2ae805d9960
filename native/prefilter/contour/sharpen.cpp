// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/sharpen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/parallel.h"
#include "prefilter/contour/feature_places.h"
#include "prefilter/contour/source_regions.h"
#include "prefilter/remesh/intersections.h"

namespace prefilter {
namespace {

// All in cells.
constexpr double kRidgeReach = 1.5;
constexpr double kTooClose = 0.05;
constexpr double kPlaceCells = 2.0;
constexpr int kMostAttempts = 2;
constexpr int kMostHalvings = 3;
constexpr int kRings = 2;
constexpr int kSmoothings = 4;
constexpr std::int64_t kLoopsPerTask = 64;

using Triangle = std::array<std::int32_t, 3>;
using Labels = std::vector<std::int32_t>;

std::uint64_t side_key(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32U) | static_cast<std::uint32_t>(high);
}

class Sharpener {
 public:
  Sharpener(LoopedMesh looped, const std::vector<Vector3>& crossings, const FeatureSurface& surface,
            const VertexSamples& samples, int threads)
      : looped_(std::move(looped)),
        crossings_(crossings),
        surface_(surface),
        samples_(samples),
        threads_(threads),
        cell_(surface.cell()),
        feature_places_(surface) {}

  FacetedMesh run(const Progress& progress) {
    find_sides(progress.part(0.0, 0.1));
    find_turned();
    place_features(progress.part(0.1, 0.5));
    feature_places_.claim_corners(&features_);
    find_joints();
    const Progress checking = progress.part(0.6, 1.0);
    // What is near edges comes last, so that it can be looked at by itself.
    const auto far_end =
        std::stable_partition(looped_.triangles.begin(), looped_.triangles.end(),
                              [&](const Triangle& triangle) { return !is_near(triangle); });
    far_count_ = static_cast<std::size_t>(far_end - looped_.triangles.begin());
    FacetedMesh mesh;
    mesh.triangles = looped_.triangles;
    for (const Triangle& triangle : mesh.triangles) mesh.labels.push_back(label_of(triangle));
    mesh.positions = looped_.positions;
    mesh.kinds.assign(mesh.positions.size(), VertexKind::kSurface);
    for (const std::int32_t tip : samples_.tips) {
      mesh.kinds[static_cast<std::size_t>(tip)] = VertexKind::kCorner;
    }
    is_changed_loop_.assign(features_.size(), 1);
    is_changed_vertex_.assign(crossings_.size(), 0);
    for (std::size_t v = 0; v < crossings_.size(); ++v) {
      if (looped_.positions[v] != crossings_[v]) is_changed_vertex_[v] = 1;
    }
    do {
      assemble(&mesh);
    } while (drop_intersecting(&mesh, checking));
    return mesh;
  }

 private:
  // Of a loop: its sides that an edge crosses, and what lies beyond.
  struct Side {
    bool is_divided = false;
    std::int32_t other = -1;  // loop, where that can be joined
  };

  const SharpLoop& loop(std::size_t i) const { return looped_.loops[i]; }
  std::size_t next(std::size_t i, std::size_t k) const {
    return (k + 1) % static_cast<std::size_t>(loop(i).count);
  }
  const Vector3& position(std::int32_t vertex) const {
    return looped_.positions[static_cast<std::size_t>(vertex)];
  }

  void find_sides(const Progress& progress) {
    sides_.resize(looped_.loops.size());
    const auto find_some = [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
          sides_[i][k].is_divided =
              are_divided(surface_, samples_, loop(i).corners[k], loop(i).corners[next(i, k)]);
        }
      }
    };
    parallel_ranges(static_cast<std::int64_t>(sides_.size()), kLoopsPerTask, threads_, progress,
                    find_some);
  }

  void place_features(const Progress& progress) {
    features_.resize(looped_.loops.size());
    const auto place_some = [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        features_[i] = feature_of(i);
      }
    };
    parallel_ranges(static_cast<std::int64_t>(features_.size()), kLoopsPerTask, threads_, progress,
                    place_some);
    is_sharp_.assign(features_.size(), 1);
    attempts_.assign(features_.size(), 0);
    is_single_.assign(features_.size(), 0);
    halvings_.assign(features_.size(), 0);
  }

  Feature feature_of(std::size_t i) const {
    Vector3 start{};
    Labels labels;
    int divided = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
      const std::int32_t corner = loop(i).corners[k];
      if (const SourcePoint* sample = samples_.of(corner)) labels.push_back(sample->label);
      if (!sides_[i][k].is_divided) continue;
      start = start + 0.5 * (position(corner) + position(loop(i).corners[next(i, k)]));
      ++divided;
    }
    start = (1.0 / divided) * start;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return feature_places_.feature(start, std::move(labels));
  }

  // Which loops can be joined across their divided sides.
  void find_joints() {
    std::unordered_map<std::uint64_t, std::array<std::int32_t, 2>> pairs;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
        if (!sides_[i][k].is_divided) continue;
        const std::uint64_t key = side_key(loop(i).corners[k], loop(i).corners[next(i, k)]);
        const auto [found, is_new] =
            pairs.try_emplace(key, std::array<std::int32_t, 2>{static_cast<std::int32_t>(i), -1});
        if (!is_new) found->second[1] = static_cast<std::int32_t>(i);
      }
    }
    std::unordered_map<std::uint64_t, int> joints;
    for (const auto& [key, loops] : pairs) {
      if (loops[1] >= 0) ++joints[side_key(loops[0], loops[1])];
    }
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
        if (!sides_[i][k].is_divided) continue;
        const auto& loops = pairs[side_key(loop(i).corners[k], loop(i).corners[next(i, k)])];
        const auto self = static_cast<std::int32_t>(i);
        const std::int32_t other = loops[0] == self ? loops[1] : loops[0];
        if (other < 0 || other == self || joints[side_key(self, other)] != 1) continue;
        sides_[i][k].other = other;
      }
    }
  }

  bool is_near(const Triangle& triangle) const {
    return std::any_of(triangle.begin(), triangle.end(), [&](std::int32_t corner) {
      const auto v = static_cast<std::size_t>(corner);
      return v < samples_.index.size() && samples_.index[v] >= 0;
    });
  }

  std::int32_t label_of(std::int32_t vertex) const {
    const SourcePoint* sample = samples_.of(vertex);
    return sample != nullptr ? sample->label : -1;
  }

  std::int32_t label_of(const Triangle& triangle) const {
    for (const std::int32_t corner : triangle) {
      if (static_cast<std::size_t>(corner) >= samples_.index.size()) continue;
      const std::int32_t label = label_of(corner);
      if (label >= 0) return label;
    }
    return -1;
  }

  // Loops that are joined and whose features are at one place have one vertex. Where mesh edges
  // would then be there twice, they have not.
  void assemble(FacetedMesh* mesh) {
    do {
      find_merged();
      assemble_merged(mesh);
    } while (unmerge_repeated(*mesh));
  }

  void find_merged() {
    const std::vector<std::size_t> before = merged_;
    DisjointSets<std::size_t> merged(features_.size());
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (is_sharp_[i] == 0 || is_single_[i] != 0) continue;
      for (const std::int32_t joint : joined(i)) {
        const auto other = static_cast<std::size_t>(joint);
        if (other < i || is_single_[other] != 0) continue;
        if (length(features_[i].position - features_[other].position) > kTooClose * cell_) continue;
        merged.join(i, other);
      }
    }
    merged_ = std::move(merged).roots();
    // What becomes of one loop becomes of all that have its vertex.
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (!before.empty() && before[i] != merged_[i]) is_changed_loop_[i] = 1;
      if (is_changed_loop_[i] != 0) is_changed_loop_[merged_[i]] = 1;
    }
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (merged_[i] != i && is_changed_loop_[merged_[i]] != 0) is_changed_loop_[i] = 1;
    }
  }

  // The vertices of loops that have one together, and the first of these.
  void find_shared_vertices() {
    shared_.clear();
    members_.clear();
    for (std::size_t i = 0; i < merged_.size(); ++i) {
      if (merged_[i] == i || is_sharp_[i] == 0) continue;
      shared_[places_[i]] = merged_[i];
      members_[merged_[i]].push_back(i);
    }
  }

  bool unmerge(std::size_t root) {
    std::vector<std::size_t> loops = {root};
    const auto found = members_.find(root);
    if (found != members_.end())
      loops.insert(loops.end(), found->second.begin(), found->second.end());
    bool is_any = false;
    for (const std::size_t i : loops) {
      is_any = is_any || is_single_[i] == 0;
      is_single_[i] = 1;
      is_changed_loop_[i] = 1;
    }
    return is_any;
  }

  bool unmerge_repeated(const FacetedMesh& mesh) {
    find_shared_vertices();
    if (shared_.empty()) return false;
    std::unordered_map<std::uint64_t, std::size_t> sides;
    bool is_any = false;
    for (std::size_t t = looped_.triangles.size(); t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t from = mesh.triangles[t][k];
        const std::int32_t to = mesh.triangles[t][(k + 1) % 3];
        if (!shared_.contains(from) && !shared_.contains(to)) continue;
        const std::uint64_t key =
            (static_cast<std::uint64_t>(from) << 32U) | static_cast<std::uint32_t>(to);
        const auto [found, is_new] = sides.try_emplace(key, t);
        if (is_new) continue;
        for (const std::size_t u : {t, found->second}) {
          for (const std::int32_t owner : owners_of(u)) {
            if (owner < 0) continue;
            is_any = unmerge(merged_[static_cast<std::size_t>(owner)]) || is_any;
          }
        }
      }
    }
    return unmerge_pinched(mesh) || is_any;
  }

  // Takes apart what has been merged to a vertex with several fans of triangles.
  bool unmerge_pinched(const FacetedMesh& mesh) {
    std::unordered_map<std::int32_t, std::vector<std::array<std::int32_t, 2>>> links;
    for (std::size_t t = looped_.triangles.size(); t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (!shared_.contains(mesh.triangles[t][k])) continue;
        links[mesh.triangles[t][k]].push_back(
            {mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]});
      }
    }
    bool is_any = false;
    for (const auto& [vertex, link] : links) {
      std::int32_t at = link[0][1];
      std::size_t steps = 1;
      while (at != link[0][0] && steps <= link.size()) {
        const auto next =
            std::find_if(link.begin(), link.end(), [&](const auto& side) { return side[0] == at; });
        if (next == link.end()) break;
        at = (*next)[1];
        ++steps;
      }
      if (at == link[0][0] && steps == link.size()) continue;
      is_any = unmerge(shared_[vertex]) || is_any;
    }
    return is_any;
  }

  // The triangles of sharp loops, behind all others.
  void assemble_merged(FacetedMesh* result) {
    FacetedMesh& mesh = *result;
    mesh.positions.resize(looped_.positions.size());
    mesh.kinds.resize(looped_.positions.size());
    mesh.triangles.resize(looped_.triangles.size());
    mesh.labels.resize(looped_.triangles.size());
    owners_.clear();
    std::vector<std::int32_t>& places = places_;
    places.assign(features_.size(), -1);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (is_sharp_[i] == 0) continue;
      if (merged_[i] != i) {
        places[i] = places[merged_[i]];
        continue;
      }
      places[i] = static_cast<std::int32_t>(mesh.positions.size());
      mesh.positions.push_back(features_[i].position);
      mesh.kinds.push_back(VertexKind::kEdge);
    }
    std::vector<std::uint8_t> joints(mesh.positions.size(), 0);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (is_sharp_[i] == 0) continue;
      const auto place = static_cast<std::size_t>(places[i]);
      if (features_[i].is_corner) mesh.kinds[place] = VertexKind::kCorner;
      for (const std::int32_t other : joined(i)) {
        if (merged_[static_cast<std::size_t>(other)] != merged_[i]) ++joints[place];
      }
    }
    for (std::size_t v = looped_.positions.size(); v < mesh.positions.size(); ++v) {
      if (joints[v] != 2) mesh.kinds[v] = VertexKind::kCorner;
    }
    const auto add = [&](const Triangle& triangle, std::int32_t label, std::size_t i,
                         std::int32_t other) {
      mesh.triangles.push_back(triangle);
      mesh.labels.push_back(label);
      owners_.push_back({static_cast<std::int32_t>(i), other});
    };
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (is_sharp_[i] == 0) {
        for (std::size_t t = loop(i).first; t < loop(i).end; ++t) {
          const Triangle& triangle = looped_.loop_triangles[t];
          add(triangle, label_of(triangle), i, -1);
        }
        continue;
      }
      for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
        const std::int32_t from = loop(i).corners[k];
        const std::int32_t to = loop(i).corners[next(i, k)];
        if (is_joined(i, k)) {
          const std::int32_t other = sides_[i][k].other;
          const std::int32_t place = places[static_cast<std::size_t>(other)];
          if (place != places[i]) add({places[i], from, place}, label_of(from), i, other);
        } else {
          const Triangle triangle = {places[i], from, to};
          add(triangle, label_of(triangle), i, -1);
        }
      }
    }
  }

  // The sharp loops that a triangle is made of.
  std::array<std::int32_t, 2> owners_of(std::size_t triangle) const {
    if (triangle < looped_.triangles.size()) return {-1, -1};
    return owners_[triangle - looped_.triangles.size()];
  }

  bool is_joined(std::size_t i, std::size_t k) const {
    const std::int32_t other = sides_[i][k].other;
    return other >= 0 && is_sharp_[static_cast<std::size_t>(other)] != 0;
  }

  // Of the suspect triangles with any near edges; only those are looked at whose places these
  // reach.
  std::vector<std::array<std::uint32_t, 2>> intersections(
      const FacetedMesh& mesh, const std::vector<std::uint8_t>& is_suspect,
      const Progress& progress) const {
    const double side = kPlaceCells * cell_;
    std::unordered_set<std::uint64_t> places;
    for (std::size_t t = far_count_; t < mesh.triangles.size(); ++t) {
      if (is_suspect[t] == 0) continue;
      for_places(mesh, t, side, [&](std::uint64_t place) { places.insert(place); });
    }
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> suspects;
    std::vector<std::uint32_t> numbers;
    for (std::size_t t = far_count_; t < mesh.triangles.size(); ++t) {
      bool is_reached = is_suspect[t] != 0;
      if (!is_reached) {
        for_places(mesh, t, side,
                   [&](std::uint64_t place) { is_reached = is_reached || places.contains(place); });
      }
      if (!is_reached) continue;
      triangles.push_back(mesh.triangles[t]);
      suspects.push_back(is_suspect[t]);
      numbers.push_back(static_cast<std::uint32_t>(t));
    }
    if (places.empty()) return {};
    std::vector<std::array<std::uint32_t, 2>> pairs =
        intersecting_triangles({mesh.positions, triangles}, suspects, progress, threads_);
    for (auto& pair : pairs) {
      for (std::uint32_t& t : pair) t = numbers[t];
    }
    return pairs;
  }

  // Calls visit(number) for the cubes of a grid that a triangle's box overlaps.
  template <typename Visit>
  static void for_places(const FacetedMesh& mesh, std::size_t t, double side, const Visit& visit) {
    constexpr std::int64_t kBias = std::int64_t{1} << 20;
    std::array<std::int64_t, 3> low;
    std::array<std::int64_t, 3> high;
    for (std::size_t a = 0; a < 3; ++a) {
      double least = std::numeric_limits<double>::infinity();
      double most = -least;
      for (const std::int32_t corner : mesh.triangles[t]) {
        const double x = mesh.positions[static_cast<std::size_t>(corner)][a];
        least = std::min(least, x);
        most = std::max(most, x);
      }
      low[a] = static_cast<std::int64_t>(std::floor(least / side)) + kBias;
      high[a] = static_cast<std::int64_t>(std::floor(most / side)) + kBias;
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          visit((static_cast<std::uint64_t>(x) << 42U) | (static_cast<std::uint64_t>(y) << 21U) |
                static_cast<std::uint64_t>(z));
        }
      }
    }
  }

  // Takes the edges out of loops that have intersecting triangles, and puts vertices back where no
  // loop is to blame; returns whether there were any.
  bool drop_intersecting(FacetedMesh* result, const Progress& progress) {
    const FacetedMesh& mesh = *result;
    std::vector<std::uint8_t> is_suspect(mesh.triangles.size(), 0);
    for (std::size_t t = far_count_; t < mesh.triangles.size(); ++t) {
      for (const std::int32_t owner : owners_of(t)) {
        if (owner >= 0 && is_changed_loop_[static_cast<std::size_t>(owner)] != 0) is_suspect[t] = 1;
      }
      for (const std::int32_t corner : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(corner);
        if (v < is_changed_vertex_.size() && is_changed_vertex_[v] != 0) is_suspect[t] = 1;
      }
    }
    std::fill(is_changed_loop_.begin(), is_changed_loop_.end(), std::uint8_t{0});
    std::fill(is_changed_vertex_.begin(), is_changed_vertex_.end(), std::uint8_t{0});
    std::vector<std::array<std::uint32_t, 2>> pairs = intersections(mesh, is_suspect, progress);
    // Triangles of a plane that overlap need not intersect, by rounding: then one is upside down.
    for (std::size_t t = far_count_; t < mesh.triangles.size(); ++t) {
      const auto number = static_cast<std::uint32_t>(t);
      if (is_suspect[t] != 0 && is_upside_down(mesh, t)) pairs.push_back({number, number});
    }
    bool has_dropped = false;
    // The loops with the most intersections first, until none are left.
    std::vector<std::pair<std::int32_t, std::size_t>> blamed;  // loop, pair
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      bool has_moved = false;
      for (const std::uint32_t t : pairs[p]) {
        for (const std::int32_t corner : mesh.triangles[t]) {
          has_moved = put_on_line(corner, result) || has_moved;
        }
      }
      has_dropped = has_dropped || has_moved;
      if (has_moved) continue;
      Labels loops;
      for (const std::uint32_t t : pairs[p]) {
        for (const std::int32_t owner : owners_of(t)) {
          if (owner >= 0 && is_sharp_[static_cast<std::size_t>(owner)] != 0) loops.push_back(owner);
        }
      }
      std::sort(loops.begin(), loops.end());
      loops.erase(std::unique(loops.begin(), loops.end()), loops.end());
      for (const std::int32_t i : loops) blamed.emplace_back(i, p);
      if (!loops.empty()) continue;
      for (const std::uint32_t t : pairs[p]) {
        for (const std::int32_t corner : mesh.triangles[t]) {
          if (!is_moved(corner)) continue;
          const auto v = static_cast<std::size_t>(corner);
          looped_.positions[v] = crossings_[v];
          result->positions[v] = crossings_[v];
          is_changed_vertex_[v] = 1;
          has_dropped = true;
        }
      }
    }
    has_dropped = relax(blamed) || has_dropped;
    drop_fewest(std::move(blamed), pairs.size());
    has_dropped = has_dropped || !dropped_.empty();
    for (const std::size_t i : dropped_) {
      // What cannot reach the edge gets as close to it as it can.
      Feature& feature = features_[i];
      feature.position = 0.5 * (feature.start + feature.position);
      if (++halvings_[i] > kMostHalvings) is_sharp_[i] = 0;
      is_changed_loop_[i] = 1;
      // Those beside it lose a joint.
      for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
        const std::int32_t other = sides_[i][k].other;
        if (other >= 0) is_changed_loop_[static_cast<std::size_t>(other)] = 1;
      }
    }
    dropped_.clear();
    return has_dropped;
  }

  // Where an edge is far from the loops, as at the tip of a thin wedge, their nearest points of it
  // may be out of order. Moves those of the loops, and what is next to them, to between their
  // neighbours'; loops that have been moved often enough are left. Returns whether there are
  // others.
  bool relax(std::vector<std::pair<std::int32_t, std::size_t>>& blamed) {
    std::vector<std::size_t> moving;
    std::erase_if(blamed, [&](const auto& entry) {
      const auto i = static_cast<std::size_t>(entry.first);
      if (attempts_[i] >= kMostAttempts) return false;
      moving.push_back(i);
      return true;
    });
    std::sort(moving.begin(), moving.end());
    moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
    for (const std::size_t i : moving) ++attempts_[i];
    const bool has_moving = !moving.empty();
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<std::size_t> wider = moving;
      for (const std::size_t i : moving) {
        for (const std::int32_t other : joined(i)) {
          wider.push_back(static_cast<std::size_t>(other));
        }
      }
      std::sort(wider.begin(), wider.end());
      wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
      moving.swap(wider);
    }
    std::vector<Vector3> moved(moving.size());
    for (int step = 0; step < kSmoothings; ++step) {
      for (std::size_t m = 0; m < moving.size(); ++m) {
        const Feature& feature = features_[moving[m]];
        moved[m] = feature.position;
        const std::vector<std::int32_t> others = joined(moving[m]);
        if (feature.is_corner || others.size() != 2) continue;
        const Vector3 middle = 0.5 * (features_[static_cast<std::size_t>(others[0])].position +
                                      features_[static_cast<std::size_t>(others[1])].position);
        const std::optional<Vector3> found =
            feature_places_.place(0.5 * (feature.position + middle), feature.labels);
        if (found) moved[m] = *found;
      }
      for (std::size_t m = 0; m < moving.size(); ++m) features_[moving[m]].position = moved[m];
    }
    for (const std::size_t i : moving) is_changed_loop_[i] = 1;
    return has_moving;
  }

  std::vector<std::int32_t> joined(std::size_t i) const {
    std::vector<std::int32_t> others;
    for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
      if (is_joined(i, k)) others.push_back(sides_[i][k].other);
    }
    return others;
  }

  // Of loops and the pairs that they are in: loops so that none is left, the one with the most
  // first.
  void drop_fewest(std::vector<std::pair<std::int32_t, std::size_t>> blamed, std::size_t count) {
    std::sort(blamed.begin(), blamed.end());
    std::vector<std::size_t> firsts;
    for (std::size_t i = 0; i < blamed.size(); ++i) {
      if (i == 0 || blamed[i].first != blamed[i - 1].first) firsts.push_back(i);
    }
    firsts.push_back(blamed.size());
    std::vector<std::uint8_t> is_settled(count, 0);
    const auto open_of = [&](std::size_t f) {
      std::size_t open = 0;
      for (std::size_t i = firsts[f]; i < firsts[f + 1]; ++i) {
        open += is_settled[blamed[i].second] == 0 ? 1U : 0U;
      }
      return open;
    };
    // Counts only fall: one that is still right at the top is the highest.
    struct Entry {
      std::size_t open;
      std::size_t first;

      bool operator<(const Entry& other) const {
        return open != other.open ? open < other.open : first > other.first;
      }
    };
    std::priority_queue<Entry> queue;
    for (std::size_t f = 0; f + 1 < firsts.size(); ++f) queue.push({open_of(f), f});
    while (!queue.empty()) {
      const Entry top = queue.top();
      queue.pop();
      const std::size_t open = open_of(top.first);
      if (open == 0) continue;
      if (open < top.open) {
        queue.push({open, top.first});
        continue;
      }
      dropped_.push_back(static_cast<std::size_t>(blamed[firsts[top.first]].first));
      for (std::size_t i = firsts[top.first]; i < firsts[top.first + 1]; ++i) {
        is_settled[blamed[i].second] = 1;
      }
    }
  }

  // Of each label, whether its normals point into the shape, as those of what was cut away do.
  void find_turned() {
    std::unordered_map<std::int32_t, double> facing;
    for (std::size_t i = 0; i < samples_.samples.size(); ++i) {
      facing[samples_.samples[i].label] += static_cast<double>(samples_.facing[i]);
    }
    for (const auto& [label, sum] : facing) {
      if (sum < 0.0) turned_.insert(label);
    }
  }

  bool is_upside_down(const FacetedMesh& mesh, std::size_t t) const {
    constexpr double kLeast = 0.05;
    const Triangle& corners = mesh.triangles[t];
    const auto at = [&](std::size_t i) -> const Vector3& {
      return mesh.positions[static_cast<std::size_t>(corners[i])];
    };
    const Vector3 normal = cross(at(1) - at(0), at(2) - at(0));
    // Nor may it be one that rounding in space makes flat.
    constexpr double kLeastArea = 1e-12;  // of a cell's face
    if (length(normal) < kLeastArea * cell_ * cell_) return true;
    bool is_any = false;
    for (const std::int32_t corner : corners) {
      if (static_cast<std::size_t>(corner) >= samples_.index.size()) continue;
      const SourcePoint* sample = samples_.of(corner);
      // Those across an edge have no side of their own.
      if (sample == nullptr || sample->label != mesh.labels[t]) return false;
      const double height = dot(normal, sample->normal);
      if ((turned_.contains(sample->label) ? -height : height) >= kLeast * length(normal)) {
        return false;
      }
      is_any = true;
    }
    return is_any;
  }

  bool put_on_line(std::int32_t vertex, FacetedMesh* mesh) {
    const auto v = static_cast<std::size_t>(vertex);
    if (v >= samples_.index.size() || samples_.index[v] < 0) return false;
    const Vector3& on_line = samples_.on_lines[static_cast<std::size_t>(samples_.index[v])];
    const Vector3& sampled = samples_.samples[static_cast<std::size_t>(samples_.index[v])].position;
    if (looped_.positions[v] != sampled || sampled == on_line) return false;
    looped_.positions[v] = on_line;
    mesh->positions[v] = on_line;
    is_changed_vertex_[v] = 1;
    return true;
  }

  bool is_moved(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return v < crossings_.size() && looped_.positions[v] != crossings_[v];
  }

  LoopedMesh looped_;
  const std::vector<Vector3>& crossings_;
  const FeatureSurface& surface_;
  const VertexSamples& samples_;
  int threads_;
  double cell_;
  FeaturePlaces feature_places_;
  std::vector<std::array<Side, 12>> sides_;
  std::vector<Feature> features_;
  std::vector<std::uint8_t> is_sharp_;
  std::vector<std::uint8_t> is_changed_loop_;  // since intersections were looked for
  std::vector<std::uint8_t> is_changed_vertex_;
  std::unordered_set<std::int32_t> turned_;
  std::vector<std::uint8_t> attempts_;
  std::vector<std::uint8_t> halvings_;
  std::vector<std::uint8_t> is_single_;  // not to be merged
  std::vector<std::int32_t> places_;     // of loops, their vertices
  std::vector<std::size_t> merged_;      // the first of the loops that have one vertex
  std::size_t far_count_ = 0;            // of the triangles, those that are not near edges
  std::unordered_map<std::int32_t, std::size_t> shared_;  // vertices, and the first of their loops
  std::unordered_map<std::size_t, std::vector<std::size_t>> members_;  // the other loops
  std::vector<std::size_t> dropped_;
  std::vector<std::array<std::int32_t, 2>> owners_;  // of triangles: loops
};
}  // namespace

bool are_divided(const FeatureSurface& surface, const VertexSamples& samples, std::int32_t a,
                 std::int32_t b) {
  const SourcePoint* p = samples.of(a);
  const SourcePoint* q = samples.of(b);
  if (p == nullptr || q == nullptr) return false;
  if (p->label != q->label) return true;
  if (dot(p->normal, q->normal) >= kSharpCosine) return false;
  const Vector3 middle = 0.5 * (p->position + q->position);
  return surface.nearest_border(middle, kRidgeReach * surface.cell(), p->label, p->label)
      .has_value();
}

FacetedMesh sharpen(LoopedMesh looped, const std::vector<Vector3>& crossings,
                    const FeatureSurface& surface, const VertexSamples& samples,
                    const Progress& progress, int threads) {
  return Sharpener(std::move(looped), crossings, surface, samples, threads).run(progress);
}

}  // namespace prefilter
