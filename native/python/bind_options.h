// SPDX-License-Identifier: GPL-3.0-or-later

// Binds the library's option structures to classes whose members the Python package sets by name.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>

#include "convert.h"
#include "prefilter/base/names.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter::python {

/// Binds a class of options, constructed with the library's defaults, with the common members
/// `wrap`, `bounds`, `premultiplied` and, if `kIsParallel`, `threads`, if it has them.
template <typename Options, bool kIsParallel = true>
pybind11::class_<Options> bind_options(pybind11::module_& m, const char* name) {
  pybind11::class_<Options> bound(m, name);
  bound.def(pybind11::init<>());
  if constexpr (requires { &Options::wrap; }) {
    bound.def_property(
        "wrap",
        [](const Options& o) {
          return WrapNames(name_in(kWraps, o.wrap.u), name_in(kWraps, o.wrap.v));
        },
        [](Options& o, const WrapNames& names) { o.wrap = wrap_modes(names); });
  }
  if constexpr (requires { &Options::bounds; }) {
    using Pair = std::pair<std::optional<float>, std::optional<float>>;
    bound.def_property(
        "bounds", [](const Options& o) { return Pair(o.bounds.low, o.bounds.high); },
        [](Options& o, const Pair& pair) {
          o.bounds = {pair.first, pair.second};
        });
  }
  if constexpr (requires { &Options::premultiplied; }) {
    bound.def_readwrite("premultiplied", &Options::premultiplied);
  }
  if constexpr (kIsParallel && requires { &Options::run; }) {
    bound.def_property(
        "threads", [](const Options& o) { return o.run.threads(); },
        [](Options& o, int threads) { o.run = o.run.with_threads(threads); });
  }
  return bound;
}

/// Binds an option whose values are the names in a table.
template <typename Options, typename Value, std::size_t kCount>
void bind_named(pybind11::class_<Options>& bound, const char* name, Value Options::*member,
                const Named<Value> (&table)[kCount]) {
  bound.def_property(
      name, [member, &table](const Options& o) { return std::string(name_in(table, o.*member)); },
      [name, member, &table](Options& o, const std::string& name_of_value) {
        o.*member = value_named(name, name_of_value, table);
      });
}

/// Binds the option "filter", the name of a kernel.
template <typename Options>
void bind_kernel(pybind11::class_<Options>& bound) {
  bound.def_property(
      "filter", [](const Options& o) { return std::string(o.kernel->name()); },
      [](Options& o, const std::string& name) { o.kernel = &kernel_named(name); });
}

}  // namespace prefilter::python
