// SPDX-License-Identifier: Apache-2.0
// Bodies given by shape: mass properties, attachments, motion.
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace iota {
namespace {

using std::numbers::pi;

double at(const Matrix3& m, int i, int j) {
  const Vec3& row = m[static_cast<std::size_t>(i)];
  return j == 0 ? row.x : j == 1 ? row.y : row.z;
}

void expect_diagonal(const Matrix3& m, const Vec3& diagonal, double tolerance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double wanted = i != j ? 0 : i == 0 ? diagonal.x : i == 1 ? diagonal.y : diagonal.z;
      EXPECT_NEAR(at(m, i, j), wanted, tolerance) << i << ", " << j;
    }
}

/// A torus, capsule ... as a mesh: a surface of revolution about z through points (radius, height), closed or ending on
/// the axis.
Mesh revolve(const std::vector<std::pair<double, double>>& profile, bool is_ring, int slices) {
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(profile.size());
  for (int s = 0; s < slices; ++s)
    for (const auto& [radius, height] : profile)
      mesh.vertices.push_back({radius * std::cos(2 * pi * s / slices), radius * std::sin(2 * pi * s / slices), height});
  const auto vertex = [&](std::uint32_t s, std::uint32_t k) { return (s % slices) * count + k % count; };
  for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(slices); ++s)
    for (std::uint32_t k = 0; k + (is_ring ? 0 : 1) < count; ++k) {
      mesh.triangles.push_back({vertex(s, k), vertex(s + 1, k), vertex(s + 1, k + 1)});
      mesh.triangles.push_back({vertex(s, k), vertex(s + 1, k + 1), vertex(s, k + 1)});
    }
  if (is_ring) return mesh;
  for (const std::uint32_t end : {0u, count - 1}) {  // caps
    mesh.vertices.push_back({0, 0, profile[end].second});
    const auto tip = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(slices); ++s)
      if (end == 0)
        mesh.triangles.push_back({tip, vertex(s + 1, end), vertex(s, end)});
      else
        mesh.triangles.push_back({tip, vertex(s, end), vertex(s + 1, end)});
  }
  return mesh;
}

Mesh box_mesh(const Vec3& low, const Vec3& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(low + Vec3{(i & 1) * size.x, (i >> 1 & 1) * size.y, (i >> 2 & 1) * size.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TEST(Solid, inertia_of_every_shape_is_the_textbooks) {
  System system;
  const double m = 3;
  const auto inertia = [&](const Shape& shape) {
    return system.bodies().inertia(system.bodies().create(shape, {.mass = m}));
  };
  expect_diagonal(inertia(Sphere{0.7}), 0.4 * m * 0.49 * Vec3{1, 1, 1}, 1e-14);
  expect_diagonal(inertia(Box{{1, 2, 3}}), m / 12 * Vec3{4 + 9, 1 + 9, 1 + 4}, 1e-14);
  const double a2 = 0.3 * 0.3, l2 = 2.0 * 2.0;
  expect_diagonal(inertia(Cylinder{0.3, 2}), Vec3{m * a2 / 2, m * (3 * a2 + l2) / 12, m * (3 * a2 + l2) / 12}, 1e-14);
  expect_diagonal(inertia(Torus{0.5, 0.1}),
                  m * Vec3{(4 * 0.25 + 5 * 0.01) / 8, (4 * 0.25 + 5 * 0.01) / 8, 0.25 + 0.75 * 0.01}, 1e-14);
  // A capsule: cylinder and two half spheres, each by the parallel axis theorem.
  const double r = 0.2, l = 1.5, tube = pi * r * r * l, ends = 4 * pi / 3 * r * r * r, density = m / (tube + ends);
  const double axial = density * (tube * r * r / 2 + ends * 0.4 * r * r);
  const double half = ends / 2, offset = l / 2 + 3 * r / 8, own = 0.4 * r * r - 9 * r * r / 64;
  const double across = density * (tube * (3 * r * r + l * l) / 12 + 2 * half * (own + offset * offset));
  expect_diagonal(inertia(Capsule{r, l}), {axial, across, across}, 1e-14);
}

TEST(Solid, volumes_are_the_textbooks) {
  EXPECT_DOUBLE_EQ(mass_properties(Sphere{2}).volume, 4 * pi / 3 * 8);
  EXPECT_DOUBLE_EQ(mass_properties(Box{{1, 2, 3}}).volume, 6);
  EXPECT_DOUBLE_EQ(mass_properties(Cylinder{2, 3}).volume, pi * 4 * 3);
  EXPECT_DOUBLE_EQ(mass_properties(Capsule{2, 3}).volume, pi * 4 * 3 + 4 * pi / 3 * 8);
  EXPECT_DOUBLE_EQ(mass_properties(Torus{2, 0.5}).volume, 2 * pi * pi * 2 * 0.25);
  System system;
  EXPECT_DOUBLE_EQ(system.bodies().mass(system.bodies().create(Box{{1, 2, 3}}, {.density = 7})), 42);
}

TEST(Solid, a_mesh_of_a_box_anywhere_has_the_boxs_properties) {
  const MassProperties box = mass_properties(Box{{1, 2, 3}});
  const MassProperties mesh = mass_properties(box_mesh({10, -20, 30}, {1, 2, 3}));
  EXPECT_NEAR(mesh.volume, box.volume, 1e-13);
  expect_near(mesh.center, {10.5, -19, 31.5}, 1e-13);
  expect_diagonal(mesh.mean_squares, {1 / 12.0, 4 / 12.0, 9 / 12.0}, 1e-13);
}

TEST(Solid, a_fine_mesh_tends_to_its_shape_with_the_square_of_its_edges) {
  const auto ring = [](int n) {
    std::vector<std::pair<double, double>> circle;
    for (int i = 0; i < n; ++i)
      circle.emplace_back(0.5 + 0.1 * std::cos(2 * pi * i / n), 0.1 * std::sin(2 * pi * i / n));
    return revolve(circle, true, n);
  };
  const MassProperties exact = mass_properties(Torus{0.5, 0.1});
  double last = 0;
  for (const int n : {24, 48, 96}) {
    const MassProperties mesh = mass_properties(ring(n));
    const double error = std::abs(mesh.volume / exact.volume - 1) +
                         std::abs(at(mesh.mean_squares, 0, 0) / at(exact.mean_squares, 0, 0) - 1) +
                         std::abs(at(mesh.mean_squares, 2, 2) / at(exact.mean_squares, 2, 2) - 1);
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.1);
    }
    last = error;
  }
  EXPECT_LT(last, 0.01);
  const MassProperties can = mass_properties(revolve({{0.3, -1}, {0.3, 1}}, false, 200));
  EXPECT_NEAR(can.volume, mass_properties(Cylinder{0.3, 2}).volume, 1e-3);
}

std::string refusal(const Shape& shape) {
  try {
    (void)mass_properties(shape);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Solid, bad_shapes_are_refused_with_the_reason) {
  const double nan = std::nan("");
  for (const Shape& bad : {Shape{Sphere{0}}, Shape{Sphere{nan}}, Shape{Box{{1, -1, 1}}}, Shape{Cylinder{1, 0}},
                           Shape{Capsule{INFINITY, 1}}, Shape{Torus{0.1, 0.2}}, Shape{Mesh{}}})
    EXPECT_NE(refusal(bad), "");
  const Mesh whole = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(refusal(whole), "");
  Mesh open = whole;
  open.triangles.pop_back();
  EXPECT_NE(refusal(open).find("not closed"), std::string::npos) << refusal(open);
  Mesh inside_out = whole;
  for (auto& [a, b, c] : inside_out.triangles) std::swap(b, c);
  EXPECT_NE(refusal(inside_out).find("inside out"), std::string::npos) << refusal(inside_out);
  Mesh twisted = whole;
  std::swap(twisted.triangles[3][0], twisted.triangles[3][1]);
  EXPECT_NE(refusal(twisted).find("wound inconsistently"), std::string::npos) << refusal(twisted);
  Mesh stranger = whole;
  stranger.triangles[5][1] = 8;
  EXPECT_NE(refusal(stranger).find("names vertex 8"), std::string::npos) << refusal(stranger);
  EXPECT_NE(refusal(box_mesh({0, 0, 0}, {1, 1, 0})).find("no volume"), std::string::npos);
  Mesh broken = whole;
  broken.vertices[2].x = nan;
  EXPECT_NE(refusal(broken).find("vertex 2"), std::string::npos) << refusal(broken);
}

TEST(Solid, a_turned_body_has_the_turned_inertia_and_moves) {
  System system({.gravity = {}});
  const Quaternion turn{0.1, -0.5, 0.3, std::sqrt(1 - 0.35)};
  const BodyId body = system.bodies().create(
      Box{{1, 2, 3}},
      {.mass = 5, .position = {7, 8, 9}, .orientation = turn, .velocity = {1, 2, 3}, .spin = {-2, 1, 0.5}});
  EXPECT_NEAR(system.bodies().mass(body), 5, 1e-14);
  expect_near(system.bodies().center_of_mass(body), {7, 8, 9}, 1e-13);
  expect_near(system.bodies().velocity(body), {1, 2, 3}, 1e-13);
  expect_near(system.bodies().angular_velocity(body), {-2, 1, 0.5}, 1e-13);
  const Quaternion q = system.bodies().orientation(body);
  EXPECT_NEAR(std::abs(q.x * turn.x + q.y * turn.y + q.z * turn.z + q.w * turn.w), 1, 1e-13);
  double trace = 0;
  for (int i = 0; i < 3; ++i) trace += at(system.bodies().inertia(body), i, i);
  EXPECT_NEAR(trace, 5.0 / 12 * 2 * (1 + 4 + 9), 1e-12);
  // J is what makes L of omega.
  const Matrix3 j = system.bodies().inertia(body);
  const Vec3 w{-2, 1, 0.5};
  expect_near(system.bodies().angular_momentum(body), {dot(j[0], w), dot(j[1], w), dot(j[2], w)}, 1e-12);
  EXPECT_TRUE(system.validate().empty());
}

// The promise that lets attachments be ordinary particles: nothing that the motion depends on changes.
TEST(Solid, attachments_anywhere_keep_mass_center_inertia_and_motion) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    System system({.gravity = {}});
    const Vec3 size{0.01 + std::abs(number(random)), 0.01 + std::abs(number(random)), 0.01 + std::abs(number(random))};
    const BodyId body =
        system.bodies().create(Box{size}, {.mass = 2,
                                           .orientation = {number(random), number(random), number(random), 1.1},
                                           .velocity = {1, 0, 2},
                                           .spin = {number(random), number(random), number(random)}});
    const Matrix3 before = system.bodies().inertia(body);
    const Vec3 momentum = system.momentum(), angular = system.angular_momentum(),
               center = system.bodies().center_of_mass(body);
    const Quaternion orientation = system.bodies().orientation(body);
    for (int i = 0; i < 6; ++i) {
      const double far = i == 5 ? 100 : 1;
      const Vec3 place{far * number(random), far * number(random), far * number(random)};
      const ParticleId p = system.bodies().create_attachment(body, place);
      EXPECT_GT(system.particles().mass(p), 0);
      expect_near(system.particles().position(p), place, 1e-12);
    }
    EXPECT_EQ(system.bodies().attachments(body).size(), 6u);
    EXPECT_NEAR(system.bodies().mass(body), 2, 1e-13);
    const double scale = at(before, 0, 0) + at(before, 1, 1) + at(before, 2, 2);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(at(system.bodies().inertia(body), i, j), at(before, i, j), 1e-12 * scale);
    expect_near(system.bodies().center_of_mass(body), center, 1e-13);
    expect_near(system.momentum(), momentum, 1e-12);
    expect_near(system.angular_momentum(), angular, 1e-12);
    const Quaternion& q = orientation;
    const Quaternion now = system.bodies().solids(body)[0].orientation;
    EXPECT_NEAR(std::abs(q.x * now.x + q.y * now.y + q.z * now.z + q.w * now.w), 1, 1e-12);
    expect_near(system.bodies().solids(body)[0].position, {}, 1e-12);
    EXPECT_TRUE(system.validate().empty());
  }
}

TEST(Solid, attachments_need_a_solid_whose_points_are_free) {
  System system;
  const BodyId points = system.bodies().create();
  (void)system.particles().create(points, {0, 0, 0});
  EXPECT_THROW((void)system.bodies().create_attachment(points, {1, 0, 0}), std::invalid_argument);
  const BodyId box = system.bodies().create(Box{});
  system.particles().nail(system.bodies().particles(box)[0]);
  EXPECT_THROW((void)system.bodies().create_attachment(box, {1, 0, 0}), std::invalid_argument);
  EXPECT_TRUE(system.validate().empty());
}

// Dzhanibekov: about its middle axis a free body flips over and over; energy and angular momentum stay.
TEST(Solid, a_free_top_flips_about_its_middle_axis_and_only_there) {
  const auto flips = [](const Vec3& spin) {
    System system({.gravity = {}});
    const BodyId top = system.bodies().create(Box{{0.1, 0.3, 0.6}}, {.mass = 1, .spin = spin});
    const Vec3 angular = system.angular_momentum();
    const double energy = system.energy().kinetic;
    const Vec3 axis = (1 / norm(spin)) * spin;
    int count = 0;
    double side = 1;
    for (int step = 0; step < 120 * 10; ++step) {
      const StepReport report = system.step(1.0 / 120);
      EXPECT_EQ(report.fallbacks + report.unconverged, 0);
      // the body's own axis that was along the spin at the start, seen in space
      const Quaternion q = system.bodies().orientation(top);
      const Vec3 u{q.x, q.y, q.z}, t = 2 * cross(u, axis);
      const double along = dot(axis, axis + q.w * t + cross(u, t));
      if (along * side < -0.5) side = -side, ++count;
    }
    expect_near(system.angular_momentum(), angular, 1e-9 * norm(angular));
    EXPECT_NEAR(system.energy().kinetic, energy, 1e-9 * energy);
    return count;
  };
  EXPECT_GE(flips({0.001, 8, 0.001}), 3);  // edges 0.1 < 0.3 < 0.6: y has the middle moment
  EXPECT_EQ(flips({8, 0.001, 0.001}), 0);
  EXPECT_EQ(flips({0.001, 0.001, 8}), 0);
}

TEST(Solid, a_hinged_link_costs_four_points_of_which_the_hinges_are_two) {
  System system;
  ParticleId last{};
  std::vector<BodyId> links;
  for (int i = 0; i < 10; ++i) {
    const BodyId link = system.bodies().create(
        Box{{0.2, 0.04, 0.04}}, {.position = {0.1 + 0.2 * i, 0, 0}, .attachments = {{-0.1, 0, 0}, {0.1, 0, 0}}});
    links.push_back(link);
    const auto ends = system.bodies().attachments(link);
    if (i == 0)
      system.particles().nail(ends[0]);
    else
      (void)system.edits().combine(last, ends[0]);
    last = ends[1];
  }
  const double start = system.energy().total();
  for (int step = 0; step < 240; ++step) {
    const StepReport report = system.step(1.0 / 240);
    EXPECT_EQ(report.unconverged, 0);
    EXPECT_LT(report.worst_gap, 1e-9);
  }
  EXPECT_NEAR(system.energy().total(), start, 1e-6 * system.energy().kinetic);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Solid, a_physical_pendulum_swings_with_its_own_period) {
  System system;
  const double a = 0.4, l = 1.0;  // a plate 0.1 x 0.4 x 1 hung half its length above its center, swinging about z
  const BodyId plate =
      system.bodies().create(Box{{a, l, 0.1}}, {.mass = 2, .attachments = {{0, l / 2, 0.05}, {0, l / 2, -0.05}}});
  for (const ParticleId p : system.bodies().attachments(plate)) system.particles().nail(p);
  const double moment = (a * a + l * l) / 12 + l * l / 4, omega = std::sqrt(9.81 * (l / 2) / moment);
  system.bodies().set_angular_velocity(plate, {0, 0, 0.01});
  double crossed = 0, before = 0;
  const double h = 1.0 / 240;
  for (int step = 1; crossed == 0 && step < 1000; ++step) {
    (void)system.step(h);
    const double x = system.bodies().center_of_mass(plate).x;
    if (before > 0 && x <= 0) crossed = h * (step - 1 + before / (before - x));
    before = x;
  }
  EXPECT_NEAR(crossed, pi / omega, 1e-4 * pi / omega);
}

TEST(Solid, velocity_and_spin_are_assigned_one_by_one) {
  System system({.gravity = {}});
  const BodyId body = system.bodies().create(Cylinder{0.1, 1}, {.mass = 2, .position = {1, 2, 3}});
  system.bodies().set_velocity(body, {1, 0, 0});
  system.bodies().set_angular_velocity(body, {0, 3, 0});
  expect_near(system.bodies().velocity(body), {1, 0, 0}, 1e-14);
  expect_near(system.bodies().angular_velocity(body), {0, 3, 0}, 1e-13);
  (void)system.step(0.01);
  expect_near(system.bodies().velocity(body), {1, 0, 0}, 1e-10);
  expect_near(system.bodies().angular_velocity(body), {0, 3, 0}, 1e-9);
  EXPECT_NEAR(system.energy().kinetic, system.energy().edits, 1e-9);
}

TEST(Solid, angular_velocity_has_no_part_where_there_is_no_inertia) {
  System system({.gravity = {}});
  const BodyId point = system.bodies().create(), rod = system.bodies().create();
  (void)system.particles().create(point, {0, 0, 0});
  (void)system.particles().create(rod, {0, 0, 0}, 1, {0, 1, 0});
  (void)system.particles().create(rod, {1, 0, 0}, 1, {0, 3, 0});
  EXPECT_EQ(system.bodies().angular_velocity(point), Vec3{});
  expect_near(system.bodies().angular_velocity(rod), {0, 0, 2}, 1e-14);
  EXPECT_THROW(system.bodies().set_angular_velocity(rod, {5, 0, 1}), std::invalid_argument);  // none about its own line
  system.bodies().set_angular_velocity(rod, {0, 0, 1});
  expect_near(system.bodies().angular_velocity(rod), {0, 0, 1}, 1e-14);
}

TEST(Solid, a_static_body_stays_where_its_pose_puts_it_whatever_is_jointed_to_it) {
  System system({.gravity = {}});
  const BodyId post = system.bodies().create(Box{{1, 1, 1}}, {.kind = BodyKind::static_});
  const BodyId door = system.bodies().create(Box{{1, 1, 1}}, {.position = {1, 0, 0}});
  const ConstraintId hinge = system.joints().create(JointSpec{.a = door, .b = post, .at = {0.5, 0, 0}});
  (void)system.step(0.01);
  system.bodies().set_pose(post, {0, 2, 0}, {});
  (void)system.step(0.01);
  expect_near(system.bodies().center_of_mass(post), {0, 2, 0}, 1e-12);
  EXPECT_LT(system.joints().state(hinge).gap, 1e-9);
  EXPECT_GT(system.bodies().center_of_mass(door).y, 1);
}

TEST(Solid, is_damped_as_one_whatever_points_carry_it) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system({.gravity = {}, .mode = mode});
    const BodyId box = system.bodies().create(
        Box{{1, 2, 3}},
        {.velocity = {1, 2, 3}, .spin = {0, 0, 0.2}, .attachments = {{0.5, 1, 0}, {-0.5, -1, 1}}, .damping = 0.7});
    const ParticleId far = system.particles().create(system.bodies().create(), {9, 9, 9});
    for (const ParticleId held : system.bodies().attachments(box))  // and so in its basis
      system.bonds().create(held, far, SpringLaw{.stiffness = 1e-9});
    for (int i = 0; i < 200; ++i) (void)system.step(0.005);
    expect_near(system.bodies().velocity(box), std::exp(-0.7) * Vec3{1, 2, 3}, 1e-8);
    if (mode == IntegrationMode::energy_keeping) {
      expect_near(system.bodies().angular_velocity(box), {0, 0, 0.2 * std::exp(-0.7)}, 1e-5);
    }
  }
}

TEST(Solid, a_pose_moves_all_that_hangs_on_it) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(Box{}, {.attachments = {{0.5, 0, 0}}});
  const BodyId b = system.bodies().create(Box{}, {.position = {1, 0, 0}, .attachments = {{-0.5, 0, 0}}});
  (void)system.edits().combine(system.bodies().attachments(a)[0], system.bodies().attachments(b)[0]);
  system.bodies().set_pose(a, {0, 5, 0}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)});  // a quarter turn about z
  expect_near(system.bodies().center_of_mass(a), {0, 5, 0}, 1e-13);
  expect_near(system.bodies().center_of_mass(b), {0, 6, 0}, 1e-13);
  EXPECT_LT(system.worst_gap(), 1e-12);
  EXPECT_NEAR(system.bodies().orientation(a).z, std::sqrt(0.5), 1e-13);
  EXPECT_THROW(system.bodies().set_pose(a, {}, {0, 0, 0, 0}), std::invalid_argument);
}

TEST(Solid, a_pose_turns_the_motion_along) {
  System system({.gravity = {}});
  const BodyId body = system.bodies().create(Box{{1, 2, 3}}, {.velocity = {1, 2, 3}, .spin = {3, 0, 0}});
  const double energy = system.energy().kinetic;
  system.bodies().set_pose(body, {}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  expect_near(system.bodies().velocity(body), {1, 2, 3}, 1e-12);
  expect_near(system.bodies().angular_velocity(body), {0, 3, 0}, 1e-12);
  EXPECT_NEAR(system.energy().kinetic, energy, 1e-9 * energy);
}

TEST(Solid, combining_solids_adds_mass_and_inertia_and_keeps_momenta) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(Box{{1, 1, 1}}, {.mass = 2, .velocity = {1, 0, 0}, .spin = {0, 0, 1}});
  const BodyId b = system.bodies().create(Sphere{0.5}, {.mass = 3, .position = {2, 0, 0}, .velocity = {0, 1, 0}});
  const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
  const double energy = system.energy().kinetic;
  const RestructureReport report = system.edits().combine(a, b);
  EXPECT_NEAR(system.bodies().mass(a), 5, 1e-13);
  const double box = 2.0 / 6, ball = 0.4 * 3 * 0.25, reduced = 2.0 * 3 / 5 * 4;
  expect_diagonal(system.bodies().inertia(a), {box + ball, box + ball + reduced, box + ball + reduced}, 1e-12);
  expect_near(system.momentum(), momentum, 1e-12);
  expect_near(system.angular_momentum(), angular, 1e-12);
  EXPECT_NEAR(report.energy_change, system.energy().kinetic - energy, 1e-13);
  EXPECT_LT(report.energy_change, 0);
  EXPECT_EQ(system.bodies().solids(a).size(), 2u);
  expect_near(system.bodies().solids(a)[1].position, {2, 0, 0}, 1e-12);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Solid, snapshot_and_replay_keep_shapes) {
  System system;
  system.record().start();
  const BodyId body =
      system.bodies().create(box_mesh({0, 0, 0}, {1, 1, 2}), {.spin = {1, 2, 3}, .attachments = {{0, 0, 0}}});
  system.particles().nail(system.bodies().attachments(body)[0]);
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  const Recording recording = system.record().stop();
  EXPECT_EQ(system.record().replay(recording), std::nullopt);
  const auto solids = system.bodies().solids(body);
  ASSERT_EQ(solids.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(solids[0].shape).triangles.size(), 12u);
}

TEST(HalfSpace, is_the_shape_of_a_body_that_stays_where_it_is) {
  System system;
  const BodyId ground = system.bodies().create(HalfSpace{}, {.position = {0, 1, 0}, .kind = BodyKind::static_});
  ASSERT_EQ(system.bodies().solids(ground).size(), 1u);
  EXPECT_EQ(system.bodies().solids(ground)[0].shape, Shape{HalfSpace{}});
  EXPECT_LT(norm(system.bodies().solids(ground)[0].position - Vec3{0, 1, 0}), 1e-12);
  system.bodies().set_pose(ground, {0, 2, 0}, {});
  EXPECT_LT(norm(system.bodies().solids(ground)[0].position - Vec3{0, 2, 0}), 1e-12);

  const BodyId ball = system.bodies().create(Sphere{0.5}, {.position = {0, 3, 0}});
  system.joints().create(SurfacePairSpec{
      .a = ball, .b = ground, .surface_a = {Sphere{0.5}, {0, 3, 0}, {}}, .surface_b = {HalfSpace{}, {0, 2, 0}, {}}});
  for (int i = 0; i < 300; ++i) (void)system.step(0.01);
  EXPECT_NEAR(system.bodies().center_of_mass(ball).y, 2.5, 1e-6);
}

TEST(HalfSpace, has_no_mass_and_cannot_move) {
  System system;
  EXPECT_THROW((void)mass_properties(HalfSpace{}), std::invalid_argument);
  EXPECT_THROW((void)system.bodies().create(HalfSpace{}), std::invalid_argument);
  const BodyId wall = system.bodies().create(HalfSpace{{1, 0, 0}}, {.kind = BodyKind::static_});
  const BodyId box = system.bodies().create(Box{}, {.position = {2, 0, 0}});
  EXPECT_THROW(system.bodies().set_kind(wall, BodyKind::dynamic), std::invalid_argument);
  system.bodies().set_active(wall, false);
  system.bodies().set_active(wall, true);
  EXPECT_EQ(system.bodies().kind(wall), BodyKind::static_);
  EXPECT_TRUE(system.validate().empty());
  (void)system.edits().combine(box, wall);
  EXPECT_EQ(system.bodies().kind(box), BodyKind::static_) << "what is combined with it does not move either";
  system.bodies().set_active(box, false);
  const BodyId ball = system.bodies().create(Sphere{}, {.position = {5, 0, 0}});
  EXPECT_THROW((void)system.edits().combine(ball, box), std::invalid_argument);
  EXPECT_THROW((void)system.edits().combine(box, ball), std::invalid_argument);
  EXPECT_TRUE(system.validate().empty());
}

}  // namespace
}  // namespace iota
