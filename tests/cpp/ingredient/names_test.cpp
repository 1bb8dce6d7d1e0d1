// SPDX-License-Identifier: Apache-2.0
#include "ingredient/names.h"

#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace iota::ingredient {
namespace {

TEST(Names, go_with_their_bodies_and_are_not_inherited_by_a_slot) {
  model::SmallModel small;
  const std::uint32_t body = small.body({{}});
  small.model.names.make(body)[0] = 'a';
  EXPECT_TRUE(validate(small.model).empty());
  model::destroy_body(small.model, body);
  EXPECT_FALSE(small.model.names.has(body));
  EXPECT_EQ(small.body({{}}), body) << "the slot is used again";
  EXPECT_FALSE(small.model.names.has(body));
}

TEST(Names, without_an_end_or_an_owner_are_found) {
  model::SmallModel small;
  const std::uint32_t body = small.body({{}});
  std::ranges::fill(small.model.names.make(body), 'x');
  EXPECT_FALSE(validate(small.model).empty());
  small.model.names.erase(body);
  (void)small.model.names.make(body + 5);
  EXPECT_FALSE(validate(small.model).empty());
}

}  // namespace
}  // namespace iota::ingredient
