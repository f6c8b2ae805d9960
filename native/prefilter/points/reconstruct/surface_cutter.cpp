// SPDX-License-Identifier: GPL-3.0-or-later

// Trims like the surface trimmer of M. Kazhdan, H. Hoppe, Screened Poisson surface reconstruction
// (2013), but by the distance from the samples instead of their density.
#include "prefilter/points/reconstruct/surface_cutter.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace prefilter {
namespace {

// Outputs the remaining mesh part by part. Vertices are numbered in order of first use.
class CutWriter {
 public:
  CutWriter(const SurfaceRegions& regions, double distance, std::size_t width,
            std::size_t out_width, MeshCounts* counts)
      : regions_(regions),
        distance_(distance),
        width_(width),
        out_width_(out_width),
        counts_(*counts) {}

  void write(const CutPart& part, MeshSink* sink);

 private:
  using Edge = std::pair<std::int64_t, std::int64_t>;

  double distance(std::uint32_t v) const {
    return static_cast<double>(
        part_->attributes[(v + std::size_t{1}) * width_ - kSupportAttributes]);
  }
  bool is_retained(std::uint32_t v) const { return regions_.is_kept(part_->components[v]); }
  std::int64_t number_of(std::uint32_t v);
  std::int64_t number_between(std::uint32_t near, std::uint32_t far);
  void add_triangle(const std::array<std::uint32_t, 3>& triangle);
  void add_fan(const CutFan& fan);
  void cut_triangle(const std::array<std::uint32_t, 3>& triangle, std::size_t retained);
  void retain_shared();
  std::vector<std::int64_t> shared() const;  // numbers that later parts may refer to

  const SurfaceRegions& regions_;
  double distance_;
  std::size_t width_;
  std::size_t out_width_;
  MeshCounts& counts_;
  // Numbers of vertices, and of cut vertices on edges, that were output with earlier parts.
  std::unordered_map<std::int64_t, std::int64_t> known_;
  std::map<Edge, std::int64_t> known_cuts_;

  // State of the current part.
  const CutPart* part_ = nullptr;
  std::vector<std::int64_t> numbers_;
  std::map<Edge, std::int64_t> cuts_;
  std::vector<Vector3> positions_;
  std::vector<float> attributes_;
  std::vector<std::array<std::int64_t, 3>> triangles_;
};

std::int64_t CutWriter::number_of(std::uint32_t v) {
  if (numbers_[v] >= 0) return numbers_[v];
  const auto it = known_.find(part_->ids[v]);
  if (it != known_.end()) return numbers_[v] = it->second;
  numbers_[v] = static_cast<std::int64_t>(counts_.vertices++);
  positions_.push_back(part_->positions[v]);
  const auto first = part_->attributes.begin() + static_cast<std::ptrdiff_t>(v * width_);
  attributes_.insert(attributes_.end(), first, first + static_cast<std::ptrdiff_t>(out_width_));
  return numbers_[v];
}

std::int64_t CutWriter::number_between(std::uint32_t near, std::uint32_t far) {
  const Edge edge = {part_->ids[near], part_->ids[far]};
  const auto known = known_cuts_.find(edge);
  if (known != known_cuts_.end()) return known->second;
  const auto [it, is_new] = cuts_.try_emplace(edge, 0);
  if (!is_new) return it->second;
  it->second = static_cast<std::int64_t>(counts_.vertices++);
  const double at = crossing(distance_, distance(near), distance(far));
  const Vector3& from = part_->positions[near];
  positions_.push_back(from + at * (part_->positions[far] - from));
  for (std::size_t a = 0; a < out_width_; ++a) {
    const auto low = static_cast<double>(part_->attributes[near * width_ + a]);
    const auto high = static_cast<double>(part_->attributes[far * width_ + a]);
    attributes_.push_back(static_cast<float>(low + at * (high - low)));
  }
  if (out_width_ == width_) {
    attributes_[attributes_.size() - kSupportAttributes] = static_cast<float>(distance_);
  }
  return it->second;
}

// Cuts a triangle of which `retained` corners, one or two, remain.
void CutWriter::cut_triangle(const std::array<std::uint32_t, 3>& triangle, std::size_t retained) {
  std::size_t lone = 0;
  while (is_retained(triangle[lone]) != (retained == 1)) ++lone;
  const std::uint32_t a = triangle[lone];
  const std::uint32_t b = triangle[(lone + 1) % 3];
  const std::uint32_t c = triangle[(lone + 2) % 3];
  if (retained == 1) {
    const std::int64_t corner = number_of(a);
    const std::int64_t second = number_between(a, b);
    triangles_.push_back({corner, second, number_between(a, c)});
    return;
  }
  const std::int64_t first = number_of(b);
  const std::int64_t second = number_of(c);
  const std::int64_t third = number_between(c, a);
  const std::int64_t fourth = number_between(b, a);
  triangles_.push_back({first, second, third});
  triangles_.push_back({first, third, fourth});
}

void CutWriter::retain_shared() {
  std::unordered_map<std::int64_t, std::int64_t> known;
  const auto is_kept = [&](std::int64_t id) {
    return std::binary_search(part_->shared_ids.begin(), part_->shared_ids.end(), id);
  };
  for (const auto& [id, number] : known_) {
    if (is_kept(id)) known.emplace(id, number);
  }
  for (std::size_t v = 0; v < numbers_.size(); ++v) {
    if (numbers_[v] >= 0 && is_kept(part_->ids[v])) known.emplace(part_->ids[v], numbers_[v]);
  }
  known_ = std::move(known);
  known_cuts_.merge(cuts_);
  std::erase_if(known_cuts_, [&](const auto& entry) {
    return !is_kept(entry.first.first) || !is_kept(entry.first.second);
  });
}

std::vector<std::int64_t> CutWriter::shared() const {
  std::vector<std::int64_t> numbers;
  for (const auto& [id, number] : known_) numbers.push_back(number);
  for (const auto& [edge, number] : known_cuts_) numbers.push_back(number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

void CutWriter::add_triangle(const std::array<std::uint32_t, 3>& triangle) {
  const auto retained = static_cast<std::size_t>(std::count_if(
      triangle.begin(), triangle.end(), [&](std::uint32_t v) { return is_retained(v); }));
  if (retained == 0) return;
  if (retained < 3) {
    cut_triangle(triangle, retained);
    return;
  }
  std::array<std::int64_t, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = number_of(triangle[i]);
  triangles_.push_back(corners);
}

// Divides a facet only where it is cut; otherwise outputs the original triangle.
void CutWriter::add_fan(const CutFan& fan) {
  const std::uint32_t middle = part_->triangles[fan.first][2];
  std::vector<std::uint32_t> around;
  for (std::uint32_t i = fan.first; i < fan.first + fan.count; ++i) {
    const std::uint32_t v = part_->triangles[i][0];
    const bool is_corner =
        std::find(fan.corners.begin(), fan.corners.end(), v) != fan.corners.end();
    if (is_corner || !is_retained(v)) around.push_back(v);
  }
  if (around.size() == 3 && is_retained(middle)) {
    add_triangle(fan.corners);
    return;
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    add_triangle({around[i], around[(i + 1) % around.size()], middle});
  }
}

void CutWriter::write(const CutPart& part, MeshSink* sink) {
  part_ = &part;
  numbers_.assign(part.size(), -1);
  cuts_.clear();
  std::size_t t = 0;
  for (const CutFan& fan : part.fans) {
    while (t < fan.first) add_triangle(part.triangles[t++]);
    add_fan(fan);
    t += fan.count;
  }
  while (t < part.triangles.size()) add_triangle(part.triangles[t++]);
  retain_shared();
  counts_.triangles += triangles_.size();
  if (!positions_.empty()) {
    sink->add_vertices(std::exchange(positions_, {}), std::exchange(attributes_, {}));
  }
  if (!triangles_.empty()) sink->add_triangles(std::exchange(triangles_, {}));
  sink->end_part(shared());
}

}  // namespace

SurfaceCutter::SurfaceCutter(const TrimOptions& options, std::size_t width, double cell,
                             bool keeps_support, std::uint64_t memory_limit, std::string folder)
    : options_(options),
      width_(width),
      keeps_support_(keeps_support),
      builder_({options.distance, cell, width}, &regions_),
      parts_(memory_limit, std::move(folder)) {}

TrimReport SurfaceCutter::finish(const Run& run, MeshSink* sink) {
  const TrimReport report = regions_.decide(options_);
  const std::size_t out_width = keeps_support_ ? width_ : width_ - kSupportAttributes;
  CutWriter writer(regions_, options_.distance, width_, out_width, &counts_);
  for (std::size_t i = 0; i < parts_.count(); ++i) {
    writer.write(parts_.take(i), sink);
    run.report(static_cast<double>(i + 1) / static_cast<double>(parts_.count()));
  }
  return report;
}

}  // namespace prefilter
