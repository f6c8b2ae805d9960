// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/raster_layers.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/outline/resolve_soon.h"
#include "prefilter/outline/visible_pieces.h"
#include "prefilter/raster/gradient_strips.h"

namespace prefilter {
namespace {

// Coverage is summed up in whole numbers that hold this many times a full cell, and more.
constexpr int kMostShapesTogether = 16;

bool has_alpha(const Paint& paint) { return paint.channels == kMaxChannels; }

constexpr int kAlpha = kMaxChannels - 1;

// Before a background a shape adds, at every point, its value less what it hides of it.
void take_background(const ChannelValues& background, Paint* paint) {
  const auto take = [&](ChannelValues* value, double opaque) {
    const double alpha = has_alpha(*paint) ? (*value)[kAlpha] : opaque;
    for (int c = 0; c < paint->channels; ++c) (*value)[c] -= alpha * background[c];
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

bool is_opaque(const Paint& paint) {
  if (!has_alpha(paint)) return true;
  if (!paint.stops.empty()) {
    return std::all_of(paint.stops.begin(), paint.stops.end(),
                       [](const GradientStop& stop) { return stop.value[kAlpha] >= 1.0; });
  }
  return paint.constant[kAlpha] >= 1.0 && paint.along_x[kAlpha] == 0.0 &&
         paint.along_y[kAlpha] == 0.0;
}

Paint scaled(Paint paint, double factor) {
  const auto scale = [&](ChannelValues* values) {
    for (double& value : *values) value *= factor;
  };
  scale(&paint.constant);
  scale(&paint.along_x);
  scale(&paint.along_y);
  for (GradientStop& stop : paint.stops) scale(&stop.value);
  return paint;
}

class LayerMaker {
 public:
  LayerMaker(RasterMethod method, RasterLayers* out) : method_(method), out_(out) {}

  // An outline that is kept elsewhere, under paints that let 1 - alpha pass.
  void add_veiled(const Outline& outline, const Paint& paint, const std::vector<Paint>& veils) {
    double passing = 1.0;
    std::vector<Paint> varying;
    for (const Paint& veil : veils) {
      if (veil.kind == Paint::Kind::kConstant) {
        passing *= 1.0 - veil.constant[kAlpha];
      } else {
        varying.push_back(veil);
      }
    }
    if (varying.empty()) {
      add(outline, scaled(paint, passing));
    } else if (!outline.empty()) {
      out_->layers.push_back({{}, scaled(paint, passing), std::move(varying)});
      out_->layers.back().edges.add(outline);
      together_ = 0;
    }
  }

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
      out_->layers.push_back({{}, paint, {}});
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

int channel_count(std::span<const Shape> shapes, const RasterOptions& options) {
  if (!shapes.empty()) return shapes.front().paint.channels;
  return std::max(1, static_cast<int>(options.background.size()));
}

RasterLayers make_layers(std::span<const Shape> shapes, const RasterOptions& options) {
  RasterLayers out;
  out.channels = channel_count(shapes, options);
  std::copy(options.background.begin(), options.background.end(), out.background.begin());
  std::vector<Paint> paints;
  for (const Shape& shape : shapes) {
    paints.push_back(shape.paint);
    take_background(out.background, &paints.back());
  }
  const Progress progress = options.progress.part(0.0, kLayersShare);
  LayerMaker maker(options.method, &out);
  if (options.overlap == Overlap::kCover && shapes.size() > 1) {
    std::vector<CoveringLayer> layers;
    for (const Shape& shape : shapes) {
      layers.push_back({&shape.outline, shape.fill_rule, is_opaque(shape.paint)});
    }
    auto pieces = visible_pieces(layers, ArrangementEffort::kBounded, options.threads, progress);
    if (!pieces) {
      out.stacks.push_back(stack_of(shapes));
      return out;
    }
    for (VisiblePiece& piece : *pieces) {
      std::vector<Paint> veils;
      for (const std::uint32_t veil : piece.veils) veils.push_back(shapes[veil].paint);
      maker.add_veiled(maker.keep(std::move(piece.outline)), paints[piece.layer], veils);
    }
    return out;
  }
  // Only the thread that called reports, which one shape by itself stays on.
  const Progress within = shapes.size() == 1 ? progress : Progress();
  std::vector<std::optional<Outline>> changed(shapes.size());
  std::vector<std::uint8_t> is_stacked(shapes.size(), 0);
  parallel_for(
      static_cast<std::int64_t>(shapes.size()), options.threads, progress, [&](std::int64_t i) {
        if (shapes[i].winds_once) return;
        if (options.method == RasterMethod::kWavelet && is_left_open(shapes[i].outline)) {
          return;
        }
        is_stacked[i] = !resolve_soon(shapes[i].outline, shapes[i].fill_rule, within, &changed[i]);
      });
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (is_stacked[i] != 0) {
      out.stacks.push_back(stack_of(shapes.subspan(i, 1)));
    } else {
      maker.add(changed[i] ? maker.keep(*std::move(changed[i])) : shapes[i].outline, paints[i]);
    }
  }
  return out;
}

}  // namespace prefilter
