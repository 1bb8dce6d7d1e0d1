// SPDX-License-Identifier: Apache-2.0
#include "model/corrections.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace iota::model {
namespace {

TEST(Corrections, of_scenes_without_any_take_no_room) {
  Corrections corrections;
  corrections.set(7, {});
  EXPECT_TRUE(corrections.are_none());
  EXPECT_FALSE(corrections.lacks_room());
  EXPECT_EQ(corrections[7], Vec3{});
}

TEST(Corrections, say_when_they_need_room) {
  Corrections corrections;
  corrections.set(1, {1, 2, 3});
  EXPECT_TRUE(corrections.lacks_room());
  EXPECT_EQ(corrections[1], Vec3{}) << "it waits";
  corrections.make_room(2);
  EXPECT_FALSE(corrections.lacks_room());
  EXPECT_EQ(corrections[1], (Vec3{1, 2, 3}));
  EXPECT_EQ(corrections[0], Vec3{});
  EXPECT_EQ(corrections[2], Vec3{}) << "a ring that is newer than the room";
  corrections.set(2, {1, 0, 0});
  EXPECT_TRUE(corrections.lacks_room());
}

TEST(Corrections, of_more_rings_than_there_are_is_refused) {
  Corrections corrections;
  corrections.make_room(2);
  corrections.set(1, {1, 2, 3});
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  corrections.archive(writer, 2);
  Reader reader(bytes);
  Corrections read;
  read.archive(reader, 2);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(read[1], (Vec3{1, 2, 3}));
  Reader again(bytes);
  read.archive(again, 1);
  EXPECT_FALSE(again.ok());
  EXPECT_TRUE(read.are_none());
}

}  // namespace
}  // namespace iota::model
