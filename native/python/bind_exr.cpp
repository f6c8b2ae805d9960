// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstdint>
#include <utility>

#include "convert.h"
#include "prefilter/images/exr_tiles.h"
#include "prefilter/images/transfer.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// Chunks of tile rows, and their sizes. The level holds floats or bytes.
std::pair<Array<std::uint8_t>, std::vector<std::int64_t>> bound_exr_tiles(
    const py::array& level, bool srgb, int number, int first_row, int row_count, bool half,
    bool has_alpha, bool multiplies, int threads) {
  const ExrTileOptions options{half, has_alpha, multiplies, threads};
  ExrChunks chunks;
  const auto write = [&](const TexelSource& source) {
    const py::gil_scoped_release unlocked;
    chunks = exr_tiles(source, number, first_row, row_count, options);
  };
  if (level.dtype().kind() == 'u') {
    const auto bytes = py::cast<Array<std::uint8_t>>(level);
    const ByteValues values = byte_values(srgb);
    write(TexelSource(bytes.data(), static_cast<int>(bytes.shape(1)),
                      static_cast<int>(bytes.shape(0)), static_cast<int>(bytes.shape(2)), &values));
  } else {
    const auto floats = py::cast<Array<float>>(level);
    write(view_of(floats));
  }
  const auto size = static_cast<py::ssize_t>(chunks.bytes.size());
  return {to_array<std::uint8_t>(std::move(chunks.bytes), {size}), std::move(chunks.sizes)};
}

}  // namespace

void bind_exr(py::module_& m) {
  m.attr("EXR_TILE_SIDE") = kExrTileSide;
  m.def("exr_tiles", &bound_exr_tiles, py::arg("level"), py::arg("srgb"), py::arg("number"),
        py::arg("first_row"), py::arg("row_count"), py::arg("half"), py::arg("has_alpha"),
        py::arg("multiplies"), py::arg("threads"));
}

}  // namespace prefilter::python
