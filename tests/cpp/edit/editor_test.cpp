// SPDX-License-Identifier: Apache-2.0
// Snapshots whose checksum is right and whose tables are not.
#include "base/seal.h"
#include "tests/cpp/edit/hostile.h"
#include "tests/cpp/ingredient/everything.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace iota {
namespace {

Snapshot seal_again(std::span<const std::byte> like, std::span<const std::byte> content) {
  Seal mark{{}, "snapshot"};
  std::memcpy(mark.mark.data(), like.data(), sizeof mark.mark);
  return {seal(mark, content)};
}

/// Uses a system in all ways that follow what its tables say.
void use(System& system) {
  ASSERT_EQ(system.validate(), std::vector<std::string>{});
  for (int i = 0; i < 2; ++i) {
    (void)system.step(1.0 / 60);
    (void)system.viewer().poses();
    (void)system.viewer().take_scene_changes();
    (void)system.energy();
    for (const ParticleId p : system.particles().ids()) (void)system.particles().hinge_force(p);
    for (const BodyId b : system.bodies().ids()) (void)system.bodies().outside_force(b, {});
    for (const ConstraintId c : system.joints().ids()) (void)system.joints().state(c);
  }
  const auto bodies = system.bodies().ids();
  for (std::size_t i = 0; i + 1 < bodies.size(); i += 2) {
    if (system.bodies().contains(bodies[i])) system.bodies().destroy(bodies[i]);
    (void)system.step(1.0 / 60);
  }
  (void)system.snapshot();
}

/// A value that a table should not hold at a random place: any bits, a slot far out, a list that runs in a ring, a kind that is
/// none, a number beyond all numbers.
void damage_content(std::vector<std::byte>& content, std::mt19937_64& random) {
  const auto put = [&](const auto& value) {
    const std::size_t at = random() % (content.size() - sizeof value) / 4 * 4;
    std::memcpy(content.data() + at, &value, sizeof value);
  };
  switch (random() % 6) {
    case 0: content[random() % content.size()] ^= static_cast<std::byte>(1 + random() % 255); break;
    case 1: put(static_cast<std::uint32_t>(random() % 64)); break;
    case 2: put(std::uint32_t{0xffffffff}); break;
    case 3: put(static_cast<std::uint32_t>(random())); break;
    case 4: put(static_cast<std::uint64_t>(random())); break;
    default: {
      constexpr double inf = std::numeric_limits<double>::infinity();
      const double values[] = {std::numeric_limits<double>::quiet_NaN(), inf, -inf, -1, 0, 1e300};
      put(values[random() % std::size(values)]);
    }
  }
}

TEST(Restore, refuses_hostile_tables_under_a_right_checksum_or_makes_a_valid_world) {
  System original;
  model::Everything().fill(original);
  const Snapshot whole = original.snapshot();
  const std::span<const std::byte> bytes(whole.bytes);
  const std::vector<std::byte> content(bytes.begin() + 16, bytes.end() - 8);
  {
    System again;
    again.restore(seal_again(bytes, content));
    use(again);
  }
  std::mt19937_64 random(hostile_seed());
  const int count = hostile_count(3000);
  int refused = 0, taken = 0;
  for (int i = 0; i < count; ++i) {
    std::vector<std::byte> hostile = content;
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n) damage_content(hostile, random);
    System system;
    system.particles().create(system.bodies().create(), {1, 2, 3});
    const std::uint64_t before = system.state_hash();
    try {
      system.restore(seal_again(bytes, hostile));
    } catch (const std::invalid_argument& error) {
      ASSERT_NE(std::string(error.what()).find("restore: "), std::string::npos) << error.what();
      ASSERT_EQ(system.state_hash(), before) << "nothing has changed";
      ++refused;
      continue;
    }
    ++taken;
    SCOPED_TRACE(i);
    use(system);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(refused, count / 5);
  EXPECT_GT(taken, count / 10) << "most bytes are numbers that may be anything";
}

}  // namespace
}  // namespace iota
