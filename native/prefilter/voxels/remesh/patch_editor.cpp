// SPDX-License-Identifier: GPL-3.0-or-later

// Removes vertices and triangulates their holes, or flips edges, choosing the change that leaves
// the fewest and least narrow triangles.
#include "prefilter/voxels/remesh/patch_editor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Minimum decrease of the total fault, which guarantees termination.
constexpr double kMinFaultGain = 0.05;
// Cosine of the largest angle of normals to the mean one, 20 degrees, unless the previous normals
// exceed it.
constexpr double kFlatCosine = 0.9396926207859084;
constexpr double kMinNormalCosine = 0.5;
// Maximum mean depth of the volume that a change cuts off or fills, relative to the square root of
// the area.
constexpr double kMaxDepth = 0.04;
// Below this depth no other change is tried.
constexpr double kSmallDepth = 0.005;
constexpr double kPatchEditorCreaseCosine = 0.9659258262890683;  // 15 degrees

double squared(const Vector3& v) { return dot(v, v); }

Vector3 normal_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  return cross(b - a, c - a);
}

bool has(const Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

std::size_t corner_of(const Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}
}  // namespace

double width_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 u = b - a;
  const Vector3 v = c - a;
  const double uu = squared(u);
  const double vv = squared(v);
  const double ww = squared(c - b);
  const double longest = std::max({uu, vv, ww});
  const double middle = std::max(std::min(uu, vv), std::min(std::max(uu, vv), ww));
  const double sides = longest * middle;
  return sides > 0.0 ? squared(cross(u, v)) / sides : 0.0;
}

void PatchEditor::link(std::span<const std::uint32_t> triangles) {
  for (const std::uint32_t t : triangles) {
    for (const std::int32_t vertex : edited_.mesh.triangles[t]) {
      if (!is_own(vertex)) continue;
      edited_.counts[static_cast<std::size_t>(vertex)] = 0;
    }
  }
  for (const std::uint32_t t : triangles) {
    for (const std::int32_t vertex : edited_.mesh.triangles[t]) {
      if (is_own(vertex)) ++edited_.counts[static_cast<std::size_t>(vertex)];
    }
  }
  // Assigns ranges at the first visit; the highest bit of a count marks that it restarted at 0.
  around_.clear();
  around_.reserve(4 * triangles.size());
  for (const std::uint32_t t : triangles) {
    for (const std::int32_t vertex : edited_.mesh.triangles[t]) {
      if (!is_own(vertex)) continue;
      const auto v = static_cast<std::size_t>(vertex);
      constexpr std::uint32_t kPlaced = 0x80000000;  // bit of counts: the vertex has a range
      if ((edited_.counts[v] & kPlaced) == 0) {
        edited_.firsts[v] = static_cast<std::uint32_t>(around_.size());
        around_.resize(around_.size() + edited_.counts[v]);
        edited_.counts[v] = kPlaced;
      }
      around_[edited_.firsts[v] + (edited_.counts[v]++ & ~kPlaced)] = t;
    }
  }
  for (const std::uint32_t t : triangles) {
    for (const std::int32_t vertex : edited_.mesh.triangles[t]) {
      if (is_own(vertex)) edited_.counts[static_cast<std::size_t>(vertex)] &= 0x7fffffff;
    }
  }
}

void PatchEditor::edit(std::uint32_t patch, std::span<const std::uint32_t> triangles) {
  patch_ = patch;
  narrow_.clear();
  waiting_.clear();
  link(triangles);
  for (const std::uint32_t t : triangles) {
    if (edited_.is_removed(t)) continue;
    const auto& [a, b, c] = edited_.mesh.triangles[t];
    edited_.widths[t] = static_cast<float>(width_of(point(a), point(b), point(c)));
    if (edited_.widths[t] < kMinWidth) waiting_.push_back(t);
  }
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const std::uint32_t t = waiting_[i];
    if (!edited_.is_removed(t) && edited_.widths[t] < kMinWidth) widen(t);
  }
}

void PatchEditor::widen(std::uint32_t triangle) {
  const Triangle corners = edited_.mesh.triangles[triangle];
  // Edge i is opposite to corner i.
  std::array<double, 3> squares;
  for (std::size_t i = 0; i < 3; ++i) {
    squares[i] = squared(point(corners[(i + 1) % 3]) - point(corners[(i + 2) % 3]));
  }
  std::array<std::size_t, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return squares[i] != squares[j] ? squares[i] < squares[j] : corners[i] < corners[j];
  });
  best_.count = 0;
  const auto try_flip = [&](std::size_t i) {
    find_flip(corners[(i + 1) % 3], corners[(i + 2) % 3], &candidate_);
    keep_better_change();
  };
  const auto try_removal = [&](std::int32_t vertex) {
    find_removal(vertex, &candidate_);
    keep_better_change();
  };
  const auto is_fine = [&] { return best_.count > 0 && best_.fault == 0.0; };
  // Try first the end of the shortest edge with more narrow triangles around it.
  std::array<std::int32_t, 2> ends = {corners[order[1]], corners[order[2]]};
  if (fault_around(ends[0]) < fault_around(ends[1])) std::swap(ends[0], ends[1]);
  try_flip(order[2]);
  if (!is_fine() || best_.depth > kSmallDepth) try_removal(ends[0]);
  if (!is_fine() || best_.depth > kSmallDepth) try_removal(ends[1]);
  if (!is_fine()) {
    try_removal(corners[order[0]]);
    try_flip(order[1]);
    try_flip(order[0]);
  }
  if (best_.count == 0) {
    narrow_.push_back(triangle);
    return;
  }
  apply(best_);
}

void PatchEditor::keep_better_change() {
  if (candidate_.count == 0) return;
  const bool are_fine = candidate_.fault == 0.0 && best_.fault == 0.0;
  if (best_.count == 0 ||
      (are_fine ? candidate_.depth < best_.depth : candidate_.gain > best_.gain)) {
    std::swap(candidate_, best_);
  }
}

double PatchEditor::fault_around(std::int32_t vertex) const {
  if (!is_own(vertex)) return 0.0;
  double sum = 0.0;
  for (const std::uint32_t t : triangles_of(vertex)) sum += fault_of(edited_.widths[t]);
  return sum;
}

bool PatchEditor::find_fan(std::int32_t vertex, Fan* fan) const {
  const auto around = triangles_of(vertex);
  if (around.size() < 3 || around.size() > kMaxRingSize) return false;
  fan->count = around.size();
  std::array<std::int32_t, kMaxRingSize> nexts;
  std::array<std::int32_t, kMaxRingSize> afters;
  for (std::size_t i = 0; i < fan->count; ++i) {
    const Triangle& triangle = edited_.mesh.triangles[around[i]];
    const std::size_t place = corner_of(triangle, vertex);
    nexts[i] = triangle[(place + 1) % 3];
    afters[i] = triangle[(place + 2) % 3];
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < fan->count; ++i) {
    fan->ring[i] = nexts[at];
    fan->triangles[i] = around[at];
    const std::int32_t next = afters[at];
    at = 0;
    while (at < fan->count && nexts[at] != next) ++at;
    if (at == fan->count || (at == 0) != (i + 1 == fan->count)) return false;
  }
  return true;
}

bool PatchEditor::is_edge(std::int32_t a, std::int32_t b) const {
  const std::int32_t known = is_own(a) ? a : b;
  const std::int32_t other = known == a ? b : a;
  const auto around = triangles_of(known);
  return std::any_of(around.begin(), around.end(),
                     [&](std::uint32_t t) { return has(edited_.mesh.triangles[t], other); });
}

// The common label of consecutive triangles of a fan; none if they have several.
std::optional<std::int32_t> PatchEditor::label_of_all(const Fan& fan, std::size_t begin,
                                                      std::size_t count) const {
  std::int32_t label = kNoLabel;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t other = label_of(fan.triangles[(begin + i) % fan.count]);
    if (other == kNoLabel || other == label) continue;
    if (label != kNoLabel) return std::nullopt;
    label = other;
  }
  return label;
}

// The least cosine between the normals of consecutive triangles of a fan and a direction.
double PatchEditor::least_cosine(const Fan& fan, std::size_t begin, std::size_t count,
                                 const Vector3& direction) const {
  double least = kFlatCosine;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = edited_.mesh.triangles[fan.triangles[(begin + i) % fan.count]];
    const Vector3 normal = normal_of(point(a), point(b), point(c));
    least = std::min(least, dot(normal, direction) / std::sqrt(squared(normal)));
  }
  return std::max(least, kMinNormalCosine);
}

// Adds the best triangulation of a part of a fan's ring, from `begin` to `end` inclusive, where
// indices wrap around.
bool PatchEditor::fill(const Fan& fan, std::size_t begin, std::size_t end,
                       std::size_t* triangle_count, Change* change) const {
  const std::size_t count = end - begin + 1;
  std::array<std::int32_t, kMaxRingSize> ring;
  std::array<Vector3, kMaxRingSize> points;
  for (std::size_t i = 0; i < count; ++i) {
    ring[i] = fan.ring[(begin + i) % fan.count];
    points[i] = point(ring[i]);
  }
  const std::size_t steps = count == fan.count ? count : count - 1;
  const std::optional<std::int32_t> label = label_of_all(fan, begin, steps);
  if (!label) return false;
  Vector3 mean = {};
  for (std::size_t i = 2; i < count; ++i) {
    mean = mean + normal_of(points[0], points[i - 1], points[i]);
  }
  const double mean_length = std::sqrt(squared(mean));
  if (!(mean_length > 0.0)) return false;
  change->area += 0.5 * mean_length;
  const double unit = 1.0 / mean_length;
  const Vector3 direction = {unit * mean[0], unit * mean[1], unit * mean[2]};
  const auto corners = std::span<const Vector3>(points).first(count);
  RingTriangles triangulation;
  if (!triangulate_ring(corners, direction, unit, kFlatCosine, &triangulation)) {
    const double least = least_cosine(fan, begin, steps, direction);
    if (!(least < kFlatCosine)) return false;
    if (!triangulate_ring(corners, direction, unit, least, &triangulation)) return false;
  }
  change->fault += triangulation.fault;
  for (std::size_t i = 0; i < triangulation.count; ++i) {
    const auto [a, b, c] = triangulation.triangles[i];
    change->labels[*triangle_count] = *label;
    change->triangles[(*triangle_count)++] = {ring[a], ring[b], ring[c]};
  }
  return true;
}

// Indices in the ring to which creases lead; none unless exactly two or zero creases meet.
std::optional<PatchEditor::CreaseSpokes> PatchEditor::crease_spokes(std::int32_t vertex,
                                                                    const Fan& fan) const {
  CreaseSpokes creases;
  if (edited_.mesh.labels.empty() && edited_.mesh.kinds.empty()) return creases;
  for (std::size_t i = 0; i < fan.count; ++i) {
    const std::size_t last = (i + fan.count - 1) % fan.count;
    if (!is_crease(vertex, fan.ring[i], fan.triangles[i], fan.triangles[last])) continue;
    if (creases.count == 2) return std::nullopt;
    creases.at[creases.count++] = i;
  }
  if (creases.count == 1) return std::nullopt;
  return creases;
}

// Whether the crease through a vertex is straight, its ends are on creases, and there are triangles
// on both sides.
bool PatchEditor::is_crease_straight(std::int32_t vertex, const Fan& fan,
                                     const CreaseSpokes& creases) const {
  const auto [low, high] = creases.at;
  const std::int32_t from = fan.ring[low];
  const std::int32_t to = fan.ring[high];
  if (kind_of(from) == VertexKind::kSurface || kind_of(to) == VertexKind::kSurface) return false;
  if (high - low < 2 || low + fan.count - high < 2) return false;
  const Vector3 chord = point(to) - point(from);
  const Vector3 offset = point(vertex) - point(from);
  const double tolerance = edited_.crease_tolerance;
  return squared(cross(chord, offset)) <= tolerance * tolerance * squared(chord) &&
         dot(offset, chord) > 0.0 && dot(offset, chord) < squared(chord);
}

// Whether diagonals do not exist yet, and all vertices keep three triangles or more.
bool PatchEditor::keeps_manifold(const Fan& fan, const Change& change,
                                 std::size_t triangle_count) const {
  const auto place_in_ring = [&](std::int32_t corner) {
    const auto* const it = std::find(fan.ring.begin(), fan.ring.begin() + fan.count, corner);
    return static_cast<std::size_t>(it - fan.ring.begin());
  };
  std::array<int, kMaxRingSize> uses{};
  for (std::size_t i = 0; i < triangle_count; ++i) {
    for (const std::int32_t corner : change.triangles[i]) ++uses[place_in_ring(corner)];
  }
  for (std::size_t i = 0; i < fan.count; ++i) {
    if (uses[i] > 1) continue;
    const std::int32_t corner = fan.ring[i];
    if (!is_own(corner) || triangles_of(corner).size() < 4) return false;
  }
  for (std::size_t i = 0; i < triangle_count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = change.triangles[i][k];
      const std::int32_t b = change.triangles[i][(k + 1) % 3];
      if (fan.ring[(place_in_ring(a) + 1) % fan.count] == b) continue;  // edge of the ring
      if (!is_own(a) && !is_own(b)) return false;
      if (is_edge(a, b)) return false;
    }
  }
  return true;
}

void PatchEditor::find_removal(std::int32_t vertex, Change* change) const {
  change->count = 0;
  if (!is_own(vertex) || kind_of(vertex) == VertexKind::kCorner) return;
  Fan fan;
  if (!find_fan(vertex, &fan) || fan.count < 4) return;
  double before = 0.0;
  for (std::size_t i = 0; i < fan.count; ++i) {
    before += fault_of(edited_.widths[fan.triangles[i]]);
  }
  const std::optional<CreaseSpokes> creases = crease_spokes(vertex, fan);
  if (!creases) return;
  change->vertex = vertex;
  change->fault = 0.0;
  change->area = 0.0;
  change->old_triangles = fan.triangles;
  std::size_t triangle_count = 0;
  if (creases->count == 0) {
    if (!fill(fan, 0, fan.count - 1, &triangle_count, change)) return;
  } else {
    const auto [low, high] = creases->at;
    if (!is_crease_straight(vertex, fan, *creases)) return;
    if (!fill(fan, low, high, &triangle_count, change)) return;
    if (!fill(fan, high, low + fan.count, &triangle_count, change)) return;
  }
  change->old_count = fan.count;
  change->gain = before - change->fault;
  if (!(change->gain > kMinFaultGain)) return;
  // Volume between the triangles before and after.
  const Vector3& top = point(vertex);
  double volume = 0.0;
  for (std::size_t i = 0; i < triangle_count; ++i) {
    const auto& [a, b, c] = change->triangles[i];
    volume += dot(normal_of(point(a), point(b), point(c)), point(a) - top) / 6.0;
  }
  change->depth = std::abs(volume) / (change->area * std::sqrt(change->area));
  if (!(change->depth < kMaxDepth) || !is_near_replacement(vertex, *change, triangle_count)) return;
  if (keeps_manifold(fan, *change, triangle_count)) change->count = triangle_count;
}

// Whether a removed vertex is close to the planes of the triangles that replace it.
bool PatchEditor::is_near_replacement(std::int32_t vertex, const Change& change,
                                      std::size_t triangle_count) const {
  const double most = edited_.max_height;
  for (std::size_t i = 0; i < triangle_count && most < std::numeric_limits<double>::infinity();
       ++i) {
    const auto& [a, b, c] = change.triangles[i];
    const Vector3 normal = normal_of(point(a), point(b), point(c));
    const double height = dot(normal, point(vertex) - point(a));
    if (!(height * height <= most * most * squared(normal))) return false;
  }
  return true;
}

bool PatchEditor::is_crease(std::int32_t a, std::int32_t b, std::uint32_t left,
                            std::uint32_t right) const {
  const std::int32_t label = label_of(left);
  const std::int32_t other = label_of(right);
  if (label != other && label != kNoLabel && other != kNoLabel) return true;
  if (kind_of(a) == VertexKind::kSurface || kind_of(b) == VertexKind::kSurface) return false;
  const auto normal = [&](std::uint32_t t) {
    const auto& [i, j, k] = edited_.mesh.triangles[t];
    return normal_of(point(i), point(j), point(k));
  };
  const Vector3 n = normal(left);
  const Vector3 m = normal(right);
  return dot(n, m) < kPatchEditorCreaseCosine * std::sqrt(squared(n)) * std::sqrt(squared(m));
}

void PatchEditor::find_flip(std::int32_t a, std::int32_t b, Change* change) const {
  change->count = 0;
  change->vertex = -1;
  if (!is_own(a) || !is_own(b) || triangles_of(a).size() < 4 || triangles_of(b).size() < 4) {
    return;
  }
  int uses = 0;
  std::int32_t c = -1;
  std::int32_t d = -1;
  for (const std::uint32_t t : triangles_of(a)) {
    const Triangle& triangle = edited_.mesh.triangles[t];
    const std::size_t i = corner_of(triangle, a);
    if (triangle[(i + 1) % 3] == b) {
      change->old_triangles[0] = t;
      c = triangle[(i + 2) % 3];
      ++uses;
    } else if (triangle[(i + 2) % 3] == b) {
      change->old_triangles[1] = t;
      d = triangle[(i + 1) % 3];
      ++uses;
    }
  }
  if (uses != 2 || c == d || c < 0 || d < 0 || (!is_own(c) && !is_own(d))) {
    return;
  }
  const auto [left, right] = std::array{change->old_triangles[0], change->old_triangles[1]};
  change->fault = fault_of(width_of(point(a), point(d), point(c))) +
                  fault_of(width_of(point(d), point(b), point(c)));
  change->gain = fault_of(edited_.widths[left]) + fault_of(edited_.widths[right]) - change->fault;
  if (!(change->gain > kMinFaultGain)) return;
  if (is_crease(a, b, left, right) || is_edge(c, d)) return;
  const Vector3 new_1 = normal_of(point(a), point(d), point(c));
  const Vector3 new_2 = normal_of(point(d), point(b), point(c));
  const Vector3 mean = new_1 + new_2;
  const double size = std::sqrt(squared(mean));
  for (const Vector3* normal : {&new_1, &new_2}) {
    if (!(dot(mean, *normal) > kFlatCosine * size * std::sqrt(squared(*normal)))) return;
  }
  const double area = 0.5 * size;
  const double volume = dot(new_1, point(b) - point(a)) / 6.0;
  change->depth = std::abs(volume) / (area * std::sqrt(area));
  if (!(change->depth < kMaxDepth)) return;
  // Distance between the diagonals.
  const double height = 6.0 * std::abs(volume);
  if (height >
      edited_.max_height * std::sqrt(squared(cross(point(b) - point(a), point(d) - point(c)))))
    return;
  change->old_count = 2;
  change->labels.fill(label_of(left) != kNoLabel ? label_of(left) : label_of(right));
  change->triangles[0] = {a, d, c};
  change->triangles[1] = {d, b, c};
  change->count = 2;
}

void PatchEditor::remove_around(std::int32_t vertex, std::uint32_t triangle) {
  if (!is_own(vertex)) return;
  const auto v = static_cast<std::size_t>(vertex);
  std::uint32_t* const begin = around_.data() + edited_.firsts[v];
  std::uint32_t* const end = begin + edited_.counts[v];
  std::uint32_t* const entry = std::find(begin, end, triangle);
  std::copy(entry + 1, end, entry);
  --edited_.counts[v];
}

void PatchEditor::add_around(std::int32_t vertex, std::uint32_t triangle) {
  if (!is_own(vertex)) return;
  const auto v = static_cast<std::size_t>(vertex);
  const std::uint32_t first = edited_.firsts[v];
  if (first + edited_.counts[v] != around_.size()) {
    edited_.firsts[v] = static_cast<std::uint32_t>(around_.size());
    for (std::uint32_t i = 0; i < edited_.counts[v]; ++i) around_.push_back(around_[first + i]);
  }
  around_.push_back(triangle);
  ++edited_.counts[v];
}

void PatchEditor::apply(const Change& change) {
  std::vector<Triangle>& triangles = edited_.mesh.triangles;
  for (std::size_t i = 0; i < change.old_count; ++i) {
    const std::uint32_t t = change.old_triangles[i];
    for (const std::int32_t corner : triangles[t]) remove_around(corner, t);
    triangles[t] = kRemoved;
  }
  for (std::size_t i = 0; i < change.count; ++i) {
    const std::uint32_t t = change.old_triangles[i];
    triangles[t] = change.triangles[i];
    if (!edited_.mesh.labels.empty()) edited_.mesh.labels[t] = change.labels[i];
    const auto& [a, b, c] = triangles[t];
    for (const std::int32_t corner : triangles[t]) add_around(corner, t);
    edited_.widths[t] = static_cast<float>(width_of(point(a), point(b), point(c)));
    if (edited_.widths[t] < kMinWidth) waiting_.push_back(t);
  }
  if (change.vertex >= 0) {
    edited_.owners[static_cast<std::size_t>(change.vertex)] = EditedMesh::kUnowned;
  }
}

}  // namespace prefilter
