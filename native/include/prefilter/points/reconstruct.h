// SPDX-License-Identifier: GPL-3.0-or-later

// Reconstructs closed surfaces from oriented points (chapter 4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/base/point_attribute.h"
#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/phantoms.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/trim_surface.h"

namespace prefilter {

enum class WaveletBasis {
  kHaar,  // piecewise constant: fast, and sharp where points are clean
  kD4,    // Daubechies, four coefficients: wider support, so less noise
};

inline constexpr Named<WaveletBasis> kWaveletBases[] = {{"haar", WaveletBasis::kHaar},
                                                        {"d4", WaveletBasis::kD4}};

enum class Isovalue {
  kMean,   // the mean of the function at the points
  kHalf,   // 1/2
  kGiven,  // a number
};

struct ReconstructOptions {
  // 1 to kMaxTreeDepth: 2^depth cells along the longest axis. None: the greatest depth at which at
  // least half of the surface has one point per face of a cell.
  std::optional<int> depth;
  // Alternative to `depth`: the least depth at which cells are no larger than this. Sizes in single
  // precision may be rounded down.
  std::optional<double> cell_size;
  WaveletBasis basis = WaveletBasis::kHaar;
  bool smooth = true;  // smooth the indicator function over neighboring cells
  Isovalue isovalue = Isovalue::kMean;
  double given_isovalue = 0.5;  // for a function that is 0 outside and 1 inside
  // Normals are trusted to point out of the solid (they were given, or face the scanner). In a
  // room, where they point inward, they and the mesh's are kept. Otherwise most normals are assumed
  // to point outward.
  bool are_sides_known = false;
  // Check whether normals are missing or contradict each other; if so, make no mesh.
  bool check_normals = false;
  bool fit = true;  // move vertices onto the surface of the points around them
  // Close the surface. Otherwise it ends where the points do: regions far from all points, relative
  // to the points' spacing, are cut as TrimOptions describes.
  bool watertight = false;
  // Alternative to this, independent of `watertight`: omit triangles with a vertex that is farther
  // than this from all points, in cells, above 0 and up to 1e6.
  std::optional<double> trim;
  // Tolerance, in finest cells, within which simplified triangles follow the surface; 0 to 1e6,
  // where 0 disables simplification. Remaining vertices do not move. With `support`, vertices
  // farther from all points than TrimOptions::distance all remain.
  double adaptivity = 0.0;
  bool support = false;  // add the attributes of support_attributes() to vertices
  // Bytes, not counting the memory of the source and the sink; 0 requests the minimum.
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();
  std::string folder;  // for temporary files; "": the system's
  Run run;
};

/// Points that were excluded as invalid, counted by the first reason that applies.
struct DroppedPoints {
  std::size_t not_finite = 0;  // a coordinate is not finite, or beyond 1e300
  std::size_t huge = 0;        // a coordinate beyond 1e30, unlike most other points
  std::size_t weightless = 0;  // a weight outside (0, 1e30]
  std::size_t normalless = 0;  // a normal of length 0 or not finite

  std::size_t sum() const { return not_finite + huge + weightless + normalless; }
  void add(const DroppedPoints& other) {
    not_finite += other.not_finite;
    huge += other.huge;
    weightless += other.weightless;
    normalless += other.normalless;
  }
};

/// Faults in the normals of a cloud that prevent a reconstruction.
enum class NormalFault {
  kNone,
  kMissing,        // some have no direction
  kContradictory,  // neighboring normals are opposed over most of the surface
};

struct ReconstructReport {
  std::size_t points = 0;
  DroppedPoints dropped;
  // Positions of excluded phantom points, which `dropped` does not count.
  std::vector<PhantomPlace> phantoms;
  std::size_t strays = 0;  // excluded: about twice as far from the mean as all other points
  // Set with `check_normals`. If there is a fault, there is no mesh, and the fields below are
  // unset.
  NormalFault normal_fault = NormalFault::kNone;
  // Share of neighbors whose normals are opposed although they do not lie on the other side of a
  // thin part.
  double contradiction = 0.0;
  double outliers = 0.0;  // weight of the outliers, as a share of all weight
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  bool is_flipped = false;  // most normals pointed inward and were reversed
  bool is_room = false;     // most normals point inward and were kept
  double residual = 0.0;    // deviation of a sample from the local surface, in finest cells
  int depth = 0;            // of the octree
  double cell = 0.0;        // the side of a finest cell
  // Step to which coordinates were rounded by single precision, if above a quarter of a cell; else
  // 0.
  double float_step = 0.0;
  bool is_spilled = false;  // temporary files were used
  TrimReport trimmed;       // cut for lack of support; excludes `trim`
};

/// The two attributes that vertices get after those of the points: the distance from the nearest
/// points, in local spacings but at least a cell, and the number of points per area.
std::vector<PointAttribute> support_attributes();

/// Reconstructs the surface of oriented points: the isosurface of a function that is 1 inside and 0
/// outside. Wavelet coefficients of the function are sums over the points (equation 4.2), weighted
/// by the area that each represents; their octree is contoured on its dual grid.
///
/// The mesh is two-manifold except with `trim`, and closed if it is watertight or points lie on all
/// sides. Triangles are counterclockwise seen from the side to which normals point. The result does
/// not depend on the number of threads or the memory limit; with another order of the points it
/// differs by rounding only.
///
/// Throws Error for options out of range, cells that are too small, fewer than 3 valid points,
/// points that all coincide, normals that cancel everywhere, a mesh without triangles, and a memory
/// limit that is positive but too low; exceptions of the source and the sink; Error(kOutOfMemory);
/// Error(kCancelled).
ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink);

}  // namespace prefilter
