// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/raster/raster_layers.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/shapes/outline/resolve_soon.h"
#include "prefilter/shapes/outline/shared_edges.h"
#include "prefilter/shapes/outline/visible_pieces.h"
#include "prefilter/shapes/raster/box_coverage.h"
#include "prefilter/shapes/raster/gradient_strips.h"
#include "prefilter/shapes/raster/paint_bounds.h"
#include "prefilter/shapes/raster/shape_groups.h"

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

// Whether what shows of a shape under others of which the colors are constant, or that are opaque,
// is told by moments: a color that is constant or, between stops, linear.
bool has_moments(const Paint& paint) {
  if (paint.kind == Paint::Kind::kConstant) return true;
  return paint.kind == Paint::Kind::kLinearStops && most_passing(paint, paint.channels) == 0.0;
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

// A shape by itself: its outline as it winds once, where that can be told.
struct Single {
  std::optional<Outline> changed;
  bool is_clear = true;
  bool is_told = false;  // whether it was looked for
};

// Shapes that are apart from all others.
struct Group {
  std::vector<std::uint32_t> shapes;  // numbers, from the lowest
  /// Where they are not beside each other, so that they only have to be added.
  bool is_covered = false;
  /// Where they are then put over each other pixel by pixel.
  bool is_composited = false;
  /// What is seen of them then, where that can be told.
  std::optional<std::vector<VisiblePiece>> pieces;
};

class LayerFinder {
 public:
  LayerFinder(std::span<const Shape> shapes, const RasterOptions& options)
      : shapes_(shapes), options_(options), singles_(shapes.size()) {}

  // Looks for what is seen of shapes that cover each other, from a number on.
  void find_covered(std::uint32_t first, const Progress& progress) {
    group_shapes(first);
    if (groups_.empty()) return;
    // Large groups take all threads one after another, as only the one that called can be told to
    // stop; the others one each.
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
      const auto done = static_cast<double>(i);
      find_pieces(&groups_[large[i]], options_.threads,
                  progress.part(done / groups, (done + 1.0) / groups));
    }
    parallel_for(static_cast<std::int64_t>(small.size()), options_.threads,
                 progress.part(static_cast<double>(large.size()) / groups, 1.0),
                 [&](std::int64_t i) { find_pieces(&groups_[small[i]], 1, {}); });
  }

  // The same of shapes that are added.
  void find_added(const Progress& progress) {
    groups_.resize(shapes_.size());
    for (std::uint32_t i = 0; i < shapes_.size(); ++i) groups_[i].shapes = {i};
    // Only the thread that called reports, which one shape by itself stays on.
    const Progress within = shapes_.size() == 1 ? progress : Progress();
    parallel_for(static_cast<std::int64_t>(shapes_.size()), options_.threads, progress,
                 [&](std::int64_t i) { find_single(static_cast<std::uint32_t>(i), within); });
  }

  void add_to(std::span<const Paint> paints, RasterLayers* out) {
    LayerMaker maker(options_.method, out);
    std::vector<std::uint32_t> composited;
    std::vector<std::uint32_t> stacked;
    for (Group& group : groups_) {
      if (group.is_covered) {
        if (!group.pieces) {
          auto& numbers = group.is_composited ? composited : stacked;
          numbers.insert(numbers.end(), group.shapes.begin(), group.shapes.end());
          continue;
        }
        for (VisiblePiece& piece : *group.pieces) {
          double passing = 1.0;
          for (const std::uint32_t veil : piece.veils) {
            passing *= 1.0 - shapes_[group.shapes[veil]].paint.constant[kAlpha];
          }
          maker.add(maker.keep(std::move(piece.outline)),
                    scaled(paints[group.shapes[piece.layer]], passing));
        }
        continue;
      }
      for (const std::uint32_t i : group.shapes) {
        Single& single = singles_[i];
        const bool is_radial = shapes_[i].paint.kind == Paint::Kind::kRadialStops;
        if (is_radial && options_.overlap == Overlap::kCover && may_composite_) {
          composited.push_back(i);
        } else if (single.is_clear && !is_radial) {
          maker.add(single.changed ? maker.keep(*std::move(single.changed)) : shapes_[i].outline,
                    paints[i]);
        } else if (options_.overlap == Overlap::kAdd) {
          std::vector<std::uint32_t> numbers = {i};
          add_stack(&numbers, &maker, out);
        } else {
          stacked.push_back(i);
        }
      }
    }
    add_stack(&composited, &maker, out);
    if (!composited.empty()) out->stacks.back().is_composited = true;
    add_stack(&stacked, &maker, out);
  }

 private:
  // Several groups in one, so that it has the steps of one, however many groups there are.
  void add_stack(std::vector<std::uint32_t>* numbers, LayerMaker* maker, RasterLayers* out) {
    if (numbers->empty()) return;
    std::sort(numbers->begin(), numbers->end());
    std::vector<StackShape> shapes;
    for (const std::uint32_t i : *numbers) {
      const Shape& shape = shapes_[i];
      Single& single = singles_[i];
      const bool winds_once = shape.winds_once || (single.is_told && single.is_clear);
      const Outline& outline =
          single.changed ? maker->keep(*std::move(single.changed)) : shape.outline;
      shapes.push_back({&outline, shape.fill_rule, &shape.paint, winds_once});
    }
    out->stacks.push_back(stack_of(shapes));
  }

  // Whether shapes may be put over each other pixel by pixel: those that cover the image very often
  // take less in other ways.
  bool may_composite(std::span<const Box2> boxes) const {
    if (options_.method != RasterMethod::kScanline || options_.filter != "box") return false;
    if (std::max(options_.width, options_.height) > kMostBoxPixels) return false;
    constexpr double kMostImages = 64.0;
    double area = 0.0;
    for (const Box2& box : boxes) {
      if (box.empty()) continue;
      const double width = std::min(box.high.x, options_.width + 0.0) - std::max(box.low.x, 0.0);
      const double height = std::min(box.high.y, options_.height + 0.0) - std::max(box.low.y, 0.0);
      area += std::max(width, 0.0) * std::max(height, 0.0);
    }
    return area <= kMostImages * options_.width * options_.height;
  }

  void group_shapes(std::uint32_t first) {
    if (options_.method == RasterMethod::kWavelet) {
      // That leaves contours open where shapes do not cover each other.
      groups_.push_back({{}, true, false, {}});
      for (std::uint32_t i = first; i < shapes_.size(); ++i) groups_[0].shapes.push_back(i);
      return;
    }
    std::vector<Box2> boxes(shapes_.size());
    for (std::uint32_t i = first; i < shapes_.size(); ++i) {
      if (!shapes_[i].outline.empty()) boxes[i] = control_box(shapes_[i].outline);
    }
    may_composite_ = may_composite(boxes);
    for (std::vector<std::uint32_t>& group : groups_apart(boxes)) {
      groups_.push_back({std::move(group), false, false, {}});
    }
  }

  void find_single(std::uint32_t i, const Progress& progress) {
    const Shape& shape = shapes_[i];
    if (shape.winds_once) return;
    if (options_.method == RasterMethod::kWavelet && is_left_open(shape.outline)) return;
    Single& single = singles_[i];
    single.is_told = true;
    single.is_clear = resolve_soon(shape.outline, shape.fill_rule, progress, &single.changed);
  }

  void find_pieces(Group* group, int threads, const Progress& progress) {
    if (!group->is_covered) {
      const auto count = static_cast<std::int64_t>(group->shapes.size());
      const Progress within = count == 1 ? progress : Progress();
      parallel_for(count, threads, progress.part(0.0, 0.1),
                   [&](std::int64_t i) { find_single(group->shapes[i], within); });
      group->is_covered = count > 1 && !are_beside(group->shapes);
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
      layers.push_back(
          {&shapes_[i].outline, shapes_[i].fill_rule, most_passing(paint, paint.channels) == 0.0});
    }
    group->pieces =
        visible_pieces(layers, ArrangementEffort::kBounded, threads, progress.part(0.1, 1.0));
  }

  bool are_beside(std::span<const std::uint32_t> numbers) const {
    std::vector<const Outline*> outlines;
    for (const std::uint32_t i : numbers) {
      const Single& single = singles_[i];
      if (!single.is_clear) return false;
      outlines.push_back(single.changed ? &*single.changed : &shapes_[i].outline);
    }
    return are_side_by_side(outlines);
  }

  std::span<const Shape> shapes_;
  const RasterOptions& options_;
  std::vector<Single> singles_;
  bool may_composite_ = false;
  std::vector<Group> groups_;
};

// Whether a shape is one color all over an image, and so far around it that a filter sees no more.
bool is_behind_all(const Shape& shape, const RasterOptions& options) {
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
    // Sides along one axis in turns; with those of no length it is no rectangle around anything.
    if (!((side.x == 0.0 && next.y == 0.0) || (side.y == 0.0 && next.x == 0.0))) return false;
  }
  constexpr double kFarthestSeen = 16.0;
  const double margin = options.filter == "box" ? 0.0 : kFarthestSeen;
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
  // Pages mostly have one behind all that is on them.
  std::uint32_t first = 0;
  for (; covers && first < shapes.size() && is_behind_all(shapes[first], options); ++first) {
    const ChannelValues& color = shapes[first].paint.constant;
    const double passing = has_alpha(shapes[first].paint) ? 1.0 - color[kAlpha] : 0.0;
    for (int c = 0; c < out.channels; ++c) {
      out.background[c] = passing * out.background[c] + color[c];
    }
  }
  std::vector<Paint> paints;
  for (const Shape& shape : shapes) {
    paints.push_back(shape.paint);
    take_background(out.background, &paints.back());
  }
  const Progress progress = options.progress.part(0.0, kLayersShare);
  LayerFinder finder(shapes, options);
  if (covers) {
    finder.find_covered(first, progress);
  } else {
    finder.find_added(progress);
  }
  finder.add_to(paints, &out);
  return out;
}

}  // namespace prefilter
