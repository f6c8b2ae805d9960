// SPDX-License-Identifier: GPL-3.0-or-later

// Decides for each group of overlapping shapes whether they are split into visible pieces,
// composited by pixel, or stacked.
#include "prefilter/shapes/raster/raster_layers.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/shapes/outline/resolve_within_budget.h"
#include "prefilter/shapes/outline/shared_edges.h"
#include "prefilter/shapes/outline/visible_pieces.h"
#include "prefilter/shapes/raster/box_coverage.h"
#include "prefilter/shapes/raster/gradient_strips.h"
#include "prefilter/shapes/raster/paint_bounds.h"
#include "prefilter/shapes/raster/shape_groups.h"

namespace prefilter {
namespace {

// Integer coverage holds at least this many times a full cell without overflow.
constexpr int kMaxShapesPerLayer = 16;

bool has_alpha(const Paint& paint) { return paint.channels == kMaxChannels; }

constexpr int kRasterLayersAlpha = kMaxChannels - 1;

// Subtracts the part of the background that a paint hides, so that a shape's value can be added to
// the background.
void subtract_background(const ChannelValues& background, Paint* paint) {
  const auto take = [&](ChannelValues* value, double opaque) {
    const double alpha = has_alpha(*paint) ? (*value)[kRasterLayersAlpha] : opaque;
    for (int c = 0; c < paint->channels; ++c) (*value)[c] -= alpha * background[c];
  };
  take(&paint->constant, 1.0);
  take(&paint->along_x, 0.0);
  take(&paint->along_y, 0.0);
  for (GradientStop& stop : paint->stops) take(&stop.value, 1.0);
}

// The wavelet method does not close open contours, so winding numbers are kept as given.
bool is_left_open(const Outline& outline) {
  for (std::size_t i = 0; i < outline.contour_count(); ++i) {
    const auto segments = outline.contour(i);
    if (!segments.empty() && !(outline.controls(segments.back()).back() == outline.begin_of(i))) {
      return true;
    }
  }
  return false;
}

// Whether a color can be integrated by moments where it is visible under layers of constant or
// opaque colors: it is constant or, between stops, linear.
bool has_moments(const Paint& paint) {
  if (paint.kind == Paint::Kind::kConstant) return true;
  return paint.kind == Paint::Kind::kLinearStops && max_transmittance(paint, paint.channels) == 0.0;
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

class LayerBuilder {
 public:
  LayerBuilder(RasterMethod method, RasterLayers* out) : method_(method), out_(out) {}

  void add(const Outline& outline, const Paint& paint) {
    if (outline.empty()) return;
    if (paint.kind == Paint::Kind::kLinearStops) {
      for (GradientStrip& strip : gradient_strips(outline, paint)) {
        add(keep(std::move(strip.outline)), strip.paint);
      }
      return;
    }
    const bool is_constant = paint.kind == Paint::Kind::kConstant;
    const bool joins = is_constant && layer_shapes_ > 0 &&
                       (layer_shapes_ < kMaxShapesPerLayer || method_ == RasterMethod::kWavelet) &&
                       out_->layers.back().paint.constant == paint.constant;
    if (!joins) {
      out_->layers.push_back({{}, paint});
      layer_shapes_ = 0;
    }
    layer_shapes_ = is_constant ? layer_shapes_ + 1 : 0;
    out_->layers.back().edges.add(outline, method_ == RasterMethod::kScanline);
  }

  const Outline& keep(Outline outline) {
    out_->outlines.push_back(std::move(outline));
    return out_->outlines.back();
  }

 private:
  RasterMethod method_;
  RasterLayers* out_;
  int layer_shapes_ = 0;  // shapes in the last layer, if it has one constant color
};

// A shape by itself, and its resolved outline.
struct ResolvedShape {
  std::optional<Outline> changed;
  bool is_clear = true;
  bool was_tried = false;  // whether resolving was tried
};

// Shapes whose boxes overlap, directly or via others.
struct Group {
  std::vector<std::uint32_t> shapes;  // indices, from the lowest
  /// Whether shapes cover each other; otherwise they only have to be added.
  bool is_covered = false;
  /// If they cover each other: whether they are composited by pixel.
  bool is_composited = false;
  /// If they cover each other: their visible pieces, if these could be found.
  std::optional<std::vector<VisiblePiece>> pieces;
};

class LayerPlanner {
 public:
  LayerPlanner(std::span<const Shape> shapes, const RasterOptions& options)
      : shapes_(shapes), options_(options), resolved_(shapes.size()) {}

  // Prepares shapes that cover each other, from index `first` on.
  void prepare_covered(std::uint32_t first, const Run& run) {
    group_shapes(first);
    if (groups_.empty()) return;
    // Cancellation is only seen by the calling thread. So large groups run one after another with
    // all threads, and small ones in parallel with one thread each.
    constexpr std::size_t kLargeSegments = 4096;
    std::vector<std::size_t> small;
    std::vector<std::size_t> large;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      std::size_t segments = 0;
      for (const std::uint32_t shape : groups_[i].shapes) {
        segments += shapes_[shape].outline.segments().size();
      }
      (segments < kLargeSegments ? small : large).push_back(i);
    }
    const auto groups = static_cast<double>(groups_.size());
    for (std::size_t i = 0; i < large.size(); ++i) {
      const auto finished = static_cast<double>(i);
      find_pieces(&groups_[large[i]], run.part(finished / groups, (finished + 1.0) / groups));
    }
    parallel_for(static_cast<std::int64_t>(small.size()),
                 run.part(static_cast<double>(large.size()) / groups, 1.0),
                 [&](std::int64_t i) { find_pieces(&groups_[small[i]], Run(1)); });
  }

  // Prepares shapes that are added.
  void prepare_added(const Run& run) {
    groups_.resize(shapes_.size());
    for (std::uint32_t i = 0; i < shapes_.size(); ++i) groups_[i].shapes = {i};
    // Only the calling thread reports progress, and a single shape runs on it.
    const Run within = shapes_.size() == 1 ? run : Run();
    parallel_for(static_cast<std::int64_t>(shapes_.size()), run,
                 [&](std::int64_t i) { resolve_shape(static_cast<std::uint32_t>(i), within); });
  }

  void add_to(std::span<const Paint> paints, RasterLayers* out) {
    LayerBuilder builder(options_.method, out);
    std::vector<std::uint32_t> composited;
    std::vector<std::uint32_t> stacked;
    for (Group& group : groups_) {
      if (group.is_covered) {
        if (!group.pieces) {
          auto& indices = group.is_composited ? composited : stacked;
          indices.insert(indices.end(), group.shapes.begin(), group.shapes.end());
          continue;
        }
        for (VisiblePiece& piece : *group.pieces) {
          double transmittance = 1.0;
          for (const std::uint32_t overlay : piece.overlays) {
            transmittance *=
                1.0 - shapes_[group.shapes[overlay]].paint.constant[kRasterLayersAlpha];
          }
          builder.add(builder.keep(std::move(piece.outline)),
                      scaled(paints[group.shapes[piece.layer]], transmittance));
        }
        continue;
      }
      for (const std::uint32_t i : group.shapes) {
        ResolvedShape& resolved = resolved_[i];
        const bool is_radial = shapes_[i].paint.kind == Paint::Kind::kRadialStops;
        if (is_radial && options_.overlap == Overlap::kCover && may_composite_) {
          composited.push_back(i);
        } else if (resolved.is_clear && !is_radial) {
          builder.add(
              resolved.changed ? builder.keep(*std::move(resolved.changed)) : shapes_[i].outline,
              paints[i]);
        } else if (options_.overlap == Overlap::kAdd) {
          std::vector<std::uint32_t> indices = {i};
          add_stack(&indices, &builder, out);
        } else {
          stacked.push_back(i);
        }
      }
    }
    add_stack(&composited, &builder, out);
    if (!composited.empty()) out->stacks.back().is_composited = true;
    add_stack(&stacked, &builder, out);
  }

 private:
  // Combines several groups to one stack, so that they share one limit of steps.
  void add_stack(std::vector<std::uint32_t>* indices, LayerBuilder* builder, RasterLayers* out) {
    if (indices->empty()) return;
    std::sort(indices->begin(), indices->end());
    std::vector<StackShape> shapes;
    for (const std::uint32_t i : *indices) {
      const Shape& shape = shapes_[i];
      ResolvedShape& resolved = resolved_[i];
      const bool winds_once = shape.winds_once || (resolved.was_tried && resolved.is_clear);
      const Outline& outline =
          resolved.changed ? builder->keep(*std::move(resolved.changed)) : shape.outline;
      shapes.push_back({&outline, shape.fill_rule, &shape.paint, winds_once});
    }
    out->stacks.push_back(make_stack(shapes));
  }

  // Whether shapes may be composited by pixel: other methods are faster for shapes that cover the
  // image many times.
  bool may_composite(std::span<const Box2> boxes) const {
    if (options_.method != RasterMethod::kScanline || options_.filter != "box") return false;
    if (std::max(options_.width, options_.height) > kMaxBoxImageSide) return false;
    // The ratio of the total area of boxes to the image.
    constexpr double kMaxCoveredImages = 64.0;
    double area = 0.0;
    for (const Box2& box : boxes) {
      if (box.empty()) continue;
      const double width = std::min(box.high.x, options_.width + 0.0) - std::max(box.low.x, 0.0);
      const double height = std::min(box.high.y, options_.height + 0.0) - std::max(box.low.y, 0.0);
      area += std::max(width, 0.0) * std::max(height, 0.0);
    }
    return area <= kMaxCoveredImages * options_.width * options_.height;
  }

  void group_shapes(std::uint32_t first) {
    if (options_.method == RasterMethod::kWavelet) {
      // Open contours stay open if shapes do not cover each other, so all shapes form one group.
      groups_.push_back({{}, true, false, {}});
      for (std::uint32_t i = first; i < shapes_.size(); ++i) groups_[0].shapes.push_back(i);
      return;
    }
    std::vector<Box2> boxes(shapes_.size());
    for (std::uint32_t i = first; i < shapes_.size(); ++i) {
      if (!shapes_[i].outline.empty()) boxes[i] = control_box(shapes_[i].outline);
    }
    may_composite_ = may_composite(boxes);
    for (std::vector<std::uint32_t>& group : overlapping_groups(boxes)) {
      groups_.push_back({std::move(group), false, false, {}});
    }
  }

  void resolve_shape(std::uint32_t i, const Run& run) {
    const Shape& shape = shapes_[i];
    if (shape.winds_once) return;
    if (options_.method == RasterMethod::kWavelet && is_left_open(shape.outline)) return;
    ResolvedShape& resolved = resolved_[i];
    resolved.was_tried = true;
    resolved.is_clear =
        resolve_within_budget(shape.outline, shape.fill_rule, run, &resolved.changed);
  }

  void find_pieces(Group* group, const Run& run) {
    const Stages stages(run, {1, 9});
    if (!group->is_covered) {
      const auto count = static_cast<std::int64_t>(group->shapes.size());
      const Run within = count == 1 ? run : Run();
      parallel_for(count, stages[0],
                   [&](std::int64_t i) { resolve_shape(group->shapes[i], within); });
      group->is_covered = count > 1 && !are_disjoint(group->shapes);
    }
    if (!group->is_covered) return;
    group->is_composited = may_composite_;
    if (group->is_composited) return;
    if (!std::all_of(group->shapes.begin(), group->shapes.end(),
                     [&](auto i) { return has_moments(shapes_[i].paint); })) {
      return;
    }
    std::vector<CoveringLayer> layers;
    for (const std::uint32_t i : group->shapes) {
      const Paint& paint = shapes_[i].paint;
      layers.push_back({&shapes_[i].outline, shapes_[i].fill_rule,
                        max_transmittance(paint, paint.channels) == 0.0});
    }
    group->pieces = visible_pieces(layers, ArrangementEffort::kBounded, stages[1]);
  }

  bool are_disjoint(std::span<const std::uint32_t> indices) const {
    std::vector<const Outline*> outlines;
    for (const std::uint32_t i : indices) {
      const ResolvedShape& resolved = resolved_[i];
      if (!resolved.is_clear) return false;
      outlines.push_back(resolved.changed ? &*resolved.changed : &shapes_[i].outline);
    }
    return have_disjoint_interiors(outlines);
  }

  std::span<const Shape> shapes_;
  const RasterOptions& options_;
  std::vector<ResolvedShape> resolved_;
  bool may_composite_ = false;
  std::vector<Group> groups_;
};

// Whether a shape covers the whole image, and a margin as wide as any filter, with one color.
bool covers_image(const Shape& shape, const RasterOptions& options) {
  if (shape.paint.kind != Paint::Kind::kConstant || options.method == RasterMethod::kWavelet) {
    return false;
  }
  const Outline& outline = shape.outline;
  const auto points = outline.points();
  if (outline.contour_count() != 1 || outline.segments().size() + 1 < points.size()) return false;
  if (points.size() < 4 || points.size() > 5) return false;
  if (points.size() == 5 && !(points[4] == points[0])) return false;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point2 side = points[(i + 1) % 4] - points[i];
    const Point2 next = points[(i + 2) % 4] - points[(i + 1) % 4];
    // The sides must alternate between both axes; sides without length enclose nothing.
    if (!((side.x == 0.0 && next.y == 0.0) || (side.y == 0.0 && next.x == 0.0))) return false;
  }
  constexpr double kMaxFilterRadius = 16.0;
  const double margin = options.filter == "box" ? 0.0 : kMaxFilterRadius;
  const Box2 box = control_box(outline);
  return box.low.x <= -margin && box.low.y <= -margin && box.high.x >= options.width + margin &&
         box.high.y >= options.height + margin;
}

}  // namespace

int channel_count(std::span<const Shape> shapes, const RasterOptions& options) {
  if (!shapes.empty()) return shapes.front().paint.channels;
  return std::max(1, static_cast<int>(options.background.size()));
}

RasterLayers make_layers(std::span<const Shape> shapes, const RasterOptions& options) {
  RasterLayers out;
  out.channels = channel_count(shapes, options);
  std::copy(options.background.begin(), options.background.end(), out.background.begin());
  const bool covers = options.overlap == Overlap::kCover && shapes.size() > 1;
  // Pages often begin with a shape behind everything else.
  std::uint32_t first = 0;
  for (; covers && first < shapes.size() && covers_image(shapes[first], options); ++first) {
    const ChannelValues& color = shapes[first].paint.constant;
    const double transmittance =
        has_alpha(shapes[first].paint) ? 1.0 - color[kRasterLayersAlpha] : 0.0;
    for (int c = 0; c < out.channels; ++c) {
      out.background[c] = transmittance * out.background[c] + color[c];
    }
  }
  std::vector<Paint> paints;
  for (const Shape& shape : shapes) {
    paints.push_back(shape.paint);
    subtract_background(out.background, &paints.back());
  }
  const Run run = options.run.part(0.0, kLayersProgressShare);
  LayerPlanner planner(shapes, options);
  if (covers) {
    planner.prepare_covered(first, run);
  } else {
    planner.prepare_added(run);
  }
  planner.add_to(paints, &out);
  return out;
}

}  // namespace prefilter
