// SPDX-License-Identifier: Apache-2.0
// Every constraint of the list against finite differences, at random places with random weights. A new type does not
// compile here before it has an `example`.
#include "solver/constraints/constraint_list.h"

#include "shape/shape.h"
#include "solver/holds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <typeinfo>

namespace iota::solver {
namespace {

struct Random {
  std::mt19937 engine{7};
  double number(double low = -1, double high = 1) {
    return low + (high - low) * std::uniform_real_distribution<double>()(engine);
  }
  Vec3 vec(double size = 1) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine); }
};

/// A constraint and the points on which it acts.
template <class C>
struct Example {
  C constraint;
  std::vector<Vec3> x;
};

/// Points 0 ... 3 are the corners of a nearly orthonormal frame of one body, 4 ... 7 of another.
std::vector<Vec3> two_bodies(Random& random, double noise = 0.02) {
  std::vector<Vec3> x;
  for (int body = 0; body < 2; ++body) {
    const Vec3 axis = random.vec();
    const Quaternion q = axis_angle((1 / norm(axis)) * axis, random.number(-3, 3));
    const Vec3 origin = random.vec(0.5);
    for (const Vec3& corner : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      x.push_back(origin + rotate(q, corner) + random.vec(noise));
  }
  return x;
}

/// arm += sign * (the point at `place` of body 0 or 1)
template <class C>
void add_point(C& c, int arm, int body, const Vec3& place, double sign = 1) {
  const auto first = static_cast<std::uint32_t>(4 * body);
  const double weights[4] = {1 - place.x - place.y - place.z, place.x, place.y, place.z};
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_TRUE(c.add(arm, first + i, sign * weights[i]));
}
template <class C>
void add_direction(C& c, int arm, int body, const Vec3& direction) {
  add_point(c, arm, body, direction), add_point(c, arm, body, {}, -1);
}

/// The frame of a point of body 1: that of body 0, or the world's.
template <class C>
void add_place(C& c, Random& random, const Vec3& place) {
  if (random.whole(0, 2) == 0) {
    c.set_world_frame(random.vec(0.1));
    add_point(c, 0, 1, place);
    return;
  }
  add_point(c, 0, 1, place), add_point(c, 0, 0, random.vec(0.1), -1);
  add_direction(c, 1, 0, {1, 0, 0}), add_direction(c, 2, 0, {0, 1, 0}), add_direction(c, 3, 0, {0, 0, 1});
  c.first_side = 4;
}

Example<DistanceConstraint> example(Random& random, DistanceConstraint c) {
  c.nodes = {0, 1}, c.length = random.number(0.5, 2), c.scale = random.number(0.5, 2);
  return {c, {random.vec(), random.vec()}};
}

Example<AffineConstraint> example(Random& random, AffineConstraint c) {
  std::vector<Vec3> x;
  c.count = static_cast<std::uint32_t>(random.whole(1, 8));
  for (std::uint32_t i = 0; i < c.count; ++i) c.nodes[i] = i, c.weights[i] = random.number(), x.push_back(random.vec());
  c.target_start = random.vec(), c.target = random.vec();
  return {c, x};
}

template <std::derived_from<BilinearConstraint> C>
Example<C> example(Random& random, C c) {
  auto x = two_bodies(random);
  add_point(c, 0, random.whole(0, 1), random.vec()), add_point(c, 1, random.whole(0, 1), random.vec());
  c.constant_start[0] = random.vec(), c.constant[0] = random.vec(), c.set_constant(1, random.vec());
  c.product = random.number(), c.scale = random.number(0.5, 2);
  return {c, x};
}

Example<AngleConstraint> example(Random& random, AngleConstraint c) {
  auto x = two_bodies(random);
  add_direction(c, 0, 0, {0, 0, random.number(0.5, 2)});
  add_direction(c, 1, 0, {1, 0, 0.3});
  add_direction(c, 2, 1, random.vec());
  c.target_start = random.number(), c.target = random.number();
  c.track(x.data(), 0.3);
  return {c, x};
}

const geometry::Curve& random_curve(Random& random) {
  static const std::vector<std::unique_ptr<geometry::Curve>> curves = [] {
    std::vector<std::unique_ptr<geometry::Curve>> list;
    const auto knot = [](double u) {
      return Vec3{std::cos(u) + 0.3 * std::cos(2 * u), 0.3 * std::sin(3 * u), std::sin(u)};
    };
    list.push_back(std::make_unique<geometry::Spline>(geometry::Spline::of_function(knot, 0, 2 * M_PI, true)));
    list.push_back(std::make_unique<geometry::Spline>(std::vector<Vec3>{{0, 0, 0}, {1, 0.5, 0}, {2, 0, 1}, {3, 1, 1}}));
    list.push_back(std::make_unique<geometry::Polyline>(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {2, 1, 0}},
                                                        false, 0.4));
    return list;
  }();
  return *curves[static_cast<std::size_t>(random.whole(0, 2))];
}

/// A place of body 1 near the curve, as seen from the frame of `c`: the curve is found where the point is.
template <class C>
Example<C> near_curve(Random& random, C c) {
  c.curve = &random_curve(random);
  const double s = random.number(0.05, 0.95) * c.curve->length();
  add_place(c, random, random.vec(0.3));
  for (int tries = 0;; ++tries) {  // bodies that happen to be near it
    auto x = two_bodies(random);
    const Vec3 shift = c.curve->at(s).position + random.vec(0.05) - c.place(x.data(), 0);
    const Vec3 a = c.arm(1, x.data(), 0), b = c.arm(2, x.data(), 0), d = c.arm(3, x.data(), 0);
    for (int i = 4; i < 8; ++i) x[i] += shift.x * a + shift.y * b + shift.z * d;
    c.parameter = c.curve->nearest(c.place(x.data(), 0));
    if (norm(c.curve->at(c.parameter).position - c.place(x.data(), 0)) < 0.15) return {c, x};
  }
}

Example<CurveConstraint> example(Random& random, CurveConstraint c) {
  auto found = near_curve(random, c);
  double multipliers[2];
  found.constraint.start(found.constraint.parameter + random.number(-0.1, 0.1), {}, multipliers);
  return found;
}

Example<StationConstraint> example(Random& random, StationConstraint c) {
  auto found = near_curve(random, c);
  found.constraint.target_start = random.number(), found.constraint.target = random.number();
  return found;
}

const shape::Surface& random_surface(Random& random, bool convex = false) {
  using shape::make_surface;
  static const std::vector<std::shared_ptr<const shape::Surface>> surfaces{
      make_surface(Sphere{0.5}),
      make_surface(Ellipsoid{{0.8, 1.2, 1.0}}),
      make_surface(Capsule{0.4, 0.6}),
      make_surface(Box{{0.8, 1.0, 1.2}, 0.35}),
      make_surface(HalfSpace{{0.3, 1, 0.2}}),
      make_surface(Torus{0.7, 0.3}),
      std::make_shared<shape::FunctionSurface>([](const Vec3& p) { return p.y - 0.1 * std::sin(p.x) * std::sin(p.z); },
                                               1.0)};
  return *surfaces[static_cast<std::size_t>(random.whole(0, convex ? 3 : 6))];
}

Example<SurfaceConstraint> example(Random& random, SurfaceConstraint c) {
  c.surface = &random_surface(random);
  add_place(c, random, random.vec(0.5));
  return {c, two_bodies(random)};
}

Example<SurfacePairConstraint> example(Random& random, SurfacePairConstraint c) {
  c.surface_a = &random_surface(random, true), c.surface_b = &random_surface(random, true);
  auto x = two_bodies(random);
  Vec3 apart = random.vec();
  apart *= random.number(0.8, 1.6) / norm(apart);
  const Vec3 moved = x[0] + apart - x[4];
  for (int i = 4; i < 8; ++i) x[i] += moved;
  add_point(c, 0, 1, {}), add_point(c, 0, 0, {}, -1);
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis{k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0};
    add_direction(c, 1 + k, 0, axis), add_direction(c, 4 + k, 1, axis);
  }
  c.start(x.data(), 0);
  return {c, x};
}

Example<SpanConstraint> example(Random& random, SpanConstraint c) {
  add_point(c, 0, 0, random.vec()), add_point(c, 0, 1, random.vec(), -1);
  c.target = random.number(), c.target_start = 0.8 * c.target;
  return {c, two_bodies(random)};
}

Example<FrictionLineConstraint> example(Random& random, FrictionLineConstraint c) {
  c.friction = random.number(0, 1);
  add_place(c, random, random.vec(0.5));
  return {c, two_bodies(random)};
}

Example<ContactConstraint> example(Random& random, ContactConstraint c) {
  c.radius = random.number(0, 0.3);
  add_point(c, 0, 0, random.vec()), add_point(c, 0, 1, random.vec(), -1);
  add_point(c, 1, 0, random.vec()), add_point(c, 1, 1, random.vec(), -1);
  for (int arm = 2; arm < 5; ++arm) add_direction(c, arm, 1, random.vec());
  return {c, two_bodies(random)};
}

/// Coordinates of all kinds between bodies, some of which are in several of them.
Example<CouplingConstraint> example(Random& random, CouplingConstraint c) {
  std::vector<Vec3> x;
  const auto add = [&](auto row, double ratio, std::uint32_t body) {  // of the bodies `body` and `body + 1`
    auto made = example(random, row);
    if (x.empty()) x = made.x;
    while (x.size() < 4 * (body + 2)) x.insert(x.end(), made.x.end() - 4, made.x.end());
    for (std::uint32_t i = 0; i < made.constraint.count; ++i) made.constraint.nodes[i] += 4 * body;
    if constexpr (requires { made.constraint.product; }) made.constraint.product = 0;
    for (std::uint32_t i = 0; i < made.constraint.count; ++i) EXPECT_TRUE(c.list_node(made.constraint.nodes[i]));
    c.add(ratio, made.constraint);
  };
  add(SpanConstraint{}, random.number(), 0);
  add(AngleConstraint{}, random.number(), 1);
  add(BilinearConstraint{}, random.number(), 3);
  add(AngleConstraint{}, random.number(), 1);
  c.target_start = random.number(), c.target = random.number();
  c.track(x.data(), 0.3);
  return {c, x};
}

/// Difference quotient of a vector-valued function of one coordinate.
template <class Function>
auto central(double& coordinate, double step, Function f) {
  const double before = coordinate;
  coordinate = before + step;
  auto high = f();
  coordinate = before - step;
  const auto low = f();
  coordinate = before;
  for (std::size_t i = 0; i < high.size(); ++i) high[i] = (high[i] - low[i]) / (2 * step);
  return high;
}

double* coordinate(Vec3& v, int k) { return k == 0 ? &v.x : k == 1 ? &v.y : &v.z; }

template <class C>
void check(Random& random) {
  SCOPED_TRACE(typeid(C).name());
  auto [c, x] = example(random, C{});
  const double fraction = random.number(0, 1);
  const int n = c.node_count();
  const auto values = [&] {
    std::array<double, C::rows> g;
    c.value(x.data(), fraction, g.data());
    return g;
  };
  const auto gradients = [&] {
    std::vector<double> all;
    const Gradients<C> at(c, x.data(), fraction);
    for (int i = 0; i < n; ++i) {
      Vec3 rows[C::rows];
      at.of_node(i, rows);
      for (Vec3& row : rows) all.insert(all.end(), {row.x, row.y, row.z});
    }
    return all;
  };
  const std::vector<double> gradient = gradients();
  double size = 1e-3;
  for (const double v : gradient) size = std::max(size, std::abs(v));
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) {
      const auto slope = central(*coordinate(x[c.nodes[i]], k), 1e-6, values);
      for (int r = 0; r < C::rows; ++r) {
        const double exact = gradient[static_cast<std::size_t>((i * C::rows + r) * 3 + k)];
        ASSERT_NEAR(slope[static_cast<std::size_t>(r)], exact, 2e-7 * size);
      }
    }
  if constexpr (C::has_curvature) {
    double lambda[C::rows];
    for (double& l : lambda) l = random.number();
    std::vector<Mat3> blocks;
    if constexpr (GeneralConstraint<C>) {
      blocks.resize(static_cast<std::size_t>(n * (n + 1) / 2));
      c.curvature(x.data(), fraction, lambda, false, blocks.data());
    } else {
      for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) blocks.push_back(Mat3::diagonal(c.curvature(lambda, i, j)));
    }
    double largest = size;
    for (const Mat3& b : blocks)
      for (const auto& row : b.m)
        for (const double v : row) largest = std::max(largest, std::abs(v));
    for (int j = 0; j < n; ++j)
      for (int l = 0; l < 3; ++l) {
        const auto slope = central(*coordinate(x[c.nodes[j]], l), 1e-5, gradients);
        const Mat3* block = blocks.data();
        for (int i = 0; i < n; ++i)
          for (int other = i; other < n; ++other, ++block) {
            if (other != j) continue;
            for (int k = 0; k < 3; ++k) {
              double expected = 0;
              for (int r = 0; r < C::rows; ++r)
                expected += lambda[r] * slope[static_cast<std::size_t>((i * C::rows + r) * 3 + k)];
              ASSERT_NEAR(block->m[k][l], expected, 2e-5 * largest) << i << ' ' << j;
            }
          }
      }
  }
}

template <class C>
struct Type {};

/// visit(C{}): each type of constraint.
template <class Visit>
void for_each_type(Visit visit) {
  std::apply([&]<class... C>(Type<C>...) { (visit(C{}), ...); }, ConstraintPools<Type>{});
}

TEST(Constraints, have_the_gradients_and_hessians_that_finite_differences_say) {
  Random random;
  for (int round = 0; round < 100 && !testing::Test::HasFatalFailure(); ++round)
    for_each_type([&]<class C>(C) { check<C>(random); });
}

TEST(Constraints, that_call_themselves_internal_do_not_notice_a_translation) {
  Random random;
  for (int round = 0; round < 30; ++round)
    for_each_type([&]<class T>(T type) {
      auto [c, x] = example(random, type);
      if (!c.is_internal()) return;
      double before[T::rows], after[T::rows];
      c.value(x.data(), 0.5, before);
      const Vec3 shift = random.vec();
      for (Vec3& p : x) p += shift;
      c.value(x.data(), 0.5, after);
      for (int r = 0; r < T::rows; ++r) ASSERT_NEAR(after[r], before[r], 1e-10) << typeid(T).name();
    });
}

TEST(Constraints, clamped_have_no_negative_curvature) {
  Random random;
  for (int round = 0; round < 300; ++round)
    for_each_type([&]<class T>(T type) {
      if constexpr (GeneralConstraint<T> && T::has_curvature) {
        auto [c, x] = example(random, type);
        double lambda[T::rows];
        for (double& l : lambda) l = random.number();
        Mat3 blocks[T::max_nodes * (T::max_nodes + 1) / 2];
        c.curvature(x.data(), 0, lambda, true, blocks);
        Vec3 u[T::max_nodes];
        for (Vec3& v : u) v = random.vec();
        double sum = 0;
        const Mat3* block = blocks;
        for (int i = 0; i < c.node_count(); ++i)
          for (int j = i; j < c.node_count(); ++j, ++block) sum += (i == j ? 1 : 2) * dot(u[i], *block * u[j]);
        ASSERT_GE(sum, -1e-12) << typeid(T).name();
      }
    });
}

/// The changes of the rows' values from x0 to x1, at this fraction of the step, that their mean gradients give.
template <class C>
std::array<double, C::rows> changes_by_mean_gradients(const C& c, const std::vector<Vec3>& x0,
                                                      const std::vector<Vec3>& x1, double fraction = 1) {
  static_assert(DiscreteGradientConstraint<C>);
  const MeanGradients<C> means(c, x0.data(), 0, {c, x1.data(), fraction});
  std::array<double, C::rows> changes{};
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 mean[C::rows];
    means.of_node(i, nullptr, mean);
    for (int r = 0; r < C::rows; ++r) changes[r] += dot(mean[r], x1[c.nodes[i]] - x0[c.nodes[i]]);
  }
  return changes;
}

/// Contacts have a friction that follows what slides, and a Coupling sums up others.
template <class C>
constexpr bool keeps_angular_momentum = !is_of_contact<C> && !std::is_same_v<C, CouplingConstraint>;

TEST(Constraints, between_bodies_keep_angular_momentum_over_a_step) {
  Random random;
  for (int round = 0; round < 100; ++round)
    for_each_type([&]<class T>(T type) {
      if constexpr (keeps_angular_momentum<T>) {
        const auto [c, x0] = example(random, type);
        if (!c.is_internal() || holds_direction(c)) return;
        auto x1 = x0;
        for (Vec3& p : x1) p += random.vec(0.05);
        const Gradients<T> at_end(c, x1.data(), 0);
        const MeanGradients<T> means(c, x0.data(), 0, at_end);
        Vec3 sums[T::rows];
        double size = 0;
        for (int i = 0; i < c.node_count(); ++i) {
          Vec3 end[T::rows], mean[T::rows];
          at_end.of_node(i, end), means.of_node(i, end, mean);
          const Vec3 place = 0.5 * (x0[c.nodes[i]] + x1[c.nodes[i]]);
          for (int r = 0; r < T::rows; ++r) sums[r] += cross(place, mean[r]), size += norm(mean[r]);
        }
        for (const Vec3& sum : sums) ASSERT_LT(norm(sum), 1e-12 * (1 + size)) << typeid(T).name();
      }
    });
}

/// Example{c, x} after its two bodies have turned and moved a little.
template <class C>
void expect_exact_change(Random& random) {
  auto [c, x0] = example(random, C{});
  auto x1 = x0;
  for (std::uint32_t body = 0; body < 2; ++body) {
    const Vec3 axis = random.vec(), shift = random.vec(0.02);
    const Quaternion turn = axis_angle((1 / norm(axis)) * axis, random.number(-0.05, 0.05));
    for (std::uint32_t i = 0; i < 4; ++i)
      x1[4 * body + i] = x0[4 * body] + shift + rotate(turn, x0[4 * body + i] - x0[4 * body]);
  }
  double before[C::rows], after[C::rows];
  c.value(x0.data(), 0, before), c.value(x1.data(), 0, after);
  const auto change = changes_by_mean_gradients(c, x0, x1, 0);
  for (int r = 0; r < C::rows; ++r) ASSERT_NEAR(change[r], after[r] - before[r], 1e-9) << typeid(C).name();
}

TEST(Constraints, on_curves_and_surfaces_change_exactly_by_their_mean_gradients) {
  Random random;
  for (int round = 0; round < 100; ++round) {
    expect_exact_change<CurveConstraint>(random), expect_exact_change<StationConstraint>(random);
    expect_exact_change<SurfaceConstraint>(random), expect_exact_change<SurfacePairConstraint>(random);
  }
}

TEST(Span, changes_exactly_by_its_mean_gradient) {
  Random random;
  for (int round = 0; round < 100; ++round) {
    const auto [c, x0] = example(random, SpanConstraint{});
    const auto x1 = two_bodies(random);
    double before, after;
    c.value(x0.data(), 0, &before), c.value(x1.data(), 1, &after);
    EXPECT_NEAR(changes_by_mean_gradients(c, x0, x1)[0], after - before + c.target - c.target_start, 1e-12);
  }
}

/// The angle of a point about z.
AngleConstraint angle_of(std::uint32_t node) {
  AngleConstraint c;
  c.set_constant(0, {0, 0, 1}), c.set_constant(1, {1, 0, 0});
  c.add(2, node, 1);
  return c;
}

TEST(Angle, changes_by_its_mean_gradient_and_not_by_a_sine) {
  for (const double turn : {1e-6, 0.01, 0.5, 1.5, -1.0}) {
    const std::vector<Vec3> x0{{2, 0, 0.5}}, x1{{2 * std::cos(turn), 2 * std::sin(turn), 0.5}};
    EXPECT_NEAR(changes_by_mean_gradients(angle_of(0), x0, x1)[0], turn, 1e-8 * std::abs(turn));
  }
}

TEST(Coupling, of_unlike_turns_and_a_length_passes_all_work_on) {
  const std::vector<Vec3> x0{{2, 0, 0}, {1, 0, 0}, {0, 3, 0}};
  const std::vector<Vec3> x1{{2 * std::cos(0.1), 2 * std::sin(0.1), 0}, {std::cos(-0.9), std::sin(-0.9), 0}, {1, 4, 1}};
  CouplingConstraint c;
  for (const std::uint32_t node : {2u, 0u, 1u}) EXPECT_TRUE(c.list_node(node));
  SpanConstraint span;
  span.add(0, 2, 1);
  c.add(9, angle_of(0)), c.add(1, angle_of(1)), c.add(-0.5, span);
  const double change = 9 * 0.1 - 0.9 - 0.5 * (std::sqrt(18.0) - 3);
  double before, after;
  c.value(x0.data(), 0, &before), c.value(x1.data(), 1, &after);
  EXPECT_NEAR(after - before, change, 1e-12);
  EXPECT_NEAR(changes_by_mean_gradients(c, x0, x1)[0], change, 1e-7);
}

TEST(Angle, counts_turns) {
  AngleConstraint c = angle_of(0);
  for (int i = 0; i <= 100; ++i) {
    const double angle = 0.2 * i;
    const Vec3 x{2 * std::cos(angle), 2 * std::sin(angle), 0.5};
    c.track(&x, 0);
    ASSERT_NEAR(c.near, angle, 1e-12);
  }
}

}  // namespace
}  // namespace iota::solver
