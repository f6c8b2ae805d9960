// SPDX-License-Identifier: GPL-3.0-or-later

// Each part gets the least that keeps it. What winding numbers make of the mesh, with its holes
// closed, is looked up in the cells that it is going to have; parts that leave no contour there are
// replaced, and the rest is looked at again, since their caps are gone.
#include "prefilter/solid/open_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/solid/close_holes.h"
#include "prefilter/solid/fill.h"
#include "prefilter/solid/kept.h"
#include "prefilter/solid/reach.h"
#include "prefilter/solid/shell.h"
#include "prefilter/voxel/queries.h"
#include "prefilter/voxel/voxelize.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 10;
// A part that was of one mind is turned against it only where this many times more of it is seen
// from the other side.
constexpr double kAgainstItself = 4.0;
// Shares of a part's area: lost of an open one that becomes a sheet, of a closed one that is
// thickened, of one that is thickened where it is lost; without an outside of one that is buried.
constexpr double kLostOfSheet = 0.25;
constexpr double kLostOfThin = 0.5;
constexpr double kLostInPart = 0.005;
constexpr double kInnerOfBuried = 0.8;
// In cells: the least volume over its area of a part that encloses something.
constexpr double kBulkyCells = 1.0;
constexpr int kRounds = 3;
// Of a part that counts as closed: the square of the length of its border over its area.
constexpr double kLargestHole = 0.02;
// The mean occupancy of a region below which it is not filled by winding numbers.
constexpr double kLeastFilling = 0.9;
constexpr std::size_t kMostRegionSamples = 1U << 16;
constexpr double kSampleCells = 2.0;

enum class Fate : std::uint8_t {
  kWound,   // stays, and winding numbers say what is inside
  kSheet,   // replaced by a shell
  kBuried,  // dropped: the outside is on neither side
  kFilled,  // replaced by the surface of a region
};

// Shares of a triangle, by what is in front of it and behind it.
struct Sides {
  float outside_both = 0.0F;
  float outside_front = 0.0F;
  float outside_back = 0.0F;
  float inside_both = 0.0F;
  ReachGrid::Label region = ReachGrid::kMet;  // one that it has on one side alone
};

class OpenParts {
 public:
  OpenParts(const Patches& patches, const SolidOptions& options, WorkMesh* mesh,
            SolidReport* report)
      : patches_(patches), options_(options), mesh_(mesh), report_(report) {
    fates_.assign(patches.patches.size(), Fate::kWound);
    areas_.resize(mesh->triangles.size());
    for (std::size_t t = 0; t < areas_.size(); ++t) {
      const std::array<Vector3, 3> p = mesh->corners(t);
      areas_[t] = length(cross(p[1] - p[0], p[2] - p[0])) / 2.0;
    }
  }

  bool mend(const Progress& progress) {
    const bool has_open = has_open_part();
    if (!has_open && !has_thin_part()) return false;
    if (has_open) {
      grid_.emplace(mesh_->view(), options_.cell, options_.gap * options_.cell,
                    progress.part(0.0, 0.2), options_.threads);
      look(progress.part(0.2, 0.3));
      turn();
    }
    for (int round = 0; round < kRounds; ++round) {
      const double begin = 0.3 + 0.5 * round / kRounds;
      if (!judge(round, progress.part(begin, begin + 0.5 / kRounds))) break;
    }
    const bool is_rebuilt = rebuild(progress.part(0.8, 1.0));
    progress.report(1.0);
    return is_rebuilt || is_turned_;
  }

 private:
  const Patch& patch_of(std::size_t t) const { return patches_.patches[patches_.patch_of[t]]; }
  Fate fate_of(std::size_t t) const { return fates_[patches_.patch_of[t]]; }

  // Parts with small holes alone are wound around as they are.
  bool has_open_part() const {
    const auto& patches = patches_.patches;
    return std::any_of(patches.begin(), patches.end(), [&](const Patch& patch) {
      const bool is_nearly_closed = patch.is_orientable && patch.turned_area == 0.0 &&
                                    patch.border * patch.border < kLargestHole * patch.area &&
                                    patch.volume > options_.cell * patch.area;
      return !patch.is_closed() && !is_nearly_closed;
    });
  }
  bool is_thin(const Patch& patch) const {
    return patch.is_closed() &&
           2.0 * std::abs(patch.volume) < options_.thickness * options_.cell * patch.area;
  }
  bool has_thin_part() const {
    return std::any_of(patches_.patches.begin(), patches_.patches.end(),
                       [&](const Patch& patch) { return is_thin(patch); });
  }

  // What is in front of the triangles, and behind them.
  void look(const Progress& progress) {
    sides_.resize(mesh_->triangles.size());
    parallel_ranges(static_cast<std::int64_t>(sides_.size()), kRowsPerTask, options_.threads,
                    progress, [&](std::int64_t begin, std::int64_t end) {
                      for (auto t = static_cast<std::size_t>(begin);
                           t < static_cast<std::size_t>(end); ++t) {
                        sides_[t] = sides_of(mesh_->corners(t));
                      }
                    });
  }

  Sides sides_of(const std::array<Vector3, 3>& corners) const {
    Sides sides;
    Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double size = length(normal);
    if (!(size > 0.0)) return sides;
    for (double& x : normal) x /= size;
    const Vector3 back = {-normal[0], -normal[1], -normal[2]};
    float samples = 0.0F;
    for_samples(corners, kSampleCells * grid_->cell(), [&](const Vector3& point) {
      samples += 1.0F;
      const ReachGrid::Label in_front = grid_->along(point, normal);
      const ReachGrid::Label behind = grid_->along(point, back);
      const auto is_region = [](ReachGrid::Label l) { return l >= ReachGrid::kFirstRegion; };
      const auto is_outside = [](ReachGrid::Label l) { return l == ReachGrid::kOutside; };
      if (is_outside(in_front) && is_outside(behind)) sides.outside_both += 1.0F;
      if (is_region(in_front) && is_region(behind)) sides.inside_both += 1.0F;
      if (is_outside(in_front) && is_region(behind)) sides.outside_front += 1.0F;
      if (is_region(in_front) && is_outside(behind)) sides.outside_back += 1.0F;
      if (is_region(in_front) != is_region(behind)) {
        sides.region = is_region(in_front) ? in_front : behind;
      }
    });
    for (float* share :
         {&sides.outside_both, &sides.outside_front, &sides.outside_back, &sides.inside_both}) {
      *share /= samples;
    }
    return sides;
  }

  // Turns open patches as a whole, and single triangles of those that cannot be oriented.
  void turn() {
    const std::size_t count = patches_.patches.size();
    std::vector<double> front(count, 0.0);
    std::vector<double> back(count, 0.0);
    std::vector<double> both(count, 0.0);
    std::vector<double> volumes(count, 0.0);  // with a fan over the border
    for (std::size_t t = 0; t < sides_.size(); ++t) {
      const std::uint32_t p = patches_.patch_of[t];
      front[p] += areas_[t] * sides_[t].outside_front;
      back[p] += areas_[t] * sides_[t].outside_back;
      both[p] += areas_[t] * sides_[t].outside_both;
      const std::array<Vector3, 3> corners = mesh_->corners(t);
      const Vector3& middle = patches_.patches[p].border_middle;
      volumes[p] += dot(corners[0] - middle, cross(corners[1] - middle, corners[2] - middle)) / 6.0;
    }
    std::vector<bool> is_turned(count, false);
    for (std::size_t p = 0; p < count; ++p) {
      const Patch& patch = patches_.patches[p];
      if (patch.is_closed() || !patch.is_orientable) continue;
      const double limit = patch.turned_area > 0.0 || patch.triangles == 1 ? 1.0 : kAgainstItself;
      is_turned[p] = back[p] > limit * front[p] && back[p] > 0.1 * patch.area;
      // The outside reaches both sides of what is open wide: as with closed parts, by the volume.
      if (both[p] > patch.area / 2.0) {
        is_turned[p] = -volumes[p] > kBulkyCells * options_.cell * patch.area;
      }
      if (is_turned[p]) ++report_->turned_parts;
    }
    for (std::size_t t = 0; t < sides_.size(); ++t) {
      const Patch& patch = patch_of(t);
      const bool is_single =
          !patch.is_orientable && sides_[t].outside_back > sides_[t].outside_front;
      if (!is_single && !is_turned[patches_.patch_of[t]]) continue;
      if (is_single) ++report_->turned_faces;
      is_turned_ = true;
      std::swap(mesh_->triangles[t][1], mesh_->triangles[t][2]);
      std::swap(sides_[t].outside_front, sides_[t].outside_back);
    }
  }

  // The triangles that stay, with what they were among all.
  WorkMesh wound() const {
    WorkMesh result;
    result.positions = mesh_->positions;
    for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
      if (fate_of(t) != Fate::kWound) continue;
      result.triangles.push_back(mesh_->triangles[t]);
      result.origins.push_back(mesh_->origins[t]);
    }
    return result;
  }

  // Its occupancies, with its holes closed.
  Octree voxels_of(const WorkMesh& mesh, const Progress& progress) const {
    Box box = kEmptyBox;
    for (const Patch& patch : patches_.patches) box.include(patch.box);
    Octree octree = empty_tree_around(box, options_.cell);
    if (mesh.triangles.empty()) return octree;
    bool has_area = false;
    for (std::size_t t = 0; t < mesh.triangles.size() && !has_area; ++t) {
      const std::array<Vector3, 3> p = mesh.corners(t);
      has_area = length(cross(p[1] - p[0], p[2] - p[0])) > 0.0;
    }
    if (!has_area) return octree;
    CloseHolesOptions holes;
    holes.method = HoleMethod::kFan;
    // So that sheets are lost, and get a thickness.
    holes.leaves_losses = false;
    holes.progress = progress.part(0.0, 0.3);
    holes.threads = options_.threads;
    const Caps caps = close_holes({mesh.positions, mesh.triangles}, holes);
    std::vector<Vector3> positions = mesh.positions;
    positions.insert(positions.end(), caps.positions.begin(), caps.positions.end());
    std::vector<std::array<std::int32_t, 3>> triangles = mesh.triangles;
    for (const auto& [a, b, c] : caps.triangles) {
      triangles.push_back({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
                           static_cast<std::int32_t>(c)});
    }
    VoxelizeOptions options;
    options.depth = octree.depth;
    options.bounds = octree.bounds;
    options.threads = options_.threads;
    options.progress = progress.part(0.3, 1.0);
    return voxelize({positions, triangles}, options);
  }

  // Decides on the parts that are still wound. Returns whether any other is left to be looked at
  // again.
  bool judge(int round, const Progress& progress) {
    if (std::find(fates_.begin(), fates_.end(), Fate::kWound) == fates_.end()) return false;
    const Octree octree = voxels_of(wound(), progress.part(0.0, 0.7));
    shares_ = kept_shares(mesh_->view(), octree, progress.part(0.7, 0.9), options_.threads);
    const bool is_filling = round == 0 && grid_ && options_.gap > 0.0 && fill_regions(octree);
    const std::size_t count = patches_.patches.size();
    std::vector<double> lost(count, 0.0);
    std::vector<double> inner(count, 0.0);
    std::vector<double> seen(count, 0.0);
    for (std::size_t t = 0; t < areas_.size(); ++t) {
      lost[patches_.patch_of[t]] += areas_[t] * (1.0 - shares_[t]);
      if (!grid_) continue;
      const Sides& sides = sides_[t];
      inner[patches_.patch_of[t]] += areas_[t] * sides.inside_both;
      seen[patches_.patch_of[t]] +=
          areas_[t] * (sides.outside_both + sides.outside_front + sides.outside_back);
    }
    bool has_changed = is_filling;
    is_thickened_.assign(count, false);
    for (std::size_t p = 0; p < count; ++p) {
      const Patch& patch = patches_.patches[p];
      if (fates_[p] != Fate::kWound) continue;
      if (patch.is_closed()) {
        is_thickened_[p] = is_thin(patch) && lost[p] > kLostOfThin * patch.area;
      } else if (lost[p] > kLostOfThin * patch.area &&
                 inner[p] > kInnerOfBuried * (inner[p] + seen[p])) {
        fates_[p] = Fate::kBuried;
        has_changed = true;
      } else if (lost[p] > kLostOfSheet * patch.area && options_.thickness > 0.0) {
        fates_[p] = Fate::kSheet;
        has_changed = true;
      } else {
        is_thickened_[p] = lost[p] > kLostInPart * patch.area && options_.thickness > 0.0;
      }
    }
    return has_changed;
  }

  // Finds the regions that are not filled, though they are bounded by open parts for the most; and
  // the parts that bound them.
  bool fill_regions(const Octree& octree) {
    const std::size_t labels = grid_->region_end();
    if (labels == ReachGrid::kFirstRegion) return false;
    std::vector<double> open(labels, 0.0);
    std::vector<double> closed(labels, 0.0);
    for (std::size_t t = 0; t < sides_.size(); ++t) {
      (patch_of(t).is_closed() ? closed : open)[sides_[t].region] += areas_[t];
    }
    const std::vector<double> means = region_means(octree);
    is_filled_.assign(labels, false);
    for (std::size_t r = ReachGrid::kFirstRegion; r < labels; ++r) {
      is_filled_[r] = open[r] > closed[r] && means[r] < kLeastFilling;
    }
    if (std::find(is_filled_.begin(), is_filled_.end(), true) == is_filled_.end()) return false;
    std::vector<double> bounding(patches_.patches.size(), 0.0);
    for (std::size_t t = 0; t < sides_.size(); ++t) {
      const Sides& sides = sides_[t];
      if (!is_filled_[sides.region]) continue;
      bounding[patches_.patch_of[t]] += areas_[t] * (sides.outside_front + sides.outside_back);
    }
    bool any = false;
    for (std::size_t p = 0; p < bounding.size(); ++p) {
      const Patch& patch = patches_.patches[p];
      if (patch.is_closed() || bounding[p] <= patch.area / 2.0) continue;
      fates_[p] = Fate::kFilled;
      any = true;
    }
    if (!any) is_filled_.clear();
    return any;
  }

  // The mean occupancy of each region.
  std::vector<double> region_means(const Octree& octree) const {
    const auto& labels = grid_->labels();
    std::vector<double> sums(grid_->region_end(), 0.0);
    std::vector<double> counts(grid_->region_end(), 0.0);
    const auto cells = static_cast<std::size_t>(std::count_if(
        labels.begin(), labels.end(), [](auto l) { return l >= ReachGrid::kFirstRegion; }));
    const std::size_t step = cells / kMostRegionSamples + 1;
    std::vector<Vector3> points;
    std::vector<ReachGrid::Label> of_points;
    std::size_t place = 0;
    const auto& [nx, ny, nz] = grid_->size();
    for (int x = 0; x < nx; ++x) {
      for (int y = 0; y < ny; ++y) {
        for (int z = 0; z < nz; ++z) {
          const ReachGrid::Label label = labels[grid_->index(x, y, z)];
          if (label < ReachGrid::kFirstRegion || place++ % step != 0) continue;
          of_points.push_back(label);
          points.push_back({grid_->origin()[0] + (x + 0.5) * grid_->cell(),
                            grid_->origin()[1] + (y + 0.5) * grid_->cell(),
                            grid_->origin()[2] + (z + 0.5) * grid_->cell()});
        }
      }
    }
    const std::vector<float> values = values_at(octree, points, options_.threads);
    for (std::size_t i = 0; i < points.size(); ++i) {
      sums[of_points[i]] += values[i] >= 0.5F ? 1.0 : 0.0;
      counts[of_points[i]] += 1.0;
    }
    for (std::size_t r = 0; r < sums.size(); ++r) sums[r] /= std::max(counts[r], 1.0);
    return sums;
  }

  // Returns whether the triangles are others.
  bool rebuild(const Progress& progress) {
    std::vector<std::uint32_t> thin;
    for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
      const std::uint32_t p = patches_.patch_of[t];
      const bool is_lost = is_thickened_[p] && shares_[t] < 1.0F;
      if (fates_[p] == Fate::kSheet || is_lost) thin.push_back(static_cast<std::uint32_t>(t));
    }
    for (std::size_t p = 0; p < fates_.size(); ++p) {
      if (fates_[p] == Fate::kSheet || is_thickened_[p]) ++report_->thickened_parts;
      if (fates_[p] == Fate::kFilled) ++report_->filled_parts;
    }
    const bool is_same = thin.empty() && std::all_of(fates_.begin(), fates_.end(), [](Fate fate) {
                           return fate == Fate::kWound;
                         });
    if (is_same) {
      count_lost();
      return false;
    }
    WorkMesh result = wound();
    if (!is_filled_.empty()) {
      const TriangleMesh filled = filled_regions(mesh_->view(), *grid_, is_filled_,
                                                 progress.part(0.0, 0.5), options_.threads);
      const auto first = static_cast<std::int32_t>(result.positions.size());
      result.positions.insert(result.positions.end(), filled.positions.begin(),
                              filled.positions.end());
      for (const auto& [a, b, c] : filled.triangles) {
        result.triangles.push_back({first + a, first + b, first + c});
      }
      result.origins.resize(result.triangles.size(), -1);
    }
    add_shell(mesh_->view(), mesh_->origins, thin, options_.thickness * options_.cell / 2.0,
              &result);
    const Octree octree = voxels_of(result, progress.part(0.5, 0.8));
    shares_ = kept_shares(mesh_->view(), octree, progress.part(0.8, 1.0), options_.threads);
    count_lost();
    *mesh_ = std::move(result);
    return true;
  }

  void count_lost() {
    std::vector<double> lost(patches_.patches.size(), 0.0);
    for (std::size_t t = 0; t < areas_.size(); ++t) {
      lost[patches_.patch_of[t]] += areas_[t] * (1.0 - shares_[t]);
    }
    for (std::size_t p = 0; p < lost.size(); ++p) {
      const bool may_be_lost = fates_[p] != Fate::kBuried;
      if (may_be_lost && lost[p] > patches_.patches[p].area / 2.0) ++report_->lost_parts;
    }
  }

  const Patches& patches_;
  const SolidOptions& options_;
  WorkMesh* mesh_;
  SolidReport* report_;
  std::vector<Fate> fates_;
  std::vector<bool> is_thickened_;
  std::vector<double> areas_;    // of the triangles
  std::vector<Sides> sides_;     // of the triangles
  std::vector<float> shares_;    // of the triangles, kept
  std::vector<bool> is_filled_;  // of the labels
  std::optional<ReachGrid> grid_;
  bool is_turned_ = false;
};

}  // namespace

bool mend_open_parts(const Patches& patches, const SolidOptions& options, const Progress& progress,
                     WorkMesh* mesh, SolidReport* report) {
  return OpenParts(patches, options, mesh, report).mend(progress);
}

}  // namespace prefilter
