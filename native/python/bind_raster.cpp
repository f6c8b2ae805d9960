// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/shapes/half_plane.h"
#include "prefilter/shapes/path_data.h"
#include "prefilter/shapes/pixel_outline.h"
#include "prefilter/shapes/rasterize.h"
#include "prefilter/shapes/set_operations.h"
#include "prefilter/shapes/stroke.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

Point2 point_of(const std::array<double, 2>& pair) { return {pair[0], pair[1]}; }

// The points of an array of shape (points, 2).
std::span<const Point2> points_of(const Array<double>& points) {
  static_assert(sizeof(Point2) == 2 * sizeof(double));
  return {reinterpret_cast<const Point2*>(points.data()),
          static_cast<std::size_t>(points.shape(0))};
}

// Rows of a map: the images of the x and y axes, and the origin.
AffineMap2 map_of(const std::array<double, 6>& matrix) {
  return {{matrix[0], matrix[3]}, {matrix[1], matrix[4]}, {matrix[2], matrix[5]}};
}

Outline bound_pixels(const Outline& outline, const std::string& rule) {
  return pixel_outline(outline, value_named("fill_rule", rule, kFillRules));
}

// The part of an outline with coordinates within a limit.
Outline bound_within(const Outline& outline, double limit) {
  const Outline columns = clip_between(outline, {{1.0, 0.0}, 0.0}, -limit, limit);
  return clip_between(columns, {{0.0, 1.0}, 0.0}, -limit, limit);
}

// A contour of segments with `degree` points each, after the first point.
void add_contour(Outline* outline, const Array<double>& points, int degree) {
  const std::span<const Point2> all = points_of(points);
  outline->reserve(all.size() + 1, all.size() / degree + 1);
  outline->move_to(all.front());
  for (std::size_t i = 1; i < all.size(); i += degree) outline->curve_to(all.subspan(i, degree));
  outline->close();
}

void add_path(Outline* outline, const std::string& letters, const Array<double>& numbers) {
  std::size_t needed = 0;
  for (const char letter : letters) {
    const int count = number_count(letter);
    if (count < 0) {
      throw_invalid("letters: '" + std::string(1, letter) + "' is not one of M, L, Q, C, W, Z");
    }
    needed += static_cast<std::size_t>(count);
  }
  const std::size_t size = static_cast<std::size_t>(numbers.size());
  if (needed != size) {
    throw_invalid("numbers: " + std::to_string(size) + "; the letters need " +
                  std::to_string(needed));
  }
  if (!letters.empty() && letters.front() != 'M') {
    throw_invalid("letters: begin with '" + letters.substr(0, 1) + "'; M is needed");
  }
  const double* at = numbers.data();
  outline->reserve(size, letters.size());
  for (const char letter : letters) {
    if (letter == 'M') {
      outline->move_to({at[0], at[1]});
    } else if (letter == 'L') {
      outline->line_to({at[0], at[1]});
    } else if (letter == 'W') {
      if (!(at[2] >= 1e-6 && at[2] <= 1e6)) {
        throw_invalid("numbers: a weight of " + std::to_string(at[2]) +
                      "; it has to be from 1e-6 to 1e6");
      }
      outline->conic_to({at[0], at[1]}, at[2], {at[3], at[4]});
    } else if (letter == 'Z') {
      outline->close();
    } else {
      std::array<Point2, 3> points;
      const std::size_t count = letter == 'Q' ? 2 : 3;
      for (std::size_t k = 0; k < count; ++k) points[k] = {at[2 * k], at[2 * k + 1]};
      outline->curve_to(std::span(points).first(count));
    }
    at += number_count(letter);
  }
}

ChannelValues channel_values(const std::vector<double>& values) {
  ChannelValues out{};
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

Paint linear_paint(const std::vector<double>& constant, const std::vector<double>& along_x,
                   const std::vector<double>& along_y) {
  Paint paint;
  paint.channels = static_cast<int>(constant.size());
  paint.constant = channel_values(constant);
  paint.along_x = channel_values(along_x);
  paint.along_y = channel_values(along_y);
  const ChannelValues none{};
  const bool is_constant = paint.along_x == none && paint.along_y == none;
  paint.kind = is_constant ? Paint::Kind::kConstant : Paint::Kind::kLinear;
  return paint;
}

Paint stops_paint(bool is_radial, const std::array<double, 2>& start, double start_radius,
                  const std::array<double, 2>& end, double end_radius,
                  const std::vector<std::pair<double, std::vector<double>>>& stops,
                  const std::string& spread, const std::array<double, 6>& matrix) {
  Paint paint;
  paint.kind = is_radial ? Paint::Kind::kRadialStops : Paint::Kind::kLinearStops;
  paint.channels = static_cast<int>(stops.front().second.size());
  for (const auto& [offset, value] : stops) paint.stops.push_back({offset, channel_values(value)});
  paint.spread = value_named("spread", spread, kSpreads);
  paint.start = point_of(start);
  paint.end = point_of(end);
  paint.start_radius = start_radius;
  paint.end_radius = end_radius;
  paint.to_shape = map_of(matrix);
  return paint;
}

void bind_raster_options(py::module_& m) {
  using Options = RasterOptions;
  auto bound = bind_options<Options>(m, "RasterOptions");
  bind_named(bound, "method", &Options::method, kRasterMethods);
  bind_named(bound, "overlap", &Options::overlap, kOverlaps);
  bound.def_readwrite("width", &Options::width)
      .def_readwrite("height", &Options::height)
      .def_readwrite("filter", &Options::filter)
      .def_readwrite("background", &Options::background)
      .def_readwrite("depth", &Options::depth);
}

void bind_stroke_options(py::module_& m) {
  using Options = StrokeOptions;
  auto bound = bind_options<Options>(m, "StrokeOptions");
  bind_named(bound, "join", &Options::join, kStrokeJoins);
  bind_named(bound, "cap", &Options::cap, kStrokeCaps);
  bound.def_readwrite("width", &Options::width)
      .def_readwrite("miter_limit", &Options::miter_limit)
      .def_readwrite("dashes", &Options::dashes)
      .def_readwrite("dash_offset", &Options::dash_offset);
}

// An outline, its fill rule's name, its paint, and whether it winds once.
using DrawnShape = std::tuple<const Outline*, std::string, const Paint*, bool>;

py::array bound_rasterize(const std::vector<DrawnShape>& drawn, RasterOptions options,
                          bool is_bytes, const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  std::vector<Shape> shapes;
  shapes.reserve(drawn.size());
  for (const auto& [outline, fill_rule, paint, winds_once] : drawn) {
    shapes.push_back(
        {*outline, value_named("fill_rule", fill_rule, kFillRules), *paint, winds_once});
  }
  if (is_bytes) {
    ByteImage image;
    {
      const py::gil_scoped_release unlocked;
      image = rasterize_bytes(shapes, options);
    }
    const int height = image.height;
    return to_array<std::uint8_t>(std::move(image.data), {height, image.width, image.channels});
  }
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = rasterize(shapes, options);
  }
  return to_array(std::move(image));
}

Outline bound_combine_outlines(const Outline& first, const std::string& first_rule,
                               const Outline& second, const std::string& second_rule,
                               const std::string& operation) {
  const FillRule rule = value_named("fill_rule", first_rule, kFillRules);
  const FillRule other = value_named("fill_rule", second_rule, kFillRules);
  const OutlineOperation what = value_named("operation", operation, kOutlineOperations);
  const py::gil_scoped_release unlocked;
  return combine(first, rule, second, other, what);
}

// The outline of a stroke, and whether its contours wind once.
std::pair<Outline, bool> bound_stroke(const Outline& outline, const StrokeOptions& options,
                                      double tolerance) {
  const py::gil_scoped_release unlocked;
  bool winds_once = false;
  Outline covered = stroke_within_budget(outline, options, tolerance, &winds_once);
  return {std::move(covered), winds_once};
}

py::bytes packed(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

// Letters, the numbers as bytes, and whether the text is valid; None for too many segments.
py::tuple bound_read_path(const std::string& text, std::size_t most) {
  PathSteps steps;
  const PathOutcome outcome = read_path_data(text, most, &steps);
  if (outcome == PathOutcome::kTooMany) return py::make_tuple(py::none(), py::none(), false);
  return py::make_tuple(py::bytes(steps.letters), packed(steps.numbers),
                        outcome == PathOutcome::kWhole);
}

py::tuple bound_read_numbers(const std::string& text) {
  std::vector<double> numbers;
  const bool is_whole = read_numbers(text, &numbers);
  return py::make_tuple(std::move(numbers), is_whole);
}

py::object bound_drawn_box(const std::string& letters, const Array<double>& numbers) {
  const Box2 box = drawn_box(letters, values_of(numbers));
  if (box.empty()) return py::none();
  return py::make_tuple(box.low.x, box.low.y, box.high.x, box.high.y);
}

py::object bound_bounds(const Outline& outline) {
  const Box2 box = control_box(outline);
  if (outline.empty()) return py::none();
  return py::make_tuple(py::make_tuple(box.low.x, box.low.y),
                        py::make_tuple(box.high.x, box.high.y));
}

}  // namespace

void bind_raster(py::module_& m) {
  bind_raster_options(m);
  bind_stroke_options(m);
  py::class_<Outline>(m, "Outline")
      .def(py::init<>())
      .def(
          "move_to",
          [](Outline& outline, double x, double y) {
            outline.move_to({x, y});
          },
          py::arg("x"), py::arg("y"))
      .def(
          "curve_to",
          [](Outline& outline, const Array<double>& points) {
            outline.curve_to(points_of(points));
          },
          py::arg("points"))
      .def(
          "line_to",
          [](Outline& outline, double x, double y) {
            outline.line_to({x, y});
          },
          py::arg("x"), py::arg("y"))
      .def(
          "conic_to",
          [](Outline& outline, double x1, double y1, double weight, double x2, double y2) {
            outline.conic_to({x1, y1}, weight, {x2, y2});
          },
          py::arg("x1"), py::arg("y1"), py::arg("weight"), py::arg("x2"), py::arg("y2"))
      .def("close", &Outline::close)
      .def("add_contour", &add_contour, py::arg("points"), py::arg("degree"))
      .def("add_path", &add_path, py::arg("letters"), py::arg("numbers"))
      .def(
          "transformed",
          [](const Outline& outline, const std::array<double, 6>& matrix) {
            return outline.transformed(map_of(matrix));
          },
          py::arg("matrix"))
      .def("pixels", &bound_pixels, py::arg("fill_rule"))
      .def("within", &bound_within, py::arg("limit"))
      .def("copy", [](const Outline& outline) { return Outline(outline); })
      .def("stroked", &bound_stroke, py::arg("options"), py::arg("tolerance"))
      .def("combined", &bound_combine_outlines, py::arg("fill_rule"), py::arg("other"),
           py::arg("other_rule"), py::arg("operation"))
      .def("bounds", &bound_bounds)
      .def_property_readonly("contour_count", &Outline::contour_count);
  py::class_<Paint>(m, "Paint")
      .def(py::init(&linear_paint), py::arg("constant"), py::arg("along_x"), py::arg("along_y"))
      .def(py::init(&stops_paint), py::arg("is_radial"), py::arg("start"), py::arg("start_radius"),
           py::arg("end"), py::arg("end_radius"), py::arg("stops"), py::arg("spread"),
           py::arg("matrix"))
      .def(
          "transformed",
          [](const Paint& paint, const std::array<double, 6>& matrix) {
            return paint.transformed(map_of(matrix));
          },
          py::arg("matrix"));
  m.def("rasterize", &bound_rasterize, py::arg("shapes"), py::arg("options"), py::arg("is_bytes"),
        py::arg("progress"));
  m.def("read_path", &bound_read_path, py::arg("text"), py::arg("most"));
  m.def("read_numbers", &bound_read_numbers, py::arg("text"));
  m.def("drawn_box", &bound_drawn_box, py::arg("letters"), py::arg("numbers"));
  m.attr("FILL_RULES") = names_of(kFillRules);
}

}  // namespace prefilter::python
