// SPDX-License-Identifier: GPL-3.0-or-later

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "convert.h"
#include "prefilter/blocks/compress_blocks.h"
#include "prefilter/blocks/supercompress.h"

namespace py = pybind11;

namespace prefilter::python {

namespace {
template <class Channel>
py::bytes compressed(const py::array& rgba, const BlockOptions& options, const Progress& progress) {
  const auto texels = py::cast<Array<Channel>>(rgba);
  std::vector<std::uint8_t> blocks;
  {
    const py::gil_scoped_release unlocked;
    blocks = compress_blocks(texels.data(), static_cast<int>(texels.shape(1)),
                             static_cast<int>(texels.shape(0)), options, progress);
  }
  return {reinterpret_cast<const char*>(blocks.data()), blocks.size()};
}
}  // namespace

void bind_blocks(py::module_& m) {
  m.def("block_layouts", [] {
    py::dict layouts;
    for (const BlockLayout& one : block_layouts()) {
      layouts[one.name] = py::make_tuple(one.columns, one.rows, one.bytes, one.is_float);
    }
    return layouts;
  });
  m.def(
      "compress_blocks",
      [](const py::array& rgba, const std::string& format, bool srgb, bool weigh_by_alpha,
         const py::object& callback, int threads) {
        const BlockLayout& layout = layout_named(format);
        const BlockOptions options{layout.format, weigh_by_alpha, srgb, threads};
        const Progress progress = to_progress(callback);
        return layout.is_float ? compressed<HalfBits>(rgba, options, progress)
                               : compressed<std::uint8_t>(rgba, options, progress);
      },
      py::arg("rgba"), py::arg("format"), py::arg("srgb"), py::arg("weigh_by_alpha"),
      py::arg("progress"), py::arg("threads"));
  m.def(
      "supercompress",
      [](const py::bytes& data, const py::object& callback) {
        const auto view = static_cast<std::string_view>(data);
        const Progress progress = to_progress(callback);
        std::vector<std::uint8_t> frame;
        {
          const py::gil_scoped_release unlocked;
          frame = supercompress(reinterpret_cast<const std::uint8_t*>(view.data()), view.size(),
                                progress);
        }
        return py::bytes(reinterpret_cast<const char*>(frame.data()), frame.size());
      },
      py::arg("data"), py::arg("progress"));
}

}  // namespace prefilter::python
