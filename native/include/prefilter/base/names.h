// SPDX-License-Identifier: GPL-3.0-or-later

// The names that users give values by: those of an enumeration in a table beside it, both ways.
#pragma once

#include <functional>
#include <ranges>
#include <string>
#include <string_view>

#include "prefilter/base/error.h"

namespace prefilter {

template <typename Value>
struct Named {
  std::string_view name;
  Value value;
};

/// The element of `all` of which `name_of` says `name`. Throws Error where there is none, with the
/// argument and the names that there are.
template <std::ranges::input_range All, typename NameOf>
const std::ranges::range_value_t<All>& element_named(std::string_view argument,
                                                     std::string_view name, const All& all,
                                                     const NameOf& name_of) {
  std::string names;
  for (const auto& one : all) {
    const std::string own(std::invoke(name_of, one));
    if (own == name) return one;
    names += (names.empty() ? "" : ", ") + own;
  }
  throw_invalid(std::string(argument) + ": '" + std::string(name) + "' is not one of " + names);
}

/// The value of a name in a table. Throws Error where there is none, as above.
template <typename Value, std::size_t kCount>
Value value_named(std::string_view argument, std::string_view name,
                  const Named<Value> (&table)[kCount]) {
  return element_named(argument, name, table, &Named<Value>::name).value;
}

/// The name of a value; empty where the table does not have it.
template <typename Value, std::size_t kCount>
constexpr std::string_view name_in(const Named<Value> (&table)[kCount], const Value& value) {
  for (const Named<Value>& one : table) {
    if (one.value == value) return one.name;
  }
  return {};
}

}  // namespace prefilter
