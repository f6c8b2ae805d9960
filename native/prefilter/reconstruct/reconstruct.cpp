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
#include "prefilter/contour/tree_contour.h"
#include "prefilter/reconstruct/assemble.h"
#include "prefilter/reconstruct/d4_function.h"
#include "prefilter/reconstruct/fit_samples.h"
#include "prefilter/reconstruct/flux_tree.h"
#include "prefilter/reconstruct/gather_samples.h"
#include "prefilter/reconstruct/mesh_joiner.h"
#include "prefilter/reconstruct/plane_patches.h"
#include "prefilter/reconstruct/sample_grid.h"
#include "prefilter/reconstruct/sample_slab.h"
#include "prefilter/reconstruct/sample_store.h"
#include "prefilter/spatial/morton.h"
#include "prefilter/voxel/voxelize.h"
#include "prefilter/wavelet/root_mean.h"
#include "prefilter/wavelet/smooth.h"

namespace prefilter {
namespace {

constexpr int kSlabBits = 6;  // slabs are up to 64 cells high
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

class Reconstruction {
 public:
  Reconstruction(PointSource* source, const SampleGrid& grid, const ReconstructOptions& options,
                 double mean_weight, SampleStore* store)
      : source_(source),
        grid_(grid),
        options_(options),
        attribute_count_(source->attributes().size()),
        mean_weight_(mean_weight),
        store_(store),
        top_(grid.depth - std::min(kSlabBits, grid.depth)),
        slabs_(static_cast<std::size_t>(store->slab_count())),
        trees_(slabs_.size()) {}

  void run(MeshSink* sink, ReconstructReport* report) {
    make_slabs();
    make_whole();
    const int least_leaf = least_leaf_depth();
    if (options_.basis == WaveletBasis::kD4) {
      make_d4_trees(least_leaf, report);
    } else {
      make_trees(least_leaf, report);
      make_coarse(report);
    }
    const float scale = scale_of_values();
    contour(scale, sink, report);
  }

 private:
  int depth() const { return grid_.depth; }
  std::int64_t slab_count() const { return static_cast<std::int64_t>(slabs_.size()); }

  template <typename Body>
  void for_slabs(double from, double to, const Body& body) {
    parallel_for(slab_count(), options_.threads, options_.progress.part(from, to),
                 [&](std::int64_t i) { body(static_cast<std::size_t>(i)); });
  }

  void make_slabs() {
    for_slabs(0.0, 0.1, [&](std::size_t s) {
      slabs_[s] =
          make_sample_slab(store_->take(static_cast<int>(s)), depth(), top_, attribute_count_);
    });
    for_slabs(0.1, 0.15, [&](std::size_t s) {
      find_met_cells(s > 0 ? &slabs_[s - 1] : nullptr,
                     s + 1 < slabs_.size() ? &slabs_[s + 1] : nullptr, &slabs_[s]);
    });
  }

  // The levels above the slabs' first one, and this one, for all slabs together.
  void make_whole() {
    SampleCells tops;
    for (const SampleSlab& slab : slabs_) {
      offsets_.push_back(tops.size());
      const SampleCells& samples = slab.at(top_).samples;
      tops.cells.insert(tops.cells.end(), samples.cells.begin(), samples.cells.end());
      tops.attributes.insert(tops.attributes.end(), samples.attributes.begin(),
                             samples.attributes.end());
    }
    whole_ = make_sample_slab(std::move(tops), top_, 0, attribute_count_);
    find_met_cells(nullptr, nullptr, &whole_);
    whole_.at(0).leaf.assign(whole_.at(0).size(), 0);
    find_leaves(mean_weight_, depth(), &whole_);
    for_slabs(0.15, 0.2, [&](std::size_t s) {
      SampleLevel& first = slabs_[s].at(top_);
      const SampleLevel& tops_level = whole_.at(top_);
      first.leaf.assign(
          tops_level.leaf.begin() + static_cast<std::ptrdiff_t>(offsets_[s]),
          tops_level.leaf.begin() + static_cast<std::ptrdiff_t>(offsets_[s] + first.size()));
      find_leaves(mean_weight_, depth(), &slabs_[s]);
    });
  }

  // Samples that lie much thinner than most are no part of the surface.
  int least_leaf_depth() const {
    std::vector<double> weights(static_cast<std::size_t>(depth()) + 1);
    double all = 0.0;
    for (const SampleSlab& slab : slabs_) {
      const SampleLevel& finest = slab.at(depth());
      for (std::size_t i = 0; i < finest.size(); ++i) {
        const auto weight = static_cast<double>(finest.samples.cells[i].weight);
        weights[static_cast<std::size_t>(finest.leaf[i])] += weight;
        all += weight;
      }
    }
    int median = 0;
    for (double sum = weights[0]; sum < all / 2.0 && median < depth();) {
      sum += weights[static_cast<std::size_t>(++median)];
    }
    return std::max(0, median - kOutlierDepths + 1);
  }

  void make_trees(int least_leaf, ReconstructReport* report) {
    std::vector<double> left_out(slabs_.size());
    std::vector<PooledFlux> coarse(slabs_.size());
    for_slabs(0.2, 0.3, [&](std::size_t s) {
      PooledFlux pooled(static_cast<std::size_t>(depth()) + 1);
      left_out[s] = pool_flux(slabs_[s], whole_, offsets_[s], least_leaf, &pooled);
      const int height = 1 << (depth() - top_);
      const int low = static_cast<int>(s) * height;
      add_patches(s > 0 ? &slabs_[s - 1].at(depth()) : nullptr, slabs_[s].at(depth()),
                  s + 1 < slabs_.size() ? &slabs_[s + 1].at(depth()) : nullptr, depth(), low,
                  low + height, &pooled.back());
      coarse[s].assign(std::make_move_iterator(pooled.begin()),
                       std::make_move_iterator(pooled.begin() + top_));
      trees_[s] = analyse_flux(std::move(pooled), top_, depth());
    });
    coarse_flux_.resize(static_cast<std::size_t>(top_) + 1);
    double weight = 0.0;
    for (std::size_t s = 0; s < slabs_.size(); ++s) {
      for (std::size_t k = 0; k < coarse[s].size(); ++k) {
        coarse_flux_[k].insert(coarse_flux_[k].end(), coarse[s][k].begin(), coarse[s][k].end());
      }
      const std::vector<CellFlux>& tops = trees_[s].tops;
      coarse_flux_.back().insert(coarse_flux_.back().end(), tops.begin(), tops.end());
      weight += left_out[s];
    }
    report->outliers = weight;
  }

  void make_d4_trees(int least_leaf, ReconstructReport* report) {
    D4Function made = make_d4_function({source_, grid_, &slabs_, &whole_, &offsets_, least_leaf},
                                       options_.progress.part(0.2, 0.4), options_.threads);
    trees_ = std::move(made.trees);
    coarse_ = std::move(made.coarse);
    report->is_flipped = is_flipped_ = made.is_flipped;
    report->outliers = made.left_out;
  }

  void make_coarse(ReconstructReport* report) {
    std::vector<CellFlux> tops = coarse_flux_.back();
    std::sort(tops.begin(), tops.end(),
              [](const CellFlux& a, const CellFlux& b) { return a.place < b.place; });
    std::vector<std::uint32_t> next(slabs_.size());
    for (const CellFlux& cell : tops) {
      if (!cell.is_split) continue;
      const int slab = morton_cell(cell.place)[2];
      coarse_.continuations.push_back({slab, next[static_cast<std::size_t>(slab)]++});
    }
    coarse_.tree = analyse_flux(std::move(coarse_flux_), 0, top_);
    RootMean mean;
    if (!coarse_.tree.tops.empty()) mean.add_inside(coarse_.tree.tops.front().flux);
    coarse_.root = static_cast<float>(mean.median());
    report->is_flipped = is_flipped_ = coarse_.root < 0.0F;
    synthesise_part({coarse_.root}, &coarse_.tree);
    give_values_to_slabs(tops);
  }

  void give_values_to_slabs(const std::vector<CellFlux>& tops) {
    // The values of the slabs' first cells, by slab and along the Morton curve.
    std::vector<std::vector<float>> values(slabs_.size());
    std::size_t block = 0;
    for (const CellFlux& cell : tops) {
      float value = coarse_.root;
      if (top_ > 0) {
        const NodeLevel& last = coarse_.tree.levels.back();
        while (last.places[block] != cell.place >> 3U) ++block;
        value = last.blocks.blocks[block][cell.place & 7U];
      }
      values[static_cast<std::size_t>(morton_cell(cell.place)[2])].push_back(value);
    }
    for_slabs(0.3, 0.4, [&](std::size_t s) { synthesise_part(values[s], &trees_[s]); });
  }

  CellTree tree_around(std::size_t s, float scale) const {
    const SlabTrees around = {s > 0 ? &trees_[s - 1] : nullptr, &trees_[s],
                              s + 1 < trees_.size() ? &trees_[s + 1] : nullptr};
    CellTree tree = assemble(coarse_, around, static_cast<int>(s), depth(), scale);
    if (options_.smooth) smooth_leaves(&tree);
    return tree;
  }

  float scale_of_values() {
    const float sign = is_flipped_ ? -1.0F : 1.0F;
    if (options_.isovalue != Isovalue::kMean) return sign;
    std::vector<double> sums(slabs_.size());
    std::vector<double> weights(slabs_.size());
    for_slabs(0.4, 0.6, [&](std::size_t s) {
      const CellTree tree = tree_around(s, sign);
      const SampleLevel& finest = slabs_[s].at(depth());
      for (std::size_t i = 0; i < finest.size(); ++i) {
        const SampleCell& cell = finest.samples.cells[i];
        const auto weight = static_cast<double>(cell.weight);
        sums[s] += weight * static_cast<double>(leaf_value(tree, cell_position(cell.key)));
        weights[s] += weight;
      }
    });
    double sum = 0.0;
    double weight = 0.0;
    for (std::size_t s = 0; s < slabs_.size(); ++s) {
      sum += sums[s];
      weight += weights[s];
    }
    const double mean = sum / weight;
    // Normals that tell nothing leave no function to speak of.
    return mean > 1e-3 ? sign * static_cast<float>(0.5 / mean) : sign;
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
  SampleNoise find_noise() const {
    constexpr std::size_t kCells = 4096;
    std::size_t largest = 0;
    for (std::size_t s = 1; s < slabs_.size(); ++s) {
      if (slabs_[s].at(depth()).size() > slabs_[largest].at(depth()).size()) largest = s;
    }
    const SampleLevel& level = slabs_[largest].at(depth());
    const SampleIndex coarser = samples_around(largest, depth() - 1, 2);
    const std::size_t step = std::max<std::size_t>(1, level.size() / kCells);
    std::vector<SampleCell> cells;
    for (std::size_t i = 0; i < level.size(); i += step) {
      if (level.leaf[i] == depth()) cells.push_back(level.samples.cells[i]);
    }
    return measure_noise(cells, coarser, mean_weight_);
  }

  void contour(float scale, MeshSink* sink, ReconstructReport* report) {
    noise_ = find_noise();
    report->residual = noise_.distance;
    MeshJoiner joiner(grid_, attribute_count_, sink);
    const auto width = static_cast<std::size_t>(resolve_threads(options_.threads));
    const int side = 1 << depth();
    const int height = side / static_cast<int>(slabs_.size());
    std::vector<SlabMesh> parts(width);
    for (std::size_t begin = 0; begin < slabs_.size(); begin += width) {
      const std::size_t count = std::min(width, slabs_.size() - begin);
      parallel_for(static_cast<std::int64_t>(count), options_.threads, Progress(),
                   [&](std::int64_t i) {
                     const std::size_t s = begin + static_cast<std::size_t>(i);
                     parts[static_cast<std::size_t>(i)] = mesh_of_slab(s, scale);
                   });
      for (std::size_t i = 0; i < count; ++i) {
        const bool is_last = begin + i + 1 == slabs_.size();
        joiner.add(parts[i], is_last ? side + 1 : static_cast<int>(begin + i + 1) * height);
        parts[i] = SlabMesh();
      }
      options_.progress.part(0.6, 1.0).report(static_cast<double>(begin + count) /
                                              static_cast<double>(slabs_.size()));
    }
    report->vertices = joiner.vertices();
    report->triangles = joiner.triangles();
  }

  SlabMesh mesh_of_slab(std::size_t s, float scale) const {
    const int side = 1 << depth();
    const int height = side / static_cast<int>(slabs_.size());
    HeightRange heights = {static_cast<int>(s) * height, static_cast<int>(s + 1) * height};
    if (s + 1 == slabs_.size()) ++heights.high;
    CellTree tree = tree_around(s, scale);
    const bool are_occupancies = options_.basis == WaveletBasis::kHaar && !options_.smooth;
    if (are_occupancies) {
      for (TreeLevel& level : tree.levels) {
        for (OctantValues& block : level.blocks) {
          for (float& value : block) value = std::clamp(value, 0.0F, 1.0F);
        }
      }
    }
    const float isovalue =
        options_.isovalue == Isovalue::kGiven ? static_cast<float>(options_.given_isovalue) : 0.5F;
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
  SampleIndex samples_around(std::size_t s, int k, int margin) const {
    if (k < top_) {
      SampleIndex index(k, 0, 1 << k);
      index.add(whole_.at(k));
      index.finish();
      return index;
    }
    const int height = 1 << (k - top_);
    const int low = static_cast<int>(s) * height - margin;
    SampleIndex index(k, std::max(0, low),
                      std::min(1 << k, static_cast<int>(s + 1) * height + margin));
    for (std::size_t t = s > 0 ? s - 1 : 0; t < std::min(s + 2, slabs_.size()); ++t) {
      index.add(slabs_[t].at(k));
    }
    index.finish();
    return index;
  }

  void follow_samples(std::size_t s, SlabMesh* slab) const {
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

  void trim(std::size_t s, SlabMesh* slab) const {
    const double limit = *options_.trim;
    const int reach = static_cast<int>(std::ceil(limit));
    const SampleIndex index = samples_around(s, depth(), reach + 2);
    for (const Vector3& p : slab->contour.mesh.positions) {
      bool is_near = false;
      for (int r = std::min(1, reach); !is_near; r = reach) {
        index.for_near(p, r, [&](const SampleCells& cells, std::size_t i, const Vector3& corner) {
          const SampleCell& cell = cells.cells[i];
          double squared = 0.0;
          for (std::size_t a = 0; a < 3; ++a) {
            const double x =
                corner[a] +
                static_cast<double>(cell.position[a]) / static_cast<double>(cell.weight) - p[a];
            squared += x * x;
          }
          is_near = is_near || squared <= limit * limit;
        });
        if (r == reach) break;
      }
      slab->is_trimmed.push_back(is_near ? 0 : 1);
    }
  }

  PointSource* source_;
  SampleGrid grid_;
  const ReconstructOptions& options_;
  std::size_t attribute_count_;
  double mean_weight_;
  SampleNoise noise_;
  SampleStore* store_;
  int top_;
  std::vector<SampleSlab> slabs_;
  SampleSlab whole_;
  std::vector<std::size_t> offsets_;  // of the slabs' first cells among all
  std::vector<FluxTree> trees_;
  PooledFlux coarse_flux_;
  CoarseTree coarse_;
  bool is_flipped_ = false;
};

}  // namespace

ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink) {
  check_depth(options.depth, 1, "depth");
  ReconstructReport report;
  const CloudExtent extent =
      measure_cloud(source, options.progress.part(0.0, 0.1), options.threads);
  report.points = extent.points;
  report.dropped = extent.dropped;
  if (extent.points - extent.dropped < 3) {
    throw_invalid("points: " + std::to_string(extent.points) + ", of which " +
                  std::to_string(extent.dropped) +
                  " are not finite, have no normal or no weight; at least 3 are needed");
  }
  const double longest = std::max({extent.box.size(0), extent.box.size(1), extent.box.size(2)});
  if (!(longest > 0.0)) throw_invalid("points: all coincide; a cloud with an extent is needed");
  const SampleGrid grid = grid_around(extent.box, options.depth);
  report.cell = grid.cell;
  SampleStore store(options.depth, std::min(kSlabBits, options.depth), source->attributes().size(),
                    options.memory_limit / 4, options.folder);
  gather_samples(source, grid, options.progress.part(0.1, 0.4), options.threads, &store);
  report.is_spilled = store.is_spilled();
  const double mean_weight = extent.weight / static_cast<double>(extent.points - extent.dropped);
  ReconstructOptions inner = options;
  inner.progress = options.progress.part(0.4, 1.0);
  Reconstruction(source, grid, inner, mean_weight, &store).run(sink, &report);
  report.outliers /= extent.weight;
  return report;
}

}  // namespace prefilter
