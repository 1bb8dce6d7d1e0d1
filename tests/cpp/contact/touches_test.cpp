// SPDX-License-Identifier: Apache-2.0
// The gaps of touches, against the least distance of many points of the surface from a plane.
#include "contact/touches.h"

#include "placed.h"
#include "tests/cpp/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <tuple>

namespace iota::contact {
namespace {

Outline outline_of(const Shape& shape, const Vec3& position, const Quaternion& turn) {
  Outline outline;
  outline.solids.push_back({make_form(shape), 7, position, turn});
  return outline;
}

TEST(Touches, have_the_gap_of_the_lowest_point_of_the_shape) {
  std::mt19937 random(3);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const Outline ground = outline_of(HalfSpace{{0, 1, 0}}, {}, {});
  const Shape shapes[] = {
      Sphere{0.3},    Box{{0.6, 0.4, 0.2}, 0.05}, Capsule{0.1, 0.5},     Cylinder{0.2, 0.5, 0.02},
      Cone{0.2, 0.5}, Torus{0.3, 0.05},           Torus{0.2, 0.03, 0.4}, Ellipsoid{{0.3, 0.5, 0.2}}};
  TouchFinder finder;
  for (int round = 0; round < 400; ++round) {
    const Shape& shape = shapes[round % std::size(shapes)];
    const Quaternion q = normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)});
    const Vec3 position{number(-1, 1), number(0, 1), number(-1, 1)};
    const Vec3 down = rotate(conjugate(q), {0, -1, 0});
    const double lowest = (position + rotate(q, shape::support(shape, down))).y;
    std::vector<Touch> found;
    finder.find(outline_of(shape, position, q), {1e-6, 2e-6, 3e-6}, ground, {}, 10, found);
    ASSERT_FALSE(found.empty());
    double least = std::numeric_limits<double>::infinity();
    for (const Touch& touch : found) {
      EXPECT_NEAR(dot(touch.normal, touch.center - touch.origin) - touch.radius, touch.gap, 1e-12);
      EXPECT_NEAR(dot(touch.normal, touch.place - touch.origin), touch.gap, 1e-12);
      EXPECT_EQ(touch.part, 7u);
      least = std::min(least, touch.gap);
    }
    EXPECT_NEAR(least, lowest, 1e-9) << "shape " << shape.index();
  }
}

TEST(Touches, of_a_corner_on_a_face_know_its_normal) {
  const Outline table = outline_of(Box{{2, 1, 2}}, {0, -0.5, 0}, {});
  TouchFinder finder;
  for (const double height : {0.0, 1e-12, 1e-3, -1e-3}) {
    std::vector<Touch> found;
    finder.find(outline_of(Box{{0.2, 0.2, 0.2}}, {0.3, 0.1 + height, 0.2}, {}), {}, table, {}, 0.01, found);
    ASSERT_EQ(found.size(), 4u) << height;
    for (const Touch& touch : found) {
      EXPECT_LT(norm(touch.normal - Vec3{0, 1, 0}), 1e-9);
      EXPECT_NEAR(touch.gap, height, 1e-12);
    }
  }
}

TEST(Touches, of_a_corner_behind_an_open_mesh_are_on_the_side_of_the_middle_of_the_body) {
  Outline floor;
  floor.solids.push_back(
      {make_open_form({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, -2}, {2, 0, 2}}, {{0, 1, 2}, {1, 3, 2}}}), 1, {}, {}});
  TouchFinder finder;
  for (const double height : {0.0, 1e-3, -1e-3})
    for (const double side : {1.0, -1.0}) {
      std::vector<Touch> found;
      finder.find(outline_of(Box{{0.2, 0.2, 0.2}}, {0.3, side * (0.1 + height), 0.2}, {}), {}, floor, {}, 0.01, found);
      ASSERT_EQ(found.size(), 4u) << height;
      for (const Touch& touch : found) {
        EXPECT_LT(norm(touch.normal - Vec3{0, side, 0}), 1e-9);
        EXPECT_NEAR(touch.gap, height, 1e-12);
      }
    }
}

TEST(Touches, of_lines_are_at_their_ends_each_once) {
  const Outline ground = outline_of(HalfSpace{{0, 1, 0}}, {}, {});
  Outline rods;
  rods.lines = {{1, 2, 0.1, {0, 0.1, 0}, {1, 0.2, 0}}, {2, 3, 0.1, {1, 0.2, 0}, {2, 0.1, 0}}};
  std::vector<Touch> found;
  TouchFinder().find(rods, {}, ground, {}, 1, found);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[1].gap, 0.1, 1e-12);
}

/// Moves a body along a line until it is about so far from the other, m.
void bring_near(Solid& moved, const Solid& other, const Vec3& way, double wanted, double size) {
  moved.position = other.position;
  const double apart = dot(way, farthest_of(moved, -way) - farthest_of(other, way));
  moved.position += (wanted - apart) * way;
  double distance = upper_distance(moved, other);
  for (int k = 0; k < 20 && distance > 1e-6 * size; ++k) {
    moved.position -= 0.9 * distance * way;
    distance = upper_distance(moved, other);
  }
}

TEST(Touches, of_random_pairs_have_gaps_that_are_not_larger_than_their_distance) {
  RandomShapes random(9);
  TouchFinder finder;
  for (int round = 0; round < 81 * 25; ++round) {
    const int kind = round % RandomShapes::kinds, other_kind = round / RandomShapes::kinds % RandomShapes::kinds;
    const double scale = std::pow(10, random.number(-2, 1.3));
    Outline first = placed(random.make(kind, scale), {}, random.turn());
    const Outline second =
        placed(random.make(other_kind, scale * random.number(0.3, 3)), random.vector(10), random.turn());
    const auto size_of_box = [](const Solid& solid) { return norm(solid.form->box.high - solid.form->box.low); };
    const double size = std::min(size_of_box(first.solids[0]), size_of_box(second.solids[0]));
    bring_near(first.solids[0], second.solids[0], rotate(random.turn(), {1, 0, 0}), random.number(0, 0.2) * size, size);
    std::vector<Touch> found;
    finder.find(first, random.vector(1e-6), second, random.vector(1e-6), 0.1 * size, found);
    const double distance = upper_distance(first.solids[0], second.solids[0], 1000);
    if (distance > 0.099 * size) continue;  // it went past
    ASSERT_FALSE(found.empty()) << kind << " " << other_kind;
    const bool is_round = (kind >= 4 && kind <= 7) || (other_kind >= 4 && other_kind <= 7);
    EXPECT_LE(found.size(), is_round ? 6u : 4u);
    EXPECT_LE(least_gap_of(found), distance * (1 + 2e-5) + 1e-9 * size) << kind << " " << other_kind;
    for (const Touch& touch : found) {
      EXPECT_NEAR(dot(touch.normal, touch.center - touch.origin) - touch.radius, touch.gap, 1e-13 * (size + 10));
      EXPECT_NEAR(norm(touch.normal), 1, 1e-12);
      EXPECT_LE(touch.gap, 0.1 * size);
    }
    // The plane at the least gap is between them by that gap.
    const Touch& least = *std::ranges::min_element(found, {}, &Touch::gap);
    const Vec3 normal = (least.is_turned ? -1.0 : 1.0) * least.normal;
    const double apart = dot(normal, farthest_of(first.solids[0], -normal) - farthest_of(second.solids[0], normal));
    EXPECT_LE(apart, least.gap + 1e-8 * size) << kind << " " << other_kind;
  }
}

TEST(Touches, of_two_bodies_are_the_same_from_either_side) {
  RandomShapes random(10);
  for (int round = 0; round < 81 * 10; ++round) {
    const int kind = round % RandomShapes::kinds, other_kind = round / RandomShapes::kinds % RandomShapes::kinds;
    Outline first = placed(random.make(kind, 1), {}, random.turn());
    const Outline second = placed(random.make(other_kind, 1), {}, random.turn());
    bring_near(first.solids[0], second.solids[0], rotate(random.turn(), {1, 0, 0}), random.number(0, 0.2), 1);
    const auto one = touches_of(first, second, 0.05), other = touches_of(second, first, 0.05);
    if (one.empty() && other.empty()) continue;
    ASSERT_FALSE(one.empty() || other.empty()) << kind << " " << other_kind;
    EXPECT_NEAR(least_gap_of(one), least_gap_of(other), 1e-5 * (1e-3 + std::abs(least_gap_of(one))))
        << kind << " " << other_kind;
  }
}

TEST(Touches, of_shapes_on_a_grid_are_finite_and_named_once) {
  const double h = std::sqrt(0.5);
  const Shape shapes[] = {Sphere{0.5},      Box{{1, 0.5, 2}},       Box{{1, 1, 1}, 0.5},   Box{{1, 0.5, 1}, 0.25},
                          Capsule{0.25, 1}, Cylinder{0.5, 1},       Cylinder{0.5, 2, 0.5}, Cylinder{1, 0.5, 0.25},
                          Cone{0.5, 1},     Ellipsoid{{1, 0.5, 2}}, Torus{0.5, 0.25},      Torus{0.5, 0.25, 1}};
  const Quaternion turns[] = {{}, {0, 0, h, h}, {0, h, 0, h}, {h, 0, 0, h}, axis_angle({0, 1, 0}, 0.785398163397448)};
  RandomShapes random(13);
  const auto any = [&](int count) { return static_cast<int>(random.number(0, count)); };
  std::vector<std::shared_ptr<const Form>> forms;
  for (const Shape& shape : shapes) forms.push_back(make_form(shape));
  const auto body = [&](int kind) {
    const Vec3 place{0.25 * (any(11) - 5), 0.25 * (any(11) - 5), 0.25 * (any(11) - 5)};
    Outline outline;
    outline.solids.push_back(
        {forms[kind], 7, place + random.vector(any(2) ? 1e-9 : 0), multiply(turns[any(5)], turns[any(5)])});
    return outline;
  };
  TouchFinder finder;
  for (int round = 0; round < 40000; ++round) {
    const int kind = any(12), other_kind = any(12);
    const Outline first = body(kind), second = body(other_kind);
    std::vector<Touch> found, turned;
    finder.find(first, {}, second, {}, 0.05, found), finder.find(second, {}, first, {}, 0.05, turned);
    std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, bool>> names;
    for (const Touch& t : found) {
      names.insert({t.part, t.feature, t.other_part, t.other_feature, t.is_turned});
      ASSERT_TRUE(is_finite(t.center) && is_finite(t.place) && is_finite(t.origin) && is_finite(t.axis));
      ASSERT_NEAR(norm(t.normal), 1, 1e-12);
      ASSERT_NEAR(dot(t.normal, t.center - t.origin) - t.radius, t.gap, 1e-13);
      const Vec3 between = t.center - t.origin;
      if (t.form == TouchForm::round) {
        ASSERT_NEAR(norm(between - dot(t.axis, between) * t.axis) - t.radius, t.gap, 1e-13);
      }
    }
    ASSERT_EQ(names.size(), found.size());
    if (kind >= 10 || other_kind >= 10) continue;  // rings
    ASSERT_EQ(found.empty(), turned.empty());
    const double gap = least_gap_of(found);
    if (found.empty() || gap < -0.02) continue;
    ASSERT_NEAR(gap, least_gap_of(turned), 1e-7) << kind << " " << other_kind;
  }
}

TEST(Touches, of_far_bodies_are_none) {
  EXPECT_TRUE(touches_of(placed(Box{{1, 1, 1}}, {0, 1.2, 0}), placed(Box{{1, 1, 1}}, {}), 0.1).empty());
  EXPECT_TRUE(touches_of(Outline{}, placed(Box{{1, 1, 1}}, {}), 0.1).empty());
}

TEST(Touches, of_a_compound_are_those_of_all_its_parts) {
  Outline table;
  for (const double x : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0})
      table.solids.push_back(
          {make_form(Box{{0.2, 1, 0.2}}), static_cast<std::uint32_t>(table.solids.size()), {x, 0.5, z}, {}});
  const auto found = touches_of(table, placed(Box{{4, 1, 4}}, {0, -0.5, 0}), 0.01);
  EXPECT_EQ(found.size(), 16u);
}

TEST(Touches, are_found_without_allocations_once_warm) {
  TouchFinder finder;
  std::vector<Touch> found;
  const Outline box = placed(Box{{1, 1, 1}}, {0.1, 1, 0.2}, axis_angle({0, 1, 0}, 0.3)),
                other = placed(Box{{1, 1, 1}}, {});
  const Outline log = placed(Cylinder{0.2, 1}, {0, 0.7, 0});
  const auto find_all = [&] {
    found.clear();
    finder.find(box, {}, other, {}, 0.02, found), finder.find(log, {}, other, {}, 0.02, found);
  };
  find_all();
  const long before = allocations;
  find_all();
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(found.size(), 6u);
}

// A ring that was created after a box fell through it.
TEST(Touches, do_not_depend_on_which_body_comes_first) {
  RandomShapes random(5);
  constexpr int kinds = RandomShapes::kinds + 2;
  const auto shape_of = [&](int kind) -> Shape {
    if (kind == RandomShapes::kinds) return Torus{0.6, 0.15, random.number(0, 0.5)};
    return kind > RandomShapes::kinds ? Shape(step_mesh()) : random.make(kind, 0.7);
  };
  int found_any = 0;
  for (int a = 0; a < kinds; ++a)
    for (int b = 0; b < kinds; ++b)
      for (int round = 0; round < 12; ++round) {
        const Outline one = placed(shape_of(a), random.vector(0.9), random.turn(), 3),
                      other = placed(shape_of(b), {}, random.turn(), 8);
        const auto found = touches_of(one, other, 0.05), swapped = touches_of(other, one, 0.05);
        ASSERT_EQ(found.empty(), swapped.empty()) << a << " and " << b << ", round " << round;
        if (found.empty()) continue;
        ++found_any;
        if (least_gap_of(found) > -0.05)  // of what overlaps deeply there are several planes
          EXPECT_NEAR(least_gap_of(found), least_gap_of(swapped), 1e-4) << a << " and " << b << ", round " << round;
      }
  EXPECT_GT(found_any, 500);
}

TEST(Touches, hold_a_box_at_an_edge_of_a_mesh_that_is_nearer_to_a_side_of_the_box) {
  const double overhang = 0.005, depth = 0.01;
  const auto found =
      touches_of(placed(Box{{0.2, 0.2, 0.2}}, {0.9 + overhang, 1.1 - depth, 0}), placed(step_mesh(), {}), 0.01);
  const auto is_at_edge = [](const Touch& touch) { return touch.place.x > 1 - 1e-9; };
  const auto touch = std::ranges::find_if(found, is_at_edge);
  ASSERT_NE(touch, found.end());
  EXPECT_NEAR(norm(touch->normal - Vec3{0, 1, 0}), 0, 1e-9);
  EXPECT_NEAR(touch->gap, -depth, 1e-9);
}

}  // namespace
}  // namespace iota::contact
