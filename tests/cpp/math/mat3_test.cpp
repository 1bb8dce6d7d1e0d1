// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace iota {
namespace {

class Random {
 public:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(engine_); }
  Vec3 vector() { return {number(), number(), number()}; }
  Vec3 direction() {
    Vec3 v = vector();
    while (norm(v) < 0.1) v = vector();
    return (1 / norm(v)) * v;
  }
  Quaternion turn() { return axis_angle(direction(), 4 * number()); }

 private:
  std::mt19937 engine_{2};
};

double distance(const Vec3& a, const Vec3& b) { return norm(a - b); }
/// As turns: q and -q are one.
double difference(const Quaternion& p, const Quaternion& q) {
  return 1 - std::abs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w);
}

TEST(Mat3, products_with_a_vector_are_what_their_names_say) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Vec3 a = random.vector(), b = random.vector(), v = random.vector();
    EXPECT_LT(distance(Mat3::outer(a, b) * v, dot(b, v) * a), 1e-15);
    EXPECT_LT(distance(Mat3::cross_matrix(a) * v, cross(a, v)), 1e-15);
    EXPECT_LT(distance(Mat3::cross_matrix(a).transposed() * v, cross(v, a)), 1e-15);
    EXPECT_LT(distance((Mat3::diagonal(2) + 3 * Mat3::outer(a, b)) * v, 2 * v + 3 * dot(b, v) * a), 1e-15);
  }
}

TEST(Mat3, transposed_times_a_vector_and_of_a_turn_are_what_they_say) {
  const Mat3 a{{{1, 2, 3}, {-4, 5, 6}, {7, 8, -9}}};
  const Vec3 v{0.3, -2, 5};
  EXPECT_EQ(transposed_times(a, v), a.transposed() * v);
  const Quaternion q = normalized({0.3, -0.5, 0.2, 0.7});
  EXPECT_LT(norm(matrix_of(q) * v - rotate(q, v)), 1e-14);
}

TEST(Mat3, inertia_of_a_point_gives_the_angular_momentum_of_its_turning) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Vec3 r = random.vector(), spin = random.vector();
    EXPECT_LT(distance(point_inertia(2, r) * spin, 2 * cross(r, cross(spin, r))), 1e-15);
  }
}

TEST(SymmetricEigen, puts_a_matrix_back_together_from_a_right_handed_set) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    Mat3 a;
    // Every fourth of rank one, every fourth with a double eigenvalue.
    const Vec3 u = random.direction(), v = random.vector(), w = random.vector();
    if (i % 4 == 0) a = Mat3::outer(v, v);
    if (i % 4 == 1) a = Mat3::diagonal(random.number()) + random.number() * Mat3::outer(u, u);
    if (i % 4 >= 2) a = Mat3::outer(v, w) + Mat3::outer(w, v) + random.number() * Mat3::outer(u, u);
    const SymmetricEigen e = symmetric_eigen(a);
    Mat3 again;
    for (int k = 0; k < 3; ++k) {
      again += e.values[k] * Mat3::outer(e.axes[k], e.axes[k]);
      for (int l = 0; l < 3; ++l) EXPECT_NEAR(dot(e.axes[k], e.axes[l]), k == l, 1e-14);
    }
    EXPECT_LT(distance(cross(e.axes[0], e.axes[1]), e.axes[2]), 1e-14);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(again.m[r][c], a.m[r][c], 1e-14);
  }
}

TEST(SymmetricEigen, leaves_a_diagonal_matrix_as_it_is) {
  const SymmetricEigen e = symmetric_eigen({{{3, 0, 0}, {0, 1, 0}, {0, 0, 2}}});
  EXPECT_EQ(e.values[0], 3);
  EXPECT_EQ(e.values[1], 1);
  EXPECT_EQ(e.values[2], 2);
  EXPECT_EQ(e.axes[0], (Vec3{1, 0, 0}));
}

TEST(SolveSemidefinite, solves_regular_directions_and_leaves_out_singular_ones) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Vec3 u = random.direction(), v = any_perpendicular(u), x = random.vector();
    const Mat3 regular = Mat3::diagonal(1) + 2 * Mat3::outer(u, u);
    EXPECT_LT(distance(solve_semidefinite(regular, regular * x), x), 1e-14);
    const Mat3 flat = 5 * Mat3::outer(u, u) + 3 * Mat3::outer(v, v);
    const Vec3 shadow = dot(x, u) * u + dot(x, v) * v;
    EXPECT_LT(distance(solve_semidefinite(flat, flat * x), shadow), 1e-13) << "of all solutions the shortest";
    EXPECT_LT(distance(solve_semidefinite(flat, cross(u, v)), {}), 1e-13) << "least squares: no part of it can be met";
  }
  EXPECT_EQ(solve_semidefinite(Mat3{}, {1, 2, 3}), Vec3{});
}

/// The sum of y . R x that a nearest rotation R makes largest, from the sum of products y x'.
double agreement(const Mat3& products, const Mat3& rotation) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += products.m[i][j] * rotation.m[i][j];
  return sum;
}

/// Of a linear map of vectors.
template <class Map>
Mat3 matrix(Map map) {
  Mat3 columns;
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) columns += Mat3::outer(map(axis), axis);
  return columns;
}

TEST(NearestRotation, finds_the_turn_back_of_any_two_directions_at_any_size) {
  Random random;
  for (const double size : {1e-9, 1.0, 1e9})
    for (int i = 0; i < 50; ++i) {
      const Quaternion q = random.turn();
      const Mat3 turn = matrix([&](const Vec3& v) { return rotate(q, v); });
      Mat3 products;
      for (int k = 0; k < 2 + i % 3; ++k) {
        const Vec3 x = size * random.direction();
        products += Mat3::outer(turn * x, x);
      }
      const Mat3 found = nearest_rotation(products);
      const Vec3 v = random.direction();
      EXPECT_LT(distance(found * v, turn * v), 1e-6);
    }
}

TEST(NearestRotation, is_a_rotation_and_no_other_is_nearer_also_to_a_mirror_image) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    Mat3 products;
    for (int k = 0; k < 4; ++k) {
      const Vec3 x = random.vector();
      products += Mat3::outer(i % 2 ? Vec3{-x.x, x.y, x.z} : random.vector(), x);
    }
    const Mat3 found = nearest_rotation(products);
    const Vec3 x = found * Vec3{1, 0, 0}, y = found * Vec3{0, 1, 0};
    EXPECT_NEAR(norm(x), 1, 1e-12);
    EXPECT_NEAR(norm(y), 1, 1e-12);
    EXPECT_NEAR(dot(x, y), 0, 1e-12);
    EXPECT_LT(distance(cross(x, y), found * Vec3{0, 0, 1}), 1e-12) << "right-handed";
    const double best = agreement(products, found);
    for (int k = 0; k < 50; ++k) {
      const Quaternion q = axis_angle(random.direction(), k % 2 ? 1e-3 : 3 * random.number());
      const Mat3 other = matrix([&](const Vec3& v) { return rotate(q, found * v); });
      EXPECT_LE(agreement(products, other), best + 1e-12);
    }
  }
}

TEST(NearestRotation, of_nothing_is_no_turn_and_of_one_line_turns_this_line) {
  EXPECT_EQ(nearest_rotation({}) * (Vec3{1, 2, 3}), (Vec3{1, 2, 3}));
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Vec3 x = random.direction(), y = random.direction();
    EXPECT_LT(distance(nearest_rotation(Mat3::outer(y, x)) * x, y), 1e-7);
  }
}

TEST(Quaternion, turns_by_its_angle_about_its_axis) {
  const double right = std::numbers::pi / 2;
  EXPECT_LT(distance(rotate(axis_angle({0, 0, 1}, right), {1, 0, 0}), {0, 1, 0}), 1e-15);
  EXPECT_LT(distance(rotate(axis_angle({1, 0, 0}, right), {0, 1, 0}), {0, 0, 1}), 1e-15);
  EXPECT_LT(distance(rotate(axis_angle({0, 1, 0}, right), {0, 0, 1}), {1, 0, 0}), 1e-15);
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Vec3 axis = random.direction(), v = random.vector();
    const double angle = 3 * random.number();
    const Vec3 along = dot(axis, v) * axis, across = v - along;  // Rodrigues
    const Vec3 turned = along + std::cos(angle) * across + std::sin(angle) * cross(axis, v);
    EXPECT_LT(distance(rotate(axis_angle(axis, angle), v), turned), 1e-15);
  }
}

TEST(Quaternion, product_turns_by_the_second_and_then_by_the_first) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Quaternion a = random.turn(), b = random.turn();
    const Vec3 v = random.vector();
    EXPECT_LT(distance(rotate(multiply(a, b), v), rotate(a, rotate(b, v))), 1e-14);
  }
}

TEST(Quaternion, that_is_zero_is_normalized_to_no_turn) {
  EXPECT_EQ(normalized({0, 0, 0, 0}), Quaternion{});
  EXPECT_EQ(normalized({0, 0, 2, 0}), (Quaternion{0, 0, 1, 0}));
}

TEST(Quaternion, shortest_turn_carries_one_direction_onto_another_also_where_they_are_opposite) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Vec3 from = random.direction();
    for (const Vec3& to : {random.direction(), from, -from, any_perpendicular(from)}) {
      const Quaternion turn = shortest_turn(from, to);
      EXPECT_LT(distance(rotate(turn, from), to), 1e-12);
      EXPECT_NEAR(turn.w, std::cos(std::acos(std::clamp(dot(from, to), -1.0, 1.0)) / 2), 1e-7) << "and no further";
    }
  }
}

TEST(Quaternion, from_axes_finds_the_turn_back_whatever_its_largest_part) {
  Random random;
  std::vector<Quaternion> turns;
  for (int i = 0; i < 50; ++i) turns.push_back(random.turn());
  // Half turns: the trace is -1, and each of the three other branches is taken.
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, random.direction()})
    turns.push_back(axis_angle(axis, std::numbers::pi));
  for (const Quaternion& turn : turns) {
    const Quaternion found = from_axes(rotate(turn, {1, 0, 0}), rotate(turn, {0, 1, 0}), rotate(turn, {0, 0, 1}));
    EXPECT_LT(difference(found, turn), 1e-14);
  }
}

TEST(Vec3, any_perpendicular_is_a_unit_vector_at_right_angles) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Vec3 v = i < 3 ? Vec3{double(i == 0), double(i == 1), double(i == 2)} : random.direction();
    EXPECT_NEAR(dot(any_perpendicular(v), v), 0, 1e-15);
    EXPECT_NEAR(norm(any_perpendicular(v)), 1, 1e-15);
  }
}

TEST(Vec3, without_a_direction_gives_the_other_unit_vector) {
  const Vec3 other{0, 0, 1};
  EXPECT_EQ(unit_or({0, -4, 0}, other), (Vec3{0, -1, 0}));
  EXPECT_EQ(unit_or({}, other), other);
  EXPECT_EQ(unit_or({1e-13, 0, 0}, other), (Vec3{1, 0, 0}));
  EXPECT_EQ(unit_or({1e-13, 0, 0}, other, 1e-12), other);
}

}  // namespace
}  // namespace iota
