// SPDX-License-Identifier: GPL-3.0-or-later

// Section 2.2: the image of shapes, filtered in closed form.
//
// Rows are processed in bands, each from the segments that cross it, so that beside the image only
// a band per thread is in memory. The height of bands depends only on the image.

#include "prefilter/shapes/rasterize.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/names.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/unit_bytes.h"
#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/box_coverage.h"
#include "prefilter/shapes/raster/composited_rows.h"
#include "prefilter/shapes/raster/coverage_rows.h"
#include "prefilter/shapes/raster/local_color.h"
#include "prefilter/shapes/raster/moment_rows.h"
#include "prefilter/shapes/raster/painted_rows.h"
#include "prefilter/shapes/raster/raster_layers.h"
#include "prefilter/shapes/raster/stack_rows.h"
#include "prefilter/shapes/raster/wavelet_image.h"

namespace prefilter {
namespace {

void check_options(std::span<const Shape> shapes, const RasterOptions& options,
                   double value_bytes) {
  if (options.width < 1 || options.height < 1) {
    throw_invalid("width, height: found " + std::to_string(options.width) + " x " +
                  std::to_string(options.height) + " pixels; at least 1 x 1 is needed");
  }
  const int channels = channel_count(shapes, options);
  check_memory("width, height: an image of " + std::to_string(options.width) + " x " +
                   std::to_string(options.height) + " pixels",
               value_bytes * options.width * options.height * channels);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::string who = "shapes: shape " + std::to_string(i);
    if (shapes[i].paint.channels != channels) {
      throw_invalid(who + " has " + std::to_string(shapes[i].paint.channels) +
                    " channels, and the first has " + std::to_string(channels) +
                    "; all must have the same number");
    }
    for (const Point2& point : shapes[i].outline.points()) {
      if (!(std::abs(point.x) <= kMaxPixelCoordinate && std::abs(point.y) <= kMaxPixelCoordinate)) {
        throw_invalid(who + " has a point that is not finite, or farther than 1e9 pixels away");
      }
    }
  }
}

void check_wavelet_options(std::span<const Shape> shapes, const RasterOptions& options) {
  const int most = wavelet_depth(options.width, options.height);
  if (options.depth > most) {
    throw_invalid("depth: found " + std::to_string(options.depth) + "; an image of " +
                  std::to_string(options.width) + " x " + std::to_string(options.height) +
                  " pixels has depths from 0 to " + std::to_string(most));
  }
  if (options.filter != "box") {
    throw_invalid("filter: '" + options.filter + "'; the method wavelet supports only box");
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].paint.kind != Paint::Kind::kConstant) {
      throw_invalid("shapes: shape " + std::to_string(i) +
                    " has a gradient; the method wavelet supports only constant colors");
    }
  }
}

// The target of pixels: either floats or bytes.
struct PixelRows {
  float* floats = nullptr;
  std::uint8_t* bytes = nullptr;
  int width = 0;
  int height = 0;
  int channels = 0;

  std::size_t row_begin(int row) const { return static_cast<std::size_t>(row) * width * channels; }
};

PixelRows rows_of(Image* image) {
  return {image->data.data(), nullptr, image->width, image->height, image->channels};
}

// Working memory for shapes of constant color.
template <int N>
struct CoverageBuffers {
  CoverageBuffers(const CellFilter& filter, int width) : moments(filter, width) {}

  MomentCells<N> cells;
  MomentRows<N> moments;
  CoverageRows rows;
  int first_row = -1;  // of the band it was prepared for
};

// Working memory for shapes of linear color.
template <int M>
struct ColorBuffers {
  ColorBuffers(const CellFilter& filter, int width) : rows(filter, width) {}

  MomentCells<M> cells;
  PaintedRows<M> rows;
  int first_row = -1;
};

// Renders bands of rows one after another, reusing memory.
template <int N>
class BandRenderer {
 public:
  BandRenderer(const RasterLayers& job, const CellFilter& filter, const PixelRows& pixels)
      : job_(job), filter_(filter), pixels_(pixels) {}

  void make(int first_row, int end_row) {
    first_row_ = first_row;
    end_row_ = end_row;
    values_.reset(pixels_.width, end_row - first_row, job_.channels, job_.background);
    // Composited stacks go first: they overwrite the band.
    for (const LayerStack& stack : job_.stacks) {
      if (stack.is_composited && is_in_band(stack)) add_composited(stack);
    }
    for (const RasterLayer& layer : job_.layers) {
      if (!is_in_band(layer.edges)) continue;
      if (is_constant(layer)) {
        add_constant(layer);
      } else {
        add_painted(layer);
      }
    }
    for (const LayerStack& stack : job_.stacks) {
      if (!stack.is_composited && is_in_band(stack)) add_stack(stack);
    }
    for (int row = first_row; row < end_row; ++row) {
      if (pixels_.bytes != nullptr) {
        values_.store(row - first_row, pixels_.bytes + pixels_.row_begin(row));
      } else {
        values_.store(row - first_row, pixels_.floats + pixels_.row_begin(row));
      }
    }
  }

 private:
  template <int M>
  void add_edges(const RasterLayer& layer, MomentCells<M>* cells) const {
    layer.edges.for_pieces_between(
        cells->window().first_row, cells->window().end_row, filter_,
        [&](const MonotoneCurve& piece, bool backward) { cells->add(piece, backward ? 1 : -1); });
    cells->finish();
  }

  void add_constant(const RasterLayer& layer) {
    // The box filter is the only one of degree 0.
    if (N == 0 && pixels_.width <= kMaxBoxImageSide && pixels_.height <= kMaxBoxImageSide) {
      add_box(layer);
      return;
    }
    if (coverage_buffers_ == nullptr)
      coverage_buffers_ = std::make_unique<CoverageBuffers<N>>(filter_, pixels_.width);
    auto& [cells, moments, rows, first_row] = *coverage_buffers_;
    if (first_row != first_row_) {
      first_row = first_row_;
      cells.begin_band(filter_, pixels_.width, first_row_, end_row_);
      rows.reset(pixels_.width, end_row_ - first_row_);
    }
    add_edges(layer, &cells);
    moments.add_coverage(cells, first_row_, end_row_, &rows);
    cells.clear();
    const ChannelValues& color = layer.paint.constant;
    for (int row = 0; row < end_row_ - first_row_; ++row) {
      if (!rows.is_changed(row)) continue;
      const auto add = [&](int begin, int end, double coverage) {
        values_.add(row, begin, end, coverage, color);
      };
      rows.take(
          row, [&](int x, double coverage) { add(x, x + 1, coverage); }, add);
    }
  }

  void add_box(const RasterLayer& layer) {
    if (box_ == nullptr) box_ = std::make_unique<BoxCoverage>();
    // Limits the band to the rows of the layer, as all rows are visited.
    const double low = std::max<double>(first_row_, std::floor(layer.edges.low()));
    const double high = std::min<double>(end_row_, std::ceil(layer.edges.high()));
    if (!(low < high)) return;
    box_->begin(pixels_.width, static_cast<int>(low), static_cast<int>(high));
    box_->add(layer.edges);
    const ChannelValues& color = layer.paint.constant;
    const auto coverage_of = [](std::uint32_t steps) {
      return static_cast<std::int32_t>(steps) * kBoxUnit;
    };
    box_->take(
        [&](int row, int x, int count, const std::uint32_t* steps) {
          // Blocks often extend beyond the shape.
          int begin = 0;
          while (begin < count && steps[begin] == 0) ++begin;
          while (count > begin && steps[count - 1] == 0) --count;
          if (begin == count) return;
          values_.add_each(
              row - first_row_, x + begin, count - begin,
              [&](int i) { return coverage_of(steps[begin + i]); }, color);
        },
        [&](int row, int begin, int end, std::uint32_t steps) {
          values_.add(row - first_row_, begin, end, coverage_of(steps), color);
        });
  }

  void add_composited(const LayerStack& stack) {
    CompositedRows composited(stack, pixels_.width, job_.channels);
    composited.composite_over(first_row_, end_row_, job_.background, &values_);
    StackRows<N> rows(stack, filter_, job_.background, job_.channels, pixels_.width,
                      pixels_.height);
    rows.add_marked(first_row_, end_row_, composited, &values_);
  }

  // Whether a layer may affect the band.
  bool is_in_band(const EdgeList& edges) const {
    return filter_.to_cell(edges.high()) >= filter_.first_cell(first_row_) &&
           filter_.to_cell(edges.low()) <= filter_.first_cell(end_row_ - 1) + filter_.taps;
  }
  bool is_in_band(const LayerStack& stack) const {
    return std::any_of(stack.layers.begin(), stack.layers.end(),
                       [&](const StackLayer& layer) { return is_in_band(layer.edges); });
  }

  void add_stack(const LayerStack& stack) {
    StackRows<N> rows(stack, filter_, job_.background, job_.channels, pixels_.width,
                      pixels_.height);
    rows.add_values(first_row_, end_row_, &values_);
  }

  void add_painted(const RasterLayer& layer) {
    if (color_buffers_ == nullptr)
      color_buffers_ = std::make_unique<ColorBuffers<N + 1>>(filter_, pixels_.width);
    auto& [cells, rows, first_row] = *color_buffers_;
    if (first_row != first_row_) {
      first_row = first_row_;
      cells.begin_band(filter_, pixels_.width, first_row_, end_row_);
    }
    add_edges(layer, &cells);
    rows.add_values(cells, LocalColor(layer.paint, filter_), first_row_, end_row_, &values_);
    cells.clear();
  }

  const RasterLayers& job_;
  const CellFilter& filter_;
  PixelRows pixels_;
  int first_row_ = 0;
  int end_row_ = 0;
  std::unique_ptr<CoverageBuffers<N>> coverage_buffers_;
  std::unique_ptr<ColorBuffers<N + 1>> color_buffers_;
  std::unique_ptr<BoxCoverage> box_;
  BandValues values_;
};

// A pool of renderers, one per concurrent band.
template <int N>
class BandRendererPool {
 public:
  using Renderer = std::unique_ptr<BandRenderer<N>>;

  // Calls use(renderer) with one that no other thread uses.
  template <typename Make, typename Use>
  void with_renderer(const Make& make, const Use& use) {
    Renderer renderer = take_idle();
    if (renderer == nullptr) renderer = make();
    use(renderer.get());
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(renderer));
  }

 private:
  Renderer take_idle() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return nullptr;
    Renderer renderer = std::move(idle_.back());
    idle_.pop_back();
    return renderer;
  }

  std::mutex mutex_;
  std::vector<Renderer> idle_;
};

template <int N>
void make_bands(const RasterLayers& job, const CellFilter& filter, const RasterOptions& options,
                const PixelRows& pixels) {
  constexpr int kBandValues = 1 << 16;
  constexpr int kMinRows = 16;
  const int rows = std::clamp(kBandValues / (options.width * job.channels), kMinRows, 256);
  BandRendererPool<N> renderers;
  parallel_ranges(options.height, rows, options.run.part(kLayersProgressShare, 1.0),
                  [&](std::int64_t begin, std::int64_t end) {
                    renderers.with_renderer(
                        [&] { return std::make_unique<BandRenderer<N>>(job, filter, pixels); },
                        [&](BandRenderer<N>* renderer) {
                          renderer->make(static_cast<int>(begin), static_cast<int>(end));
                        });
                  });
}

void make_all_bands(const RasterLayers& job, const CellFilter& filter, const RasterOptions& options,
                    const PixelRows& pixels) {
  switch (filter.degree) {
    case 0:
      make_bands<0>(job, filter, options, pixels);
      break;
    case 1:
      make_bands<1>(job, filter, options, pixels);
      break;
    case 2:
      make_bands<2>(job, filter, options, pixels);
      break;
    case 3:
      make_bands<3>(job, filter, options, pixels);
      break;
    default:
      make_bands<Kernel::kMostDegree>(job, filter, options, pixels);
      break;
  }
}

// Adds stacks to an image whose cells are squares of 2^cell_depth pixels, as means over cells.
void add_stack_means(const RasterLayers& stacks, int cell_depth, RasterOptions options,
                     Image* image) {
  const int side = 1 << cell_depth;
  const int columns = (image->width - 1) / side + 1;
  options.width = columns * side;
  options.height = ((image->height - 1) / side + 1) * side;
  check_memory("width, height: the cells of an image",
               4.0 * options.width * options.height * stacks.channels);
  Image pixels(options.width, options.height, stacks.channels);
  make_all_bands(stacks, *find_cell_filter("box"), options, rows_of(&pixels));
  std::vector<ChannelValues> sums;
  for (int first = 0; first < image->height; first += side) {
    sums.assign(columns, {});
    for (int y = first; y < first + side; ++y) {
      for (int x = 0; x < options.width; ++x) {
        for (int c = 0; c < stacks.channels; ++c) {
          sums[x / side][c] += pixels.texel(x, y)[c] - stacks.background[c];
        }
      }
    }
    for (int y = first; y < std::min(first + side, image->height); ++y) {
      for (int x = 0; x < image->width; ++x) {
        for (int c = 0; c < stacks.channels; ++c) {
          image->texel(x, y)[c] += static_cast<float>(sums[x / side][c] / side / side);
        }
      }
    }
  }
}

// Validated options and prepared layers, for images of floats and of bytes.
struct Job {
  const CellFilter* filter = nullptr;
  RasterLayers layers;
};

Job job_of(std::span<const Shape> shapes, const RasterOptions& options, double value_bytes) {
  check_options(shapes, options, value_bytes);
  const std::string_view name =
      element_named("filter", options.filter, raster_filters(), std::identity());
  if (options.method == RasterMethod::kWavelet) {
    check_wavelet_options(shapes, options);
  } else if (options.depth >= 0) {
    throw_invalid("depth: found " + std::to_string(options.depth) +
                  "; only the method wavelet has depths");
  }
  return {find_cell_filter(name), make_layers(shapes, options)};
}

void add_wavelets(RasterLayers* job, const RasterOptions& options, Image* image) {
  const int most = wavelet_depth(options.width, options.height);
  const int depth = options.depth < 0 ? most : options.depth;
  add_up_wavelets(*job, depth, options.run.part(kLayersProgressShare, 1.0), image);
  if (job->stacks.empty()) return;
  RasterLayers stacks;
  stacks.channels = job->channels;
  stacks.background = job->background;
  stacks.stacks = std::move(job->stacks);
  add_stack_means(stacks, most - depth, options, image);
}

}  // namespace

Image rasterize(std::span<const Shape> shapes, const RasterOptions& options) {
  Job job = job_of(shapes, options, sizeof(float));
  Image image(options.width, options.height, job.layers.channels);
  if (options.method == RasterMethod::kWavelet) {
    add_wavelets(&job.layers, options, &image);
  } else {
    make_all_bands(job.layers, *job.filter, options, rows_of(&image));
  }
  return image;
}

ByteImage rasterize_bytes(std::span<const Shape> shapes, const RasterOptions& options) {
  Job job = job_of(shapes, options, options.method == RasterMethod::kWavelet ? 5.0 : 1.0);
  const int channels = job.layers.channels;
  ByteImage image{options.width, options.height, channels, {}};
  image.data.resize(static_cast<std::size_t>(options.width) * options.height * channels);
  if (options.method == RasterMethod::kWavelet) {
    Image floats(options.width, options.height, channels);
    add_wavelets(&job.layers, options, &floats);
    unit_bytes(std::span<const float>(floats.data), image.data.data());
  } else {
    const PixelRows rows{nullptr, image.data.data(), options.width, options.height, channels};
    make_all_bands(job.layers, *job.filter, options, rows);
  }
  return image;
}

}  // namespace prefilter
