// SPDX-License-Identifier: GPL-3.0-or-later

// Section 3.2.2 for curves in the plane: coefficients by strips, one tree per layer, synthesis by
// strips.
#include "prefilter/shapes/raster/wavelet_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/shapes/raster/edge_list.h"
#include "prefilter/wavelet/plane_haar.h"

namespace prefilter {
namespace {

// Rows per strip; the coefficients of a strip with curves in every brick take 2 MiB.
int rows_of_strip(const PlaneGrid& grid) {
  constexpr int kCells = 1 << 16;
  constexpr int kMaxStripRows = 256;
  const int rows = std::clamp(kCells / grid.width, 2 * kPlaneBrickSide, kMaxStripRows);
  return rows / kPlaneBrickSide * kPlaneBrickSide;
}

void add_segments(const EdgeList& edges, int first_row, int end_row, const PlaneGrid& grid,
                  OutlineStrip* strip) {
  const double low = first_row == 0 ? -HUGE_VAL : first_row;
  const double high = end_row == grid.height ? HUGE_VAL : end_row;
  edges.for_segments_between(low, high, [&](std::span<const Point2> controls, double weight) {
    if (controls.size() == 2) {
      // The same direction as in for_monotone_pieces, so that shared edges cancel.
      const bool backward = is_cut_backward(controls);
      strip->add_line(controls[backward], controls[!backward], backward ? -1.0 : 1.0);
      return;
    }
    for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool backward) {
      strip->add(piece, backward ? -1.0 : 1.0);
    });
  });
}

// Rows of an image made by one thread. A single layer is written directly; several layers are
// accumulated in doubles first.
template <int Channels>
class ImageRows {
 public:
  ImageRows(Image* image, int first_row, int end_row)
      : image_(image), first_row_(first_row), end_row_(std::min(end_row, image->height)) {}

  void set(const PlaneHaar& tree, int cell_depth, const ChannelValues& background,
           const ChannelValues& color) {
    std::array<float, Channels> low;
    std::array<float, Channels> step;
    for (int c = 0; c < Channels; ++c) {
      low[c] = static_cast<float>(background[c]);
      step[c] = static_cast<float>(color[c]);
    }
    synthesise(
        tree, cell_depth,
        [&](int row, int begin, int end, float value) {
          std::array<float, Channels> run;
          for (int c = 0; c < Channels; ++c) run[c] = low[c] + step[c] * value;
          float* out = image_->texel(0, row);
          for (int x = begin; x < end; ++x) {
            for (int c = 0; c < Channels; ++c) out[x * Channels + c] = run[c];
          }
        },
        [&](int row, int begin, int count, const float* values) {
          float* out = image_->texel(begin, row);
          for (int x = 0; x < count; ++x) {
            for (int c = 0; c < Channels; ++c) out[x * Channels + c] = low[c] + step[c] * values[x];
          }
        });
  }

  void begin_sums(const ChannelValues& background) {
    sums_.resize(static_cast<std::size_t>(end_row_ - first_row_) * image_->width * Channels);
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] = background[i % Channels];
  }
  void add(const PlaneHaar& tree, int cell_depth, const ChannelValues& color) {
    synthesise(
        tree, cell_depth,
        [&](int row, int begin, int end, float value) {
          if (value == 0.0F) return;
          double* out = sums_at(row);
          for (int x = begin; x < end; ++x) {
            for (int c = 0; c < Channels; ++c) out[x * Channels + c] += color[c] * value;
          }
        },
        [&](int row, int begin, int count, const float* values) {
          double* out = sums_at(row) + begin * Channels;
          for (int x = 0; x < count; ++x) {
            for (int c = 0; c < Channels; ++c) out[x * Channels + c] += color[c] * values[x];
          }
        });
  }
  void end_sums() {
    std::transform(sums_.begin(), sums_.end(), image_->texel(0, first_row_),
                   [](double value) { return static_cast<float>(value); });
  }

 private:
  double* sums_at(int row) {
    return sums_.data() + static_cast<std::size_t>(row - first_row_) * image_->width * Channels;
  }

  template <typename UseRun, typename Row>
  void synthesise(const PlaneHaar& tree, int cell_depth, const UseRun& use_run, const Row& in_row) {
    tree.synthesise(
        cell_depth, first_row_, end_row_,
        [&](int row, int begin, int end, float value) {
          use_run(row, begin, std::min(end, image_->width), value);
        },
        [&](int x, int y, const auto& values) {
          const int count = std::min(kPlaneBrickSide, image_->width - x);
          const int end = std::min(y + kPlaneBrickSide, end_row_);
          for (int row = y; row < end; ++row) {
            in_row(row, x, count, values.data() + (row - y) * kPlaneBrickSide);
          }
        });
  }

  Image* image_;
  int first_row_;
  int end_row_;
  std::vector<double> sums_;
};

template <int Channels>
void set_image(std::span<const PlaneHaar> trees, const RasterLayers& job, int cell_depth, int rows,
               const Run& run, Image* image) {
  parallel_ranges(image->height, rows, run, [&](std::int64_t begin, std::int64_t end) {
    ImageRows<Channels> strip(image, static_cast<int>(begin), static_cast<int>(end));
    if (trees.size() == 1) {
      strip.set(trees[0], cell_depth, job.background, job.layers[0].paint.constant);
      return;
    }
    strip.begin_sums(job.background);
    for (std::size_t i = 0; i < trees.size(); ++i) {
      strip.add(trees[i], cell_depth, job.layers[i].paint.constant);
    }
    strip.end_sums();
  });
}

}  // namespace

int wavelet_depth(int width, int height) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height)) - 1));
}

void add_up_wavelets(const RasterLayers& job, int depth, const Run& run, Image* image) {
  if (std::max(image->width, image->height) > 1 << PlaneGrid::kMostDepth) {
    throw_invalid("width, height: found " + std::to_string(image->width) + " x " +
                  std::to_string(image->height) + " pixels; the wavelet method takes up to 2^24");
  }
  // Cells at the image's border are complete.
  const int cell_depth = wavelet_depth(image->width, image->height) - depth;
  const auto in_whole_cells = [&](int pixels) {
    return static_cast<int>((((pixels - 1) >> cell_depth) + 1) << cell_depth);
  };
  const PlaneGrid grid(in_whole_cells(image->width), in_whole_cells(image->height));
  const int rows = rows_of_strip(grid);

  const auto strip_count = static_cast<std::size_t>(range_count(grid.height, rows));
  std::vector<std::vector<StripBricks>> strips(job.layers.size());
  for (auto& of_layer : strips) of_layer.resize(strip_count);
  const Stages stages(run, {6, 1, 3});
  parallel_ranges(grid.height, rows, stages[0], [&](std::int64_t begin, std::int64_t end) {
    OutlineStrip strip;
    const auto first_row = static_cast<int>(begin);
    const auto end_row = static_cast<int>(end);
    strip.begin(grid, first_row, end_row);
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
      const EdgeList& edges = job.layers[i].edges;
      if (edges.high() < first_row && first_row > 0) continue;
      if (edges.low() > end_row && end_row < grid.height) continue;
      add_segments(edges, first_row, end_row, grid, &strip);
      strips[i][static_cast<std::size_t>(begin / rows)] = strip.take();
    }
  });
  std::vector<PlaneHaar> trees(job.layers.size());
  parallel_for(static_cast<std::int64_t>(job.layers.size()), stages[1],
               [&](std::int64_t i) { trees[i] = PlaneHaar(grid, strips[i]); });
  const Run synthesis = stages[2];
  switch (image->channels) {
    case 1:
      set_image<1>(trees, job, cell_depth, rows, synthesis, image);
      break;
    case 2:
      set_image<2>(trees, job, cell_depth, rows, synthesis, image);
      break;
    case 3:
      set_image<3>(trees, job, cell_depth, rows, synthesis, image);
      break;
    default:
      set_image<4>(trees, job, cell_depth, rows, synthesis, image);
      break;
  }
}

}  // namespace prefilter
