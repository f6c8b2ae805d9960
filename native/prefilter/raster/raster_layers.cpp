#include "prefilter/raster/raster_layers.h"

#include <optional>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/outline/resolve.h"
#include "prefilter/raster/gradient_strips.h"

namespace prefilter {
namespace {

// Coverage is summed up in whole numbers that hold this many times a full cell, and more.
constexpr int kMostShapesTogether = 16;

// Before a background a shape adds, at every point, its value less what it hides of it.
void take_background(const ChannelValues& background, Paint* paint) {
  const int channels = paint->channels;
  const auto alpha_of = [&](const ChannelValues& value, double opaque) {
    return channels == kMaxChannels ? value[kMaxChannels - 1] : opaque;
  };
  const auto take = [&](ChannelValues* value, double opaque) {
    const double alpha = alpha_of(*value, opaque);
    for (int c = 0; c < channels; ++c) (*value)[c] -= alpha * background[c];
  };
  take(&paint->constant, 1.0);
  take(&paint->along_x, 0.0);
  take(&paint->along_y, 0.0);
  for (GradientStop& stop : paint->stops) take(&stop.value, 1.0);
}

// The wavelet method leaves gaps as they are, and with them what winds round what.
bool is_left_open(const Outline& outline) {
  for (std::size_t i = 0; i < outline.contour_count(); ++i) {
    const auto segments = outline.contour(i);
    if (!segments.empty() && !(outline.controls(segments.back()).back() == outline.begin_of(i))) {
      return true;
    }
  }
  return false;
}

class LayerMaker {
 public:
  LayerMaker(RasterMethod method, RasterLayers* out) : method_(method), out_(out) {}

  // An outline that is kept elsewhere.
  void add(const Outline& outline, const Paint& paint) {
    if (outline.empty()) return;
    if (paint.kind == Paint::Kind::kLinearStops) {
      for (GradientStrip& strip : gradient_strips(outline, paint)) {
        add(keep(std::move(strip.outline)), strip.paint);
      }
      return;
    }
    const bool is_constant = paint.kind == Paint::Kind::kConstant;
    const bool joins = is_constant && together_ > 0 &&
                       (together_ < kMostShapesTogether || method_ == RasterMethod::kWavelet) &&
                       out_->layers.back().paint.constant == paint.constant;
    if (!joins) {
      out_->layers.push_back({{}, paint});
      together_ = 0;
    }
    together_ = is_constant ? together_ + 1 : 0;
    out_->layers.back().edges.add(outline, method_ == RasterMethod::kScanline);
  }

  const Outline& keep(Outline outline) {
    out_->outlines.push_back(std::move(outline));
    return out_->outlines.back();
  }

 private:
  RasterMethod method_;
  RasterLayers* out_;
  int together_ = 0;  // shapes in the last layer, where that is of one color
};

}  // namespace

RasterLayers make_layers(std::span<const Shape> shapes, const RasterOptions& options) {
  RasterLayers out;
  if (!shapes.empty()) out.channels = shapes.front().paint.channels;
  for (std::size_t c = 0; c < options.background.size(); ++c) {
    out.background[c] = options.background[c];
  }
  std::vector<std::optional<Outline>> changed(shapes.size());
  parallel_for(static_cast<std::int64_t>(shapes.size()), options.threads,
               options.progress.part(0.0, 0.2), [&](std::int64_t i) {
                 if (shapes[i].winds_once) return;
                 if (options.method == RasterMethod::kWavelet && is_left_open(shapes[i].outline)) {
                   return;
                 }
                 changed[i] = resolved(shapes[i].outline, shapes[i].fill_rule);
               });
  LayerMaker maker(options.method, &out);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Paint paint = shapes[i].paint;
    take_background(out.background, &paint);
    maker.add(changed[i] ? maker.keep(*std::move(changed[i])) : shapes[i].outline, paint);
  }
  return out;
}

}  // namespace prefilter
