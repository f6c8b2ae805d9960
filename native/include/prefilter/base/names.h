// SPDX-License-Identifier: GPL-3.0-or-later

// Public names of values: tables that map enumerators to names and back.
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

/// The element of `all` with the name `name`, as returned by `name_of`. Throws Error if there is
/// none, with the argument and all valid names.
template <std::ranges::input_range All, typename NameOf>
const std::ranges::range_value_t<All>& element_named(std::string_view argument,
                                                     std::string_view name, const All& all,
                                                     const NameOf& name_of) {
  std::string names;
  for (const auto& element : all) {
    const std::string own(std::invoke(name_of, element));
    if (own == name) return element;
    names += (names.empty() ? "" : ", ") + own;
  }
  throw_invalid(std::string(argument) + ": '" + std::string(name) + "' is not one of " + names);
}

/// The value with a name in a table. Throws Error if there is none, as above.
template <typename Value, std::size_t kCount>
Value value_named(std::string_view argument, std::string_view name,
                  const Named<Value> (&table)[kCount]) {
  return element_named(argument, name, table, &Named<Value>::name).value;
}

/// The name of a value; empty if it is not in the table.
template <typename Value, std::size_t kCount>
constexpr std::string_view name_in(const Named<Value> (&table)[kCount], const Value& value) {
  for (const Named<Value>& element : table) {
    if (element.value == value) return element.name;
  }
  return {};
}

}  // namespace prefilter
