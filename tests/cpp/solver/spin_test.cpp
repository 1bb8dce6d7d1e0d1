// SPDX-License-Identifier: Apache-2.0
// Angular momentum of what nothing outside holds, or only one nail.
#include "modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace iota {
namespace {

BodyId add_bar(System& system, const Vec3& from, const Vec3& to) {
  const BodyId body = system.bodies().create();
  system.particles().create(body, from);
  system.particles().create(body, to);
  return body;
}
BodyId add_box(System& system, const Vec3& position, const Vec3& spin, const std::vector<Vec3>& attachments) {
  return system.bodies().create(Box{{0.3, 0.2, 0.1}},
                                {.mass = 1, .position = position, .spin = spin, .attachments = attachments});
}
void turn_all(System& system, const Vec3& spin, const Vec3& center) {
  for (const ParticleId p : system.particles().ids())
    system.particles().set_velocity(p, cross(spin, system.particles().position(p) - center));
}
Vec3 spin_about(const System& system, const Vec3& place) {
  return system.angular_momentum() - cross(place, system.momentum());
}

/// In empty space, 2 s at 60 and 240 Hz: angular momentum about `center` to `tolerance`, and energy that never rises.
template <class Make>
void expect_kept(Make make, const Vec3& center, double tolerance, const std::string& what) {
  for (const IntegrationMode mode : end_point_modes)
    for (const int hertz : {60, 240})
      for (const Vec3& spin : {Vec3{0, 0, 30}, Vec3{10, 20, 20}}) {
        System system{SystemOptions{.gravity = {}, .mode = mode}};
        make(system, spin);
        const Vec3 start = spin_about(system, center);
        double energy = system.energy().total();
        for (int i = 0; i < 2 * hertz; ++i) {
          const double now = system.step(1.0 / hertz).energy.total();
          ASSERT_LE(now, energy * (1 + 1e-9)) << what << " at " << hertz << " Hz, step " << i;
          energy = now;
        }
        EXPECT_LT(norm(spin_about(system, center) - start), tolerance * norm(start))
            << what << " at " << hertz << " Hz";
        EXPECT_EQ(system.energy().made, 0) << what;
      }
}

TEST(Spin, of_two_hinged_boxes_stays_in_the_end_point_modes) {
  const auto make = [](System& system, const Vec3& spin) {
    const Vec3 hinge{0.15, 0.1, 0.05};
    const BodyId a = add_box(system, {}, {}, {hinge}), b = add_box(system, {0.3, 0.2, 0.1}, {}, {-hinge});
    (void)system.edits().combine(system.bodies().particles(a)[4], system.bodies().particles(b)[4]);
    turn_all(system, spin, {0.15, 0.1, 0.05});
  };
  expect_kept(make, {}, 1e-5, "two boxes");
}

TEST(Spin, of_a_free_box_does_not_drift_by_what_each_solution_leaves_unbalanced) {
  for (const IntegrationMode mode : end_point_modes) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    (void)add_box(system, {}, {0, 0, 20}, {});
    for (int i = 0; i < 3; ++i) (void)system.step(1.0 / 60);
    const Vec3 start = spin_about(system, {});
    for (int i = 0; i < 600; ++i) (void)system.step(1.0 / 60);
    EXPECT_LT(norm(spin_about(system, {}) - start), 1e-10 * norm(start));
  }
}

/// Friction acted wherever a contact was in sight, so that both were one piece, which shared the spin of the heavy one.
TEST(Spin, of_a_heavy_ball_moves_nothing_before_it_touches_it) {
  for (const IntegrationMode mode : end_point_modes) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    system.set_usual_material(Material{});
    const BodyId light = system.bodies().create(Sphere{0.1}, {.mass = 1, .position = {0, 0.3, 0}});
    const SolidOptions heavy{.mass = 1e6, .position = {0.03, 0.62, 0}, .velocity = {0, -2, 0}, .spin = {0, 0, 3}};
    (void)system.bodies().create(Sphere{0.13}, heavy);
    for (int i = 0; i < 2; ++i) (void)system.step(1.0 / 60);
    EXPECT_LT(norm(system.bodies().velocity(light)), 1e-6);
  }
}

/// While contacts held bodies, they lost 40 % of it in 2 s.
TEST(Spin, of_what_rolls_or_spins_on_the_ground_stays_in_the_end_point_modes) {
  for (const IntegrationMode mode : end_point_modes)
    for (const double friction : {0.0, 0.5}) {
      System system{SystemOptions{.mode = mode}};
      system.set_usual_material(Material{friction});
      (void)system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
      const bool rolls = friction > 0;
      const Vec3 velocity = rolls ? Vec3{1, 0, 0} : Vec3{}, spin = rolls ? Vec3{0, 0, -10} : Vec3{0, 50, 0};
      const BodyId ball =
          system.bodies().create(Sphere{0.1}, {.position = {0, 0.1, 0}, .velocity = velocity, .spin = spin});
      for (int i = 0; i < 120; ++i) (void)system.step(1.0 / 60);
      EXPECT_LT(norm(system.bodies().velocity(ball) - velocity), 5e-3);
      EXPECT_LT(norm(system.bodies().angular_velocity(ball) - spin), rolls ? 0.1 : 1e-5);
      EXPECT_NEAR(system.bodies().center_of_mass(ball).x, 2 * velocity.x, 1e-2);
    }
}

/// Both were one piece, in which a light body pays with its motion for the spin that a heavy one loses.
TEST(Spin, of_a_heavy_ball_is_not_paid_for_by_the_light_one_that_it_hits) {
  const auto hit = [](IntegrationMode mode, double mass) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    system.set_usual_material(Material{0.5});
    const BodyId light = system.bodies().create(Sphere{0.1}, {.mass = 1, .position = {0, 0.3, 0}});
    const SolidOptions heavy{.mass = mass, .position = {0.03, 0.62, 0}, .velocity = {0, -2, 0}, .spin = {0, 0, 3}};
    const BodyId other = system.bodies().create(Sphere{0.13}, heavy);
    const auto about_origin = [&] {
      Vec3 sum;
      for (const BodyId body : {light, other})
        sum +=
            system.bodies().mass(body) * cross(system.bodies().center_of_mass(body), system.bodies().velocity(body)) +
            system.bodies().angular_momentum(body);
      return sum;
    };
    const Vec3 before = about_origin();
    for (int i = 0; i < 6; ++i) (void)system.step(1.0 / 60);
    EXPECT_LT(norm(about_origin() - before), 1e-10 * norm(before));
    return std::pair{system.bodies().velocity(light), system.bodies().angular_velocity(light)};
  };
  for (const double mass : {10.0, 1e3, 1e6, 1e9}) {
    const auto [velocity, spin] = hit(IntegrationMode::robust, mass);
    const auto [wanted_velocity, wanted_spin] = hit(IntegrationMode::energy_keeping, mass);
    EXPECT_LT(norm(velocity - wanted_velocity), 0.02 * norm(wanted_velocity)) << mass;
    EXPECT_LT(norm(spin - wanted_spin), 0.05 * norm(wanted_spin)) << mass;
  }
}

TEST(Spin, of_a_chain_of_eight_bars_stays_in_the_end_point_modes) {
  for (const double bend : {0.0, 0.06}) {
    const auto make = [bend](System& system, const Vec3& spin) {
      ParticleId last{};
      for (int i = 0; i < 8; ++i) {
        const auto place = [bend](int k) { return Vec3{0.1 * k, bend * (k % 2), 0.3 * bend * (k % 3)}; };
        const std::vector<ParticleId> ends = system.bodies().particles(add_bar(system, place(i), place(i + 1)));
        if (i > 0) (void)system.edits().combine(last, ends[0]);
        last = ends[1];
      }
      turn_all(system, spin, {0.4, 0, 0});
    };
    expect_kept(make, {}, 1e-4, bend == 0 ? "a straight chain" : "a zigzag chain");
  }
}

std::vector<Vec3> ring_of(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    points.push_back({std::cos(angle), 0, std::sin(angle)});
  }
  return points;
}

/// Symmetric, so that masses cancel: lumped ones are zero, by which no guess may be divided, and about a principal axis energy
/// has no slope, along which none can be returned (a T jumped by up to 0.1 rad at a time for that, and gained 1e-3).
TEST(Spin, of_regular_bodies_about_a_principal_axis_is_steady) {
  const std::vector<Vec3> cross{{0, -1, 0}, {0, 1, 0}, {0.3, 0, 0}, {-0.3, 0, 0}};
  const std::vector<Vec3> t{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, -1, 0}};
  std::vector<Vec3> octahedron{{0, 1, 0}, {0, -1, 0}}, hub = ring_of(4);
  for (const Vec3& at : ring_of(4)) octahedron.push_back(at);
  hub.push_back({});
  for (const IntegrationMode mode : all_modes)
    for (const std::vector<Vec3>& points : {cross, t, ring_of(3), ring_of(4), ring_of(5), ring_of(6), hub, octahedron})
      for (const double size : {1e-6, 1.0, 1e3})
        for (const double speed : {0.3, 5.0, 30.0}) {
          System system{SystemOptions{.gravity = {}, .mode = mode}};
          Vec3 center;
          for (const Vec3& at : points) center += (size / static_cast<double>(points.size())) * at;
          const BodyId body = system.bodies().create();
          for (const Vec3& at : points) system.particles().create(body, size * at, 0.1);
          turn_all(system, {0, speed, 0}, center);
          const double energy = system.energy().total();
          const std::string scene = std::to_string(points.size()) + " points, " + std::to_string(size) + " m, " +
                                    std::to_string(speed) + " rad/s, mode " + std::to_string(static_cast<int>(mode));
          for (int i = 0; i < 60; ++i) {
            const StepReport report = system.step(1.0 / 60);
            ASSERT_EQ(report.unconverged, 0) << scene;
            ASSERT_LE(report.energy.total(), energy * (1 + 1e-9)) << scene << ", step " << i;
          }
          const Vec3 change = system.bodies().angular_velocity(body) - Vec3{0, speed, 0};
          EXPECT_LT(norm(change), 1e-6 * speed) << scene;
          EXPECT_EQ(system.energy().made, 0) << scene;
        }
}

/// Of two boxes, one of which turns: momenta in energy_keeping also where a row has no exact discrete gradient, as an angle.
TEST(Spin, of_joined_boxes_stays_in_energy_keeping) {
  for (const ConstraintKind kind :
       {ConstraintKind::ball, ConstraintKind::universal, ConstraintKind::revolute, ConstraintKind::cylindrical,
        ConstraintKind::prismatic, ConstraintKind::weld, ConstraintKind::screw, ConstraintKind::planar})
    for (const double size : {1e-3, 1.0, 1e3})
      for (const double mass : {1e-3, 1.0, 1e3}) {
        System system{SystemOptions{.gravity = {}, .mode = IntegrationMode::energy_keeping}};
        const auto box = [&](double m, const Vec3& at, const Vec3& spin) {
          return system.bodies().create(Box{size * Vec3{0.3, 0.2, 0.1}}, {.mass = m, .position = at, .spin = spin});
        };
        JointSpec joint{.kind = kind, .a = box(1, {}, {3, 2, 20}), .at = {0, 0, 0.2 * size}, .axis = {0, 0, 1}};
        joint.b = box(mass, {0, 0, 0.4 * size}, {});
        if (kind == ConstraintKind::screw) joint.lead = 0.1 * size;
        (void)system.joints().create(joint);
        const Vec3 angular = system.angular_momentum(), momentum = system.momentum();
        const double energy = system.energy().total();
        for (int i = 0; i < 60; ++i) ASSERT_EQ(system.step(1.0 / 60).unconverged, 0);
        const std::string scene = std::to_string(static_cast<int>(kind)) + ", " + std::to_string(size) + " m, " +
                                  std::to_string(mass) + " kg";
        EXPECT_LT(norm(system.angular_momentum() - angular), 1e-8 * norm(angular)) << scene;
        EXPECT_LT(norm(system.momentum() - momentum), 1e-8 * std::sqrt(energy * (1 + mass))) << scene;
        EXPECT_LE(system.energy().total(), energy * (1 + 1e-9)) << scene;
      }
}

/// The gradients of a stop and of a gear on the same angle are parallel.
TEST(Spin, of_gears_in_a_frame_stays_also_where_they_meet_a_stop) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::accurate})
    for (const double limit : {0.3, std::numeric_limits<double>::infinity()}) {
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      const auto box = [&](double m, const Vec3& at, const Vec3& spin) {
        return system.bodies().create(Box{{0.4, 0.3, 0.2}}, {.mass = m, .position = at, .spin = spin});
      };
      const BodyId wheel = box(1, {}, {2, -3, 6}), other = box(1, {0.8, 0, 0}, {-4, 1, 2}),
                   arm = box(0.5, {1.6, 0, 0}, {3, 1, -5}), frame = box(2, {0.4, 0, 1}, {});
      (void)system.joints().create(
          JointSpec{.kind = ConstraintKind::ball, .a = other, .b = arm, .at = {1.2, 0.05, 0.1}});
      const auto axle = [&](BodyId body, double x) {
        return system.joints().create(JointSpec{
            .a = frame, .b = body, .at = {x, 0, 0}, .axis = {0, 0, 1}, .angle = {.lower = -limit, .upper = limit}});
      };
      CouplingSpec gears;
      const ConstraintId first = axle(wheel, 0);
      gears.terms = {{first, JointCoordinate::angle, 1}, {axle(other, 0.8), JointCoordinate::angle, 2}};
      (void)system.joints().create(gears);
      (void)system.step(1e-5);  // to velocities of gears
      const Vec3 angular = system.angular_momentum();
      double turned = 0;
      for (int i = 0; i < 90; ++i) {
        (void)system.step(1.0 / 120);
        turned = std::max(turned, std::abs(system.joints().state(first).coordinate[0]));
      }
      if (limit < 1) EXPECT_NEAR(turned, limit, 1e-6);
      EXPECT_LT(norm(system.angular_momentum() - angular), 1e-10 * norm(angular)) << static_cast<int>(mode);
      EXPECT_LT(system.energy().made, 1e-8 * system.energy().kinetic);
    }
}

/// It stands on a nail, where the end-point rule needs short steps not to gain energy; their guesses were far away.
TEST(Spin, of_a_cross_that_begins_to_fall_converges) {
  for (const IntegrationMode mode : all_modes)
    for (const double size : {1e-9, 1e-6, 1e-3, 1.0, 1e3})
      for (const double mass : {0.1, 1.0, 1e3}) {
        System system{SystemOptions{.gravity = {0, -9.81 * size, 0}, .mode = mode}};
        const BodyId body = system.bodies().create();
        system.particles().nail(system.particles().create(body, {0, -size, 0}, mass));
        for (const Vec3& at : {Vec3{0, 1, 0}, Vec3{0.3, 0, 0}, Vec3{-0.3, 0, 0}})
          system.particles().create(body, size * at, 0.1);
        turn_all(system, {0.1, 0, 0}, {0, -size, 0});
        for (int i = 0; i < 60; ++i)
          ASSERT_EQ(system.step(1.0 / 60).unconverged, 0) << size << " m, " << mass << " kg, step " << i;
      }
}

TEST(Spin, of_a_box_on_a_nail_without_gravity_stays_about_the_nail) {
  const auto make = [](System& system, const Vec3& spin) {
    const Vec3 corner{0.15, 0.1, 0.05};
    system.particles().nail(system.bodies().particles(add_box(system, {}, {}, {corner}))[4]);
    turn_all(system, spin, corner);
  };
  expect_kept(make, {0.15, 0.1, 0.05}, 1e-4, "a box on a nail");
}

/// Its axis is only right to first order, and so is the direction of the spin along it.
TEST(Spin, of_a_rod_about_its_axis_stays_while_it_tumbles) {
  const auto make = [](System& system, const Vec3& spin) {
    const BodyId rod = add_bar(system, {0, 0, 0}, {0.4, 0, 0});
    system.bodies().set_rod(rod, 1, 0.05);
    system.bodies().set_angular_velocity(rod, 0.1 * spin + Vec3{30, 0, 0});
  };
  expect_kept(make, {}, 0.1, "a rod");
}

/// As far as the energy suffices that the step has lost.
TEST(Spin, about_the_vertical_through_a_nail_nearly_stays_in_gravity) {
  for (const IntegrationMode mode : end_point_modes) {
    System system{SystemOptions{.mode = mode}};
    const Vec3 corner{0.15, 0.1, 0.05};
    system.particles().nail(system.bodies().particles(add_box(system, {}, {}, {corner}))[4]);
    turn_all(system, {0, 10, 0}, corner);
    const double start = spin_about(system, corner).y;
    for (int i = 0; i < 240; ++i) (void)system.step(1.0 / 120);
    EXPECT_NEAR(spin_about(system, corner).y, start, 0.01 * std::abs(start));
    EXPECT_EQ(system.energy().made, 0);
  }
}

/// A wheel loses nothing to a distant weight on a spring.
TEST(Spin, of_a_ball_on_a_spring_stays_its_own) {
  for (const IntegrationMode mode : end_point_modes) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    const BodyId ball =
        system.bodies().create(Sphere{0.1}, {.mass = 1, .spin = {0, 0, 30}, .attachments = {{0, 0, 0.05}}});
    const ParticleId weight = system.particles().create(system.bodies().create(), {3, 0, 0.05});
    system.bonds().create(system.bodies().particles(ball)[4], weight, SpringLaw{.stiffness = 1, .length = 3});
    for (int i = 0; i < 120; ++i) (void)system.step(1.0 / 60);
    EXPECT_NEAR(system.bodies().angular_velocity(ball).z, 30, 0.03);
  }
}

/// What springs connect, damped or not: dumbbells of many sizes and masses, and a soft block. A part is lost only where the step
/// loses too little energy: at the start, and while a spring contracts.
TEST(Spin, of_bodies_on_springs_nearly_stays) {
  const auto lost = [](IntegrationMode mode, int hertz, auto make) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    make(system);
    const Vec3 start = system.angular_momentum();
    Energy before = system.energy();
    for (int i = 0; i < 2 * hertz; ++i) {
      const Energy energy = system.step(1.0 / hertz).energy;
      EXPECT_LE(energy.total(), before.total() * (1 + 1e-9)) << "step " << i;
      EXPECT_GE(energy.dissipated, before.dissipated - 1e-12 * energy.total()) << "step " << i;
      before = energy;
    }
    EXPECT_EQ(system.energy().made, 0);
    return norm(system.angular_momentum() - start) / norm(start);
  };
  for (const IntegrationMode mode : end_point_modes)
    for (const int hertz : {60, 240})
      for (const double damping : {0.0, 10.0}) {
        for (const double size : {1e-6, 1.0, 1e3})
          for (const double mass : {1e-6, 1.0}) {
            const auto dumbbell = [&](System& system) {
              std::array<ParticleId, 2> ends;
              for (const int k : {0, 1})
                ends[k] = system.particles().create(system.bodies().create(), Vec3{(k - 0.5) * size, 0, 0}, mass,
                                                    Vec3{0, 5 * (k - 0.5) * size, 0});
              (void)system.bonds().create(
                  ends[0], ends[1], SpringLaw{.stiffness = 100 * mass, .damping = damping * mass, .length = size});
            };
            EXPECT_LT(lost(mode, hertz, dumbbell), 0.02) << size << " m, " << mass << " kg, damping " << damping;
          }
        const auto block = [&](System& system) {
          std::vector<ParticleId> points;
          std::vector<Vec3> places;
          for (int k = 0; k < 27; ++k) {
            places.push_back(0.1 * Vec3{double(k % 3 - 1), double(k / 3 % 3 - 1), double(k / 9 - 1)});
            points.push_back(system.particles().create(system.bodies().create(), places.back(), 0.1));
          }
          for (std::size_t a = 0; a < points.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
              if (const double r = norm(places[a] - places[b]); r < 0.18)
                (void)system.bonds().create(points[a], points[b],
                                            SpringLaw{.stiffness = 1e4, .damping = damping, .length = r});
          turn_all(system, {3, 0, 10}, {});
        };
        EXPECT_LT(lost(mode, hertz, block), 0.01) << "block, damping " << damping;
      }
}

/// On an axle that is fixed or borne by a free frame, centered and not, in sizes and masses of many decades. The momentum of what
/// is free stays.
TEST(Spin, of_a_wheel_on_an_axle_nearly_stays) {
  for (const IntegrationMode mode : end_point_modes)
    for (const auto& [hertz, tolerance] : {std::pair{60, 0.05}, {240, 0.005}})
      for (const double size : {1e-6, 1.0, 1e3})
        for (const double mass : {1e-9, 1.0, 1e6})
          for (const bool is_fixed : {true, false})
            for (const double beside : {0.0, 0.05}) {  // of the center of mass, m
              System system{SystemOptions{.gravity = {}, .mode = mode}};
              const Vec3 axis{0, 1, 0};
              const Vec3 at{beside * size, 0, 0};
              const BodyId wheel = system.bodies().create(Cylinder{0.3 * size, 0.1 * size}, {.mass = mass});
              JointSpec hinge{.kind = ConstraintKind::revolute, .a = wheel, .at = at, .axis = axis};
              if (!is_fixed)
                hinge.b = system.bodies().create(Box{size * Vec3{0.2, 0.2, 2}},
                                                 {.mass = 2 * mass, .position = size * Vec3{0, 0, 0.5}});
              (void)system.joints().create(hinge);
              system.bodies().set_angular_velocity(wheel, 30.0 * axis);
              if (beside > 0) system.bodies().set_velocity(wheel, cross(30.0 * axis, -1.0 * at));
              const Vec3 momentum = system.momentum();
              const auto speed = [&] {
                Vec3 relative = system.bodies().angular_velocity(wheel);
                if (!is_fixed) relative += -1.0 * system.bodies().angular_velocity(hinge.b);
                return dot(relative, axis);
              };
              const double start = speed();
              double energy = system.energy().total();
              for (int i = 0; i < 2 * hertz; ++i) {
                const double now = system.step(1.0 / hertz).energy.total();
                ASSERT_LE(now, energy * (1 + 1e-9));
                energy = now;
              }
              const std::string scene = std::to_string(hertz) + " Hz, " + std::to_string(size) + " m, " +
                                        std::to_string(mass) + " kg" + (is_fixed ? ", fixed" : "") +
                                        (beside > 0 ? ", beside its center" : "");
              // Beside its center a free frame whirls with it, and has its share of what is lost.
              if (is_fixed || beside == 0) EXPECT_NEAR(speed(), start, tolerance * start) << scene;
              if (!is_fixed) EXPECT_LT(norm(system.momentum() - momentum), 1e-6 * mass * size) << scene;
              EXPECT_EQ(system.energy().made, 0) << scene;
            }
}

/// Also if springs connect the frame with others: what the wheel gets back is not given to the whole once more.
TEST(Spin, of_a_wheel_in_a_frame_on_a_spring_is_given_back_once) {
  for (const IntegrationMode mode : end_point_modes)
    for (const int hertz : {60, 240}) {
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      const BodyId wheel = system.bodies().create(Cylinder{0.3, 0.1}, {.mass = 1});
      const BodyId frame =
          system.bodies().create(Box{{0.2, 0.2, 2}}, {.mass = 2, .position = {0, 0, 0.5}, .attachments = {{0, 0, 1}}});
      (void)system.joints().create(
          JointSpec{.kind = ConstraintKind::revolute, .a = wheel, .b = frame, .at = {}, .axis = {0, 1, 0}});
      const ParticleId weight = system.particles().create(system.bodies().create(), {0, 0, 3}, 1, {0.5, 0, 0});
      (void)system.bonds().create(system.bodies().particles(frame)[4], weight,
                                  SpringLaw{.stiffness = 100, .damping = 5, .length = 1.5});
      system.bodies().set_angular_velocity(wheel, {0, 30, 0});
      const Vec3 start = system.angular_momentum();
      for (int i = 0; i < 2 * hertz; ++i) (void)system.step(1.0 / hertz);
      EXPECT_NEAR(norm(system.angular_momentum() - start), 0, 0.05 * norm(start)) << hertz << " Hz";
      EXPECT_EQ(system.energy().made, 0);
    }
}

/// Bodies of two to five particles in random places, hinged in a random order by slow combinations.
TEST(Spin, and_momentum_stay_while_random_bodies_are_brought_together) {
  int closings = 0;
  for (const IntegrationMode mode : all_modes) {
    const bool is_end_point = mode == IntegrationMode::plausible || mode == IntegrationMode::robust;
    const double tolerance = is_end_point ? 1e-5 : 1e-9;  // that of the solve
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      std::mt19937 random(seed);
      const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
      };
      const auto point = [&](double size) {
        return Vec3{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
      };
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      std::vector<BodyId> bodies;
      double scale = 0;  // sum of masses times speeds times places
      const auto count = 2 + random() % 4;
      for (std::size_t i = 0; i < count; ++i) {
        const BodyId body = system.bodies().create();
        const Vec3 center = point(1), velocity = point(1);
        for (std::size_t k = 2 + random() % 4; k > 0; --k) {
          const double mass = uniform(0.5, 2);
          system.particles().create(body, center + point(0.3), mass, velocity + point(0.5));
          scale += mass;
        }
        bodies.push_back(body);
      }
      const Vec3 linear = system.momentum(), angular = system.angular_momentum();
      std::shuffle(bodies.begin() + 1, bodies.end(), random);
      const auto any_of = [&](BodyId body) {
        const auto all = system.bodies().particles(body);
        return all[random() % all.size()];
      };
      for (std::size_t i = 1; i < bodies.size(); ++i)
        (void)system.edits().combine(any_of(bodies[random() % i]), any_of(bodies[i]), uniform(0.05, 0.3)), ++closings;
      bool is_told = false;
      for (int i = 0; i < 40 && !is_told; ++i) {
        const StepReport report = system.step(1.0 / 120);
        for (const std::string& warning : report.warnings)
          is_told = is_told || warning.find("angular momentum") != warning.npos;
        if (is_told) break;
        ASSERT_LT(norm(system.momentum() - linear), 1e-9 * scale) << "seed " << seed << ", step " << i;
        ASSERT_LT(norm(system.angular_momentum() - angular), tolerance * scale) << "seed " << seed << ", step " << i;
      }
      EXPECT_FALSE(is_told) << "seed " << seed;
      EXPECT_EQ(system.edits().closing_count(), 0u);
    }
  }
  EXPECT_GT(closings, 100);
}

/// Two balls that pass each other 10 m apart, pulled together: what they cannot carry is told, the rest kept.
TEST(Spin, that_bodies_in_one_place_cannot_keep_is_reported) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1, {0, 1, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {10, 0, 0}, 1, {0, -1, 0});
  (void)system.edits().combine(p, q, 0.05);
  bool is_told = false;
  for (int i = 0; i < 10; ++i)
    for (const std::string& warning : system.step(1.0 / 60).warnings)
      is_told = is_told || warning.find("angular momentum") != warning.npos;
  EXPECT_TRUE(is_told);
  EXPECT_LT(norm(system.momentum()), 1e-12);
}

}  // namespace
}  // namespace iota
