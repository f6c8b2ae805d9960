// SPDX-License-Identifier: GPL-3.0-or-later

// Limit surfaces of subdivision meshes, through OpenSubdiv.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

enum class SubdivisionScheme { kCatmullClark, kLoop, kBilinear };

inline constexpr Named<SubdivisionScheme> kSubdivisionSchemes[] = {
    {"catmull-clark", SubdivisionScheme::kCatmullClark},
    {"loop", SubdivisionScheme::kLoop},
    {"bilinear", SubdivisionScheme::kBilinear}};

/// What boundaries of the mesh do.
enum class SubdivisionBoundary {
  kEdgeOnly,       // they are smooth curves
  kEdgeAndCorner,  // the same, but vertices of one face stay where they are
};

inline constexpr Named<SubdivisionBoundary> kSubdivisionBoundaries[] = {
    {"edge-and-corner", SubdivisionBoundary::kEdgeAndCorner},
    {"edge-only", SubdivisionBoundary::kEdgeOnly}};

/// Where texture coordinates stay linear, from nowhere to everywhere. The first five are smooth
/// inside of charts.
enum class UvInterpolation {
  kSmoothAll,                           // chart boundaries are smooth curves, seams or not
  kPreserveCorners,                     // corners of charts stay
  kPreserveCornersAndJunctions,         // and where three or more charts meet
  kPreserveCornersJunctionsAndConcave,  // and concave corners, and ends of seams
  kPreserveBoundaries,                  // chart boundaries stay as they are
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

/// Raw arrays of a polygon mesh, as a caller has them.
struct PolygonArrays {
  const double* positions = nullptr;  // vertex_count x 3
  std::size_t vertex_count = 0;
  const std::int64_t* face_sizes = nullptr;  // face_count numbers of corners
  std::size_t face_count = 0;
  const std::int64_t* face_vertices = nullptr;  // corner_count indices, face by face
  const double* face_uvs = nullptr;             // corner_count x 2
  std::size_t corner_count = 0;
  const std::int64_t* crease_edges = nullptr;  // crease_count x 2 vertices
  const double* crease_sharpness = nullptr;    // crease_count; 0 and up
  std::size_t crease_count = 0;
  const std::int64_t* corner_vertices = nullptr;  // sharp_corner_count vertices
  const double* corner_sharpness = nullptr;       // sharp_corner_count; 0 and up
  std::size_t sharp_corner_count = 0;
  const double* weights = nullptr;             // one for each of weights_of
  WeightsOf weights_of = WeightsOf::kNothing;  // kTriangles: for each face; kCorners is not allowed
  const bool* kept = nullptr;  // face_count; which faces the surface has. All where null
};

/// Sharpness from here on is infinite.
constexpr double kInfiniteSharpness = 10.0;
constexpr int kMaxSubdivisionLevel = 10;

struct SubdivisionOptions {
  SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
  SubdivisionBoundary boundary = SubdivisionBoundary::kEdgeAndCorner;
  UvInterpolation uv_interpolation = UvInterpolation::kPreserveBoundaries;
  int level = 3;  // 1 to 10
  Progress progress;
};

/// The limit surface of a mesh: its faces are refined `level` times, and the vertices moved to
/// where infinitely many times would take them. So are texture coordinates, under the rule for
/// them. The areas of the triangles approach the limit's with the square of their size.
///
/// Corners of a vertex with equal texture coordinates are joined, the others are seams. Edges of
/// more than two faces, and vertices where sheets meet, are infinitely sharp. Vertices of no face
/// are dropped. Weights of vertices are interpolated linearly, those of faces are their parts'.
///
/// Throws Error for a mesh without faces, or without one that is kept; faces of fewer than three
/// corners (Loop: of other than three) or that name a vertex twice; indices out of range; creases
/// that are no edges; values that are not finite; negative sharpness or weights; a level that is
/// out of range, or makes more than 2^25 triangles; and, from the progress callback, when
/// cancelled.
Surface subdivide(const PolygonArrays& mesh, const SubdivisionOptions& options);

}  // namespace prefilter
