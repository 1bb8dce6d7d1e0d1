// SPDX-License-Identifier: Apache-2.0
// What is true of every shape. A new one needs an example below.
#include "shape/shape.h"

#include "shape/shape_list.h"
#include "shape/surface.h"
#include "source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

namespace iota::shape {
namespace {

Mesh wedge(double s) {
  return convex_hull(std::vector<Vec3>{{0, 0, 0}, {s, 0, 0}, {0, 2 * s, 0}, {0, 0, s}, {s, 0, s}, {0, 2 * s, s}});
}

/// Shapes of about s m.
std::vector<Shape> examples(double s) {
  return {Sphere{0.7 * s},
          Box{{s, 2 * s, 3 * s}},
          Box{{s, 2 * s, 3 * s}, 0.3 * s},
          Box{{s, s, s}, 0.5 * s},
          Cylinder{0.5 * s, 2 * s},
          Cylinder{s, 0.3 * s},
          Cylinder{0.6 * s, 1.5 * s, 0.2 * s},
          Capsule{0.5 * s, 1.5 * s},
          Torus{s, 0.3 * s},
          Torus{s, 0.3 * s, 1.2 * s},
          wedge(s),
          Ellipsoid{{s, 2 * s, 3 * s}},
          Ellipsoid{{3 * s, 3 * s, s}},
          Ellipsoid{{s, s, s}},
          HalfSpace{{1, 2, -0.5}},
          HalfSpace{{0, 1, 0}},
          Cone{0.6 * s, 1.5 * s},
          Cone{2 * s, 0.5 * s}};
}

class Random {
 public:
  double number(double low = -1, double high = 1) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vec(double size = 1) {
    const double x = number(), y = number(), z = number();
    return {size * x, size * y, size * z};
  }

 private:
  std::mt19937 engine_{7};
};

/// All tests at sizes of molecules, of things at hand and of mountains.
class EveryShape : public testing::TestWithParam<double> {
 protected:
  const double s = GetParam();
  Random random;

  template <class Test>
  void for_each_example(Test test) {
    for (const Shape& shape : examples(s)) {
      std::ostringstream text;
      text << name(shape) << " of";
      for (const double size : to_data(shape).sizes) text << ' ' << size;
      SCOPED_TRACE(text.str());
      test(shape);
      if (HasFatalFailure()) return;
    }
  }
  std::vector<Vec3> points_on(const Shape& shape, int count = 300) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(closest(shape, random.vec(2 * s)));
    return points;
  }
};

INSTANTIATE_TEST_SUITE_P(Sizes, EveryShape, testing::Values(1e-8, 1.0, 1e6), [](const auto& size) {
  return size.param == 1 ? "of_meters" : size.param < 1 ? "tiny" : "huge";
});

TEST_P(EveryShape, has_an_example) {
  std::set<std::size_t> kinds;
  for (const Shape& shape : examples(s)) kinds.insert(shape.index());
  EXPECT_EQ(kinds.size(), std::variant_size_v<Shape>);
}

TEST_P(EveryShape, comes_back_from_plain_data) {
  for_each_example([&](const Shape& shape) {
    const Data data = to_data(shape);
    EXPECT_EQ(size_names(shape).empty(), std::holds_alternative<Mesh>(shape));
    if (std::holds_alternative<Mesh>(shape))
      EXPECT_NE(data.key, 0u);
    else
      EXPECT_EQ(from_data(data), shape);
  });
  EXPECT_THROW((void)from_data({.kind = std::variant_size_v<Shape>}), std::invalid_argument);
  EXPECT_THROW((void)from_data({.kind = 0xffffffff}), std::invalid_argument);
}

TEST_P(EveryShape, has_its_nearest_point_on_the_surface_and_none_is_nearer) {
  for_each_example([&](const Shape& shape) {
    const std::vector<Vec3> on = points_on(shape);
    for (const Vec3& p : on) ASSERT_NEAR(distance(shape, p), 0, 1e-9 * s);
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = random.vec(2 * s);
      const double nearest = std::abs(distance(shape, p));
      for (const Vec3& q : on) ASSERT_LE(nearest, norm(q - p) * (1 + 1e-9) + 1e-9 * s);
    }
  });
}

/// Whether a constraint can hold a point on it: a level is optional.
bool is_holding(const Shape& shape) {
  return std::visit([]<class S>(const S&) { return Holding<S>; }, shape);
}

TEST_P(EveryShape, has_a_level_that_is_about_the_distance_near_the_surface) {
  for_each_example([&](const Shape& shape) {
    if (!is_holding(shape)) return;
    const auto surface = make_surface(shape);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = random.vec(2 * s), q = closest(shape, p), near = q + 1e-4 / (norm(p - q) / s) * (p - q);
      ASSERT_EQ(surface->at(p).value < 0, distance(shape, p) < 0) << p.x << ' ' << p.y << ' ' << p.z;
      // An ellipsoid's level has its slope 1 only at the ends of its shortest axis.
      const double slope = std::holds_alternative<Ellipsoid>(shape) ? norm(surface->at(q).gradient) : 1;
      ASSERT_NEAR(surface->at(near).value, slope * distance(shape, near), 1e-6 * s);
    }
  });
}

TEST_P(EveryShape, has_a_level_with_its_derivatives) {
  for_each_example([&](const Shape& shape) {
    if (!is_holding(shape)) return;
    const auto surface = make_surface(shape);
    const double h = 1e-5 * s;
    int compared = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = random.vec(2 * s);
      const Level level = surface->at(p);
      bool kink = false;
      double slopes[3];
      Vec3 columns[3];
      for (int k = 0; k < 3; ++k) {
        const Vec3 step{k == 0 ? h : 0, k == 1 ? h : 0, k == 2 ? h : 0};
        const Level above = surface->at(p + step), below = surface->at(p - step);
        kink = kink || norm(above.gradient - below.gradient) > 1e-2 * norm(level.gradient);
        slopes[k] = (above.value - below.value) / (2 * h);
        columns[k] = (0.5 / h) * (above.gradient - below.gradient);
      }
      if (kink) continue;
      ++compared;
      const double steep = norm(level.gradient) + 1;
      ASSERT_NEAR(slopes[0], level.gradient.x, 1e-6 * steep);
      ASSERT_NEAR(slopes[1], level.gradient.y, 1e-6 * steep);
      ASSERT_NEAR(slopes[2], level.gradient.z, 1e-6 * steep);
      for (int k = 0; k < 3; ++k) {
        const Vec3 column{level.hessian.m[0][k], level.hessian.m[1][k], level.hessian.m[2][k]};
        ASSERT_LT(norm(column - columns[k]), (1e-4 * steep + 1e-3 * norm(columns[k]) * s) / s) << k;
      }
    }
    EXPECT_GT(compared, 900);
  });
}

TEST_P(EveryShape, has_its_farthest_points_and_bounds_round_all_of_its_points) {
  for_each_example([&](const Shape& shape) {
    const std::vector<Vec3> on = points_on(shape);
    const Bounds box = bounds(shape);
    for (int i = 0; i < 50; ++i) {
      const Vec3 d = random.vec(), far = support(shape, d);
      if (is_finite(far)) ASSERT_NEAR(distance(shape, far), 0, 1e-9 * s);
      for (const Vec3& p : on) ASSERT_LE(dot(p, d), dot(far, d) + 1e-9 * s);
    }
    for (const Vec3& p : on) {
      for (const auto& [low, at, high] :
           {std::array{box.low.x, p.x, box.high.x}, std::array{box.low.y, p.y, box.high.y},
            std::array{box.low.z, p.z, box.high.z}}) {
        ASSERT_LE(low, at + 1e-9 * s);
        ASSERT_LE(at, high + 1e-9 * s);
      }
    }
  });
}

TEST_P(EveryShape, is_met_by_a_ray_where_its_surface_is_and_missed_by_one_that_leaves) {
  for_each_example([&](const Shape& shape) {
    for (int i = 0; i < 200; ++i) {
      const Vec3 from = random.vec(2 * s), to = random.vec(2 * s);
      if (is_within(shape, from)) {
        EXPECT_EQ(ray(shape, from, {1, 0, 0}), 0);
        continue;
      }
      const Vec3 unit = (1 / norm(to - from)) * (to - from);
      const std::optional<double> hit = ray(shape, from, unit, 1e3 * s);
      if (is_within(shape, to)) {
        ASSERT_TRUE(hit);
        ASSERT_LE(*hit, norm(to - from));
      }
      if (hit) ASSERT_NEAR(distance(shape, from + *hit * unit), 0, 1e-8 * s);
      const Vec3 away = from - closest(shape, from);
      if (!std::holds_alternative<Torus>(shape))  // convex: straight away from it nothing is met
        ASSERT_FALSE(ray(shape, from, (1 / norm(away)) * away, 1e3 * s));
    }
  });
}

void expect_near(const MassProperties& found, const MassProperties& exact, double part) {
  const double length = std::cbrt(exact.volume);
  EXPECT_NEAR(found.volume, exact.volume, part * exact.volume);
  EXPECT_LT(norm(found.center - exact.center), part * length);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(norm(found.mean_squares[i] - exact.mean_squares[i]),
              part * (exact.mean_squares[0].x + exact.mean_squares[1].y + exact.mean_squares[2].z));
}

TEST_P(EveryShape, has_the_mass_of_its_fine_mesh) {
  for_each_example([&](const Shape& shape) {
    if (!is_solid(shape)) {
      EXPECT_THROW((void)mass_properties(shape), std::invalid_argument);
      EXPECT_THROW((void)triangulate(shape, 100), std::invalid_argument);
      return;
    }
    const bool ring = std::holds_alternative<Torus>(shape);
    const Mesh mesh = triangulate(shape, ring ? 60 : 2000);
    for (const Vec3& v : mesh.vertices) ASSERT_NEAR(distance(shape, v), 0, 1e-9 * s);
    expect_near(mass_properties(mesh), mass_properties(shape), 0.01);
  });
}

TEST_P(EveryShape, is_filled_evenly_by_births) {
  for_each_example([&](const Shape& shape) {
    if (!is_source(shape)) {
      EXPECT_THROW((void)inside(shape, [](double low, double) { return low; }), std::invalid_argument);
      return;
    }
    constexpr int count = 40000;
    const MassProperties exact = mass_properties(shape);
    MassProperties found{exact.volume, {}, {}};
    for (int i = 0; i < count; ++i) {
      const Vec3 p = inside(shape, [&](double low, double high) { return random.number(low, high); });
      ASSERT_LE(distance(shape, p), 1e-9 * s);
      found.center += (1.0 / count) * p;
      const Vec3 r = p - exact.center;
      found.mean_squares[0] += (r.x / count) * r;
      found.mean_squares[1] += (r.y / count) * r;
      found.mean_squares[2] += (r.z / count) * r;
    }
    expect_near(found, exact, 0.03);
  });
}

TEST(Shape, refuses_sizes_out_of_range_and_sizes_that_do_not_go_together) {
  const double nan = std::nan("");
  for (const Shape& bad :
       {Shape{Sphere{0}}, Shape{Sphere{nan}}, Shape{Box{{1, -1, 1}}}, Shape{Box{{1, 1, 1}, 0.6}},
        Shape{Box{{1, 1, 1}, -0.1}}, Shape{Cylinder{1, 0}}, Shape{Cylinder{1, 1, 0.6}}, Shape{Capsule{INFINITY, 1}},
        Shape{Torus{0.1, 0.2}}, Shape{Torus{1, 0.2, nan}}, Shape{Ellipsoid{{1, 1, 1e-10}}}, Shape{HalfSpace{{0, 0, 0}}},
        Shape{HalfSpace{{1, nan, 0}}}, Shape{Cone{1, -1}}})
    EXPECT_THROW(check(bad), std::invalid_argument) << name(bad);
  try {
    check(Ellipsoid{{1, 0, 1}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "each number in the size of an ellipsoid must be between 1e-09 and 1e+09 m, got 0");
  }
}

TEST(Shape, of_edges_rounded_away_is_a_ball_or_a_capsule) {
  const MassProperties ball = mass_properties(Sphere{0.5}), rounded = mass_properties(Box{{1, 1, 1}, 0.5});
  EXPECT_NEAR(rounded.volume, ball.volume, 1e-14);
  EXPECT_NEAR(rounded.mean_squares[1].y, ball.mean_squares[1].y, 1e-15);
  EXPECT_NEAR(mass_properties(Box{{1, 1, 1}, 1e-8}).volume, 1, 1e-12);
  const MassProperties can = mass_properties(Cylinder{0.5, 3, 0.5}), capsule = mass_properties(Capsule{0.5, 2});
  EXPECT_NEAR(can.volume, capsule.volume, 1e-14);
  EXPECT_NEAR(can.mean_squares[0].x, capsule.mean_squares[0].x, 1e-14);
  EXPECT_NEAR(can.mean_squares[1].y, capsule.mean_squares[1].y, 1e-14);
  const MassProperties link = mass_properties(Torus{1, 0.2, 1e-8}), ring = mass_properties(Torus{1, 0.2});
  EXPECT_NEAR(link.mean_squares[0].x, ring.mean_squares[0].x, 1e-7);
}

TEST(Shape, has_the_sizes_that_the_protocol_lists) {
  std::ifstream file(source_folder() / "protocol/shapes.json");
  std::stringstream text;
  text << file.rdbuf();
  std::string listed;
  for_each_shape([&](const Shape& shape) {
    std::string sizes;
    for (const std::string& size : size_names(shape)) sizes += (sizes.empty() ? "\"" : ", \"") + size + "\"";
    listed += (listed.empty() ? "" : ",\n") +
              ("    { \"name\": \"" + std::string(name(shape)) + "\", \"sizes\": [" + sizes + "] }");
  });
  EXPECT_NE(text.str().find("\"shapes\": [\n" + listed + "\n  ]"), std::string::npos) << listed;
}

}  // namespace
}  // namespace iota::shape
