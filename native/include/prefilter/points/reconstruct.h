// SPDX-License-Identifier: GPL-3.0-or-later

// Oriented points to closed surfaces (chapter 4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/base/point_attribute.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/phantoms.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/trim_surface.h"

namespace prefilter {

enum class WaveletBasis {
  kHaar,  // blocks: fast, and sharp where points are clean
  kD4,    // Daubechies' with four coefficients: more points to a coefficient, so less noise
};

inline constexpr Named<WaveletBasis> kWaveletBases[] = {{"haar", WaveletBasis::kHaar},
                                                        {"d4", WaveletBasis::kD4}};

enum class Isovalue {
  kMean,   // the mean of the function at the points
  kHalf,   // 1/2
  kGiven,  // a number
};

struct ReconstructOptions {
  // 1 to kMaxTreeDepth: 2^depth cells along the longest axis. None: the greatest at which half of
  // the surface has a point for each face of a cell.
  std::optional<int> depth;
  // Instead: the least depth at which cells have no longer sides. Sizes in single precision may be
  // rounded down.
  std::optional<double> cell_size;
  WaveletBasis basis = WaveletBasis::kHaar;
  bool smooth = true;  // the indicator function, over the neighboring cells
  Isovalue isovalue = Isovalue::kMean;
  double given_isovalue = 0.5;  // of a function that is 0 outside and 1 inside
  // Normals point for sure to where there is nothing: given, or toward the scanner. Those that
  // point into what they enclose, as in a room, do so then, and so do those of the mesh. Otherwise
  // most of them are taken to point outward.
  bool are_sides_known = false;
  // Find out whether normals are missing or contradict each other, and make no mesh then.
  bool check_normals = false;
  bool fit = true;  // move vertices onto the surface of the points around them
  // The surface is closed. Else it ends where points do, as TrimOptions say: what lies far from
  // them, measured by how far they are from one another, is cut.
  bool watertight = false;
  // Instead, and whatever `watertight` says: leave out triangles with a vertex that is farther from
  // all points than so many cells, above 0 and up to 1e6.
  std::optional<double> trim;
  // How far triangles that are made larger may leave the surface, in finest cells, up to 1e6; 0:
  // none is. Vertices that stay do not move. With support those stay that are farther from all
  // points than TrimOptions have it.
  double adaptivity = 0.0;
  bool support = false;  // vertices get the attributes that support_attributes() names
  // In bytes, beside what the source and the sink keep; 0: as little as can be.
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();
  std::string folder;  // for temporary files; "": the system's
  int threads = 0;     // 0: all processors
  Progress progress;
};

/// Points that were left out as they tell nothing, each by the first cause that holds.
struct DroppedPoints {
  std::size_t not_finite = 0;  // a coordinate that is no number, or beyond 1e300
  std::size_t huge = 0;        // beyond 1e30, as most others are not
  std::size_t weightless = 0;  // a weight that is not in (0, 1e30]
  std::size_t normalless = 0;  // a normal without a direction

  std::size_t sum() const { return not_finite + huge + weightless + normalless; }
  void add(const DroppedPoints& other) {
    not_finite += other.not_finite;
    huge += other.huge;
    weightless += other.weightless;
    normalless += other.normalless;
  }
};

/// What is wrong with the normals of a cloud, so that it has no surface yet.
enum class NormalFault {
  kNone,
  kMissing,        // some have no direction
  kContradictory,  // those of near points are opposed, over most of the surface
};

struct ReconstructReport {
  std::size_t points = 0;
  DroppedPoints dropped;
  // Where points were left out that stand for nothing that was seen; none of them is in `dropped`.
  std::vector<PhantomPlace> phantoms;
  std::size_t strays = 0;  // left out as they are twice as far from the middle as all others
  // With `check_normals`; where there is a fault, nothing else was found, and there is no mesh.
  NormalFault normal_fault = NormalFault::kNone;
  // Of the neighbors of points, the share whose normals are opposed to the points' without being
  // on the other side of a thin part.
  double contradiction = 0.0;
  double outliers = 0.0;  // the weight of those left out as outliers, of that of all
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  bool is_flipped = false;  // normals point inward, most of them: taken as the opposite
  bool is_room = false;     // normals point inward, most of them, and were kept
  double residual = 0.0;    // the mean distance of samples from the local surface, in cells
  int depth = 0;            // of the octree
  double cell = 0.0;        // the side of a finest cell
  // What coordinates were rounded to by single precision, if more than a quarter of a cell; else 0.
  double float_step = 0.0;
  bool is_spilled = false;  // temporary files were needed
  TrimReport trimmed;       // what was cut as no points support it; not by `trim`
};

/// What vertices get besides the attributes of points, after these: the distance from the nearest
/// points, in spacings of those, or in cells where these are larger; and how many points there are
/// to an area around.
std::vector<PointAttribute> support_attributes();

/// The surface of oriented points: where a function that is 1 inside and 0 outside takes the
/// iso-value. Wavelet coefficients of the function are sums over the points (equation 4.2), each of
/// the area that follows from its neighbors; the octree they make is contoured on its dual grid.
///
/// The mesh is two-manifold, but where `trim` was given, and closed if it is watertight or points
/// lie all around; the side that normals point to is where triangles are counter-clockwise. It is
/// the same for any number of threads and any limit of memory, and to rounding for any order of the
/// points.
///
/// Throws Error for options out of range, cells that are too small, fewer than 3 points that count,
/// or points that all coincide, normals that cancel each other everywhere, a mesh of no triangle, a
/// limit of memory that is above 0 and too low;
/// what the source and the sink throw; Error(kOutOfMemory); Error(kCancelled).
ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink);

}  // namespace prefilter
