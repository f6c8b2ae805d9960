// SPDX-License-Identifier: GPL-3.0-or-later

// Names as the common scan formats and CloudCompare write them.
#include "prefilter/points/scan/field_names.h"

#include <utility>

namespace prefilter {
namespace {

// In lower case and without separators; CloudCompare prefixes names with "scalar_".
constexpr std::pair<std::string_view, std::string_view> kNames[] = {
    {"x", "x"},
    {"y", "y"},
    {"z", "z"},
    {"nx", "nx"},
    {"ny", "ny"},
    {"nz", "nz"},
    {"normalx", "nx"},
    {"normaly", "ny"},
    {"normalz", "nz"},
    {"red", "red"},
    {"green", "green"},
    {"blue", "blue"},
    {"alpha", "alpha"},
    {"diffusered", "red"},
    {"diffusegreen", "green"},
    {"diffuseblue", "blue"},
    {"intensity", "intensity"},
    {"confidence", "confidence"},
    {"classification", "classification"},
    {"returnnumber", "return_number"},
    {"numberofreturns", "number_of_returns"},
};
constexpr std::string_view kScalar = "scalar";

}  // namespace

std::string_view known_field_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') {
      plain += static_cast<char>(c - 'A' + 'a');
    } else if (c != '_' && c != ' ') {
      plain += c;
    }
  }
  std::string_view word = plain;
  if (word.starts_with(kScalar)) word.remove_prefix(kScalar.size());
  for (const auto& [written, meaning] : kNames) {
    if (word == written) return meaning;
  }
  return {};
}

std::string field_name(std::string_view name) {
  const std::string_view known = known_field_name(name);
  return std::string(known.empty() ? name : known);
}

}  // namespace prefilter
