// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/tree_contour.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/contour/contour_slab.h"
#include "prefilter/voxels/contour/dual_cells.h"
#include "prefilter/voxels/contour/edge_source.h"
#include "prefilter/voxels/contour/fit_vertices.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/marching_table.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/sharpen.h"
#include "prefilter/voxels/contour/smooth_stairs.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour/thickened_cells.h"
#include "prefilter/voxels/contour/unfold.h"
#include "prefilter/voxels/remesh/clean_up.h"
#include "prefilter/voxels/remesh/simplify.h"
#include "prefilter/wavelet/refine.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTreeContourPartsPerTask = 8;
constexpr double kLargestAdaptivity = 1e6;  // in cells; beyond the largest root

using Triangle = std::array<std::int32_t, 3>;

// The triangles of some dual cells. Vertices that a task adds, at the centers of loops, are
// numbered from -1 downward.
struct TaskTriangles {
  std::vector<Triangle> triangles;
  std::vector<Vector3> middles;
  std::vector<SharpLoop> loops;
  std::vector<Triangle> loop_triangles;
};

// Tests whether an edge of the shape passes between two vertices.
class Division {
 public:
  Division(const FeatureSurface& surface, const VertexSamples& samples)
      : surface_(surface), samples_(samples), tips_(samples.tips) {
    std::sort(tips_.begin(), tips_.end());
  }

  bool operator()(std::int32_t a, std::int32_t b) const {
    return are_divided(surface_, samples_, a, b);
  }
  // Loops are fans around tips.
  bool is_tip(std::int32_t vertex) const {
    return samples_.of(vertex) != nullptr && std::binary_search(tips_.begin(), tips_.end(), vertex);
  }

 private:
  const FeatureSurface& surface_;
  const VertexSamples& samples_;
  std::vector<std::int32_t> tips_;  // sorted
};

constexpr std::array<unsigned, 12> kFacesOfEdges = [] {
  std::array<unsigned, 12> faces;
  for (int edge = 0; edge < 12; ++edge) faces[edge] = faces_of_edge(edge);
  return faces;
}();

// Proportional to the volume between a triangle and a large sphere through its corners: the area
// times the sum of squared sides. Among triangulations of coplanar points, Delaunay's has the least
// sum (V. Rajan, Optimality of the Delaunay triangulation in R^d, 1994); among facets, those with
// normals nearest to the sphere's do.
double sphere_gap(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 u = b - a;
  const Vector3 v = c - a;
  const Vector3 w = v - u;
  const Vector3 normal = cross(u, v);
  return std::sqrt(dot(normal, normal)) * (dot(u, u) + dot(v, v) + dot(w, w));
}

class TriangleMaker {
 public:
  explicit TriangleMaker(const SurfaceVertices& vertices, const Division* division = nullptr)
      : vertices_(vertices), division_(division), cases_(marching_cases()) {}

  void add(const Meeting& leaves, TaskTriangles* task) const {
    unsigned inside = 0;
    bool is_uniform = true;
    for (int i = 0; i < 8; ++i) {
      if (leaves[i].sides == kInside) inside |= 1U << i;
      is_uniform = is_uniform && leaves[i].depth == leaves[0].depth;
    }
    const MarchingCase& found = cases_[inside];
    const unsigned joined = is_uniform ? 0U : joined_faces(leaves, inside, found.ambiguous_faces);
    const std::vector<MarchingLoop> other_loops =
        joined == 0U ? std::vector<MarchingLoop>() : marching_loops(inside, joined);
    const std::vector<MarchingLoop>& loops = joined == 0U ? found.loops : other_loops;
    std::array<std::int32_t, 12> on_edge;
    for (const MarchingLoop& loop : loops) {
      for (const int edge : loop) {
        on_edge[edge] =
            vertices_.between(leaves[low_corner(edge)], leaves[high_corner(edge)], edge / 4);
      }
    }
    std::array<unsigned, 12> faces;
    if (is_uniform) {
      faces = kFacesOfEdges;
    } else {
      find_shared_faces(leaves, loops, &faces);
    }
    for (const MarchingLoop& loop : loops) add_loop(loop, on_edge, faces, task);
  }

 private:
  // The ambiguous faces on which the inside is joined: the faces whose edge has a smaller leaf
  // among the four around it that is outside. Other small leaves, on either side, may follow along
  // the edge. The leaf opposite to them is separated from all of them, so that the segment around
  // it is one, and not different for every other small leaf.
  static unsigned joined_faces(const Meeting& leaves, unsigned inside, unsigned ambiguous) {
    unsigned joined = 0;
    for (int face = 0; face < 6; ++face) {
      if (((ambiguous >> face) & 1U) == 0U) continue;
      const std::array<int, 4> corners = face_corners(face / 2, (face & 1) != 0);
      int finest = corners[0];
      for (const int corner : corners) {
        if (leaves[corner].depth > leaves[finest].depth) finest = corner;
      }
      int count = 0;
      for (const int corner : corners) {
        if (leaves[corner].depth == leaves[finest].depth) ++count;
      }
      if (count == 1 && ((inside >> finest) & 1U) == 0U) joined |= 1U << face;
    }
    return joined;
  }

  // The faces of the dual cell that both leaves of each edge touch; since a leaf may be several
  // corners of the cell, these may be more than the faces in which the edge lies.
  //
  // Two vertices whose leaves all touch one face are also in the dual cell behind it, and only
  // then: the four boxes have more than this point in common.
  static void find_shared_faces(const Meeting& leaves, const std::vector<MarchingLoop>& loops,
                                std::array<unsigned, 12>* faces) {
    std::array<unsigned, 8> reached{};
    for (int i = 0; i < 8; ++i) {
      for (int j = 0; j < 8; ++j) {
        if (leaves[i].depth != leaves[j].depth || leaves[i].block != leaves[j].block ||
            leaves[i].octant != leaves[j].octant) {
          continue;
        }
        for (int axis = 0; axis < 3; ++axis) reached[i] |= 1U << (2 * axis + ((j >> axis) & 1));
      }
    }
    for (const MarchingLoop& loop : loops) {
      for (const int edge : loop) {
        (*faces)[edge] = reached[low_corner(edge)] & reached[high_corner(edge)];
      }
    }
  }

  // Adds a loop, skipping consecutive edges between the same two leaves, which are one vertex.
  void add_loop(const MarchingLoop& loop, const std::array<std::int32_t, 12>& on_edge,
                const std::array<unsigned, 12>& faces_of, TaskTriangles* task) const {
    std::array<std::int32_t, 12> corners;
    std::array<unsigned, 12> faces;
    int count = 0;
    for (const std::uint8_t edge : loop) {
      const std::int32_t vertex = on_edge[edge];
      if (count > 0 && corners[count - 1] == vertex) {
        faces[count - 1] |= faces_of[edge];
      } else {
        corners[count] = vertex;
        faces[count] = faces_of[edge];
        ++count;
      }
    }
    while (count > 1 && corners[count - 1] == corners[0]) {
      --count;
      faces[0] |= faces[count];
    }
    if (count < 3) return;
    std::vector<Triangle>* triangles = &task->triangles;
    if (is_divided(corners, count)) {
      triangles = &task->loop_triangles;
      task->loops.push_back({corners, count, triangles->size(), 0});
    }
    triangulate(corners, faces, count, triangles, &task->middles);
    if (triangles == &task->loop_triangles) task->loops.back().end = triangles->size();
  }

  bool is_divided(const std::array<std::int32_t, 12>& corners, int count) const {
    if (division_ == nullptr) return false;
    for (int i = 0; i < count; ++i) {
      if ((*division_)(corners[i], corners[(i + 1) % count])) return true;
    }
    return false;
  }

  void triangulate(const std::array<std::int32_t, 12>& corners,
                   const std::array<unsigned, 12>& faces, int count,
                   std::vector<Triangle>* triangles, std::vector<Vector3>* middles) const {
    const auto is_allowed = [&](int i, int j) { return (faces[i] & faces[j]) == 0U; };
    int tip = -1;
    for (int i = 0; i < count; ++i) {
      if (division_ != nullptr && division_->is_tip(corners[i])) tip = i;
    }
    const auto cost = [&](int i, int j, int k) {
      constexpr double kForbidden = 1e30;
      if (tip >= 0 && tip != i && tip != j && tip != k) return kForbidden;
      return sphere_gap(position(corners[i]), position(corners[j]), position(corners[k]));
    };
    const bool is_done = triangulate_loop(count, is_allowed, cost, [&](int i, int j, int k) {
      triangles->push_back({corners[i], corners[j], corners[k]});
    });
    if (is_done) return;
    // No diagonal is free, so use a fan around the center.
    Vector3 middle{};
    for (int i = 0; i < count; ++i) middle = middle + position(corners[i]);
    for (double& x : middle) x /= count;
    middles->push_back(middle);
    const auto center = -static_cast<std::int32_t>(middles->size());
    for (int i = 0; i < count; ++i) {
      triangles->push_back({center, corners[i], corners[(i + 1) % count]});
    }
  }

  const Vector3& position(std::int32_t vertex) const {
    return vertices_.positions()[static_cast<std::size_t>(vertex)];
  }

  const SurfaceVertices& vertices_;
  const Division* division_;
  const std::array<MarchingCase, 256>& cases_;
};

LoopedMesh join(const Run& run, SurfaceVertices* vertices, std::vector<TaskTriangles>* tasks) {
  LoopedMesh mesh;
  mesh.positions = vertices->take_positions();
  std::size_t count = 0;
  for (const TaskTriangles& task : *tasks) count += task.triangles.size();
  mesh.triangles.reserve(count);
  for (TaskTriangles& task : *tasks) {
    const auto base = static_cast<std::int32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), task.middles.begin(), task.middles.end());
    if (!task.middles.empty()) {
      for (std::vector<Triangle>* triangles : {&task.triangles, &task.loop_triangles}) {
        for (Triangle& triangle : *triangles) {
          for (std::int32_t& vertex : triangle) {
            if (vertex < 0) vertex = base - 1 - vertex;
          }
        }
      }
    }
    mesh.triangles.insert(mesh.triangles.end(), task.triangles.begin(), task.triangles.end());
    for (SharpLoop& loop : task.loops) {
      loop.first += mesh.loop_triangles.size();
      loop.end += mesh.loop_triangles.size();
    }
    mesh.loops.insert(mesh.loops.end(), task.loops.begin(), task.loops.end());
    mesh.loop_triangles.insert(mesh.loop_triangles.end(), task.loop_triangles.begin(),
                               task.loop_triangles.end());
    task = TaskTriangles();
    run.report(static_cast<double>(mesh.triangles.size()) /
               static_cast<double>(std::max<std::size_t>(count, 1)));
  }
  return mesh;
}

// Removes unused vertices; returns the previous indices of the others.
template <typename Mesh>
std::vector<std::int32_t> leave_out_unused(Mesh* mesh) {
  std::vector<std::int32_t> places(mesh->positions.size(), -1);
  for (const Triangle& triangle : mesh->triangles) {
    for (const std::int32_t vertex : triangle) places[static_cast<std::size_t>(vertex)] = 0;
  }
  std::vector<std::int32_t> used;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0) continue;
    places[i] = static_cast<std::int32_t>(used.size());
    mesh->positions[used.size()] = mesh->positions[i];
    used.push_back(static_cast<std::int32_t>(i));
  }
  mesh->positions.resize(used.size());
  for (Triangle& triangle : mesh->triangles) {
    for (std::int32_t& vertex : triangle) vertex = places[static_cast<std::size_t>(vertex)];
  }
  return used;
}

LoopedMesh make_loops(const ContourTree& tree, const Division* division, const Run& run,
                      SurfaceVertices* vertices) {
  const DualCells dual(tree);
  const TriangleMaker maker(*vertices, division);
  const auto parts = static_cast<std::int64_t>(dual.part_count());
  std::vector<TaskTriangles> tasks(
      static_cast<std::size_t>(range_count(parts, kTreeContourPartsPerTask)));
  const auto make_some = [&](std::int64_t begin, std::int64_t end) {
    TaskTriangles& task = tasks[static_cast<std::size_t>(begin / kTreeContourPartsPerTask)];
    for (std::int64_t part = begin; part < end; ++part) {
      dual.for_part(static_cast<std::size_t>(part),
                    [&](const Meeting& leaves) { maker.add(leaves, &task); });
    }
  };
  const Stages stages(run, {4, 1});
  parallel_ranges(parts, kTreeContourPartsPerTask, stages[0], make_some);
  return join(stages[1], vertices, &tasks);
}

FacetedMesh sharpened(LoopedMesh looped, const Vector3& smallest, EdgeSource* edges,
                      const Run& run) {
  const Stages stages(run, {19, 1});
  FacetedMesh mesh =
      sharpen(std::move(looped), edges->crossings, *edges->surface(), edges->samples, stages[0]);
  unfold_plain_loops(edges->samples, smallest, &edges->crossings, stages[1], &mesh);
  const std::vector<std::int32_t> used = leave_out_unused(&mesh);
  for (std::size_t i = 0; i < used.size() && !mesh.kinds.empty(); ++i) {
    mesh.kinds[i] = mesh.kinds[static_cast<std::size_t>(used[i])];
  }
  mesh.kinds.resize(std::min(mesh.kinds.size(), used.size()));
  return mesh;
}

double least_cell(const RootFrame& frame, int depth) {
  return std::min({frame.cell(0, depth), frame.cell(1, depth), frame.cell(2, depth)});
}

// The cells from which a contour is cut. Owned cells can be freed early, because they and their
// derived data take as much memory as the contour.
class ContourCells {
 public:
  explicit ContourCells(const CellTree& kept) : kept_(&kept) {}
  explicit ContourCells(CellTree&& own) : own_(std::move(own)) {}

  const CellTree& tree() const { return kept_ != nullptr ? *kept_ : own_; }
  void drop() { own_ = {}; }

 private:
  const CellTree* kept_ = nullptr;
  CellTree own_;
};

// Cuts the full contour, in the frame, and frees the cells. With `sources_of_labels`, all triangles
// get labels, and the array a source triangle for each label.
FacetedMesh cut_tree(const RootFrame& frame, const ContourOptions& options, const Run& run,
                     ContourCells* own, std::vector<std::int64_t>* sources_of_labels) {
  const CellTree& cells = own->tree();
  std::optional<ContourTree> made(std::in_place, cells, options.isovalue, run.part(0.0, 0.1));
  ContourTree& tree = *made;
  const Interpolant interpolant = interpolant_of(options);
  const bool fits = options.isovalue == 0.5F &&
                    (interpolant == Interpolant::kPlane || interpolant == Interpolant::kSharp);
  const bool is_sharp = fits && interpolant == Interpolant::kSharp;
  if (fits) settle_sides(run.part(0.1, 0.2), &tree);
  EdgeSource edges;
  if (is_sharp && !options.sources.empty()) {
    read_sources(cells, frame, options, run.part(0.2, 0.35), &tree, &edges);
  }
  std::optional<SurfaceVertices> cut(std::in_place, tree, frame, interpolant, run.part(0.35, 0.45));
  SurfaceVertices& vertices = *cut;
  if (fits) {
    const std::vector<Vector3> plain = vertices.positions();
    fit_vertices(tree, frame, run.part(0.45, 0.5), &vertices);
    edges.crossings = crossings_of(tree, frame, plain, vertices);
  }
  const double cell = least_cell(frame, cells.depth());
  const Vector3 smallest = frame.cells(cells.depth());
  const ThickenedCells thickened(options.thickened, frame);
  const auto is_thickened = [&](const Vector3& p) { return thickened.holds(p); };
  if (!is_sharp) {
    LoopedMesh looped = make_loops(tree, nullptr, run.part(0.6, 0.85), &vertices);
    if (fits) unfold({}, smallest, &edges.crossings, &looped);
    FacetedMesh mesh = {std::move(looped.positions), std::move(looped.triangles), {}, {}};
    if (fits && options.thickened != nullptr) {
      smooth_stairs(cell, is_thickened, true, run.part(0.85, 1.0), &mesh);
    }
    return mesh;
  }
  sample_edges(tree, frame, options.thickened, run.part(0.5, 0.6), &vertices, &edges);
  const Division division(*edges.surface(), edges.samples);
  LoopedMesh looped = make_loops(tree, &division, run.part(0.6, 0.85), &vertices);
  cut.reset();
  if (!edges.smooth_parts) {
    made.reset();
    own->drop();
  }
  unfold(edges.samples, smallest, &edges.crossings, &looped);
  FacetedMesh mesh = sharpened(std::move(looped), smallest, &edges, run.part(0.85, 0.97));
  edges.crossings = {};
  edges.samples = {};
  smooth_stairs(cell, is_thickened, false, run.part(0.97, 1.0), &mesh);
  if (sources_of_labels != nullptr && edges.meshes) {
    *sources_of_labels = trace_labels(*edges.meshes, &mesh);
  }
  return mesh;
}

Vector3 middle_of(const FacetedMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const auto at = [&](std::int32_t v) -> const Vector3& {
    return mesh.positions[static_cast<std::size_t>(v)];
  };
  return (1.0 / 3.0) * (at(a) + at(b) + at(c));
}

// Contours a tree whose root is split.
TriangleMesh contour_split(ContourCells cells, const Box& root, const ContourOptions& options,
                           std::vector<std::int64_t>* origins) {
  constexpr double kPlacing = 0.98;
  constexpr double kSmallest = 1e-30;        // unit of length whose powers are representable
  constexpr double kCreaseTolerance = 0.01;  // cells
  constexpr double kCleaningShare = 0.2;     // share of the adaptivity for cleaning up
  const double simplifying = options.clean_up ? 0.7 : kPlacing;
  const double cutting = options.adaptivity > 0.0 ? 0.4 * simplifying : simplifying - 0.02;
  const RootFrame frame(root);
  std::vector<std::int64_t> sources_of_labels;
  double cell = least_cell(frame, cells.tree().depth());
  FacetedMesh mesh = cut_tree(frame, options, options.run.part(0.0, cutting), &cells,
                              origins != nullptr ? &sources_of_labels : nullptr);
  cells.drop();
  // Where rounding may make triangles intersect, later stages must work on the final positions.
  const bool places_first = frame.unit() > kSmallest && frame.unit() < 1.0 / kSmallest;
  const Run placing = options.run.part(cutting, cutting + 0.02);
  if (places_first) {
    frame.place(placing, &mesh.positions);
    cell *= frame.unit();
  }
  CleaningLimits limits{kCreaseTolerance * cell};
  if (options.adaptivity > 0.0) {
    mesh = simplify(std::move(mesh), options.adaptivity * cell,
                    options.run.part(cutting + 0.02, simplifying));
    limits.height = kCleaningShare * options.adaptivity * cell;
  }
  if (options.clean_up) {
    mesh = clean_up(std::move(mesh), limits, options.run.part(simplifying, kPlacing));
  }
  if (origins != nullptr) {
    const ThickenedCells thickened(options.thickened, frame);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vector3 middle = middle_of(mesh, t);
      const bool is_thickened = thickened.holds(places_first ? frame.from_space(middle) : middle);
      origins->push_back(
          is_thickened ? -1 : sources_of_labels[static_cast<std::size_t>(mesh.labels[t])]);
    }
  }
  if (!places_first) {
    frame.place(options.run.part(kPlacing, 1.0), &mesh.positions);
  }
  options.run.report(1.0);
  return {std::move(mesh.positions), std::move(mesh.triangles)};
}
}  // namespace

ContourSlab contour_slab(const CellTree& cells, float isovalue, Interpolant interpolant,
                         const HeightRange& heights) {
  assert(!cells.levels.empty());
  const ContourTree tree(cells, isovalue, Run(1));
  SurfaceVertices vertices(tree, RootFrame({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}), interpolant,
                           heights);
  const DualCells dual(tree, heights);
  const TriangleMaker maker(vertices);
  std::vector<TaskTriangles> tasks(1);
  for (std::size_t part = 0; part < dual.part_count(); ++part) {
    dual.for_part(part, [&](const Meeting& leaves) { maker.add(leaves, tasks.data()); });
  }
  ContourSlab slab;
  const std::size_t pairs = vertices.places().size();
  LoopedMesh looped = join(Run(), &vertices, &tasks);
  slab.mesh = {std::move(looped.positions), std::move(looped.triangles)};
  const std::vector<std::int32_t> used = leave_out_unused(&slab.mesh);
  for (const std::int32_t vertex : used) {
    const auto i = static_cast<std::size_t>(vertex);
    if (i < pairs) slab.places.push_back(vertices.places()[i]);
  }
  return slab;
}

namespace {

TriangleMesh contour_any(ContourCells cells, const Box& root, const ContourOptions& options,
                         std::vector<std::int64_t>* origins) {
  check_box(root, "bounds");
  if (!(options.adaptivity >= 0.0 && options.adaptivity <= kLargestAdaptivity)) {
    throw_invalid("adaptivity: found " + to_text(options.adaptivity) + "; allowed are 0 to " +
                  to_text(kLargestAdaptivity));
  }
  if (!cells.tree().levels.empty()) return contour_split(std::move(cells), root, options, origins);
  return contour_split(ContourCells(split_root(cells.tree().root)), root, options, origins);
}

// Contours a tree, refined first if the surface passes through cells of several sizes.
TriangleMesh contour_refined(const CellTree& cells, const Box& root, const ContourOptions& options,
                             std::vector<std::int64_t>* origins) {
  constexpr double kRefining = 0.3;
  if (options.isovalue != 0.5F || !has_coarse_surface(cells)) {
    return contour_any(ContourCells(cells), root, options, origins);
  }
  check_box(root, "bounds");
  ContourCells fine(refined(cells, cells.depth(), options.run.part(0.0, kRefining)));
  ContourOptions rest = options;
  rest.run = options.run.part(kRefining, 1.0);
  return contour_any(std::move(fine), root, rest, origins);
}
}  // namespace

TriangleMesh contour_tree(const CellTree& cells, const Box& root, const ContourOptions& options) {
  return contour_any(ContourCells(cells), root, options, nullptr);
}

TriangleMesh contour_occupancies(const CellTree& cells, const Box& root,
                                 const ContourOptions& options) {
  return contour_refined(cells, root, options, nullptr);
}

TracedMesh contour_traced(const CellTree& cells, const Box& root, const ContourOptions& options) {
  if (interpolant_of(options) != Interpolant::kSharp || options.sources.empty()) {
    throw_invalid("sources: there are none; origins need at least one, and 'sharp'");
  }
  if (options.isovalue != 0.5F) {
    throw_invalid("isovalue: " + to_text(static_cast<double>(options.isovalue)) +
                  "; origins need 0.5");
  }
  TracedMesh traced;
  traced.mesh = contour_refined(cells, root, options, &traced.origins);
  return traced;
}

}  // namespace prefilter
