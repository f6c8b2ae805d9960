// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <cstdint>
#include <vector>

#include "convert.h"
#include "prefilter/images/transfer.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_color(py::module_& m) {
  const auto bind = [&m](const char* name, Image (*convert)(const ImageView&, int)) {
    m.def(
        name,
        [convert](const Array<float>& array, int threads) {
          const ImageView image = view_of(array);
          Image result;
          {
            const py::gil_scoped_release unlocked;
            result = convert(image, threads);
          }
          return to_array(std::move(result));
        },
        py::arg("image"), py::arg("threads"));
  };
  bind("decode_srgb", decode_srgb);
  bind("encode_srgb", encode_srgb);
  m.def(
      "decode_bytes",
      [](const Array<std::uint8_t>& array, int threads) {
        const ByteValues values = byte_values(true);
        const TexelSource bytes = bytes_of(array, &values);
        Image result;
        {
          const py::gil_scoped_release unlocked;
          result = to_floats(bytes, threads);
        }
        return to_array(std::move(result));
      },
      py::arg("image"), py::arg("threads"));
  m.def(
      "to_bytes",
      [](const Array<float>& array, bool srgb, int threads) {
        const ImageView image = view_of(array);
        Array<std::uint8_t> bytes({image.height, image.width, image.channels});
        std::vector<std::uint8_t> values;
        {
          const py::gil_scoped_release unlocked;
          values = to_bytes(image, srgb, threads);
        }
        std::copy(values.begin(), values.end(), bytes.mutable_data());
        return bytes;
      },
      py::arg("image"), py::arg("srgb"), py::arg("threads"));
}

}  // namespace prefilter::python
