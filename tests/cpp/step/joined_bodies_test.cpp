// SPDX-License-Identifier: Apache-2.0
// Bodies that welds hold together count as one for what joints hold at them.
#include "step/joined_bodies.h"

#include "tests/cpp/ingredient/everything.h"

#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota {
namespace {

struct BoxRow {
  System system{{.gravity = {}}};
  std::vector<BodyId> boxes;
  step::JoinedBodies joined;

  explicit BoxRow(int count) {
    for (int i = 0; i < count; ++i)
      boxes.push_back(system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0.3 * i, 0, 0}}));
  }
  ConstraintId join(ConstraintKind kind, int a, int b) {
    JointSpec spec{.kind = kind, .a = boxes[a], .at = {0.3 * a + 0.15, 0, 0}};
    if (b >= 0) spec.b = boxes[b];
    return system.joints().create(spec);
  }
  ConstraintId weld(int a, int b) { return join(ConstraintKind::weld, a, b); }
  ConstraintId hinge(int a, int b) { return join(ConstraintKind::ball, a, b); }
  bool are_joined(int a, int b) {
    const auto model = model::model_of(system);
    joined.forget();
    const bool is = joined.are_joined_by_welds(model, boxes[a].slot, boxes[b].slot);
    EXPECT_EQ(joined.are_joined_by_welds(model, boxes[b].slot, boxes[a].slot), is);
    return is || step::JoinedBodies::are_joined(model, boxes[a].slot, boxes[b].slot);
  }
};

TEST(JoinedBodies, are_one_along_a_chain_of_welds) {
  BoxRow row(6);
  for (int i = 0; i < 3; ++i) row.weld(i, i + 1);
  row.hinge(3, 4), row.hinge(4, 5);
  EXPECT_TRUE(row.are_joined(0, 3)) << "both ends of the chain";
  EXPECT_TRUE(row.are_joined(0, 4)) << "what hangs on its other end";
  EXPECT_FALSE(row.are_joined(0, 5)) << "what hangs on that";
  EXPECT_FALSE(row.are_joined(3, 5));
}

TEST(JoinedBodies, are_one_on_both_sides_of_a_hinge) {
  BoxRow row(4);
  row.weld(0, 1), row.hinge(1, 2), row.weld(2, 3);
  EXPECT_TRUE(row.are_joined(0, 3));
}

TEST(JoinedBodies, are_apart_while_a_weld_is_off_or_yields) {
  BoxRow row(3);
  const ConstraintId weld = row.weld(0, 1);
  row.hinge(1, 2);
  EXPECT_TRUE(row.are_joined(0, 2));
  row.system.joints().set_active(weld, false);
  EXPECT_FALSE(row.are_joined(0, 2));
  row.system.joints().set_active(weld, true);
  row.system.joints().set_compliance(weld, {.linear = 1e-6});
  EXPECT_FALSE(row.are_joined(0, 2));
}

TEST(JoinedBodies, are_fixed_at_each_other_by_the_world_but_not_joined_to_what_it_holds) {
  BoxRow row(3);
  row.weld(0, -1), row.weld(1, -1), row.hinge(2, -1);
  EXPECT_TRUE(row.are_joined(0, 1));
  EXPECT_FALSE(row.are_joined(0, 2));
}

TEST(JoinedBodies, are_not_one_through_a_static_body) {
  BoxRow row(3);
  row.system.bodies().set_kind(row.boxes[1], BodyKind::static_);
  row.weld(0, 1), row.hinge(1, 2);
  EXPECT_FALSE(row.are_joined(0, 2));
  EXPECT_TRUE(row.are_joined(0, 1));
}

}  // namespace
}  // namespace iota
