// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/names.h"

#include <gtest/gtest.h>

#include <string>

#include "prefilter/base/wrap.h"

namespace prefilter {
namespace {

enum class Season { kSpring, kAutumn, kWinter };

constexpr Named<Season> kSeasons[] = {{"spring", Season::kSpring}, {"autumn", Season::kAutumn}};

std::string refusal(const char* name) {
  try {
    value_named("season", name, kSeasons);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return {};
}

TEST(Names, RoundTrip) {
  for (const Named<Season>& one : kSeasons) {
    EXPECT_EQ(value_named("season", one.name, kSeasons), one.value);
    EXPECT_EQ(name_in(kSeasons, one.value), one.name);
  }
  EXPECT_EQ(name_in(kSeasons, Season::kWinter), "");
}

TEST(Names, UnknownNamesListTheValidOnes) {
  EXPECT_EQ(refusal("winter"), "season: 'winter' is not one of spring, autumn");
  EXPECT_EQ(refusal(""), "season: '' is not one of spring, autumn");
  EXPECT_EQ(refusal("Spring"), "season: 'Spring' is not one of spring, autumn");
}

TEST(Names, WorkForAnyElements) {
  struct Box {
    std::string name;
    int size;
  };
  const Box boxes[] = {{"small", 1}, {"large", 2}};
  EXPECT_EQ(&element_named("box", "large", boxes, &Box::name), &boxes[1]);
  EXPECT_THROW(element_named("box", "huge", boxes, &Box::name), Error);
}

TEST(Names, OfWrapModesAreThoseOfTheirTable) {
  EXPECT_EQ(value_named("wrap", "repeat", kWraps), Wrap::kRepeat);
}

}  // namespace
}  // namespace prefilter
