// SPDX-License-Identifier: GPL-3.0-or-later

// Slab by slab (section 4.3.2): the samples of all slabs give the coarse levels of the tree; with
// these a slab's own levels can be made, smoothed, contoured and dropped.
#include "prefilter/reconstruct/reconstruct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/contour/contour_slab.h"
#include "prefilter/reconstruct/assemble.h"
#include "prefilter/reconstruct/d4_function.h"
#include "prefilter/reconstruct/fit_samples.h"
#include "prefilter/reconstruct/flux_tree.h"
#include "prefilter/reconstruct/gather_samples.h"
#include "prefilter/reconstruct/mesh_joiner.h"
#include "prefilter/reconstruct/sample_grid.h"
#include "prefilter/reconstruct/sample_slab.h"
#include "prefilter/reconstruct/sample_store.h"
#include "prefilter/reconstruct/slabs.h"
#include "prefilter/spatial/morton.h"
#include "prefilter/voxel/voxelize.h"
#include "prefilter/wavelet/root_mean.h"
#include "prefilter/wavelet/smooth.h"

namespace prefilter {
namespace {

// Slabs are up to 64 cells high; lower where there are many cells, so that those in memory at a
// time are fewer. That follows from the depth alone, as the order of triangles follows from it.
int slab_bits(int depth) { return std::min({depth, 6, std::max(16 - depth, 4)}); }

constexpr int kOutlierDepths = 3;

SampleGrid grid_around(const Box& box, int depth) {
  SampleGrid grid;
  grid.depth = depth;
  int longest = 0;
  for (int a = 1; a < 3; ++a) {
    if (box.size(a) > box.size(longest)) longest = a;
  }
  grid.turn = (longest + 1) % 3;
  const Box cube = cube_around(box, depth);
  check_box(cube, "points");
  grid.low = grid.turned(cube.low);
  grid.cell = cube.size(0) / std::ldexp(1.0, depth);
  return grid;
}

// Of cells that sizes in single precision, and those of messages, are rounded by.
constexpr double kSizeRounding = 1e-6;

int depth_for(const Box& box, const ReconstructOptions& options) {
  if (!options.cell_size) return options.depth;
  const auto cell_at = [&](int depth) {
    return cube_around(box, depth).size(0) / std::ldexp(1.0, depth);
  };
  for (int depth = 1; depth <= kMaxTreeDepth; ++depth) {
    if (cell_at(depth) <= *options.cell_size * (1.0 + kSizeRounding)) return depth;
  }
  throw_invalid("cell_size: " + to_text(*options.cell_size) + " makes more than " +
                std::to_string(1 << kMaxTreeDepth) + " cells along an axis; use " +
                to_text(cell_at(kMaxTreeDepth) * (1.0 + 1e-5)) + " or more");  // not rounded down
}

// What is kept of a cell of the samples, in all stages, at most.
constexpr double kBytesPerCell = 130.0;

class Reconstruction {
 public:
  Reconstruction(PointSource* source, const SampleGrid& grid, const ReconstructOptions& options,
                 double mean_weight, bool keeps_all, SampleStore* store)
      : source_(source),
        grid_(grid),
        options_(options),
        attribute_count_(source->attributes().size()),
        slabs_(store, grid.depth, grid.depth - slab_bits(grid.depth), attribute_count_, keeps_all,
               options.threads) {
    slabs_.mean_weight = mean_weight;
  }

  void run(MeshSink* sink, ReconstructReport* report) {
    make_whole();
    if (options_.basis == WaveletBasis::kD4) {
      make_d4_trees(report);
    } else {
      make_coarse(report);
    }
    if (slabs_.coarse.is_empty()) {
      throw_invalid("normals: they cancel each other in all cells; ones that agree are needed");
    }
    contour(find_level(), sink, report);
  }

 private:
  int depth() const { return grid_.depth; }

  // Brings all slabs to a stage, some at a time with those `margin` slabs to both sides of them,
  // and calls visit(s) for each, on any thread, and then join(s), in order.
  template <typename Visit, typename Join>
  void for_slabs(SlabStage stage, int margin, double from, double to, const Visit& visit,
                 const Join& join, bool is_last = false) {
    const int width = resolve_threads(options_.threads);
    const Progress part = options_.progress.part(from, to);
    for (int begin = 0; begin < slabs_.count(); begin += width) {
      const int end = std::min(begin + width, slabs_.count());
      slabs_.bring(begin - margin, end + margin, stage);
      parallel_for(end - begin, options_.threads, Progress(),
                   [&](std::int64_t i) { visit(begin + static_cast<int>(i)); });
      for (int s = begin; s < end; ++s) join(s);
      // The next slabs need the levels of those two below the margin.
      slabs_.drop_below(end - margin - 2, is_last);
      part.report(static_cast<double>(end) / slabs_.count());
    }
    slabs_.drop_below(slabs_.count(), is_last);
  }
  static void do_nothing(int) {}

  // The levels above the slabs' first one, and this one, for all slabs together.
  void make_whole() {
    SampleCells tops;
    std::vector<double> weights(static_cast<std::size_t>(depth()) + 1);
    std::size_t most = 0;
    for_slabs(SlabStage::kMet, 0, 0.0, 0.15, do_nothing, [&](int s) {
      const SampleSlab& slab = *slabs_.samples(s);
      slabs_.offsets.push_back(tops.size());
      const SampleCells& samples = slab.at(slabs_.top()).samples;
      tops.cells.insert(tops.cells.end(), samples.cells.begin(), samples.cells.end());
      tops.attributes.insert(tops.attributes.end(), samples.attributes.begin(),
                             samples.attributes.end());
      weigh_leaves(slab, &weights);
      if (slab.at(depth()).size() > most) {
        most = slab.at(depth()).size();
        largest_ = s;
      }
    });
    slabs_.whole = make_sample_slab(std::move(tops), slabs_.top(), 0, attribute_count_);
    find_met_cells(nullptr, nullptr, &slabs_.whole);
    slabs_.whole.at(0).leaf.assign(slabs_.whole.at(0).size(), 0);
    find_leaves(slabs_.mean_weight, depth(), &slabs_.whole);
    slabs_.least_leaf = least_leaf_depth(weights);
  }

  // Adds the weight of samples to that of the depth at which they count; those that count above the
  // slab's first level are taken to count there.
  static void weigh_leaves(const SampleSlab& slab, std::vector<double>* weights) {
    std::vector<std::int8_t> leaf(slab.at(slab.top).size(), static_cast<std::int8_t>(slab.top));
    for (int k = slab.top + 1; k <= slab.depth(); ++k) {
      const SampleLevel& level = slab.at(k);
      std::vector<std::int8_t> next(level.size());
      for (std::size_t i = 0; i < level.size(); ++i) {
        next[i] = level.is_met[i] != 0 ? static_cast<std::int8_t>(k) : leaf[level.parents[i]];
      }
      leaf = std::move(next);
    }
    const std::vector<SampleCell>& finest = slab.at(slab.depth()).samples.cells;
    for (std::size_t i = 0; i < finest.size(); ++i) {
      (*weights)[static_cast<std::size_t>(leaf[i])] += static_cast<double>(finest[i].weight);
    }
  }

  // Samples that lie much thinner than most are no part of the surface.
  int least_leaf_depth(const std::vector<double>& weights) const {
    double all = 0.0;
    for (const double weight : weights) all += weight;
    int median = 0;
    for (double sum = weights[0]; sum < all / 2.0 && median < depth();) {
      sum += weights[static_cast<std::size_t>(++median)];
    }
    return std::max(0, median - kOutlierDepths + 1);
  }

  void make_d4_trees(ReconstructReport* report) {
    slabs_.bring(0, slabs_.count(), SlabStage::kLeaves);
    D4Function made = make_d4_function(source_, grid_, slabs_, options_.progress.part(0.15, 0.4),
                                       options_.threads);
    for (int s = 0; s < slabs_.count(); ++s) {
      slabs_.set_values(s, std::move(made.trees[static_cast<std::size_t>(s)]));
    }
    slabs_.coarse = std::move(made.coarse);
    report->is_flipped = is_flipped_ = made.is_flipped && !options_.are_sides_known;
    report->outliers = made.left_out;
  }

  void make_coarse(ReconstructReport* report) {
    PooledFlux flux(static_cast<std::size_t>(slabs_.top()) + 1);
    for_slabs(SlabStage::kCoefficients, 0, 0.15, 0.35, do_nothing, [&](int s) {
      const PooledFlux& pooled = slabs_.coarse_flux(s);
      for (std::size_t k = 0; k < pooled.size(); ++k) {
        flux[k].insert(flux[k].end(), pooled[k].begin(), pooled[k].end());
      }
      const std::vector<CellFlux>& tops = slabs_.tree(s)->tops;
      flux.back().insert(flux.back().end(), tops.begin(), tops.end());
      report->outliers += slabs_.left_out(s);
    });
    std::vector<CellFlux> tops = flux.back();
    std::sort(tops.begin(), tops.end(),
              [](const CellFlux& a, const CellFlux& b) { return a.place < b.place; });
    std::vector<std::uint32_t> next(static_cast<std::size_t>(slabs_.count()));
    CoarseTree& coarse = slabs_.coarse;
    for (const CellFlux& cell : tops) {
      if (!cell.is_split) continue;
      const int slab = morton_cell(cell.place)[2];
      coarse.continuations.push_back({slab, next[static_cast<std::size_t>(slab)]++});
    }
    coarse.tree = analyse_flux(std::move(flux), 0, slabs_.top());
    RootMean mean;
    if (!coarse.tree.tops.empty()) mean.add_inside(coarse.tree.tops.front().flux);
    coarse.root = static_cast<float>(mean.median());
    report->is_flipped = is_flipped_ = coarse.root < 0.0F && !options_.are_sides_known;
    synthesise_part({coarse.root}, &coarse.tree);
  }

  CellTree tree_around(int s, float scale) const {
    CellTree tree = assemble(
        slabs_.coarse, {slabs_.tree(s - 1), slabs_.tree(s), slabs_.tree(s + 1)}, s, depth(), scale);
    if (options_.smooth) smooth_leaves(&tree);
    return tree;
  }

  // Where the surface is: at `isovalue` of the function times `scale`.
  struct Level {
    float scale;
    float isovalue;
  };

  Level find_level() {
    const float sign = is_flipped_ ? -1.0F : 1.0F;
    if (options_.isovalue == Isovalue::kHalf) return {sign, 0.5F};
    if (options_.isovalue == Isovalue::kGiven) {
      return {sign, static_cast<float>(options_.given_isovalue)};
    }
    std::vector<double> sums(static_cast<std::size_t>(slabs_.count()));
    double sum = 0.0;
    double weight = 0.0;
    for_slabs(
        SlabStage::kValues, 1, 0.35, 0.6,
        [&](int s) {
          const CellTree tree = tree_around(s, sign);
          for (const SampleCell& cell : slabs_.samples(s)->at(depth()).samples.cells) {
            sums[static_cast<std::size_t>(s)] +=
                static_cast<double>(cell.weight) *
                static_cast<double>(leaf_value(tree, cell_position(cell.key)));
          }
        },
        [&](int s) {
          sum += sums[static_cast<std::size_t>(s)];
          for (const SampleCell& cell : slabs_.samples(s)->at(depth()).samples.cells) {
            weight += static_cast<double>(cell.weight);
          }
        });
    const double mean = sum / weight;
    // Of a closed surface the mean is off from 1/2 as the areas are; of an open one, as the mean
    // over the root is, to which its holes leave much.
    constexpr double kLeastOfClosed = 0.2;
    if (options_.are_sides_known || mean < kLeastOfClosed) return {sign, static_cast<float>(mean)};
    return {sign * static_cast<float>(0.5 / mean), 0.5F};
  }

  float leaf_value(const CellTree& tree, const CellPosition& at) const {
    std::size_t block = 0;
    for (int k = 0;; ++k) {
      const int shift = depth() - k - 1;
      const int o =
          ((at[0] >> shift) & 1) | ((at[1] >> shift) & 1) << 1 | ((at[2] >> shift) & 1) << 2;
      const TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
      if (!level.is_split(block, o)) return level.blocks[block][static_cast<std::size_t>(o)];
      block = level.child(block, o);
    }
  }

  // Of some cells of the slab that has most.
  SampleNoise find_noise() {
    constexpr std::size_t kCells = 4096;
    if (depth() == slabs_.top()) return {};
    slabs_.bring(largest_ - 1, largest_ + 2, SlabStage::kLeaves);
    const SampleLevel& level = slabs_.samples(largest_)->at(depth());
    const SampleIndex coarser = samples_around(largest_, depth() - 1, 2);
    const std::size_t step = std::max<std::size_t>(1, level.size() / kCells);
    std::vector<SampleCell> cells;
    for (std::size_t i = 0; i < level.size(); i += step) {
      if (level.leaf[i] == depth()) cells.push_back(level.samples.cells[i]);
    }
    const SampleNoise noise = measure_noise(cells, coarser, slabs_.mean_weight);
    slabs_.drop_below(slabs_.count(), false);
    return noise;
  }

  void contour(const Level& level, MeshSink* sink, ReconstructReport* report) {
    noise_ = find_noise();
    report->residual = noise_.distance;
    MeshJoiner joiner(grid_, attribute_count_, sink);
    std::vector<SlabMesh> parts(static_cast<std::size_t>(slabs_.count()));
    for_slabs(
        SlabStage::kValues, 1, 0.6, 1.0,
        [&](int s) { parts[static_cast<std::size_t>(s)] = mesh_of_slab(s, level); },
        [&](int s) {
          const bool is_last = s + 1 == slabs_.count();
          SlabMesh& part = parts[static_cast<std::size_t>(s)];
          joiner.add(part, is_last ? (1 << depth()) + 1 : (s + 1) * slabs_.height());
          part = SlabMesh();
        },
        true);
    report->vertices = joiner.vertices();
    report->triangles = joiner.triangles();
  }

  SlabMesh mesh_of_slab(int s, const Level& level) const {
    const int side = 1 << depth();
    HeightRange heights = {s * slabs_.height(), (s + 1) * slabs_.height()};
    if (s + 1 == slabs_.count()) ++heights.high;
    CellTree tree = tree_around(s, level.scale);
    const bool are_occupancies = options_.basis == WaveletBasis::kHaar && !options_.smooth;
    float isovalue = level.isovalue;
    if (are_occupancies && options_.isovalue == Isovalue::kMean) {
      for (TreeLevel& blocks : tree.levels) {
        for (OctantValues& block : blocks.blocks) {
          for (float& value : block) value = std::clamp(value + 0.5F - isovalue, 0.0F, 1.0F);
        }
      }
      isovalue = 0.5F;
    }
    SlabMesh slab;
    slab.contour = contour_slab(
        tree, isovalue, are_occupancies ? Interpolant::kOccupancy : Interpolant::kLinear, heights);
    for (Vector3& p : slab.contour.mesh.positions) {
      for (double& x : p) x *= side;
    }
    tree = CellTree();
    if (options_.fit || attribute_count_ > 0 || options_.trim) follow_samples(s, &slab);
    return slab;
  }

  // The samples of a depth, in the slab and next to it.
  SampleIndex samples_around(int s, int k, int margin) const {
    if (k < slabs_.top()) {
      SampleIndex index(k, 0, 1 << k);
      index.add(slabs_.whole.at(k));
      index.finish();
      return index;
    }
    const int height = 1 << (k - slabs_.top());
    SampleIndex index(k, std::max(0, s * height - margin),
                      std::min(1 << k, (s + 1) * height + margin));
    for (int t = s - 1; t <= s + 1; ++t) {
      if (slabs_.samples(t) != nullptr) index.add(slabs_.samples(t)->at(k));
    }
    index.finish();
    return index;
  }

  void follow_samples(int s, SlabMesh* slab) const {
    std::vector<Vector3>& positions = slab->contour.mesh.positions;
    const std::vector<VertexPlace>& places = slab->contour.places;
    slab->attributes.resize(positions.size() * attribute_count_);
    std::vector<std::unique_ptr<SampleIndex>> indices(static_cast<std::size_t>(depth()) + 1);
    const auto index_of = [&](int k) -> const SampleIndex& {
      auto& index = indices[static_cast<std::size_t>(k)];
      if (!index) index = std::make_unique<SampleIndex>(samples_around(s, k, 3));
      return *index;
    };
    const SampleFit fit(index_of, depth(), noise_);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      int k = v < places.size() ? places[v].depth : depth();
      if (options_.fit) fit.move(k, &positions[v]);
      if (attribute_count_ == 0) continue;
      const std::span<float> attributes(slab->attributes.data() + v * attribute_count_,
                                        attribute_count_);
      const Vector3& p = positions[v];
      for (; k > 0; --k) {
        const double shrink = std::ldexp(1.0, k - depth());
        const Vector3 in_level = {p[0] * shrink, p[1] * shrink, p[2] * shrink};
        if (blend_attributes(index_of(k), in_level, attributes)) break;
      }
    }
    if (options_.trim) trim(s, slab);
  }

  // Marks vertices that are farther from all samples than the limit: than the means of those in a
  // cell, which is small beside it.
  void trim(int s, SlabMesh* slab) const {
    constexpr double kMostCells = 8.0;
    int k = depth();
    double limit = *options_.trim;
    // Cells of the next slabs are at hand as well, but not of those after.
    while (k > 0 && (limit > kMostCells ||
                     (k > slabs_.top() && std::ceil(limit) > (1 << (k - slabs_.top()))))) {
      --k;
      limit /= 2.0;
    }
    const int reach = static_cast<int>(std::ceil(limit));
    const SampleIndex index = samples_around(s, k, reach + 2);
    const double cell_size = std::ldexp(1.0, depth() - k);
    for (const Vector3& position : slab->contour.mesh.positions) {
      const Vector3 p = {position[0] / cell_size, position[1] / cell_size, position[2] / cell_size};
      bool is_near = false;
      const auto look = [&](const SampleCells& cells, std::size_t i, const Vector3& corner) {
        const SampleCell& cell = cells.cells[i];
        double squared = 0.0;
        for (std::size_t a = 0; a < 3; ++a) {
          const double x = corner[a] + static_cast<double>(cell.position[a] / cell.weight) - p[a];
          squared += x * x;
        }
        is_near = is_near || squared <= limit * limit;
      };
      index.for_near(p, std::min(1, reach), look);
      if (!is_near) index.for_near(p, reach, look);
      slab->is_trimmed.push_back(is_near ? 0 : 1);
    }
  }

  PointSource* source_;
  SampleGrid grid_;
  const ReconstructOptions& options_;
  std::size_t attribute_count_;
  Slabs slabs_;
  int largest_ = 0;  // the slab with most cells
  bool is_flipped_ = false;
  SampleNoise noise_;
};

constexpr double kLargestIsovalue = 1e30;
constexpr double kLargestTrim = 1e6;

void check_options(const ReconstructOptions& options) {
  check_depth(options.depth, 1, "depth");
  if (options.cell_size && !(*options.cell_size > 0.0 && std::isfinite(*options.cell_size))) {
    throw_invalid("cell_size: " + to_text(*options.cell_size) +
                  "; a length above 0 is needed, or none");
  }
  if (options.isovalue == Isovalue::kGiven &&
      !(std::abs(options.given_isovalue) <= kLargestIsovalue)) {
    throw_invalid("isovalue: " + to_text(options.given_isovalue) +
                  "; a finite number of at most 1e30 is needed");
  }
  if (options.trim && !(*options.trim > 0.0 && *options.trim <= kLargestTrim)) {
    throw_invalid("trim: " + to_text(*options.trim) +
                  "; a number of cells above 0 and up to 1e6 is needed, or none");
  }
}

}  // namespace

ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink) {
  check_options(options);
  ReconstructReport report;
  const CloudExtent extent =
      measure_cloud(source, options.progress.part(0.0, 0.1), options.threads);
  report.points = extent.points;
  report.dropped = extent.dropped;
  if (extent.points - extent.dropped < 3) {
    throw_invalid(
        "points: " + std::to_string(extent.points) + ", of which " +
        std::to_string(extent.dropped) +
        " are not finite and at most 1e300, or have no normal or no weight; at least 3 are "
        "needed");
  }
  const double longest = std::max({extent.box.size(0), extent.box.size(1), extent.box.size(2)});
  if (!(longest > 0.0)) throw_invalid("points: all coincide; a cloud with an extent is needed");
  const SampleGrid grid = grid_around(extent.box, depth_for(extent.box, options));
  report.cell = grid.cell;
  SampleStore store(grid.depth, slab_bits(grid.depth), source->attributes().size(),
                    options.memory_limit / 4, options.folder);
  gather_samples(source, grid, options.progress.part(0.1, 0.4), options.threads, &store);
  report.is_spilled = store.is_spilled();
  const double mean_weight = extent.weight / static_cast<double>(extent.points - extent.dropped);
  ReconstructOptions inner = options;
  inner.progress = options.progress.part(0.4, 1.0);
  // The D4 basis needs all slabs at once.
  const bool keeps_all =
      options.basis == WaveletBasis::kD4 ||
      (!store.is_spilled() && kBytesPerCell * static_cast<double>(store.size()) <=
                                  static_cast<double>(options.memory_limit) / 2.0);
  Reconstruction(source, grid, inner, mean_weight, keeps_all, &store).run(sink, &report);
  report.outliers /= extent.weight;
  return report;
}

}  // namespace prefilter
