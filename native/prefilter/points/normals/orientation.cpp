// SPDX-License-Identifier: GPL-3.0-or-later

// Propagates orientations as Hoppe et al., Surface Reconstruction from Unorganized Points (1992),
// between patches instead of points: neighbors with unambiguous normals are joined first, then
// patches by the sum of votes of all pairs along their common border.
#include "prefilter/points/normals/orientation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr std::int64_t kNormalsPerTask = 1 << 12;
// Agreements are integers up to this value, so that sums do not depend on the order.
constexpr int kFullAgreement = 1023;
constexpr int kUnambiguousAgreement = 992;  // 0.97
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Disjoint sets of normals with known relative orientations.
class SignedSets {
 public:
  struct Member {
    std::uint32_t set;
    std::uint32_t is_reversed;  // 1 if reversed relative to the set's root, otherwise 0
  };

  explicit SignedSets(std::size_t count) : links_(count) {
    for (std::size_t i = 0; i < count; ++i) links_[i] = link(static_cast<std::uint32_t>(i), 0);
  }

  Member find(std::uint32_t i) {
    std::uint32_t reversed = 0;
    while (true) {
      const std::uint32_t up = links_[i];
      const std::uint32_t next = up >> 1U;
      if (next == i) return {i, reversed};
      // Path halving.
      links_[i] = links_[next] ^ (up & 1U);
      reversed ^= links_[i] & 1U;
      i = links_[i] >> 1U;
    }
  }

  // The root with the lower index becomes the common root.
  void join(std::uint32_t a, std::uint32_t b, bool are_opposite) {
    const Member first = find(a);
    const Member second = find(b);
    if (first.set == second.set) return;
    const std::uint32_t reversed =
        first.is_reversed ^ second.is_reversed ^ static_cast<std::uint32_t>(are_opposite);
    links_[std::max(first.set, second.set)] = link(std::min(first.set, second.set), reversed);
  }

 private:
  static std::uint32_t link(std::uint32_t to, std::uint32_t reversed) {
    return (to << 1U) | reversed;
  }

  std::vector<std::uint32_t> links_;
};

std::vector<std::int16_t> agreements(const LinkedPoints& points, std::span<const Vector3> normals,
                                     const Run& run) {
  std::vector<std::int16_t> result(points.links.size());
  const auto compare = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      for (std::size_t e = i * points.degree; e < (i + 1) * points.degree; ++e) {
        const std::uint32_t j = points.links[e];
        const double share =
            std::clamp(agreement(normals[i], normals[j], points.positions[j] - points.positions[i]),
                       -1.0, 1.0);
        result[e] = static_cast<std::int16_t>(std::lround(share * kFullAgreement));
      }
    }
  };
  parallel_ranges(static_cast<std::int64_t>(points.positions.size()), kNormalsPerTask, run,
                  compare);
  return result;
}

// Index of each point's patch, and its orientation within the patch.
struct Patches {
  std::vector<SignedSets::Member> members;
  std::size_t count = 0;
};

// Joins neighbors with unambiguous normals. Points in `is_known`, if it is not empty, have final
// orientations and form one patch.
Patches grow_patches(const LinkedPoints& points, std::span<const std::int16_t> agreements,
                     const std::vector<bool>& is_known, const Run& run) {
  const std::size_t count = points.positions.size();
  SignedSets sets(count);
  CancelCheck cancel_check(run);
  const auto known = [&](std::size_t i) { return !is_known.empty() && is_known[i]; };
  std::uint32_t first_known = kNone;
  for (std::size_t i = 0, e = 0; i < count; ++i) {
    cancel_check.step();
    if (known(i)) {
      first_known = std::min(first_known, static_cast<std::uint32_t>(i));
      sets.join(first_known, static_cast<std::uint32_t>(i), false);
    }
    for (std::size_t end = e + points.degree; e < end; ++e) {
      if (std::abs(agreements[e]) < kUnambiguousAgreement || known(i) || known(points.links[e]))
        continue;
      sets.join(static_cast<std::uint32_t>(i), points.links[e], agreements[e] < 0);
    }
  }
  Patches patches;
  patches.members.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    cancel_check.step();
    SignedSets::Member& own = patches.members[i];
    own = sets.find(static_cast<std::uint32_t>(i));
    // The root of a set is its first member, so its patch already has an index.
    own.set =
        own.set == i ? static_cast<std::uint32_t>(patches.count++) : patches.members[own.set].set;
  }
  return patches;
}

// Sum of the votes between two patches: above 0 if they have the same orientation.
struct Border {
  std::uint32_t a;  // the lower index
  std::uint32_t b;
  std::int64_t votes;

  bool operator<(const Border& other) const {
    if (a != other.a) return a < other.a;
    return b != other.b ? b < other.b : votes < other.votes;
  }
};

// The border between two members of patches, or of sets of patches. Within a patch both indices are
// equal.
Border border_between(SignedSets::Member a, SignedSets::Member b, std::int64_t votes) {
  return {std::min(a.set, b.set), std::max(a.set, b.set),
          a.is_reversed != b.is_reversed ? -votes : votes};
}

// A cache of recent borders that sums votes early: consecutive pairs of points mostly belong to the
// same borders.
class RecentBorders {
 public:
  void add(const Border& border) {
    Border& slot = slots_[(border.a * 0x9E3779B9U + border.b * 0x85EBCA6BU) >> (32 - kSlotBits)];
    if (slot.a == border.a && slot.b == border.b) {
      slot.votes += border.votes;
    } else {
      if (slot.a != kNone) past_.push_back(slot);
      slot = border;
    }
  }

  std::vector<Border> take() {
    for (const Border& slot : slots_) {
      if (slot.a != kNone) past_.push_back(slot);
    }
    return std::move(past_);
  }

 private:
  static constexpr int kSlotBits = 12;
  std::vector<Border> slots_ = std::vector<Border>(std::size_t{1} << kSlotBits, {kNone, kNone, 0});
  std::vector<Border> past_;
};

std::vector<Border> find_borders(const LinkedPoints& points,
                                 std::span<const std::int16_t> agreements, const Patches& patches,
                                 const Run& run) {
  RecentBorders borders;
  CancelCheck cancel_check(run);
  for (std::size_t i = 0, e = 0; i < points.positions.size(); ++i) {
    cancel_check.step();
    for (std::size_t end = e + points.degree; e < end; ++e) {
      // The fourth power, so that many doubtful pairs count less than a few clear ones.
      const std::int64_t square = agreements[e] * agreements[e];
      const std::int64_t votes = (square * square) >> 16;
      const Border border = border_between(patches.members[i], patches.members[points.links[e]],
                                           agreements[e] < 0 ? -votes : votes);
      if (votes != 0 && border.a != border.b) borders.add(border);
    }
  }
  return borders.take();
}

// Sums the votes for each pair of patches.
void merge_borders(std::vector<Border>* borders, const Run& run) {
  sort_in_parallel(borders, run);
  std::size_t kept = 0;
  for (const Border& border : *borders) {
    if (kept > 0 && (*borders)[kept - 1].a == border.a && (*borders)[kept - 1].b == border.b) {
      (*borders)[kept - 1].votes += border.votes;
    } else {
      (*borders)[kept++] = border;
    }
  }
  borders->resize(kept);
}

// Joins each patch to the one with the most votes, and repeats that with the joined sets (Boruvka's
// algorithm).
SignedSets join_patches(std::size_t count, std::vector<Border> borders, const Run& run) {
  SignedSets sets(count);
  CancelCheck cancel_check(run);
  while (!borders.empty()) {
    merge_borders(&borders, run.part(0.0, 0.0));
    std::vector<std::uint32_t> strongest(count, kNone);
    for (std::uint32_t k = 0; k < borders.size(); ++k) {
      cancel_check.step();
      for (const std::uint32_t patch : {borders[k].a, borders[k].b}) {
        std::uint32_t& best = strongest[patch];
        if (best == kNone || std::abs(borders[k].votes) > std::abs(borders[best].votes)) best = k;
      }
    }
    for (const std::uint32_t k : strongest) {
      if (k != kNone) sets.join(borders[k].a, borders[k].b, borders[k].votes < 0);
    }
    std::vector<Border> left;
    for (const Border& border : borders) {
      cancel_check.step();
      const Border next = border_between(sets.find(border.a), sets.find(border.b), border.votes);
      if (next.a != next.b) left.push_back(next);
    }
    borders.swap(left);
  }
  return sets;
}

// Flux of the position vector, relative to a center, through a part of the surface. For a closed
// surface it is three times the enclosed volume, for any center.
struct Flux {
  double sum = 0.0;
  double most = 0.0;  // the sum if every normal were parallel to its position vector

  void add(const Vector3& offset, const Vector3& normal, double area) {
    sum += area * dot(offset, normal);
    most += area * std::sqrt(dot(offset, offset));
  }
  bool is_surer_than(const Flux& other) const {
    return std::abs(sum) * other.most > std::abs(other.sum) * most;
  }
};

struct Part {
  Vector3 first_moment{};
  double area = 0.0;
  Flux from_own_middle;
  Flux from_whole_middle;

  Vector3 middle() const {
    return {first_moment[0] / area, first_moment[1] / area, first_moment[2] / area};
  }
};

// Whether the normals of each set point inward on the whole. A convex set shows that by itself; a
// piece of a larger surface, such as a separate face of a box, by the position of the other pieces.
std::vector<bool> sets_inside_out(const LinkedPoints& points, std::span<const Vector3> normals,
                                  const Patches& patches, const Run& run) {
  // Normalized, so that products neither overflow nor vanish.
  Box box = kEmptyBox;
  for (const Vector3& position : points.positions) box.include(position);
  const double size = std::max({box.size(0), box.size(1), box.size(2)});
  const double largest = *std::max_element(points.areas.begin(), points.areas.end());
  const auto place = [&](std::size_t i) {
    Vector3 p = points.positions[i] - box.low;
    for (double& x : p) x /= size;
    return p;
  };
  std::vector<Part> parts(patches.count);
  Part whole;
  CancelCheck cancel_check(run);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    cancel_check.step();
    const double area = points.areas[i] / largest;
    const Vector3 p = place(i);
    for (Part* part : {&parts[patches.members[i].set], &whole}) {
      for (int a = 0; a < 3; ++a) part->first_moment[a] += area * p[a];
      part->area += area;
    }
  }
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    cancel_check.step();
    Part& part = parts[patches.members[i].set];
    const double area = points.areas[i] / largest;
    const Vector3 p = place(i);
    const Vector3 normal =
        patches.members[i].is_reversed != 0 ? Vector3{} - normals[i] : normals[i];
    part.from_own_middle.add(p - part.middle(), normal, area);
    part.from_whole_middle.add(p - whole.middle(), normal, area);
  }
  std::vector<bool> result;
  for (const Part& part : parts) {
    const Flux& flux = part.from_own_middle.is_surer_than(part.from_whole_middle)
                           ? part.from_own_middle
                           : part.from_whole_middle;
    result.push_back(flux.sum < 0.0);
  }
  return result;
}

// Reverses normals that clearly point down. Returns which normals clearly point up or down.
std::vector<bool> turn_up(std::vector<Vector3>* normals) {
  // Sine of ten degrees, the usual error of estimated normals.
  constexpr double kMinVertical = 0.17;
  std::vector<bool> is_known(normals->size());
  for (std::size_t i = 0; i < normals->size(); ++i) {
    Vector3& normal = (*normals)[i];
    is_known[i] = std::abs(normal[2]) >= kMinVertical;
    if (is_known[i] && normal[2] < 0.0) normal = Vector3{} - normal;
  }
  return is_known;
}

// Whether the normals of each set point down: decided by its known normals, otherwise by the mean.
std::vector<bool> sets_upside_down(const LinkedPoints& points, std::span<const Vector3> normals,
                                   const Patches& patches, const std::vector<bool>& is_known,
                                   const Run& run) {
  const double largest = *std::max_element(points.areas.begin(), points.areas.end());
  std::vector<double> sums(patches.count);
  std::vector<bool> has_known(patches.count);
  std::vector<bool> result(patches.count);
  CancelCheck cancel_check(run);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    cancel_check.step();
    const SignedSets::Member& own = patches.members[i];
    if (is_known[i]) {
      has_known[own.set] = true;
      result[own.set] = own.is_reversed != 0;
    }
    const double up = points.areas[i] / largest * normals[i][2];
    sums[own.set] += own.is_reversed != 0 ? -up : up;
  }
  for (std::size_t k = 0; k < patches.count; ++k) {
    if (!has_known[k]) result[k] = sums[k] < 0.0;
  }
  return result;
}

}  // namespace

double agreement(const Vector3& a, const Vector3& b, const Vector3& offset) {
  const double square = dot(offset, offset);
  return square > 0.0 ? dot(a, b) - dot(a, offset) * dot(b, offset) / square : 0.0;
}

void orient_normals(const LinkedPoints& points, NormalSide side, const Run& run,
                    std::vector<Vector3>* normals) {
  std::vector<bool> is_known;
  if (side == NormalSide::kUp) is_known = turn_up(normals);
  const std::vector<std::int16_t> near = agreements(points, *normals, run.part(0.0, 0.3));
  Patches patches = grow_patches(points, near, is_known, run.part(0.3, 0.6));
  std::vector<Border> borders = find_borders(points, near, patches, run.part(0.6, 0.7));
  SignedSets sets = join_patches(patches.count, std::move(borders), run.part(0.7, 0.9));
  for (SignedSets::Member& own : patches.members) {
    const SignedSets::Member patch = sets.find(own.set);
    own = {patch.set, own.is_reversed ^ patch.is_reversed};
  }
  const Run last = run.part(0.9, 1.0);
  const std::vector<bool> is_wrong =
      side == NormalSide::kUp ? sets_upside_down(points, *normals, patches, is_known, last)
                              : sets_inside_out(points, *normals, patches, last);
  const auto reverse = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const SignedSets::Member& own = patches.members[i];
      Vector3& normal = (*normals)[i];
      if ((own.is_reversed != 0) != is_wrong[own.set]) normal = Vector3{} - normal;
    }
  };
  parallel_ranges(static_cast<std::int64_t>(normals->size()), kNormalsPerTask, run.part(1.0, 1.0),
                  reverse);
}

}  // namespace prefilter
