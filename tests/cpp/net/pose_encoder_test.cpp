// SPDX-License-Identifier: Apache-2.0
#include "net/pose_encoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace iota::net {
namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

BodyPose make_pose(std::uint32_t body, float x, float y, float z) { return {body, {x, y, z}, {0, 0, 0, 1}}; }

PoseSnapshot hanging_chain(std::uint32_t links) {
  PoseSnapshot snapshot;
  for (std::uint32_t i = 0; i < links; ++i) {
    snapshot.bodies.push_back(make_pose(i, 0, -0.1F * static_cast<float>(i), 0));
  }
  return snapshot;
}

protocol::Poses decode(const std::vector<std::uint8_t>& bytes) {
  const auto decoded = protocol::decode_server_message(bytes);
  EXPECT_TRUE(decoded) << decoded.error;
  return decoded ? std::get<protocol::Poses>(*decoded.value) : protocol::Poses{};
}

/// A client and what it is sent.
struct Receiver {
  PoseQuantizer quantizer;
  PoseDelta delta;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint32_t> generations;

  protocol::Poses next(const PoseSnapshot& snapshot, bool wants_keyframe = false) {
    quantizer.update(snapshot);
    delta.encode(quantizer, generations, wants_keyframe, bytes);
    return decode(bytes);
  }
};

double angle_between(const float (&a)[4], const std::array<float, 4>& b) {
  double dot = 0;
  double difference = 0;
  for (std::size_t i = 0; i < 4; ++i) dot += static_cast<double>(a[i]) * b[i];
  const double sign = dot < 0 ? -1 : 1;
  for (std::size_t i = 0; i < 4; ++i) difference += std::pow(a[i] - sign * b[i], 2);
  return 4 * std::asin(std::min(1.0, std::sqrt(difference) / 2));
}

TEST(PoseEncoder, rotations_come_back_within_five_milliradians) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    float q[4] = {normal(random), normal(random), normal(random), normal(random)};
    if (i % 5 == 0) q[i % 4] *= 100;  // near an axis
    const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (float& component : q) component /= length;
    const auto packed = pack_rotation(q);
    ASSERT_TRUE(packed);
    worst = std::max(worst, angle_between(q, unpack_rotation(*packed)));
  }
  EXPECT_LT(worst, 5e-3);
  RecordProperty("worst_angle_urad", static_cast<int>(worst * 1e6));
}

TEST(PoseEncoder, a_quaternion_and_its_negative_are_packed_alike) {
  const float q[4] = {0.5F, -0.5F, 0.1F, 0.7F};
  const float minus[4] = {-0.5F, 0.5F, -0.1F, -0.7F};
  EXPECT_EQ(pack_rotation(q), pack_rotation(minus));
}

TEST(PoseEncoder, a_quaternion_that_is_no_rotation_is_refused) {
  EXPECT_FALSE(pack_rotation({0, 0, 0, 0}));
  EXPECT_FALSE(pack_rotation({nan_value, 0, 0, 1}));
  EXPECT_FALSE(pack_rotation({0, infinity, 0, 1}));
}

TEST(PoseEncoder, positions_come_back_within_half_a_step_of_the_box) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-3, 5);
  PoseSnapshot snapshot;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    snapshot.bodies.push_back(make_pose(i, uniform(random), uniform(random), uniform(random)));
  }
  Receiver receiver;
  const auto poses = receiver.next(snapshot);
  ASSERT_EQ(poses.bodies.size(), 2000U);
  for (std::size_t i = 0; i < 2000; ++i) {
    const auto found = unpack_position(poses, poses.bodies[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const float bound = (poses.box_max[k] - poses.box_min[k]) / 65535 / 2 + 2e-6F;
      EXPECT_NEAR(found[k], snapshot.bodies[i].position[k], bound);
    }
  }
}

TEST(PoseEncoder, a_body_takes_twelve_bytes) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(500);
  receiver.next(snapshot);
  const std::size_t before = receiver.bytes.size();
  snapshot.bodies.resize(400);
  receiver.next(snapshot, true);
  EXPECT_EQ(receiver.bytes.size(), before - 1200);
}

TEST(PoseEncoder, only_moved_bodies_are_listed_after_the_first_frame) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(24);
  auto poses = receiver.next(snapshot);
  EXPECT_TRUE(poses.keyframe);
  EXPECT_EQ(poses.bodies.size(), 24U);
  poses = receiver.next(snapshot);
  EXPECT_FALSE(poses.keyframe);
  EXPECT_TRUE(poses.bodies.empty());
  snapshot.bodies[5].position[0] += 0.01F;
  snapshot.bodies[7].orientation[0] = 0.1F;
  poses = receiver.next(snapshot);
  ASSERT_EQ(poses.bodies.size(), 2U);
  EXPECT_EQ(poses.bodies[0].body, 5);
  EXPECT_EQ(poses.bodies[1].body, 7);
  poses = receiver.next(snapshot, true);
  EXPECT_TRUE(poses.keyframe);
  EXPECT_EQ(poses.bodies.size(), 24U);
}

TEST(PoseEncoder, another_body_in_a_slot_is_listed_though_it_is_where_the_one_before_was) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(24);
  snapshot.bodies.push_back(make_pose(70000, 0, 0, 0));
  receiver.generations.assign(70001, 1);
  receiver.next(snapshot);
  receiver.generations[7] = receiver.generations[70000] = 2;
  const auto poses = receiver.next(snapshot);
  EXPECT_FALSE(poses.keyframe) << "an edit costs what it touches";
  ASSERT_EQ(poses.bodies.size(), 1U);
  EXPECT_EQ(poses.bodies[0].body, 7);
  ASSERT_EQ(poses.far_bodies.size(), 1U);
  EXPECT_EQ(poses.far_bodies[0].body, 70000U);
}

TEST(PoseEncoder, a_change_of_the_box_gives_a_keyframe) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(24);
  receiver.next(snapshot);
  EXPECT_FALSE(receiver.next(snapshot).keyframe);
  snapshot.bodies[23].position[1] -= 10;
  const auto poses = receiver.next(snapshot);
  EXPECT_TRUE(poses.keyframe);
  EXPECT_EQ(poses.bodies.size(), 24U);
}

TEST(PoseEncoder, a_client_that_skipped_frames_gets_all_that_moved_meanwhile) {
  PoseQuantizer quantizer;
  PoseDelta slow;
  std::vector<std::uint8_t> bytes;
  PoseSnapshot snapshot = hanging_chain(24);
  quantizer.update(snapshot);
  slow.encode(quantizer, {}, false, bytes);
  for (std::size_t i = 0; i < 10; ++i) {
    snapshot.bodies[i].position[0] += 0.01F;
    quantizer.update(snapshot);
  }
  slow.encode(quantizer, {}, false, bytes);
  EXPECT_EQ(decode(bytes).bodies.size(), 10U);
}

TEST(PoseEncoder, a_piece_that_falls_on_and_on_leaves_the_others_exact) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(24);
  std::size_t keyframes = 0;
  for (int step = 0; step < 120 * 60; ++step) {
    const float time = static_cast<float>(step) / 120;
    for (std::size_t i = 2; i < 24; ++i) {  // all but two fall
      snapshot.bodies[i].position[1] = -0.1F * static_cast<float>(i) - 4.905F * time * time;
    }
    snapshot.step = static_cast<std::uint64_t>(step);
    const auto poses = receiver.next(snapshot);
    if (poses.keyframe) ++keyframes;
    for (std::size_t k = 0; k < 3; ++k) ASSERT_LE(poses.box_max[k] - poses.box_min[k], 130);
  }
  EXPECT_LT(keyframes, 20U);
  const auto poses = receiver.next(snapshot, true);
  ASSERT_EQ(poses.bodies.size(), 2U);
  ASSERT_EQ(poses.far_bodies.size(), 22U);
  EXPECT_EQ(poses.far_bodies[0].position[1], snapshot.bodies[2].position[1]);
  EXPECT_NEAR(unpack_position(poses, poses.bodies[1])[1], -0.1F, 1e-4);  // the box is small again
}

TEST(PoseEncoder, a_body_that_comes_back_from_afar_is_listed_again) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(24);
  receiver.next(snapshot);
  const float home = snapshot.bodies[3].position[1];
  snapshot.bodies[3].position[1] = -1e6F;
  auto poses = receiver.next(snapshot);
  EXPECT_TRUE(poses.bodies.empty());
  EXPECT_EQ(poses.far_bodies.size(), 1U);
  EXPECT_TRUE(receiver.next(snapshot).far_bodies.empty());
  snapshot.bodies[3].position[1] = home;
  poses = receiver.next(snapshot);
  EXPECT_EQ(poses.bodies.size(), 1U);
  snapshot.bodies[3].position[1] = -1e6F;
  EXPECT_EQ(receiver.next(snapshot).far_bodies.size(), 1U);
}

TEST(PoseEncoder, positions_are_as_exact_in_a_molecule_as_in_a_valley) {
  for (const float size : {1e-9F, 1e-3F, 1.0F, 1e3F}) {
    Receiver receiver;
    PoseSnapshot snapshot = hanging_chain(24);
    for (BodyPose& body : snapshot.bodies)
      for (float& x : body.position) x *= size;
    const auto poses = receiver.next(snapshot);
    ASSERT_EQ(poses.bodies.size(), 24U);
    for (std::size_t i = 0; i < 24; ++i)
      EXPECT_NEAR(unpack_position(poses, poses.bodies[i])[1], snapshot.bodies[i].position[1], 1e-4F * size);
  }
}

/// Drawn errors of the first bodies, m.
double worst_error(const protocol::Poses& poses, const PoseSnapshot& snapshot, std::size_t count) {
  double worst = 0;
  const auto compare = [&](std::uint32_t body, const auto& found) {
    for (std::size_t k = 0; body < count && k < 3; ++k)
      worst = std::max<double>(worst, std::abs(found[k] - snapshot.bodies[body].position[k]));
  };
  for (const auto& body : poses.bodies) compare(body.body, unpack_position(poses, body));
  for (const auto& body : poses.far_bodies) compare(body.body, body.position);
  return worst;
}

TEST(PoseEncoder, bodies_beside_one_far_away_are_exact_to_a_small_part_of_their_size) {
  for (const float away : {10.0F, 100.0F, 1e3F, 1e5F}) {
    for (const std::uint32_t count : {3U, 30U, 60U}) {
      Receiver receiver;
      PoseSnapshot snapshot = hanging_chain(count);
      for (std::uint32_t i = 0; i < count; ++i) receiver.quantizer.set_size(i, 0.1F);
      for (std::uint32_t i = count; i < count + 8; ++i) {
        snapshot.bodies.push_back(make_pose(i, away, 0, static_cast<float>(i)));
        receiver.quantizer.set_size(i, 20);
      }
      EXPECT_LE(worst_error(receiver.next(snapshot), snapshot, count), 0.1 / 400) << away << " m, " << count;
    }
  }
}

TEST(PoseEncoder, bodies_far_from_the_ground_are_as_exact_as_floats) {
  for (const float away : {1e3F, 1e5F, 1e6F}) {
    Receiver receiver;
    PoseSnapshot snapshot;
    snapshot.bodies = {make_pose(0, away, 0.5F, away), make_pose(1, away + 2, 0.5F, away), make_pose(2, 0, 0, 0)};
    for (std::uint32_t i = 0; i < 2; ++i) receiver.quantizer.set_size(i, 1);
    EXPECT_EQ(worst_error(receiver.next(snapshot), snapshot, 2), 0) << away << " m";
  }
}

TEST(PoseEncoder, a_piece_that_rolls_away_leaves_small_bodies_in_their_box) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(300);
  for (BodyPose& body : snapshot.bodies) {
    for (float& x : body.position) x *= 0.1F;
    receiver.quantizer.set_size(body.body, 0.01F);
  }
  EXPECT_EQ(receiver.next(snapshot).bodies.size(), 300U);
  snapshot.bodies[299].position[0] = 50;
  const auto poses = receiver.next(snapshot, true);
  EXPECT_EQ(poses.bodies.size(), 299U);
  EXPECT_EQ(poses.far_bodies.size(), 1U);
}

TEST(PoseEncoder, many_small_bodies_stay_in_the_box_of_their_world) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(2000);
  for (std::uint32_t i = 0; i < 2000; ++i) receiver.quantizer.set_size(i, i == 0 ? nan_value : 0.2F);
  EXPECT_EQ(receiver.next(snapshot).bodies.size(), 2000U);
}

TEST(PoseEncoder, a_single_body_is_exact_at_any_size) {
  Receiver receiver;
  PoseSnapshot snapshot;
  snapshot.bodies.push_back(make_pose(0, 1e-9F, -2e-9F, 3e-9F));
  const auto poses = receiver.next(snapshot);
  ASSERT_EQ(poses.far_bodies.size(), 1U);
  EXPECT_EQ(poses.far_bodies[0].position[1], -2e-9F);
}

TEST(PoseEncoder, a_long_chain_is_one_box) {
  Receiver receiver;
  const auto poses = receiver.next(hanging_chain(4000));  // 400 m
  EXPECT_EQ(poses.bodies.size(), 4000U);
  EXPECT_TRUE(poses.far_bodies.empty());
}

TEST(PoseEncoder, slots_above_sixteen_bits_travel_too) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(2);
  snapshot.bodies.push_back(make_pose(70000, 0.1F, 0.2F, 0.3F));
  const auto poses = receiver.next(snapshot);
  ASSERT_EQ(poses.far_bodies.size(), 1U);
  EXPECT_EQ(poses.far_bodies[0].body, 70000U);
}

TEST(PoseEncoder, poses_that_are_not_finite_are_left_out_and_the_others_sent) {
  Receiver receiver;
  PoseSnapshot snapshot = hanging_chain(6);
  snapshot.bodies[0].position[1] = nan_value;
  snapshot.bodies[1].position[0] = infinity;
  snapshot.bodies[2].orientation[3] = nan_value;
  snapshot.bodies[3].position[2] = 1e30F;
  snapshot.kinetic = nan_value;
  snapshot.time = infinity;
  snapshot.holds.push_back({1, 2, 3, {0, nan_value, 0}, {0, 0, 0}, 1});
  snapshot.holds.push_back({1, 3, 3, {0, 0, 0}, {0, 0, 0}, nan_value});
  const auto poses = receiver.next(snapshot);
  EXPECT_EQ(poses.bodies.size(), 2U);
  EXPECT_EQ(poses.kinetic, 0);
  ASSERT_EQ(poses.holds.size(), 1U);
  EXPECT_EQ(poses.holds[0].hold, 3U);
  for (auto& body : snapshot.bodies) body.position[0] = nan_value;
  EXPECT_TRUE(receiver.next(snapshot, true).bodies.empty());
  EXPECT_TRUE(receiver.next(PoseSnapshot{}, true).bodies.empty());
}

TEST(PoseEncoder, a_world_that_is_replaced_elsewhere_gets_a_new_box) {
  Receiver receiver;
  receiver.next(hanging_chain(24));
  PoseSnapshot snapshot;
  for (std::uint32_t i = 0; i < 10; ++i) snapshot.bodies.push_back(make_pose(i, 1e5F, 0.1F * static_cast<float>(i), 0));
  const auto poses = receiver.next(snapshot);
  EXPECT_EQ(poses.bodies.size(), 10U);
}

}  // namespace
}  // namespace iota::net
