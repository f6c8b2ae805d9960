// Section 2.2: the image of shapes, filtered in closed form.
//
// Bands of rows are made one by one, each from the segments that pass it, so that what is held
// beside the image is a band; how high one is follows from the image alone.

#include "prefilter/raster/rasterize.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/raster/coverage_rows.h"
#include "prefilter/raster/edge_list.h"
#include "prefilter/raster/moment_rows.h"

namespace prefilter {
namespace {

// Pixels are counted by int, and a coordinate in them has 2^-20 behind the point left.
constexpr double kLargestPixel = 1e9;

// Most shapes whose arcs are added up in the same whole numbers.
constexpr int kMostShapesTogether = 16;

// Shapes of one color, the segments of which are added up together: what they share then cancels.
struct Layer {
  EdgeList edges;
  ChannelValues color{};
};

struct Job {
  std::vector<Layer> layers;
  ChannelValues background{};
  int channels = 1;
};

void check_options(std::span<const Shape> shapes, const RasterOptions& options) {
  if (options.width < 1 || options.height < 1) {
    throw_invalid("width, height: found " + std::to_string(options.width) + " x " +
                  std::to_string(options.height) + " pixels; at least 1 x 1 is needed");
  }
  const int channels = shapes.empty() ? 1 : shapes.front().paint.channels;
  check_memory("an image of " + std::to_string(options.width) + " x " +
                   std::to_string(options.height) + " pixels",
               4.0 * options.width * options.height * channels);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::string who = "shapes: shape " + std::to_string(i);
    if (shapes[i].paint.channels != channels) {
      throw_invalid(who + " has " + std::to_string(shapes[i].paint.channels) +
                    " channels, and the first has " + std::to_string(channels) +
                    "; all must have the same number");
    }
    for (const Point2& point : shapes[i].outline.points()) {
      if (!(std::abs(point.x) <= kLargestPixel && std::abs(point.y) <= kLargestPixel)) {
        throw_invalid(who + " has a point that is not finite, or farther than 1e9 pixels away");
      }
    }
  }
}

Job make_job(std::span<const Shape> shapes, const RasterOptions& options) {
  Job job;
  if (!shapes.empty()) job.channels = shapes.front().paint.channels;
  for (std::size_t c = 0; c < options.background.size(); ++c) {
    job.background[c] = options.background[c];
  }
  int together = 0;
  for (const Shape& shape : shapes) {
    if (shape.outline.empty()) continue;
    const bool is_alike = !job.layers.empty() && job.layers.back().color == shape.paint.constant;
    if (!is_alike || together == kMostShapesTogether) {
      job.layers.emplace_back();
      job.layers.back().color = shape.paint.constant;
      together = 0;
    }
    job.layers.back().edges.add(shape.outline);
    ++together;
  }
  return job;
}

// What one thread makes bands with.
template <int N>
class BandMaker {
 public:
  BandMaker(const Job& job, const CellFilter& filter, Image* image)
      : job_(job), filter_(filter), image_(image), moments_(filter, image->width) {}

  void make(int first_row, int end_row) {
    const int channels = job_.channels;
    const std::size_t row_values = static_cast<std::size_t>(image_->width) * channels;
    values_.resize(row_values * (end_row - first_row));
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = job_.background[i % channels];
    rows_.reset(image_->width, end_row - first_row);
    moments_.begin_band(first_row, end_row);
    const int first_cell = filter_.first_cell(first_row);
    const int end_cell = filter_.first_cell(end_row - 1) + filter_.taps;
    for (const Layer& layer : job_.layers) {
      if (filter_.to_cell(layer.edges.high()) < first_cell) continue;
      if (filter_.to_cell(layer.edges.low()) > end_cell) continue;
      layer.edges.for_pieces_between(first_cell, end_cell, filter_,
                                     [&](const MonotoneCurve& piece, bool backwards) {
                                       moments_.add(piece, backwards ? 1 : -1);
                                     });
      moments_.flush(&rows_);
      add_layer(layer, end_row - first_row);
    }
    float* out = image_->texel(0, first_row);
    std::transform(values_.begin(), values_.end(), out,
                   [](double value) { return static_cast<float>(value); });
  }

 private:
  void add_layer(const Layer& layer, int rows) {
    const int channels = job_.channels;
    for (int row = 0; row < rows; ++row) {
      if (!rows_.is_changed(row)) continue;
      double* out = values_.data() + static_cast<std::size_t>(row) * image_->width * channels;
      rows_.take(
          row,
          [&](int x, double coverage) {
            for (int c = 0; c < channels; ++c) out[x * channels + c] += coverage * layer.color[c];
          },
          [&](int begin, int end, double coverage) {
            for (int x = begin; x < end; ++x) {
              for (int c = 0; c < channels; ++c) out[x * channels + c] += coverage * layer.color[c];
            }
          });
    }
  }

  const Job& job_;
  const CellFilter& filter_;
  Image* image_;
  MomentRows<N> moments_;
  CoverageRows rows_;
  std::vector<double> values_;
};

template <int N>
void make_bands(const Job& job, const CellFilter& filter, const RasterOptions& options,
                Image* image) {
  constexpr int kBandValues = 1 << 17;
  const int rows = std::clamp(kBandValues / (options.width * job.channels), 16, 256);
  parallel_ranges(options.height, rows, options.threads, options.progress,
                  [&](std::int64_t begin, std::int64_t end) {
                    BandMaker<N> maker(job, filter, image);
                    maker.make(static_cast<int>(begin), static_cast<int>(end));
                  });
}

}  // namespace

Image rasterize(std::span<const Shape> shapes, const RasterOptions& options) {
  check_options(shapes, options);
  const CellFilter* filter = find_cell_filter(options.filter);
  if (filter == nullptr) {
    std::string names;
    for (const std::string_view name : raster_filters()) {
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    throw_invalid("filter: '" + options.filter + "' is not one of " + names);
  }
  const Job job = make_job(shapes, options);
  Image image(options.width, options.height, job.channels);
  switch (filter->degree) {
    case 0:
      make_bands<0>(job, *filter, options, &image);
      break;
    case 1:
      make_bands<1>(job, *filter, options, &image);
      break;
    case 2:
      make_bands<2>(job, *filter, options, &image);
      break;
    case 3:
      make_bands<3>(job, *filter, options, &image);
      break;
    default:
      make_bands<7>(job, *filter, options, &image);
      break;
  }
  return image;
}

}  // namespace prefilter
