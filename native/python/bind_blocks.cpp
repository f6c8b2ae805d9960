#include <cstdint>
#include <string>
#include <vector>

#include "convert.h"
#include "prefilter/base/error.h"
#include "prefilter/color/compress_blocks.h"

namespace py = pybind11;

namespace prefilter::python {

namespace {
BlockFormat block_format(const std::string& name) {
  if (name == "bc1") return BlockFormat::kBc1;
  if (name == "bc3") return BlockFormat::kBc3;
  if (name == "bc4") return BlockFormat::kBc4;
  if (name == "bc5") return BlockFormat::kBc5;
  throw_invalid("format: '" + name + "' is not one of bc1, bc3, bc4, bc5");
}
}  // namespace

void bind_blocks(py::module_& m) {
  m.def(
      "compress_blocks",
      [](const Array<std::uint8_t>& rgba, const std::string& format, bool weigh_by_alpha,
         const py::object& callback, int threads) {
        const BlockOptions options{block_format(format), weigh_by_alpha, threads};
        const Progress progress = to_progress(callback);
        std::vector<std::uint8_t> blocks;
        {
          const py::gil_scoped_release unlocked;
          blocks = compress_blocks(rgba.data(), static_cast<int>(rgba.shape(1)),
                                   static_cast<int>(rgba.shape(0)), options, progress);
        }
        return py::bytes(reinterpret_cast<const char*>(blocks.data()), blocks.size());
      },
      py::arg("rgba"), py::arg("format"), py::arg("weigh_by_alpha"), py::arg("progress"),
      py::arg("threads"));
}

}  // namespace prefilter::python
