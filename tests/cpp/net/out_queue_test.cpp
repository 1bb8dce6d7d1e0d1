// SPDX-License-Identifier: Apache-2.0
#include "net/out_queue.h"

#include <gtest/gtest.h>

namespace iota::net {
namespace {

Frame frame(std::size_t size, std::uint8_t value = 0) {
  return std::make_shared<const std::vector<std::uint8_t>>(size, value);
}

TEST(OutQueue, gives_frames_back_in_the_order_in_which_they_came) {
  OutQueue queue(100);
  for (const std::uint8_t value : {1, 2, 3}) EXPECT_TRUE(queue.push(frame(4, value)));
  for (const std::uint8_t value : {1, 2, 3}) EXPECT_EQ(queue.pop()->front(), value);
  EXPECT_TRUE(queue.empty());
}

TEST(OutQueue, puts_a_newer_frame_of_a_key_into_the_place_of_the_older) {
  OutQueue queue(100);
  EXPECT_TRUE(queue.push(frame(4, 1), "camera"));
  EXPECT_TRUE(queue.push(frame(4, 2)));
  EXPECT_TRUE(queue.push(frame(4, 3), "camera"));
  EXPECT_EQ(queue.pop()->front(), 3);
  EXPECT_EQ(queue.pop()->front(), 2);
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.push(frame(4, 4), "camera")) << "one that was sent is not waiting any more";
  EXPECT_EQ(queue.pop()->front(), 4);
}

TEST(OutQueue, counts_only_frames_without_a_key_against_its_cap) {
  OutQueue queue(100);
  EXPECT_TRUE(queue.push(frame(100)));
  EXPECT_FALSE(queue.push(frame(1))) << "one byte too many";
  EXPECT_TRUE(queue.push(frame(5000), "scene")) << "there is one of each key at most";
  EXPECT_EQ(queue.pop()->size(), 100u);
  EXPECT_TRUE(queue.push(frame(100))) << "there is room again";
  queue.clear();
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.push(frame(100)));
}

}  // namespace
}  // namespace iota::net
