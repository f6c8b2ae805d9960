// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/dual_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/relax_places.h"

namespace prefilter {
namespace {

constexpr std::int64_t kDualPlacesLoopsPerTask = 256;
// cells; maximum height of a vertex above the center of its loop
constexpr double kMostHeight = 0.5;
// minimum cosine between the normals of a loop that counts as smooth
constexpr double kDualPlacesLeastCosine = 0.5;
constexpr double kSameCorner = 1e-3;  // cells

Vector3 unit(const Vector3& v) {
  const double size = std::sqrt(dot(v, v));
  return size > 0.0 ? (1.0 / size) * v : Vector3{};
}

class Placer {
 public:
  Placer(const DualLoops& loops, const std::vector<Vector3>& positions, const EdgeSource& edges,
         const FeaturePlaces* features, double cell)
      : loops_(loops), positions_(positions), edges_(edges), features_(features), cell_(cell) {}

  static Vector3 middle(std::span<const std::int32_t> loop, const std::vector<Vector3>& positions) {
    Vector3 sum{};
    for (const std::int32_t v : loop) sum = sum + positions[static_cast<std::size_t>(v)];
    return (1.0 / static_cast<double>(loop.size())) * sum;
  }

  // Normal of the surface at a vertex: as sampled, or from the positions of the loops around it.
  Vector3 normal(std::size_t vertex, const std::vector<Vector3>& around) const {
    const auto& quad = loops_.quads[vertex];
    const auto at = [&](std::size_t k) -> const Vector3& {
      return around[static_cast<std::size_t>(quad[k])];
    };
    const Vector3 found = unit(cross(at(2) - at(0), at(3) - at(1)));
    const SourcePoint* sample = sample_of(static_cast<std::int32_t>(vertex));
    if (sample == nullptr) return found;
    return dot(sample->normal, found) < 0.0 ? -1.0 * sample->normal : sample->normal;
  }

  // `normals` are the normals at the vertices.
  Vector3 smooth(std::size_t i, const std::vector<Vector3>& middles,
                 const std::vector<Vector3>& normals) const {
    const std::span<const std::int32_t> loop = loops_.loop(i);
    Vector3 up{};
    for (const std::int32_t v : loop) up = up + normals[static_cast<std::size_t>(v)];
    up = unit(up);
    double height = 0.0;
    for (const std::int32_t v : loop) {
      const Vector3& n = normals[static_cast<std::size_t>(v)];
      const double cosine = dot(n, up);
      if (cosine < kDualPlacesLeastCosine) return middles[i];
      height += dot(n, positions_[static_cast<std::size_t>(v)] - middles[i]) / cosine;
    }
    height *= 0.5 / static_cast<double>(loop.size());
    return middles[i] + std::clamp(height, -kMostHeight * cell_, kMostHeight * cell_) * up;
  }

  // None if no edge of the shape passes through the loop.
  std::optional<Feature> feature(std::size_t i) const {
    if (features_ == nullptr) return std::nullopt;
    const std::span<const std::int32_t> loop = loops_.loop(i);
    const auto is_divided = [&](std::size_t k) {
      return are_divided(*edges_.surface(), edges_.samples, loop[k], loop[(k + 1) % loop.size()]);
    };
    return features_->of_loop(loop, positions_, edges_.samples, is_divided);
  }

  // The point next to the start where two of the regions of a corner intersect.
  Feature off_corner(const Feature& feature) const {
    Feature best = feature;
    best.position = feature.start;
    double least = 2.0 * cell_;
    for (std::size_t i = 0; i < feature.labels.size(); ++i) {
      for (std::size_t j = i + 1; j < feature.labels.size(); ++j) {
        const std::optional<Vector3> found =
            features_->place(feature.start, {feature.labels[i], feature.labels[j]});
        if (!found || length(*found - feature.position) < 0.1 * cell_) continue;
        const double distance = length(*found - feature.start);
        if (distance >= least) continue;
        least = distance;
        best.position = *found;
        best.labels = {feature.labels[i], feature.labels[j]};
      }
    }
    best.is_corner = false;
    return best;
  }

  // The two loops beyond the sides that an edge of the shape crosses; none unless there are two.
  std::optional<std::array<std::int32_t, 2>> beside(std::size_t i) const {
    const std::span<const std::int32_t> loop = loops_.loop(i);
    std::array<std::int32_t, 2> found;
    std::size_t count = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::int32_t a = loop[k];
      const std::int32_t b = loop[(k + 1) % loop.size()];
      if (!are_divided(*edges_.surface(), edges_.samples, a, b)) continue;
      if (count == 2) return std::nullopt;
      found[count++] = across(a, b, static_cast<std::int32_t>(i));
    }
    if (count != 2 || found[0] < 0 || found[1] < 0) return std::nullopt;
    return found;
  }

  const FeaturePlaces* features() const { return features_; }

 private:
  // The other loop at the side between two adjacent vertices.
  std::int32_t across(std::int32_t a, std::int32_t b, std::int32_t loop) const {
    const auto& one = loops_.quads[static_cast<std::size_t>(a)];
    const auto& other = loops_.quads[static_cast<std::size_t>(b)];
    for (const std::int32_t l : one) {
      if (l != loop && std::find(other.begin(), other.end(), l) != other.end()) return l;
    }
    return -1;
  }

  const SourcePoint* sample_of(std::int32_t vertex) const {
    return edges_.samples.index.empty() ? nullptr : edges_.samples.of(vertex);
  }

  const DualLoops& loops_;
  const std::vector<Vector3>& positions_;
  const EdgeSource& edges_;
  const FeaturePlaces* features_;
  double cell_;
};

// The center of a dual cell that has an edge with this midpoint.
Vector3 cell_of(const Vector3& middle, std::uint8_t edge, const Vector3& cell) {
  Vector3 found = middle;
  for (unsigned k = 0; k < 2; ++k) {
    const std::size_t axis = (edge / 4U + 1U + k) % 3U;
    found[axis] += ((edge >> k) & 1U) != 0U ? -0.5 * cell[axis] : 0.5 * cell[axis];
  }
  return found;
}

// If several features are at one corner, only the nearest stays there.
void part_corners(const Placer& placer, double cell, std::vector<Feature>* features) {
  PointGrid grid(kSameCorner * cell);
  for (std::size_t i = 0; i < features->size(); ++i) {
    if ((*features)[i].is_corner) grid.add((*features)[i].position, i);
  }
  std::vector<std::size_t> crowded;
  for (std::size_t i = 0; i < features->size(); ++i) {
    const Feature& one = (*features)[i];
    if (!one.is_corner) continue;
    bool is_first = true;
    grid.for_around(one.position, [&](std::size_t j) {
      const Feature& other = (*features)[j];
      if (j == i || length(other.position - one.position) > kSameCorner * cell) return;
      const double mine = length(one.start - one.position);
      const double its = length(other.start - other.position);
      if (its < mine || (its == mine && j < i)) is_first = false;
    });
    if (!is_first) crowded.push_back(i);
  }
  for (const std::size_t i : crowded) (*features)[i] = placer.off_corner((*features)[i]);
}

void place_features(const Placer& placer, double cell, const Run& run, DualPlaces* places) {
  const std::size_t count = places->positions.size();
  std::vector<std::optional<Feature>> found(count);
  parallel_ranges(static_cast<std::int64_t>(count), kDualPlacesLoopsPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto i = static_cast<std::size_t>(begin);
                         i < static_cast<std::size_t>(end); ++i) {
                      found[i] = placer.feature(i);
                    }
                  });
  std::vector<Feature> features;
  std::vector<std::size_t> loops;
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) continue;
    features.push_back(std::move(*found[i]));
    loops.push_back(i);
  }
  placer.features()->claim_corners(&features);
  part_corners(placer, cell, &features);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    places->positions[loops[k]] = features[k].position;
    places->is_sharp[loops[k]] = 1;
    if (features[k].is_corner) {
      places->is_corner[loops[k]] = 1;
      continue;
    }
    const auto beside = placer.beside(loops[k]);
    if (!beside) continue;
    places->on_edge[loops[k]] = static_cast<std::int32_t>(places->edge_vertices.size());
    places->edge_vertices.push_back({std::move(features[k].labels), *beside});
  }
}

// Moves the nearest of the loops around it to the tip of a smooth region.
void place_tips(const DualLoops& loops, const VertexSamples& samples, DualPlaces* places) {
  for (const std::int32_t tip : samples.tips) {
    const Vector3& position = samples.of(tip)->position;
    std::size_t nearest = 0;
    double least = -1.0;
    for (const std::int32_t loop : loops.quads[static_cast<std::size_t>(tip)]) {
      const auto i = static_cast<std::size_t>(loop);
      const double distance = length(places->middles[i] - position);
      if (places->is_sharp[i] != 0 || (least >= 0.0 && distance >= least)) continue;
      least = distance;
      nearest = i;
    }
    if (least < 0.0) continue;
    places->positions[nearest] = position;
    places->is_sharp[nearest] = 1;
  }
}
}  // namespace

DualPlaces dual_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                       const std::vector<Vector3>& halfway, const EdgeSource& edges,
                       const FeaturePlaces* features, const Vector3& cell, const Run& run) {
  const double side = std::min({cell[0], cell[1], cell[2]});
  const Placer placer(loops, positions, edges, features, side);
  DualPlaces places;
  places.middles.resize(loops.size());
  places.safe.resize(loops.size());
  places.cells.resize(loops.size());
  places.positions.resize(loops.size());
  places.is_sharp.assign(loops.size(), 0);
  places.is_corner.assign(loops.size(), 0);
  places.on_edge.assign(loops.size(), -1);
  const auto for_each = [&](std::size_t count, const Run& part, const auto& visit) {
    parallel_ranges(static_cast<std::int64_t>(count), kDualPlacesLoopsPerTask, part,
                    [&](std::int64_t begin, std::int64_t end) {
                      for (auto i = static_cast<std::size_t>(begin);
                           i < static_cast<std::size_t>(end); ++i) {
                        visit(i);
                      }
                    });
  };
  for_each(loops.size(), run.part(0.0, 0.1), [&](std::size_t i) {
    places.middles[i] = Placer::middle(loops.loop(i), positions);
    places.safe[i] = Placer::middle(loops.loop(i), halfway);
    const auto corner = static_cast<std::size_t>(loops.loop(i).front());
    places.cells[i] = cell_of(halfway[corner], loops.first_edges[i], cell);
  });
  // First from normals at the loops' centers, then from normals at the resulting positions.
  std::vector<Vector3> normals(positions.size());
  for (const double begin : {0.1, 0.3}) {
    const std::vector<Vector3>& around = begin == 0.1 ? places.middles : places.positions;
    for_each(normals.size(), run.part(begin, begin + 0.1),
             [&](std::size_t v) { normals[v] = placer.normal(v, around); });
    for_each(loops.size(), run.part(begin + 0.1, begin + 0.2), [&](std::size_t i) {
      places.positions[i] = placer.smooth(i, places.middles, normals);
    });
  }
  if (features != nullptr) {
    place_features(placer, side, run.part(0.5, 0.8), &places);
    place_tips(loops, edges.samples, &places);
  }
  relax_places(loops, positions, normals, run.part(0.8, 1.0), &places);
  return places;
}

}  // namespace prefilter
