// SPDX-License-Identifier: GPL-3.0-or-later

// Which side of a shape points are on where parts of its sources meet.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/source_surface.h"
#include "prefilter/voxels/contour/thickened_cells.h"

namespace prefilter {

/// How a shape was combined from the parts of its sources is not known; it is learned from the
/// tree: close to where some parts meet, cells that are full or empty tell what being inside of one
/// part and outside of another amounts to. Occupancies of cells that several parts run through do
/// not tell it: max(a, b) and min(a, b) are not the occupancies of unions and intersections.
class PartSides {
 public:
  /// Throws Error(kCancelled).
  PartSides(const ContourTree& tree, const RootFrame& frame, const SourceSurface& surface,
            const Progress& progress);

  /// Puts leaves where parts meet on the side that most of them is on, by the parts' planes, but
  /// for those that are thickened. Throws Error(kCancelled).
  void settle(const ThickenedCells& thickened, const Progress& progress, int threads,
              ContourTree* tree) const;

  /// Where the segment from `in`, a point that counts as inside, to `out` leaves the shape; of
  /// several places the one nearest to `expected`. `is_known` tells whether what is inside is known
  /// along the segment: not where fewer than two parts are close.
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

  // The normals, outward, of the planes of two parts between which the shape is; none where it is
  // elsewhere, too.
  std::optional<std::array<Vector3, 2>> wedge_normals(const Parts& parts) const;
  // Whether the shape is at a point, and both parts are near.
  bool is_between(const Parts& parts, const Vector3& point) const;
  // The side of a leaf in the tip of a wedge, where the occupancies of single cells would leave
  // teeth. All leaves are inside that its middle runs through, so that it has no holes, up to where
  // it is too thin for that: from there on, the loops at its end reach to its tip.
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
