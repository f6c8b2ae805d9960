// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/occupancy_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "prefilter/base/parallel.h"
#include "prefilter/wavelet/column_height.h"
#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {
namespace {

// All lengths are in cells.
constexpr double kGoesOn = 0.9;           // cosine: 26 degrees
constexpr double kNearlyParallel = 0.94;  // 20 degrees
constexpr double kJoins = 0.3;
constexpr std::int32_t kLeastRegionCells = 20;
constexpr int kReach = 4;
constexpr double kNotDeep = 1.5;
constexpr double kMostMoved = 0.45;
constexpr double kMostFar = 2.0;
constexpr double kUnexplained = 0.08;
constexpr int kSamples = 6;
constexpr std::size_t kOccupancySurfaceMostRegions = 3;
constexpr std::int64_t kCellsPerTask = 512;

std::uint64_t key_of(const CellCoordinates& at) {
  return (static_cast<std::uint64_t>(at[0]) << 40U) | (static_cast<std::uint64_t>(at[1]) << 20U) |
         static_cast<std::uint64_t>(at[2]);
}

template <typename Visit>
void for_around(const CellCoordinates& at, int reach, const Visit& visit) {
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) visit(CellCoordinates{at[0] + x, at[1] + y, at[2] + z});
    }
  }
}
}  // namespace

OccupancySurface::OccupancySurface(const ContourTree& tree, const RootFrame& frame,
                                   const SurfaceVertices& vertices, const Run& run)
    : tree_(tree), frame_(frame), depth_(tree.cells().depth()) {
  gather(tree.root(), {0, 0, 0}, vertices);
  places_.reserve(cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    places_[key_of(cells_[i].at)] = static_cast<std::uint32_t>(i);
  }
  parallel_ranges(static_cast<std::int64_t>(cells_.size()), kCellsPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t i = begin; i < end; ++i) {
                      SurfaceCell& cell = cells_[static_cast<std::size_t>(i)];
                      cell.is_smooth = fit(&cell);
                    }
                  });
  join_regions();
  near_.resize(cells_.size());
  parallel_ranges(static_cast<std::int64_t>(cells_.size()), kCellsPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto i = static_cast<std::size_t>(begin);
                         i < static_cast<std::size_t>(end); ++i) {
                      if (!cells_[i].is_smooth) near_[i] = candidates(cells_[i].at);
                    }
                  });
  merge_across_gaps();
  mark_edges();
}

void OccupancySurface::gather(const CellNode& node, const CellCoordinates& at,
                              const SurfaceVertices& vertices) {
  if (!node.is_split) return;
  if (node.depth + 1 < depth_) {
    for (int o = 0; o < 8; ++o) gather(tree_.octant(node, o), octant_at(at, o), vertices);
    return;
  }
  const auto level = static_cast<std::size_t>(node.depth);
  const std::uint64_t cuts = vertices.cuts(level, node.octants);
  std::size_t vertex = vertices.first(level, node.octants);
  for (int o = 0; o < 8; ++o) {
    const auto faces = static_cast<std::uint8_t>((cuts >> (6 * o)) & 63U);
    if (faces == 0) continue;
    SurfaceCell cell;
    cell.at = octant_at(at, o);
    cell.first_vertex = vertex;
    cell.faces = faces;
    cells_.push_back(cell);
    vertex += static_cast<std::size_t>(std::popcount(faces));
  }
}

bool OccupancySurface::fit(SurfaceCell* cell) const {
  const CellTree& tree = tree_.cells();
  const CellCoordinates& at = cell->at;
  Vector3 gradient{};
  for (int a = 0; a < 3; ++a) {
    for (const int side : {-1, 1}) {
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          LeafPlace place = at;
          place[static_cast<std::size_t>(a)] += side;
          place[static_cast<std::size_t>((a + 1) % 3)] += x;
          place[static_cast<std::size_t>((a + 2) % 3)] += y;
          gradient[a] += side * static_cast<double>(occupancy_at(tree, depth_, place));
        }
      }
    }
  }
  HeightPatch& patch = cell->patch;
  for (int a = 1; a < 3; ++a) {
    if (std::abs(gradient[a]) > std::abs(gradient[patch.axis])) patch.axis = a;
  }
  patch.is_up = gradient[patch.axis] < 0.0;
  for (int a = 0; a < 3; ++a) patch.center[a] = at[a] + 0.5;
  std::array<std::array<double, 3>, 3> heights;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::optional<float> height = column_height([&](int step) {
        LeafPlace place = at;
        place[static_cast<std::size_t>(patch.axis)] += patch.is_up ? step : -step;
        place[static_cast<std::size_t>((patch.axis + 1) % 3)] += i - 1;
        place[static_cast<std::size_t>((patch.axis + 2) % 3)] += j - 1;
        return occupancy_at(tree, depth_, place);
      });
      if (!height) return false;
      heights[i][j] = static_cast<double>(*height) - 0.5;
    }
  }
  return fit_heights(heights, &patch);
}

const OccupancySurface::SurfaceCell* OccupancySurface::find(const CellCoordinates& at) const {
  for (const int x : at) {
    if (x < 0) return nullptr;
  }
  const auto found = places_.find(key_of(at));
  return found == places_.end() ? nullptr : &cells_[found->second];
}

void OccupancySurface::join_regions() {
  regions_ = DisjointSets<std::int32_t>(cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const SurfaceCell& cell = cells_[i];
    if (!cell.is_smooth) continue;
    for_around(cell.at, 1, [&](const CellCoordinates& at) {
      const SurfaceCell* other = find(at);
      if (other == nullptr || !other->is_smooth || other >= &cell) return;
      if (dot(cell.patch.normal(), other->patch.normal()) < kGoesOn) return;
      if (std::abs(cell.patch.above(other->patch.foot(), nullptr)) > kJoins) return;
      regions_.join(static_cast<std::int32_t>(i), static_cast<std::int32_t>(other - cells_.data()));
    });
  }
  std::vector<std::int32_t> counts(cells_.size(), 0);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].is_smooth)
      ++counts[static_cast<std::size_t>(regions_.root(static_cast<std::int32_t>(i)))];
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    SurfaceCell& cell = cells_[i];
    cell.region = regions_.root(static_cast<std::int32_t>(i));
    cell.is_smooth =
        cell.is_smooth && counts[static_cast<std::size_t>(cell.region)] >= kLeastRegionCells;
  }
  for (SurfaceCell& cell : cells_) {
    cell.is_deep = cell.is_smooth;
    if (!cell.is_smooth) continue;
    for_around(cell.at, 1, [&](const CellCoordinates& at) {
      const SurfaceCell* other = find(at);
      if (other != nullptr && !other->is_smooth) cell.is_deep = false;
    });
  }
}

std::vector<OccupancySurface::Candidate> OccupancySurface::candidates(
    const CellCoordinates& at) const {
  std::vector<Candidate> found;
  for_around(at, kReach, [&](const CellCoordinates& place) {
    const SurfaceCell* other = find(place);
    if (other == nullptr || !other->is_smooth) return;
    const Vector3 offset = {static_cast<double>(place[0] - at[0]),
                            static_cast<double>(place[1] - at[1]),
                            static_cast<double>(place[2] - at[2])};
    const double score = length(offset) + (other->is_deep ? 0.0 : kNotDeep);
    const std::int32_t region = regions_.root(other->region);
    const auto cell = static_cast<std::size_t>(other - cells_.data());
    for (Candidate& candidate : found) {
      if (candidate.region != region) continue;
      if (score < candidate.score) candidate = {region, cell, score};
      return;
    }
    found.push_back({region, cell, score});
  });
  const Vector3 center = {at[0] + 0.5, at[1] + 0.5, at[2] + 0.5};
  std::erase_if(found, [&](const Candidate& candidate) {
    Vector3 gradient;
    const double above = cells_[candidate.cell].patch.above(center, &gradient);
    return std::abs(above) > kMostFar * length(gradient);
  });
  return found;
}

// Merges regions that continue across cells that are not smooth.
void OccupancySurface::merge_across_gaps() {
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    const std::vector<Candidate>& near = near_[cell];
    std::vector<Vector3> normals;
    for (const Candidate& candidate : near) {
      Vector3 gradient;
      cells_[candidate.cell].patch.projected(cells_[cell].patch.center, &gradient);
      normals.push_back((1.0 / length(gradient)) * gradient);
    }
    for (std::size_t i = 0; i < near.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (dot(normals[i], normals[j]) >= kNearlyParallel)
          regions_.join(near[i].region, near[j].region);
      }
    }
  }
  for (SurfaceCell& cell : cells_) cell.region = regions_.root(cell.region);
  for (std::vector<Candidate>& near : near_) {
    for (Candidate& candidate : near) candidate.region = regions_.root(candidate.region);
    std::sort(near.begin(), near.end(), [](const Candidate& a, const Candidate& b) {
      return a.score != b.score ? a.score < b.score : a.cell < b.cell;
    });
    std::vector<Candidate> first;
    for (const Candidate& candidate : near) {
      const bool is_known = std::any_of(first.begin(), first.end(), [&](const Candidate& other) {
        return other.region == candidate.region;
      });
      if (!is_known) first.push_back(candidate);
    }
    near = std::move(first);
  }
}

void OccupancySurface::mark_edges() {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (near_[i].size() < 2) continue;
    for_around(cells_[i].at, 2, [&](const CellCoordinates& at) {
      const SurfaceCell* other = find(at);
      if (other == nullptr) return;
      cells_[static_cast<std::size_t>(other - cells_.data())].is_beside_edge = true;
    });
  }
}

// Whether some combination of the regions' insides explains the cell's occupancy.
bool OccupancySurface::explains(const std::vector<Candidate>& all,
                                const CellCoordinates& at) const {
  const auto occupancy = static_cast<double>(occupancy_at(tree_.cells(), depth_, at));
  const std::size_t count = std::min(all.size(), kOccupancySurfaceMostRegions);
  // Share of the cell inside exactly each set of regions.
  std::array<double, 1U << kOccupancySurfaceMostRegions> shares{};
  for (int i = 0; i < kSamples * kSamples * kSamples; ++i) {
    const Vector3 point = {at[0] + (i % kSamples + 0.5) / kSamples,
                           at[1] + (i / kSamples % kSamples + 0.5) / kSamples,
                           at[2] + (i / kSamples / kSamples + 0.5) / kSamples};
    unsigned inside = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (cells_[all[k].cell].patch.above(point, nullptr) <= 0.0) inside |= 1U << k;
    }
    shares[inside] += 1.0 / (kSamples * kSamples * kSamples);
  }
  // Monotone functions of up to three regions, given by the conditions on the sets that are inside.
  const auto share_of = [&](const auto& is_inside) {
    double share = 0.0;
    for (unsigned set = 0; set < 1U << count; ++set) {
      if (is_inside(set)) share += shares[set];
    }
    return share;
  };
  double least = 1.0;
  const auto try_rule = [&](const auto& is_inside) {
    least = std::min(least, std::abs(share_of(is_inside) - occupancy));
  };
  for (unsigned asked = 1; asked < 1U << count; ++asked) {
    try_rule([&](unsigned set) { return (set & asked) == asked; });
    try_rule([&](unsigned set) { return (set & asked) != 0; });
  }
  if (count == 3) {
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned one = 1U << k;
      const unsigned others = 7U & ~one;
      try_rule([&](unsigned set) { return (set & one) != 0 && (set & others) != 0; });
      try_rule([&](unsigned set) { return (set & one) != 0 || (set & others) == others; });
    }
  }
  return least < kUnexplained;
}

Vector3 OccupancySurface::to_cells(const Vector3& point) const {
  Vector3 result;
  for (int a = 0; a < 3; ++a) result[a] = point[a] / frame_.cell(a, depth_);
  return result;
}

Vector3 OccupancySurface::to_frame(const Vector3& point) const {
  Vector3 result;
  for (int a = 0; a < 3; ++a) result[a] = point[a] * frame_.cell(a, depth_);
  return result;
}

Vector3 OccupancySurface::normal_in_frame(const Vector3& normal) const {
  Vector3 result;
  for (int a = 0; a < 3; ++a) result[a] = normal[a] / frame_.cell(a, depth_);
  return (1.0 / length(result)) * result;
}

std::optional<SourcePoint> OccupancySurface::nearest(const Vector3& point, double reach,
                                                     std::int32_t label) const {
  const Vector3 start = to_cells(point);
  CellCoordinates at;
  for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::int32_t>(std::floor(start[a]));
  const HeightPatch* patch = nullptr;
  double least = 0.0;
  std::int32_t region = -1;
  for_around(at, kReach + 1, [&](const CellCoordinates& place) {
    const SurfaceCell* other = find(place);
    if (other == nullptr || !other->is_smooth) return;
    if (label >= 0 && other->region != label) return;
    const double score = length(other->patch.foot() - start) + (other->is_deep ? 0.0 : kNotDeep);
    if (patch != nullptr && score >= least) return;
    patch = &other->patch;
    least = score;
    region = other->region;
  });
  if (patch == nullptr) return std::nullopt;
  Vector3 gradient;
  const Vector3 found = patch->projected(start, &gradient);
  const SourcePoint result = {to_frame(found), normal_in_frame(gradient), -1, region};
  if (length(result.position - point) > reach) return std::nullopt;
  return result;
}

// The nearest intersection of these regions with a vertex's line between two cells' centers, where
// the surface has the same orientation as the occupancies.
std::optional<OccupancySurface::Hit> OccupancySurface::hit_on_line(
    const std::vector<Candidate>& near, const CellCoordinates& at, int face, double rises,
    const Vector3& start) const {
  constexpr double kLeastSlope = 1e-3;
  const int axis = face / 2;
  const double forward = (face & 1) != 0 ? 1.0 : -1.0;
  std::optional<Hit> best;
  double least = kMostMoved;
  for (const Candidate& candidate : near) {
    const HeightPatch& patch = cells_[candidate.cell].patch;
    Vector3 point = start;
    Vector3 gradient;
    for (int step = 0; step < 3; ++step) {
      const double above = patch.above(point, &gradient);
      if (gradient[axis] * rises < kLeastSlope) break;
      point[axis] -= above / gradient[axis];
    }
    const double from_center = (point[axis] - at[static_cast<std::size_t>(axis)] - 0.5) * forward;
    if (gradient[axis] * rises < kLeastSlope || from_center < -0.2 || from_center > 1.2) continue;
    const double moved = std::abs(point[axis] - start[axis]);
    if (moved >= least) continue;
    least = moved;
    best = {candidate.region, point, gradient};
  }
  return best;
}

// The nearest point on any of these regions.
std::optional<OccupancySurface::Hit> OccupancySurface::hit_beside(
    const std::vector<Candidate>& near, const Vector3& start) const {
  std::optional<Hit> best;
  double least = kMostMoved;
  for (const Candidate& candidate : near) {
    Vector3 gradient;
    const Vector3 point = cells_[candidate.cell].patch.projected(start, &gradient);
    const double moved = length(point - start);
    if (moved >= least) continue;
    least = moved;
    best = {candidate.region, point, gradient};
  }
  return best;
}

std::optional<OccupancySurface::Found> OccupancySurface::sample_face(
    const SurfaceCell& cell, const std::vector<Candidate>& near, int face, std::size_t vertex,
    const Vector3& position) const {
  const auto axis = static_cast<std::size_t>(face / 2);
  const bool is_high = (face & 1) != 0;
  CellCoordinates beyond = cell.at;
  beyond[axis] += is_high ? 1 : -1;
  if (!cell.is_smooth && !explains(near, beyond)) return std::nullopt;
  const CellTree& tree = tree_.cells();
  const bool is_fuller = static_cast<double>(occupancy_at(tree, depth_, cell.at)) >
                         static_cast<double>(occupancy_at(tree, depth_, beyond));
  const Vector3 start = to_cells(position);
  const double rises = is_fuller == is_high ? 1.0 : -1.0;
  const std::optional<Hit> hit = hit_on_line(near, cell.at, face, rises, start);
  if (!hit) {
    // The sides of leaves follow from occupancies, not from their centers, so beside edges the line
    // may miss the surface.
    const std::optional<Hit> beside = hit_beside(near, start);
    if (!beside) return std::nullopt;
    const SourcePoint sample = {to_frame(beside->point), normal_in_frame(beside->gradient), -1,
                                beside->region};
    return Found{vertex, sample, position, 0.0F};
  }
  const double offset = hit->point[axis] - cell.at[axis] - 0.5;
  Vector3 on_line = position;
  on_line[axis] = frame_.crossing(face, cell.at[axis] + 0.5,
                                  std::clamp(is_high ? offset : -offset, 0.0, 1.0), 1.0, depth_);
  return Found{vertex, {on_line, normal_in_frame(hit->gradient), -1, hit->region}, on_line, 1.0F};
}

void OccupancySurface::sample_cell(const SurfaceCell& cell, const std::vector<Vector3>& positions,
                                   std::vector<Found>* found) const {
  if (!cell.is_beside_edge) return;
  const auto number = static_cast<std::size_t>(&cell - cells_.data());
  std::vector<Candidate> near;
  if (cell.is_smooth) {
    near = {{cell.region, number, 0.0}};
  } else {
    near = near_[number];
    if (near.empty() || !explains(near, cell.at)) return;
  }
  std::size_t vertex = cell.first_vertex;
  for (unsigned faces = cell.faces; faces != 0; faces &= faces - 1, ++vertex) {
    const std::optional<Found> one =
        sample_face(cell, near, std::countr_zero(faces), vertex, positions[vertex]);
    if (one) found->push_back(*one);
  }
}

VertexSamples OccupancySurface::sample_vertices(const Run& run, SurfaceVertices* vertices) const {
  const auto count = static_cast<std::int64_t>(cells_.size());
  std::vector<std::vector<Found>> tasks(
      static_cast<std::size_t>(range_count(count, kCellsPerTask)));
  parallel_ranges(count, kCellsPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      sample_cell(cells_[static_cast<std::size_t>(i)], vertices->positions(),
                  &tasks[static_cast<std::size_t>(begin / kCellsPerTask)]);
    }
  });
  VertexSamples result;
  result.index.assign(vertices->positions().size(), -1);
  for (const std::vector<Found>& task : tasks) {
    for (const Found& found : task) {
      result.index[found.vertex] = static_cast<std::int32_t>(result.samples.size());
      result.samples.push_back(found.sample);
      result.on_lines.push_back(found.on_line);
      result.facing.push_back(found.facing);
      vertices->move(found.vertex, found.sample.position);
    }
  }
  return result;
}

}  // namespace prefilter
