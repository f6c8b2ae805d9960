#include "convert.h"
#include "prefilter/surface/surface.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_surface(py::module_& m) {
  py::class_<Surface>(m, "Surface")
      .def(py::init([](const Array<double>& positions, const Array<std::int64_t>& triangles,
                       const Array<double>& uvs) {
             MeshArrays mesh;
             mesh.positions = positions.data();
             mesh.vertex_count = static_cast<std::size_t>(positions.shape(0));
             mesh.triangles = triangles.data();
             mesh.uvs = uvs.data();
             mesh.triangle_count = static_cast<std::size_t>(triangles.shape(0));
             const py::gil_scoped_release unlocked;
             return make_surface(mesh);
           }),
           py::arg("positions"), py::arg("triangles"), py::arg("uvs"))
      .def_property_readonly("triangle_count", &Surface::triangle_count)
      .def_property_readonly("area", &Surface::total_area);
}

}  // namespace prefilter::python
