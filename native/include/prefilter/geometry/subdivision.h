// SPDX-License-Identifier: GPL-3.0-or-later

// Limit surfaces of subdivision meshes, computed with OpenSubdiv.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "prefilter/base/names.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

enum class SubdivisionScheme { kCatmullClark, kLoop, kBilinear };

inline constexpr Named<SubdivisionScheme> kSubdivisionSchemes[] = {
    {"catmull-clark", SubdivisionScheme::kCatmullClark},
    {"loop", SubdivisionScheme::kLoop},
    {"bilinear", SubdivisionScheme::kBilinear}};

/// Treatment of mesh boundaries.
enum class SubdivisionBoundary {
  kEdgeOnly,       // smooth curves
  kEdgeAndCorner,  // the same, but vertices with a single face are fixed
};

inline constexpr Named<SubdivisionBoundary> kSubdivisionBoundaries[] = {
    {"edge-and-corner", SubdivisionBoundary::kEdgeAndCorner},
    {"edge-only", SubdivisionBoundary::kEdgeOnly}};

/// Where texture coordinates are interpolated linearly, from nowhere to everywhere. All but the
/// last are smooth inside charts.
enum class UvInterpolation {
  kSmoothAll,                           // chart boundaries are smooth curves, on seams too
  kPreserveCorners,                     // corners of charts are fixed
  kPreserveCornersAndJunctions,         // and points where three or more charts meet
  kPreserveCornersJunctionsAndConcave,  // and concave corners and ends of seams
  kPreserveBoundaries,                  // all chart boundaries are fixed
  kNone,                                // linear everywhere
};

inline constexpr Named<UvInterpolation> kUvInterpolations[] = {
    {"none", UvInterpolation::kNone},
    {"preserve-corners", UvInterpolation::kPreserveCorners},
    {"preserve-corners-and-junctions", UvInterpolation::kPreserveCornersAndJunctions},
    {"preserve-corners-junctions-and-concave",
     UvInterpolation::kPreserveCornersJunctionsAndConcave},
    {"preserve-boundaries", UvInterpolation::kPreserveBoundaries},
    {"smooth-all", UvInterpolation::kSmoothAll}};

/// Raw arrays of a polygon mesh, owned by the caller.
struct PolygonArrays {
  const double* positions = nullptr;  // vertex_count x 3
  std::size_t vertex_count = 0;
  const std::int64_t* face_sizes = nullptr;  // face_count corner counts
  std::size_t face_count = 0;
  const std::int64_t* face_vertices = nullptr;  // corner_count indices, face by face
  const double* face_uvs = nullptr;             // corner_count x 2
  std::size_t corner_count = 0;
  const std::int64_t* crease_edges = nullptr;  // crease_count x 2 vertices
  const double* crease_sharpness = nullptr;    // crease_count values, 0 and up
  std::size_t crease_count = 0;
  const std::int64_t* corner_vertices = nullptr;  // sharp_corner_count vertices
  const double* corner_sharpness = nullptr;       // sharp_corner_count values, 0 and up
  std::size_t sharp_corner_count = 0;
  const double* weights = nullptr;             // one per element of weights_of
  WeightsOf weights_of = WeightsOf::kNothing;  // kTriangles: per face; kCorners is not allowed
  const bool* kept = nullptr;  // face_count flags: faces to include in the surface; null for all
};

/// Sharpness from this value on is infinite.
constexpr double kInfiniteSharpness = 10.0;
constexpr int kMaxSubdivisionLevel = 10;

struct SubdivisionOptions {
  SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
  SubdivisionBoundary boundary = SubdivisionBoundary::kEdgeAndCorner;
  UvInterpolation uv_interpolation = UvInterpolation::kPreserveBoundaries;
  int level = 3;  // 1 to 10
  Run run;
};

/// The limit surface of a mesh: refines the faces `level` times and moves vertices to the limit of
/// infinite refinement. Texture coordinates are refined too, by their own interpolation rule. The
/// error of the triangles' areas decreases with the square of their size.
///
/// Corners of a vertex with equal texture coordinates are joined, others form seams. Edges of more
/// than two faces, and non-manifold vertices, are infinitely sharp. Vertices without faces are
/// dropped. Vertex weights are interpolated linearly; face weights apply to all parts of the face.
///
/// Throws Error for a mesh without faces, or without a kept one; faces with fewer than three
/// corners (Loop: other than three) or with a repeated vertex; indices out of range; creases that
/// are not edges; values that are not finite; negative sharpness or weights; a level that is out of
/// range or makes more than 2^25 triangles; and, from the progress callback, when cancelled.
Surface subdivide(const PolygonArrays& mesh, const SubdivisionOptions& options);

}  // namespace prefilter
