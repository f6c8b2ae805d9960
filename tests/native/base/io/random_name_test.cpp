// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/random_name.h"

#include <gtest/gtest.h>

#include <string>

namespace prefilter {
namespace {

TEST(RandomName, BeginsWithTheMachine) {
  const std::string start = ".prefilter-";
  const std::string first = random_name();
  const std::string second = random_name();
  EXPECT_NE(first, second);
  ASSERT_EQ(first.size(), start.size() + kMachineDigits + 8);
  EXPECT_EQ(first.substr(0, start.size()), start);
  EXPECT_EQ(first.find_first_not_of("0123456789abcdef", start.size()), std::string::npos);
  EXPECT_EQ(first.substr(0, start.size() + kMachineDigits),
            second.substr(0, start.size() + kMachineDigits));
}

}  // namespace
}  // namespace prefilter
