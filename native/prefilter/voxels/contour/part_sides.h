// SPDX-License-Identifier: GPL-3.0-or-later

// Determines the side of points where parts of a shape's sources meet.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/source_surface.h"
#include "prefilter/voxels/contour/thickened_cells.h"

namespace prefilter {

/// The operation that combined the parts of the sources is unknown, so it is learned from the tree:
/// near intersections of parts, full and empty cells show for each combination of inside and
/// outside which side of the shape it is. Cells that several parts cross are not used, since max(a,
/// b) and min(a, b) are not the occupancies of unions and intersections.
class PartSides {
 public:
  /// Throws Error(kCancelled).
  PartSides(const ContourTree& tree, const RootFrame& frame, const SourceSurface& surface,
            const Run& run);

  /// Assigns leaves where parts meet, except thickened ones, to the side on which most of their
  /// volume lies, by the parts' planes. Throws Error(kCancelled).
  void settle(const ThickenedCells& thickened, const Run& run, ContourTree* tree) const;

  /// The point at which the segment from `in`, which must be inside, to `out` leaves the shape; if
  /// there are several, the one nearest to `expected`. `is_known` is set if the sides along the
  /// segment are known, which requires at least two parts nearby.
  std::optional<SourcePoint> exit(const Vector3& in, const Vector3& out, const Vector3& expected,
                                  bool* is_known) const;

 private:
  static constexpr std::size_t kMostParts = 3;
  struct Parts {
    std::array<std::int32_t, kMostParts> numbers{-1, -1, -1};
    std::array<SourcePoint, kMostParts> planes{};
    std::size_t count = 0;

    unsigned inside_at(const Vector3& point) const;  // bit i: inside of part i
  };
  struct Votes {
    std::array<int, 1U << kMostParts> inside{};
    std::array<int, 1U << kMostParts> outside{};
  };

  // Outward normals of the planes of two parts if the shape is exactly the wedge between them; none
  // otherwise.
  std::optional<std::array<Vector3, 2>> wedge_normals(const Parts& parts) const;
  // Whether a point is in the shape, and both parts are near.
  bool is_between(const Parts& parts, const Vector3& point) const;
  // The side of a leaf in the tip of a wedge, where the occupancies of single cells would produce
  // teeth. All leaves crossed by the wedge's center plane are inside, so that it has no holes, up
  // to where it is too thin; from there the loops at its end reach to its tip.
  std::optional<bool> side_in_wedge(const Parts& parts, const Vector3& center,
                                    const Vector3& size) const;
  std::optional<bool> is_mostly_inside(const Vector3& center, const Vector3& size) const;
  std::optional<Parts> parts_near(const Vector3& point) const;
  std::optional<bool> is_inside(const Parts& parts, unsigned inside) const;

  const SourceSurface& surface_;
  const RootFrame& frame_;
  std::map<std::array<std::int32_t, kMostParts>, Votes> votes_;
};

}  // namespace prefilter
