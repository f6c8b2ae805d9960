// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/textures/compress_blocks.h"
#include "prefilter/textures/compress_etc1s.h"
#include "prefilter/textures/decode_blocks.h"
#include "prefilter/textures/supercompress.h"

namespace py = pybind11;

namespace prefilter::python {

namespace {
template <class Channel>
py::bytes compressed(const py::array& rgba, const BlockOptions& options, const Run& run) {
  const auto texels = py::cast<Array<Channel>>(rgba);
  std::vector<std::uint8_t> blocks;
  {
    const py::gil_scoped_release unlocked;
    blocks = compress_blocks(texels.data(), static_cast<int>(texels.shape(1)),
                             static_cast<int>(texels.shape(0)), options, run);
  }
  return {reinterpret_cast<const char*>(blocks.data()), blocks.size()};
}

std::span<const std::uint8_t> span_of(const py::bytes& bytes) {
  const auto view = static_cast<std::string_view>(bytes);
  return {reinterpret_cast<const std::uint8_t*>(view.data()), view.size()};
}

template <class Channel, class Decode>
py::array decoded(const Decode& decode, const py::bytes& blocks, int width, int height,
                  const DecodeOptions& options, const Run& run) {
  std::vector<Channel> texels;
  {
    const auto view = span_of(blocks);
    const py::gil_scoped_release unlocked;
    texels = decode(view, width, height, options, run);
  }
  return to_array<Channel>(std::move(texels), {height, width, 4});
}

// endpoint_count, selector_count, endpoints, selectors, tables
using Codebooks = std::tuple<int, int, py::bytes, py::bytes, py::bytes>;
// width, height, color, alpha
using Level = std::tuple<int, int, py::bytes, py::bytes>;

py::list decoded_etc1s(const Codebooks& codebook_arrays, const std::vector<Level>& levels,
                       const py::object& callback) {
  const auto& [endpoint_count, selector_count, endpoints, selectors, tables] = codebook_arrays;
  const Etc1sCodebooks codebooks{endpoint_count, selector_count, span_of(endpoints),
                                 span_of(selectors), span_of(tables)};
  std::vector<Etc1sLevel> parts;
  for (const auto& [width, height, color, alpha] : levels) {
    parts.push_back({width, height, span_of(color), span_of(alpha)});
  }
  const Run run = to_run(callback);
  std::vector<std::vector<std::uint8_t>> images;
  {
    const py::gil_scoped_release unlocked;
    images = decode_etc1s(codebooks, parts, run);
  }
  py::list arrays;
  for (std::size_t i = 0; i < images.size(); ++i) {
    arrays.append(
        to_array<std::uint8_t>(std::move(images[i]), {parts[i].height, parts[i].width, 4}));
  }
  return arrays;
}

py::bytes bytes_from(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The codebooks, and the color and alpha of each level, as decode_etc1s expects them.
py::tuple compressed_etc1s(const std::vector<Array<std::uint8_t>>& levels, int quality,
                           bool has_alpha, bool is_color, const std::string& effort,
                           const py::object& callback, int threads) {
  std::vector<Etc1sImage> images;
  for (const auto& level : levels) {
    images.push_back(
        {level.data(), static_cast<int>(level.shape(1)), static_cast<int>(level.shape(0))});
  }
  const Run run = to_run(callback, threads);
  Etc1sTexture texture;
  {
    const py::gil_scoped_release unlocked;
    texture =
        compress_etc1s(images, {quality, has_alpha, is_color, block_effort_named(effort)}, run);
  }
  py::list parts;
  for (const Etc1sTexture::Level& level : texture.levels) {
    parts.append(py::make_tuple(bytes_from(level.color), bytes_from(level.alpha)));
  }
  return py::make_tuple(
      py::make_tuple(texture.endpoint_count, texture.selector_count, bytes_from(texture.endpoints),
                     bytes_from(texture.selectors), bytes_from(texture.tables)),
      parts);
}
}  // namespace

void bind_blocks(py::module_& m) {
  m.def("block_layouts", [] {
    py::dict layouts;
    for (const BlockLayout& layout : block_layouts()) {
      layouts[layout.name] =
          py::make_tuple(layout.columns, layout.rows, layout.bytes, layout.is_float);
    }
    return layouts;
  });
  m.def(
      "compress_blocks",
      [](const py::array& rgba, const std::string& format, bool srgb, bool weigh_by_alpha,
         const std::string& effort, const py::object& callback, int threads) {
        const BlockLayout& layout = layout_named(format);
        const BlockOptions options{layout.format, weigh_by_alpha, srgb, block_effort_named(effort)};
        const Run run = to_run(callback, threads);
        return layout.is_float ? compressed<HalfBits>(rgba, options, run)
                               : compressed<std::uint8_t>(rgba, options, run);
      },
      py::arg("rgba"), py::arg("format"), py::arg("srgb"), py::arg("weigh_by_alpha"),
      py::arg("effort"), py::arg("progress"), py::arg("threads"));
  m.def(
      "supercompress",
      [](const py::bytes& data, const py::object& callback) {
        const auto view = static_cast<std::string_view>(data);
        const Run run = to_run(callback);
        std::vector<std::uint8_t> frame;
        {
          const py::gil_scoped_release unlocked;
          frame =
              supercompress(reinterpret_cast<const std::uint8_t*>(view.data()), view.size(), run);
        }
        return py::bytes(reinterpret_cast<const char*>(frame.data()), frame.size());
      },
      py::arg("data"), py::arg("progress"));
  m.def(
      "decompress",
      [](const py::bytes& frames, std::size_t count) {
        const auto view = span_of(frames);
        std::vector<std::uint8_t> bytes;
        {
          const py::gil_scoped_release unlocked;
          bytes = decompress(view, count);
        }
        return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      },
      py::arg("frames"), py::arg("count"));
  m.def(
      "decode_blocks",
      [](const py::bytes& blocks, const std::string& format, bool srgb, int width, int height,
         const py::object& callback, int threads) {
        const BlockLayout& layout = layout_named(format);
        const DecodeOptions options{layout.format, srgb};
        const Run run = to_run(callback, threads);
        return layout.is_float
                   ? decoded<HalfBits>(decode_half_blocks, blocks, width, height, options, run)
                   : decoded<std::uint8_t>(decode_blocks, blocks, width, height, options, run);
      },
      py::arg("blocks"), py::arg("format"), py::arg("srgb"), py::arg("width"), py::arg("height"),
      py::arg("progress"), py::arg("threads"));
  m.def("compress_etc1s", &compressed_etc1s, py::arg("levels"), py::arg("quality"),
        py::arg("has_alpha"), py::arg("is_color"), py::arg("effort"), py::arg("progress"),
        py::arg("threads"));
  m.def("decode_etc1s", &decoded_etc1s, py::arg("codebooks"), py::arg("levels"),
        py::arg("progress"));
}

}  // namespace prefilter::python
