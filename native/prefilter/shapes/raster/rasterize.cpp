// SPDX-License-Identifier: GPL-3.0-or-later

// Section 2.2: the image of shapes, filtered in closed form.
//
// Bands of rows are made one by one, each from the segments that pass it, so that what is held
// beside the image is a band; how high one is follows from the image alone.

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
      if (!(std::abs(point.x) <= kFarthestPixel && std::abs(point.y) <= kFarthestPixel)) {
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

// Where pixels go: floats, or else bytes.
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

// For shapes of one color.
template <int N>
struct Covered {
  Covered(const CellFilter& filter, int width) : moments(filter, width) {}

  MomentCells<N> cells;
  MomentRows<N> moments;
  CoverageRows rows;
  int first_row = -1;  // of the band that it is ready for
};

// For shapes of which the color is linear.
template <int M>
struct Painted {
  Painted(const CellFilter& filter, int width) : rows(filter, width) {}

  MomentCells<M> cells;
  PaintedRows<M> rows;
  int first_row = -1;
};

// Makes bands of rows, one after another, with memory that is kept.
template <int N>
class BandMaker {
 public:
  BandMaker(const RasterLayers& job, const CellFilter& filter, const PixelRows& pixels)
      : job_(job), filter_(filter), pixels_(pixels) {}

  void make(int first_row, int end_row) {
    first_row_ = first_row;
    end_row_ = end_row;
    values_.reset(pixels_.width, end_row - first_row, job_.channels, job_.background);
    // First, as it goes over what is there.
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
    // Of the filters the box alone is of degree 0.
    if (N == 0 && pixels_.width <= kMostBoxPixels && pixels_.height <= kMostBoxPixels) {
      add_box(layer);
      return;
    }
    if (covered_ == nullptr) covered_ = std::make_unique<Covered<N>>(filter_, pixels_.width);
    auto& [cells, moments, rows, first_row] = *covered_;
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
    // No more rows than it is in, as all of them are gone through.
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
          // Blocks mostly reach beyond the shape.
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
    composited.put_over(first_row_, end_row_, job_.background, &values_);
    StackRows<N> rows(stack, filter_, job_.background, job_.channels, pixels_.width,
                      pixels_.height);
    rows.add_marked(first_row_, end_row_, composited, &values_);
  }

  // Whether a layer may have a share in the band.
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
    if (painted_ == nullptr) painted_ = std::make_unique<Painted<N + 1>>(filter_, pixels_.width);
    auto& [cells, rows, first_row] = *painted_;
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
  std::unique_ptr<Covered<N>> covered_;
  std::unique_ptr<Painted<N + 1>> painted_;
  std::unique_ptr<BoxCoverage> box_;
  BandValues values_;
};

// Makers for as many bands as are made at once.
template <int N>
class BandMakers {
 public:
  using Maker = std::unique_ptr<BandMaker<N>>;

  // Calls use(maker) with one that nobody else has.
  template <typename Make, typename Use>
  void with_one(const Make& make, const Use& use) {
    Maker maker = taken();
    if (maker == nullptr) maker = make();
    use(maker.get());
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(maker));
  }

 private:
  Maker taken() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return nullptr;
    Maker maker = std::move(idle_.back());
    idle_.pop_back();
    return maker;
  }

  std::mutex mutex_;
  std::vector<Maker> idle_;
};

template <int N>
void make_bands(const RasterLayers& job, const CellFilter& filter, const RasterOptions& options,
                const PixelRows& pixels) {
  constexpr int kBandValues = 1 << 16;
  constexpr int kLeastRows = 16;
  const int rows = std::clamp(kBandValues / (options.width * job.channels), kLeastRows, 256);
  BandMakers<N> makers;
  parallel_ranges(options.height, rows, options.threads, options.progress.part(kLayersShare, 1.0),
                  [&](std::int64_t begin, std::int64_t end) {
                    makers.with_one(
                        [&] { return std::make_unique<BandMaker<N>>(job, filter, pixels); },
                        [&](BandMaker<N>* maker) {
                          maker->make(static_cast<int>(begin), static_cast<int>(end));
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

// Adds stacks to an image whose cells are squares of 2^cell_depth pixels: the means of pixels.
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

// What both kinds of images have in common: checked, and made ready.
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
  add_up_wavelets(*job, depth, options.threads, options.progress.part(kLayersShare, 1.0), image);
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
