// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/solid/close_holes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/solid/border_loops.h"
#include "prefilter/solid/closed_parts.h"
#include "prefilter/solid/fair_patch.h"
#include "prefilter/solid/span_loop.h"
#include "prefilter/spatial/winding_numbers.h"

namespace prefilter {
namespace {

constexpr std::size_t kMostFanned = 6;      // edges
constexpr std::size_t kMostFaired = 400;    // points of a border that a patch is made smooth over
constexpr std::size_t kFewEdges = 64;       // of loops that are quick to close
constexpr double kThinnest = 0.03;          // of a part that is no sheet, as a share of its width
constexpr double kLargestSheetHole = 0.25;  // of the sheet's area
constexpr double kThinnestTurned = 0.12;    // where all is inside out
constexpr double kWindingLoss = 0.2;        // what a cap may take away from what is inside
constexpr double kTurned = -0.25;           // the winding number at a cap that is inside out
constexpr std::size_t kMostSamples = 16;    // of a cap
constexpr std::size_t kAllSamples = 200000;
constexpr std::int64_t kLoopsPerTask = 16;
constexpr std::size_t kRowsPerReport = 1U << 18U;

double size_of(const Vector3& v) { return std::sqrt(dot(v, v)); }

// To coordinates of about 1 and back.
struct Frame {
  Vector3 middle{};
  double scale = 0.0;

  explicit Frame(const Box& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = box.low[a] / 2.0 + box.high[a] / 2.0;
      scale = std::max(scale, box.high[a] / 2.0 - box.low[a] / 2.0);
    }
  }
  Vector3 to(const Vector3& p) const {
    Vector3 result;
    for (std::size_t a = 0; a < 3; ++a) result[a] = (p[a] - middle[a]) / scale;
    return result;
  }
  Vector3 back(const Vector3& p) const {
    Vector3 result;
    for (std::size_t a = 0; a < 3; ++a) result[a] = middle[a] + scale * p[a];
    return result;
  }
};

// The triangles over a loop; those of its vertices have the first numbers.
struct Cap {
  std::vector<Vector3> added;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Cap fan(const PositionView& positions, std::span<const std::uint32_t> loop) {
  Cap cap;
  const auto count = static_cast<std::uint32_t>(loop.size());
  if (count == 3) {
    cap.triangles.push_back({0, 1, 2});
    return cap;
  }
  // The middle of the line, not of its vertices, which may crowd together.
  Vector3 middle{};
  double around = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3& a = positions[loop[i]];
    const Vector3& b = positions[loop[(i + 1) % loop.size()]];
    const double weight = length(b - a);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      middle[axis] += weight * (a[axis] / 2.0 + b[axis] / 2.0);
    }
    around += weight;
  }
  for (double& x : middle) x /= around;
  cap.added.push_back(middle);
  for (std::uint32_t i = 0; i < count; ++i) cap.triangles.push_back({count, i, (i + 1) % count});
  return cap;
}

// Over long loops between some of their points, with the others put in at the end.
HolePatch smooth_patch(const std::vector<Vector3>& loop, std::span<const Vector3> normals,
                       const Progress& progress) {
  const std::vector<std::uint32_t> kept = outline(loop, kMostFaired);
  std::vector<Vector3> points;
  for (const std::uint32_t i : kept) points.push_back(loop[i]);
  const std::vector<Vector3> beside = mean_normals(normals, kept);
  HolePatch patch = span_loop(points, beside, progress.part(0.0, 0.1));
  refine_patch(&patch, progress.part(0.1, 0.2));
  fair_patch(beside, &patch, progress.part(0.2, 0.9));
  if (kept.size() == loop.size()) return patch;
  const auto within = patch.points().subspan(kept.size());
  const auto added = static_cast<std::uint32_t>(loop.size() - kept.size());
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const HolePatch::Triangle& triangle : patch.triangles()) {
    triangles.push_back(triangle.corners);
    for (std::uint32_t& corner : triangles.back()) {
      corner = corner < kept.size() ? kept[corner] : corner + added;
    }
  }
  points = loop;
  points.insert(points.end(), within.begin(), within.end());
  HolePatch whole(std::move(points), triangles, {normals.begin(), normals.end()});
  put_in(loop, true, &whole, progress.part(0.9, 1.0));
  return whole;
}

// Closes the loops of a mesh one by one, and says which caps to keep.
class Closing {
 public:
  Closing(const InputMesh& mesh, const CloseHolesOptions& options)
      : mesh_(mesh),
        options_(options),
        loops_(border_loops(mesh, part(0.0, 0.4), options.threads)) {}

  Caps caps() {
    Caps result;
    result.open_edges = loops_.open_edges;
    result.holes = loops_.size();
    if (loops_.size() == 0) {
      options_.progress.report(1.0);
      return result;
    }
    kept_.assign(loops_.size(), 1);
    if (options_.leaves_losses) leave_single_faces();
    make_caps(true, part(0.4, 0.5));
    if (options_.leaves_losses) leave_sheets(part(0.5, 0.55));
    if (options_.method == HoleMethod::kSmooth) make_caps(false, part(0.55, 0.9));
    if (options_.leaves_losses) leave_losses(part(0.9, 0.99));
    for (std::size_t i = 0; i < loops_.size(); ++i) append(i, &result);
    options_.progress.report(1.0);
    return result;
  }

 private:
  Progress part(double from, double to) const { return options_.progress.part(from, to); }

  bool is_kept(std::size_t i) const { return kept_[i] != 0; }

  Vector3 vertex(std::size_t loop, std::uint32_t index) const {
    const auto vertices = loops_.loop(loop);
    return index < vertices.size() ? mesh_.positions[vertices[index]]
                                   : caps_[loop].added[index - vertices.size()];
  }

  // The cap of a triangle by itself is the same, turned over.
  void leave_single_faces() {
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      const auto faces = loops_.faces_beside(i);
      if (faces.size() == 3 && faces[0] != BorderLoops::kNone && faces[0] == faces[1] &&
          faces[0] == faces[2]) {
        kept_[i] = 0;
      }
    }
  }

  bool is_fanned(std::size_t i) const {
    if (options_.method == HoleMethod::kFan || loops_.loop(i).size() == 3) return true;
    const auto faces = loops_.faces_beside(i);
    const bool is_double = std::all_of(
        faces.begin(), faces.end(), [](std::uint32_t face) { return face == BorderLoops::kNone; });
    return is_double || (options_.method == HoleMethod::kSmooth && faces.size() <= kMostFanned);
  }

  Box box_of(std::size_t i) const {
    Box box = kEmptyBox;
    for (const std::uint32_t v : loops_.loop(i)) box.include(mesh_.positions[v]);
    return box;
  }

  Cap cap_of(std::size_t i, bool is_first, const Progress& progress) const {
    const auto loop = loops_.loop(i);
    const Frame frame(box_of(i));
    std::vector<Vector3> points;
    for (const std::uint32_t v : loop) points.push_back(frame.to(mesh_.positions[v]));
    std::vector<Vector3> normals;
    for (const std::uint32_t face : loops_.faces_beside(i)) {
      Vector3 normal{};
      if (face != BorderLoops::kNone) {
        auto [a, b, c] = mesh_.corners(face);
        a = frame.to(a);
        normal = cross(frame.to(b) - a, frame.to(c) - a);
        const double size = length(normal);
        for (double& x : normal) x = size > 0.0 && std::isfinite(size) ? x / size : 0.0;
      }
      normals.push_back(normal);
    }
    const HolePatch patch =
        is_first ? span_loop(points, normals, progress) : smooth_patch(points, normals, progress);
    Cap cap;
    for (const Vector3& p : patch.points().subspan(loop.size())) cap.added.push_back(frame.back(p));
    for (const HolePatch::Triangle& triangle : patch.triangles()) {
      cap.triangles.push_back(triangle.corners);
    }
    return cap;
  }

  // The first caps are fans or spans; those that continue the surface then replace spans.
  void make_caps(bool is_first, const Progress& progress) {
    caps_.resize(loops_.size());
    const auto count = static_cast<std::int64_t>(loops_.size());
    const auto close = [&](std::size_t i, const Progress& own) {
      if (!is_kept(i)) return;
      if (!is_fanned(i) && box_has_size(i)) {
        caps_[i] = cap_of(i, is_first, own);
      } else if (is_first) {
        caps_[i] = fan(mesh_.positions, loops_.loop(i));
      }
    };
    parallel_ranges(count, kLoopsPerTask, options_.threads, progress.part(0.0, 0.5),
                    [&](std::int64_t begin, std::int64_t end) {
                      for (std::int64_t i = begin; i < end; ++i) {
                        const auto loop = static_cast<std::size_t>(i);
                        if (loops_.loop(loop).size() <= kFewEdges) close(loop, Progress());
                      }
                    });
    const double all = static_cast<double>(loops_.vertices.size());
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (loops_.loop(i).size() <= kFewEdges) continue;
      close(i, progress.part(0.5 + 0.5 * static_cast<double>(loops_.begins[i]) / all,
                             0.5 + 0.5 * static_cast<double>(loops_.begins[i + 1]) / all));
    }
  }

  bool box_has_size(std::size_t i) const {
    const Frame frame(box_of(i));
    return frame.scale > 0.0 && std::isfinite(1.0 / frame.scale);
  }

  std::array<Vector3, 3> corners(std::size_t i, std::size_t triangle) const {
    const auto& [a, b, c] = caps_[i].triangles[triangle];
    return {vertex(i, a), vertex(i, b), vertex(i, c)};
  }

  // A part of the mesh with the caps of its loops.
  struct Part {
    Vector3 origin{};
    double area = 0.0;
    double volume = 0.0;  // six times it, with the caps
    std::vector<std::size_t> loops;
    std::vector<double> caps;  // the areas of their caps
  };

  static void add(const Frame& frame, const std::array<Vector3, 3>& corners, Part* part,
                  double* area) {
    const Vector3 a = frame.to(corners[0]) - part->origin;
    const Vector3 b = frame.to(corners[1]) - part->origin;
    const Vector3 c = frame.to(corners[2]) - part->origin;
    *area += size_of(cross(b - a, c - a)) / 2.0;
    part->volume += dot(a, cross(b, c));
  }

  void leave_sheets(const Progress& progress) {
    Box box = kEmptyBox;
    for (const auto& triangle : mesh_.triangles) {
      for (const std::int64_t v : triangle)
        box.include(mesh_.positions[static_cast<std::size_t>(v)]);
    }
    const Frame frame(box);
    if (!(frame.scale > 0.0)) return;
    std::map<std::uint32_t, Part> parts;
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (!is_kept(i)) continue;
      const std::uint32_t first = loops_.loop(i)[0];
      Part& own = parts[loops_.parts[first]];
      if (own.loops.empty()) own.origin = frame.to(mesh_.positions[first]);
      own.loops.push_back(i);
    }
    std::vector<Part*> part_of(mesh_.positions.size(), nullptr);
    for (auto& [id, own] : parts) part_of[id] = &own;
    double whole = 0.0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (t % kRowsPerReport == 0) {
        progress.report(static_cast<double>(t) / static_cast<double>(mesh_.triangles.size()));
      }
      const auto first = static_cast<std::size_t>(mesh_.triangles[t][0]);
      if (Part* own = part_of[loops_.parts[first]]) {
        add(frame, mesh_.corners(t), own, &own->area);
      } else {
        has_others_ = true;
        Part other;
        double area = 0.0;
        add(frame, mesh_.corners(t), &other, &area);
        whole += other.volume;
      }
    }
    for (auto& [id, own] : parts) {
      for (const std::size_t i : own.loops) {
        own.caps.push_back(0.0);
        for (std::size_t t = 0; t < caps_[i].triangles.size(); ++t) {
          add(frame, corners(i, t), &own, &own.caps.back());
        }
      }
      whole += own.volume;
    }
    is_turned_ = whole < 0.0;
    const double thinnest = is_turned_ ? kThinnestTurned : kThinnest;
    std::size_t solids = 0;
    for (auto& [id, own] : parts) {
      const auto outer = std::max_element(own.caps.begin(), own.caps.end());
      if (std::abs(own.volume) / 6.0 > thinnest * own.area * std::sqrt(*outer)) {
        ++solids;
        solids_.insert(solids_.end(), own.loops.begin(), own.loops.end());
        continue;
      }
      has_others_ = true;
      for (auto cap = own.caps.begin(); cap != own.caps.end(); ++cap) {
        if (cap != outer && *cap <= kLargestSheetHole * own.area) continue;
        kept_[own.loops[static_cast<std::size_t>(cap - own.caps.begin())]] = 0;
      }
    }
    has_others_ = has_others_ || solids > 1;
    std::sort(solids_.begin(), solids_.end());
  }

  // Points on the caps of solid parts: in the middle of triangles, evenly by area.
  struct Sample {
    std::size_t loop;
    Vector3 point;
  };
  std::vector<Sample> samples(const Frame& frame) const {
    std::vector<Sample> result;
    const std::size_t most = std::clamp<std::size_t>(
        kAllSamples / std::max<std::size_t>(solids_.size(), 1), 1, kMostSamples);
    for (const std::size_t i : solids_) {
      std::vector<double> sums = {0.0};
      for (std::size_t t = 0; t < caps_[i].triangles.size(); ++t) {
        const auto [a, b, c] = corners(i, t);
        sums.push_back(sums.back() +
                       size_of(cross(frame.to(b) - frame.to(a), frame.to(c) - frame.to(a))));
      }
      const std::size_t count = std::min(most, caps_[i].triangles.size());
      for (std::size_t k = 0; k < count; ++k) {
        const double sum =
            sums.back() * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const auto above = std::upper_bound(sums.begin() + 1, sums.end() - 1, sum);
        const auto t = static_cast<std::size_t>(above - sums.begin()) - 1;
        const auto [a, b, c] = corners(i, t);
        Vector3 middle = frame.to(a) + frame.to(b) + frame.to(c);
        for (double& x : middle) x /= 3.0;
        result.push_back({i, middle});
      }
    }
    return result;
  }

  void leave_losses(const Progress& progress) {
    // What is alone, and turned outwards, cannot lose.
    if (solids_.empty() || !has_others_) return;
    Box box = kEmptyBox;
    for (const auto& triangle : mesh_.triangles) {
      for (const std::int64_t v : triangle)
        box.include(mesh_.positions[static_cast<std::size_t>(v)]);
    }
    const Frame frame(box);
    std::vector<Vector3> positions;
    positions.reserve(mesh_.positions.size());
    // Vertices that no triangle has may be anywhere.
    for (const Vector3& p : mesh_.positions) {
      Vector3 q = frame.to(p);
      for (double& x : q) x = std::clamp(x, -2.0, 2.0);
      positions.push_back(q);
    }
    Caps caps;
    for (std::size_t i = 0; i < loops_.size(); ++i) append(i, &caps);
    if (caps.triangles.empty()) return;
    const std::vector<Sample> asked = samples(frame);
    std::vector<Vector3> points;
    for (const Sample& sample : asked) points.push_back(sample.point);
    const WindingNumbers of_mesh({positions, mesh_.triangles}, progress.part(0.0, 0.4),
                                 options_.threads);
    const std::vector<double> raw = of_mesh.find(points, progress.part(0.4, 0.6), options_.threads);
    for (const Vector3& p : caps.positions) positions.push_back(frame.to(p));
    const WindingNumbers of_caps({positions, caps.triangles}, progress.part(0.6, 0.8),
                                 options_.threads);
    const std::vector<double> closed =
        of_caps.find(points, progress.part(0.8, 1.0), options_.threads);
    const double sign = is_turned_ ? -1.0 : 1.0;
    for (std::size_t begin = 0; begin < asked.size();) {
      std::size_t end = begin;
      double change = 0.0;
      double sum = 0.0;
      for (; end < asked.size() && asked[end].loop == asked[begin].loop; ++end) {
        change += sign * closed[end];
        sum += sign * (raw[end] + closed[end]);
      }
      const auto count = static_cast<double>(end - begin);
      if (change < -kWindingLoss * count || sum < kTurned * count) kept_[asked[begin].loop] = 0;
      begin = end;
    }
  }

  void append(std::size_t i, Caps* caps) const {
    if (!is_kept(i)) {
      ++caps->left_open;
      return;
    }
    const auto loop = loops_.loop(i);
    const auto first = static_cast<std::int64_t>(mesh_.positions.size() + caps->positions.size()) -
                       static_cast<std::int64_t>(loop.size());
    caps->positions.insert(caps->positions.end(), caps_[i].added.begin(), caps_[i].added.end());
    for (const auto& triangle : caps_[i].triangles) {
      std::array<std::int64_t, 3> own;
      for (std::size_t k = 0; k < 3; ++k) {
        own[k] = triangle[k] < loop.size() ? static_cast<std::int64_t>(loop[triangle[k]])
                                           : first + static_cast<std::int64_t>(triangle[k]);
      }
      caps->triangles.push_back(own);
    }
  }

  const InputMesh& mesh_;
  const CloseHolesOptions& options_;
  BorderLoops loops_;
  std::vector<Cap> caps_;
  std::vector<unsigned char> kept_;
  std::vector<std::size_t> solids_;  // the loops of parts that are no sheets
  bool has_others_ = false;          // more than one part
  bool is_turned_ = false;
};

}  // namespace

Caps close_holes(const InputMesh& mesh, const CloseHolesOptions& options) {
  check_mesh(mesh, kLargestCoordinate);
  if (is_balanced(mesh, options.progress.part(0.0, 0.05), options.threads)) return {};
  return Closing(mesh, options).caps();
}

}  // namespace prefilter
