// SPDX-License-Identifier: Apache-2.0
// How joints are made: their places, their markers, and what they refuse.
#include "ingredient/constraint.h"

#include "ingredient/joints.h"
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <iota/constraints.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace iota::ingredient {
namespace {

using model::none;
using model::SmallModel;

const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Two bodies of four corners, 5 m apart.
struct Pair {
  SmallModel m;
  std::uint32_t a = m.body(corners), b = m.body({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});

  JointSpec spec(ConstraintKind kind) const {
    return {.kind = kind, .a = m.model.bodies.id(a), .b = m.model.bodies.id(b), .at = {2, 0.2, 0.3}, .axis = {0, 0, 2}};
  }
};

TEST(Constraint, kinds_have_a_name_each) {
  std::set<std::string> names;
  for (const ConstraintKindInfo& kind : constraint_kinds) names.insert(kind.name);
  EXPECT_EQ(names.size(), constraint_kinds.size());
  EXPECT_STREQ(info(ConstraintKind::apart).name, "apart") << "the last one";
}

TEST(Constraint, of_every_kind_between_bodies_leaves_a_whole_model_and_takes_its_markers_along) {
  for (const ConstraintKind kind :
       {ConstraintKind::ball, ConstraintKind::universal, ConstraintKind::revolute, ConstraintKind::cylindrical,
        ConstraintKind::prismatic, ConstraintKind::orientation, ConstraintKind::weld}) {
    Pair pair;
    JointSpec spec = pair.spec(kind);
    spec.second_axis = {1, 0, 0};
    const std::uint32_t particles = pair.m.model.particles.size();
    const std::uint32_t joint = make_constraint(pair.m.model, spec);
    EXPECT_EQ(validate(pair.m.model), std::vector<std::string>{}) << info(kind).name;
    EXPECT_GT(pair.m.model.particles.size(), particles) << info(kind).name;
    EXPECT_EQ(body_of_side(pair.m.model, pair.m.model.constraints[joint], 0), pair.a);
    EXPECT_EQ(body_of_side(pair.m.model, pair.m.model.constraints[joint], 1), pair.b);
    Joints::destroy(pair.m.model, joint);
    EXPECT_EQ(pair.m.model.particles.size(), particles) << info(kind).name;
    EXPECT_EQ(validate(pair.m.model), std::vector<std::string>{}) << info(kind).name;
  }
}

TEST(Constraint, has_its_axis_in_the_world_as_a_unit_vector) {
  Pair pair;
  const std::uint32_t joint = make_constraint(pair.m.model, pair.spec(ConstraintKind::revolute));
  EXPECT_LT(norm(calc_axis(pair.m.model, pair.m.model.constraints[joint]) - Vec3{0, 0, 1}), 1e-12);
  EXPECT_LT(norm(position_of(pair.m.model, pair.m.model.constraints[joint], a_origin) - Vec3{2, 0.2, 0.3}), 1e-12);
}

TEST(Constraint, is_in_force_while_both_bodies_are_there_and_one_can_move) {
  Pair pair;
  const std::uint32_t joint = make_constraint(pair.m.model, pair.spec(ConstraintKind::ball));
  const auto acts = [&] { return is_in_force(pair.m.model, pair.m.model.constraints[joint]); };
  EXPECT_TRUE(acts());
  pair.m.model.bodies[pair.a].kind = BodyKind::static_;
  EXPECT_TRUE(acts());
  pair.m.model.bodies[pair.b].kind = BodyKind::static_;
  EXPECT_FALSE(acts()) << "nobody can move";
  pair.m.model.bodies[pair.b].kind = BodyKind::inactive;
  pair.m.model.bodies[pair.a].kind = BodyKind::dynamic;
  EXPECT_FALSE(acts()) << "one is switched off";
}

TEST(Constraint, that_a_body_cannot_hold_is_refused_before_anything_changes) {
  SmallModel m;
  const std::uint32_t point = m.body({{0, 0, 0}}), other = m.body(corners);
  const std::uint32_t particles = m.model.particles.size();
  JointSpec spec{.kind = ConstraintKind::revolute,
                 .a = m.model.bodies.id(point),
                 .b = m.model.bodies.id(other),
                 .at = {0, 0, 0},
                 .axis = {0, 0, 1}};
  EXPECT_THROW((void)make_constraint(m.model, spec), std::invalid_argument) << "a point has no axis";
  EXPECT_EQ(m.model.particles.size(), particles);
  EXPECT_EQ(m.model.constraints.size(), 0u);
}

}  // namespace
}  // namespace iota::ingredient
