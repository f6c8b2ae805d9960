// SPDX-License-Identifier: GPL-3.0-or-later

// Point-to-plane registration against the triangles nearest to the points.
#include "prefilter/points/align_to_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/geometry/nearest.h"
#include "prefilter/points/cloud/motion_system.h"
#include "prefilter/points/cloud/moved_scan.h"

namespace prefilter {
namespace {

// A surface relative to an origin, with its search structure.
class PlacedSurface {
 public:
  PlacedSurface(const InputMesh& mesh, const Vector3& origin, const Run& run)
      : positions_(moved_to(origin, mesh)),
        triangles_(mesh.triangles),
        nearest_({positions_, triangles_}, run) {}

  // Pairs samples of a scan with points of the surface.
  std::vector<MotionPair> pairs(const MovedScan& scan, std::span<const std::uint32_t> samples,
                                double reach, const Run& run) const;

 private:
  static std::vector<Vector3> moved_to(const Vector3& origin, const InputMesh& mesh) {
    std::vector<Vector3> positions;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      positions.push_back(mesh.positions[v] - origin);
    }
    return positions;
  }
  const Vector3& corner(std::int64_t triangle, std::size_t i) const {
    return positions_[static_cast<std::size_t>(triangles_[static_cast<std::size_t>(triangle)][i])];
  }

  std::vector<Vector3> positions_;
  TriangleView triangles_;
  NearestPoints nearest_;
};

std::vector<MotionPair> PlacedSurface::pairs(const MovedScan& scan,
                                             std::span<const std::uint32_t> samples, double reach,
                                             const Run& run) const {
  std::vector<Vector3> points;
  for (const std::uint32_t place : samples) {
    points.push_back(moved(scan.motion, scan.position(place)));
  }
  const Vector3 center = moved(scan.motion, scan.center());
  const std::vector<SurfacePoint> nearest = nearest_.find(points, run);
  std::vector<MotionPair> pairs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfacePoint& surface_point = nearest[i];
    if (surface_point.distance > reach) continue;
    const Vector3& a = corner(surface_point.triangle, 0);
    const Vector3 to_b = corner(surface_point.triangle, 1) - a;
    const Vector3 to_c = corner(surface_point.triangle, 2) - a;
    Vector3 normal = cross(to_b, to_c);
    const double size = length(normal);
    if (!(size > 0.0)) continue;
    normal = 1.0 / size * normal;
    if (dot(normal, turned(scan.motion, scan.normal(samples[i]))) < kMinNormalCosine) continue;
    const Vector3 offset =
        points[i] - (a + surface_point.weights[1] * to_b + surface_point.weights[2] * to_c);
    const double distance = dot(normal, offset);
    // Beyond a border, the nearest point lies sideways.
    const Vector3 aside = offset - distance * normal;
    if (length(aside) > scan.spacing() + 0.5 * std::abs(distance)) continue;
    pairs.push_back({distance, derivative(normal, points[i] - center), {}});
  }
  return pairs;
}

void add_to(const std::vector<MotionPair>& pairs, std::size_t scan, Alignment* result,
            std::vector<double>* distances) {
  add_distances(pairs, distances);
  result->pairs[scan] = pairs.size();
}

// The inverse motion.
RigidMotion inverse(const RigidMotion& motion) {
  RigidMotion result;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) result.rows[r][c] = motion.rows[c][r];
  }
  result.shift = Vector3{} - turned(result, motion.shift);
  return result;
}

}  // namespace

Alignment align_to_surface(std::span<const ScanView> scans, std::span<const RigidMotion> motions,
                           const InputMesh& surface, const AlignOptions& options) {
  check_alignment(scans, options, 1);
  if (motions.size() != scans.size()) {
    throw_invalid("motions: found " + std::to_string(motions.size()) + " for " +
                  std::to_string(scans.size()) + " scans; one for each is needed");
  }
  const Vector3 origin = middle_of(box_of(scans));
  const PlacedSurface placed(surface, origin, options.run.part(0.0, 0.1));
  Alignment result;
  result.pairs.resize(scans.size());
  std::vector<double> before;
  std::vector<double> after;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const auto share = [&](double done) {
      return 0.1 + 0.9 * (static_cast<double>(s) + done) / static_cast<double>(scans.size());
    };
    const Run run = options.run.part(share(0.0), share(1.0));
    MovedScan scan(scans[s], origin, run.part(0.0, 0.2));
    scan.motion = relative_to(motions[s], origin);
    const std::vector<std::uint32_t> samples = scan.samples(kMaxSamples);
    const double most = kMinReach * scan.spacing();
    const double reach = std::min(options.reach.value_or(most), most);
    const auto pairs_at = [&](double from, double to) {
      return placed.pairs(scan, samples, reach, run.part(from, to));
    };
    std::vector<MotionPair> pairs = pairs_at(0.2, 0.25);
    add_to(pairs, s, &result, &before);
    for (int k = 0; k < options.iterations && !pairs.empty(); ++k) {
      std::vector<double> distances;
      add_distances(pairs, &distances);
      MotionSystem system(2);
      system.add(1, 0, pairs, cutoff_for(median_of(&distances), kMinMotion * scan.spacing()));
      const double moved = scan.move(system.solve()[1]);
      const double done = 0.25 + 0.75 * k / options.iterations;
      pairs = pairs_at(done, done + 0.75 / options.iterations);
      if (moved < kMinMotion * scan.spacing()) break;
    }
    add_to(pairs, s, &result, &after);
    result.motions.push_back(relative_to(scan.motion, Vector3{} - origin));
  }
  const RigidMotion back = then(inverse(result.motions.front()), motions.front());
  for (RigidMotion& motion : result.motions) motion = then(motion, back);
  result.motions.front() = motions.front();
  result.before = median_of(&before);
  result.after = median_of(&after);
  options.run.report(1.0);
  return result;
}

}  // namespace prefilter
