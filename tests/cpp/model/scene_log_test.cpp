// SPDX-License-Identifier: Apache-2.0
#include "model/scene_log.h"

#include <gtest/gtest.h>

namespace iota::model {
namespace {

TEST(SceneLog, lists_each_changed_slot_once_and_forgets_them_when_cleared) {
  ChangedSlots log;
  log.note(3);
  EXPECT_TRUE(log.slots().empty()) << "it is off";
  log.is_on = true;
  for (const std::uint32_t slot : {5u, 2u, 5u}) log.note(slot);
  EXPECT_EQ(log.slots(), (std::vector<std::uint32_t>{5, 2}));
  log.clear();
  EXPECT_TRUE(log.slots().empty());
  log.note(5);
  EXPECT_EQ(log.slots(), std::vector<std::uint32_t>{5});
}

TEST(SceneLog, a_slot_that_was_created_since_stays_new_whatever_changes_it) {
  ChangedSlots log;
  log.is_on = true;
  log.note(1, true), log.note(1), log.note(2), log.note(2, true), log.note(4);
  EXPECT_TRUE(log.is_new(1));
  EXPECT_TRUE(log.is_new(2));
  EXPECT_FALSE(log.is_new(4));
  EXPECT_FALSE(log.is_new(1000));
  log.clear();
  log.note(1);
  EXPECT_FALSE(log.is_new(1));
}

}  // namespace
}  // namespace iota::model
