// SPDX-License-Identifier: Apache-2.0
// Recording what viewers are sent, without sockets.
#include "net/recorder.h"

#include <gtest/gtest.h>

#include <variant>

namespace iota::net {
namespace {

template <class Message>
std::vector<Message> all(const std::vector<RecordedMessage>& messages) {
  std::vector<Message> found;
  for (const RecordedMessage& message : messages) {
    const auto decoded = protocol::decode_server_message(message.bytes);
    EXPECT_TRUE(decoded) << decoded.error;
    if (const auto* one = std::get_if<Message>(&*decoded.value)) found.push_back(*one);
  }
  return found;
}

PoseSnapshot snapshot_at(std::uint64_t step, float x) {
  PoseSnapshot snapshot;
  snapshot.step = step;
  snapshot.bodies.push_back({0, {x, 0, 0}, {0, 0, 0, 1}});
  snapshot.bodies.push_back({1, {0, 1, 0}, {0, 0, 0, 1}});
  return snapshot;
}

class RecorderTest : public testing::Test {
 protected:
  void publish(const PoseSnapshot& snapshot) {
    (void)hub.publish(snapshot, {});
    hub.deliver();
  }
  Counters counters;
  Hub hub{"world", 2, counters, [] {}};
  std::shared_ptr<Recorder> recorder = std::make_shared<Recorder>(hub, std::chrono::duration<double>(0));
};

TEST_F(RecorderTest, begins_with_the_present_state_and_is_no_client) {
  (void)hub.set(protocol::WorldSettings{.title = "the title"});
  publish(snapshot_at(1, 0));
  hub.watch(recorder);
  const auto begin = recorder->take();
  ASSERT_FALSE(begin.empty());
  EXPECT_TRUE(std::holds_alternative<protocol::Welcome>(*protocol::decode_server_message(begin[0].bytes).value));
  EXPECT_EQ(all<protocol::Welcome>(begin).at(0).client, 0u);
  EXPECT_EQ(all<protocol::WorldSettings>(begin).at(0).title, "the title");
  EXPECT_TRUE(all<protocol::Clients>(begin).at(0).clients.empty());
  const auto poses = all<protocol::Poses>(begin);
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_TRUE(poses[0].keyframe);
  EXPECT_EQ(poses[0].bodies.size() + poses[0].far_bodies.size(), 2u);
  EXPECT_EQ(counters.clients, 0u);
  EXPECT_TRUE(hub.take_input().empty()) << "nobody joined";
}

TEST_F(RecorderTest, gets_messages_for_all_clients_and_none_for_one_client_until_its_end) {
  hub.watch(recorder);
  publish(snapshot_at(1, 0));
  (void)recorder->take();
  (void)hub.notice(0, 0, "for all", "", "", false);
  (void)hub.notice(7, 0, "for one", "", "", false);
  (void)hub.effect("break", {1, 2, 3});
  hub.deliver();
  publish(snapshot_at(2, 0.5));
  auto taken = recorder->take();
  ASSERT_EQ(all<protocol::Notice>(taken).size(), 1u);
  EXPECT_EQ(all<protocol::Notice>(taken)[0].title, "for all");
  EXPECT_EQ(all<protocol::Effect>(taken).size(), 1u);
  EXPECT_EQ(all<protocol::Poses>(taken).at(0).step, 2u);
  for (std::size_t i = 1; i < taken.size(); ++i) EXPECT_GE(taken[i].time, taken[i - 1].time);
  hub.unwatch(*recorder);
  publish(snapshot_at(3, 1));
  EXPECT_TRUE(recorder->take().empty());
}

TEST_F(RecorderTest, keeps_the_rate_of_its_poses_but_all_messages) {
  recorder = std::make_shared<Recorder>(hub, std::chrono::duration<double>(1000));
  hub.watch(recorder);
  for (std::uint64_t step = 1; step <= 10; ++step) {
    (void)hub.effect("join", {});
    publish(snapshot_at(step, 0.1F * static_cast<float>(step)));
  }
  const auto taken = recorder->take();
  EXPECT_EQ(all<protocol::Poses>(taken).size(), 1u);
  EXPECT_EQ(all<protocol::Effect>(taken).size(), 10u);
}

TEST_F(RecorderTest, leaves_out_poses_while_too_much_waits_and_goes_on_with_the_newest) {
  hub.watch(recorder);
  PoseSnapshot crowd;
  for (std::uint32_t body = 0; body < 50'000; ++body) crowd.bodies.push_back({body, {0, 0, 0}, {0, 0, 0, 1}});
  for (std::uint64_t step = 1; step <= 200; ++step) {
    crowd.step = step;
    for (BodyPose& body : crowd.bodies) body.position[0] = static_cast<float>(step * 1e-2 * (1 + body.body % 7));
    publish(crowd);
  }
  std::size_t bytes = 0;
  const auto taken = recorder->take();
  for (const auto& message : taken) bytes += message.bytes.size();
  EXPECT_LT(bytes, Recorder::max_waiting_bytes + (2 << 20));
  EXPECT_LT(all<protocol::Poses>(taken).size(), 100u);
  crowd.step = 1000;
  publish(crowd);
  EXPECT_EQ(all<protocol::Poses>(recorder->take()).at(0).step, 1000u);
}

}  // namespace
}  // namespace iota::net
