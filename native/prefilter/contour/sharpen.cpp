#include "prefilter/contour/sharpen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/remesh/intersections.h"

namespace prefilter {
namespace {

constexpr double kSharpCosine = 0.9396926207859084;  // 20 degrees
// All in cells.
constexpr double kRidgeReach = 1.5;
constexpr double kFeatureReach = 2.0;
constexpr double kRegionReach = 3.0;
constexpr double kCornerReach = 1.0;
constexpr double kSettled = 1e-7;
constexpr double kTooClose = 0.02;
constexpr int kMostSteps = 12;
constexpr std::int64_t kLoopsPerTask = 64;

using Triangle = std::array<std::int32_t, 3>;
using Labels = std::vector<std::int32_t>;

// The symmetric matrix with these columns' products, plus a little, times the result is `right`.
std::vector<double> solve_products(const std::vector<Vector3>& normals, std::vector<double> right) {
  constexpr double kRidge = 1e-4;
  const std::size_t n = normals.size();
  std::vector<double> m(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) m[i * n + j] = dot(normals[i], normals[j]);
    m[i * n + i] += kRidge;
  }
  // Cholesky would do; elimination without pivots is as stable for such a matrix.
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = m[k * n + i] / m[i * n + i];
      for (std::size_t j = i; j < n; ++j) m[k * n + j] -= factor * m[i * n + j];
      right[k] -= factor * right[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) right[i] -= m[i * n + j] * right[j];
    right[i] /= m[i * n + i];
  }
  return right;
}

struct Feature {
  Vector3 position{};
  Labels labels;
  bool is_corner = false;
};

std::uint64_t side_key(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32U) | static_cast<std::uint32_t>(high);
}

class Sharpener {
 public:
  Sharpener(LoopedMesh looped, const std::vector<Vector3>& crossings, const SourceSurface& surface,
            const VertexSamples& samples, int threads)
      : looped_(std::move(looped)),
        crossings_(crossings),
        surface_(surface),
        samples_(samples),
        threads_(threads),
        cell_(surface.cell()) {}

  FacetedMesh run(const Progress& progress) {
    find_sides();
    place_features(progress.part(0.1, 0.5));
    claim_corners();
    find_joints();
    const Progress checking = progress.part(0.6, 1.0);
    FacetedMesh mesh = assemble();
    for (int round = 0; drop_intersecting(mesh, checking); ++round) mesh = assemble();
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

  void find_sides() {
    sides_.resize(looped_.loops.size());
    const auto find_some = [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
          sides_[i][k].is_divided =
              are_divided(surface_, samples_, loop(i).corners[k], loop(i).corners[next(i, k)]);
        }
      }
    };
    parallel_ranges(static_cast<std::int64_t>(sides_.size()), kLoopsPerTask, threads_, Progress(),
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
  }

  Feature feature_of(std::size_t i) const {
    Feature feature;
    Vector3 start{};
    int divided = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
      const std::int32_t corner = loop(i).corners[k];
      if (const SourcePoint* sample = samples_.of(corner)) feature.labels.push_back(sample->label);
      if (!sides_[i][k].is_divided) continue;
      start = start + 0.5 * (position(corner) + position(loop(i).corners[next(i, k)]));
      ++divided;
    }
    start = (1.0 / divided) * start;
    Labels& labels = feature.labels;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    feature.position = start;
    std::optional<Vector3> found;
    if (labels.size() > 2) {
      found = corner_near(start, labels);
      feature.is_corner = true;
    } else {
      found = surface_.nearest_border(start, kFeatureReach * cell_, labels.front(), labels.back());
    }
    if (!found && labels.size() > 1) found = meeting_of(start, labels);
    if (found) feature.position = *found;
    return feature;
  }

  // The corner of these regions, or more, next to a point.
  std::optional<Vector3> corner_near(const Vector3& start, const Labels& labels) const {
    std::optional<Vector3> found;
    double least = kFeatureReach * cell_;
    for (const RegionCorner& corner : surface_.regions().corners) {
      const Vector3& at = surface_.regions().positions[static_cast<std::size_t>(corner.vertex)];
      const double distance = length(at - start);
      if (distance >= least) continue;
      if (!std::includes(corner.labels.begin(), corner.labels.end(), labels.begin(),
                         labels.end())) {
        continue;
      }
      least = distance;
      found = at;
    }
    return found;
  }

  // Where the surfaces of regions meet, from a point on: least steps onto all their planes.
  std::optional<Vector3> meeting_of(const Vector3& start, const Labels& labels) const {
    Vector3 at = start;
    for (int step = 0; step < kMostSteps; ++step) {
      std::vector<Vector3> normals;
      std::vector<double> heights;
      for (const std::int32_t label : labels) {
        const std::optional<SourcePoint> near = surface_.nearest(at, kRegionReach * cell_, label);
        if (!near) continue;
        normals.push_back(near->normal);
        heights.push_back(dot(near->normal, near->position - at));
      }
      if (normals.empty()) return std::nullopt;
      const std::vector<double> factors = solve_products(normals, heights);
      Vector3 move{};
      for (std::size_t i = 0; i < normals.size(); ++i) move = move + factors[i] * normals[i];
      at = at + move;
      if (length(at - start) > kFeatureReach * cell_) return std::nullopt;
      if (length(move) < kSettled * cell_) break;
    }
    return at;
  }

  // Corners of the shape that no loop has found get the nearest vertex of an edge that ends there.
  void claim_corners() {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    grid_.clear();
    for (std::size_t i = 0; i < features_.size(); ++i)
      grid_[place_of(features_[i].position)].push_back(i);
    std::vector<std::uint8_t> is_taken(features_.size(), 0);
    for (const RegionCorner& corner : surface_.regions().corners) {
      const Vector3& at = surface_.regions().positions[static_cast<std::size_t>(corner.vertex)];
      std::size_t best = features_.size();
      double least = kCornerReach * cell_;
      for_around(at, [&](std::size_t i) {
        const Labels& labels = features_[i].labels;
        const double distance = length(features_[i].position - at);
        if (is_taken[i] != 0 || distance > least || (distance == least && i > best)) return;
        if (!std::includes(corner.labels.begin(), corner.labels.end(), labels.begin(),
                           labels.end())) {
          return;
        }
        best = i;
        least = distance;
      });
      if (best == features_.size()) continue;
      is_taken[best] = 1;
      features_[best].position = at;
      features_[best].is_corner = true;
    }
  }

  std::array<std::int64_t, 3> place_of(const Vector3& p) const {
    std::array<std::int64_t, 3> place;
    for (std::size_t a = 0; a < 3; ++a)
      place[a] = static_cast<std::int64_t>(std::floor(p[a] / cell_));
    return place;
  }
  template <typename Visit>
  void for_around(const Vector3& p, const Visit& visit) const {
    const std::array<std::int64_t, 3> place = place_of(p);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = grid_.find({place[0] + x, place[1] + y, place[2] + z});
          if (found == grid_.end()) continue;
          for (const std::size_t i : found->second) visit(i);
        }
      }
    }
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

  FacetedMesh assemble() {
    FacetedMesh mesh;
    mesh.positions = looped_.positions;
    mesh.triangles = looped_.triangles;
    mesh.kinds.assign(mesh.positions.size(), VertexKind::kSurface);
    owners_.assign(mesh.triangles.size(), {-1, -1});
    for (const Triangle& triangle : mesh.triangles) mesh.labels.push_back(label_of(triangle));
    const auto base = static_cast<std::int32_t>(mesh.positions.size());
    std::vector<std::int32_t> places(features_.size(), -1);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (is_sharp_[i] == 0) continue;
      places[i] = static_cast<std::int32_t>(mesh.positions.size());
      mesh.positions.push_back(features_[i].position);
      int joints = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(loop(i).count); ++k) {
        joints += is_joined(i, k) ? 1 : 0;
      }
      mesh.kinds.push_back(joints == 2 && !features_[i].is_corner ? VertexKind::kEdge
                                                                  : VertexKind::kCorner);
    }
    (void)base;
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
          add({places[i], from, places[static_cast<std::size_t>(other)]}, label_of(from), i, other);
        } else {
          const Triangle triangle = {places[i], from, to};
          add(triangle, label_of(triangle), i, -1);
        }
      }
    }
    return mesh;
  }

  bool is_joined(std::size_t i, std::size_t k) const {
    const std::int32_t other = sides_[i][k].other;
    return other >= 0 && is_sharp_[static_cast<std::size_t>(other)] != 0;
  }

  // Takes the edges out of loops that have intersecting triangles, and puts vertices back where no
  // loop is to blame; returns whether there were any.
  bool drop_intersecting(const FacetedMesh& mesh, const Progress& progress) {
    std::vector<std::uint8_t> is_suspect(mesh.triangles.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      is_suspect[t] = owners_[t][0] >= 0 ? 1 : 0;
      for (const std::int32_t corner : mesh.triangles[t]) {
        if (is_moved(corner)) is_suspect[t] = 1;
      }
    }
    const auto pairs =
        intersecting_triangles({mesh.positions, mesh.triangles}, is_suspect, progress, threads_);
    bool has_dropped = false;
    for (const auto& pair : pairs) {
      bool has_loop = false;
      for (const std::uint32_t t : pair) {
        for (const std::int32_t owner : owners_[t]) {
          if (owner < 0 || is_sharp_[static_cast<std::size_t>(owner)] == 0) continue;
          dropped_.push_back(static_cast<std::size_t>(owner));
          has_loop = true;
        }
      }
      if (has_loop) continue;
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : mesh.triangles[t]) {
          if (!is_moved(corner)) continue;
          looped_.positions[static_cast<std::size_t>(corner)] =
              crossings_[static_cast<std::size_t>(corner)];
          has_dropped = true;
        }
      }
    }
    has_dropped = has_dropped || !dropped_.empty();
    for (const std::size_t i : dropped_) is_sharp_[i] = 0;
    dropped_.clear();
    return has_dropped;
  }

  bool is_moved(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return v < crossings_.size() && looped_.positions[v] != crossings_[v];
  }

  struct PlaceHash {
    std::size_t operator()(const std::array<std::int64_t, 3>& place) const {
      std::uint64_t hash = 0;
      for (const std::int64_t p : place) {
        hash = (hash ^ static_cast<std::uint64_t>(p)) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29U;
      }
      return hash;
    }
  };

  LoopedMesh looped_;
  const std::vector<Vector3>& crossings_;
  const SourceSurface& surface_;
  const VertexSamples& samples_;
  int threads_;
  double cell_;
  std::vector<std::array<Side, 12>> sides_;
  std::vector<Feature> features_;
  std::vector<std::uint8_t> is_sharp_;
  std::vector<std::size_t> dropped_;
  std::vector<std::array<std::int32_t, 2>> owners_;  // of triangles: loops
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::size_t>, PlaceHash> grid_;
};
}  // namespace

bool are_divided(const SourceSurface& surface, const VertexSamples& samples, std::int32_t a,
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
                    const SourceSurface& surface, const VertexSamples& samples,
                    const Progress& progress, int threads) {
  return Sharpener(std::move(looped), crossings, surface, samples, threads).run(progress);
}

}  // namespace prefilter
