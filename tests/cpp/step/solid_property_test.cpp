// SPDX-License-Identifier: Apache-2.0
// Random edits of worlds of solids: the structure stays whole, momenta are kept, the energy book adds up.
#include "energy_book.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota {
namespace {

class Playground {
 public:
  explicit Playground(unsigned seed, const Vec3& gravity = {}) : system({.gravity = gravity}), random_(seed) {
    for (int i = 0; i < 6; ++i) add_solid();
    const BodyId molecule = system.bodies().create();
    ParticleId last{};
    for (int i = 0; i < 6; ++i) {
      const ParticleId atom =
          system.particles().create(molecule, {0.5 * i, number(-1, 1), number(-1, 1)}, number(0.5, 2));
      if (i > 0) (void)system.cosmetic_bonds().create(last, atom);
      last = atom;
    }
  }

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  template <class Id>
  Id any(const std::vector<Id>& ids) {
    return ids[std::uniform_int_distribution<std::size_t>(0, ids.size() - 1)(random_)];
  }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  void add_solid() {
    const std::array<Shape, 4> shapes{Sphere{number(0.1, 0.5)}, Box{{number(0.1, 1), number(0.1, 1), number(0.1, 1)}},
                                      Cylinder{number(0.05, 0.3), number(0.2, 1)}, Torus{0.4, 0.1}};
    const auto which = static_cast<std::size_t>(number(0, 3.999));
    (void)system.bodies().create(shapes[which], {.mass = number(0.3, 3),
                                                 .position = vector(3),
                                                 .orientation = {number(-1, 1), number(-1, 1), number(-1, 1), 1.5},
                                                 .velocity = vector(1),
                                                 .spin = vector(2),
                                                 .attachments = {vector(0.6), vector(0.6)}});
  }

  /// Edits that must keep momentum and angular momentum, unless the report says otherwise.
  RestructureReport edit() {
    const BodyId body = any(system.bodies().ids());
    switch (static_cast<int>(number(0, 5))) {
      case 0:
        return system.edits().combine(any(system.particles().ids()), any(system.particles().ids()),
                                      number(0, 1) < 0.3 ? 0.05 : 0.0);
      case 1: return system.edits().separate(any(system.particles().ids()), any(system.particles().ids()));
      case 2: return system.edits().combine(body, any(system.bodies().ids()));
      case 3: return system.edits().separate(body, any(system.bodies().parts(body)));
      default: {
        const auto bonds = system.cosmetic_bonds().ids();
        if (!bonds.empty()) return system.cosmetic_bonds().destroy(any(bonds));
        const auto particles = system.bodies().particles(body);
        if (particles.size() > 1 && particles[0] != particles.back())
          (void)system.cosmetic_bonds().create(particles[0], particles.back());
        return {};
      }
    }
  }

  /// Edits that take away or bring what they like.
  void upset() {
    const BodyId body = any(system.bodies().ids());
    switch (static_cast<int>(number(0, 17))) {
      case 0: system.bodies().set_active(body, !system.bodies().is_active(body)); break;
      case 1: {
        const ParticleId p = any(system.particles().ids());
        system.particles().set_active(p, !system.particles().is_active(p));
        break;
      }
      case 2: system.bodies().set_velocity(body, vector(1)); break;
      case 3: system.bodies().set_angular_velocity(body, vector(1)); break;
      case 4:
        if (system.bodies().ids().size() < 12) add_solid();
        break;
      case 5: (void)system.bodies().create_attachment(body, system.bodies().center_of_mass(body) + vector(0.5)); break;
      case 6: {
        const ParticleId p = any(system.particles().ids());
        if (system.particles().is_nailed(p))
          system.particles().release(p);
        else
          system.particles().nail(p);
        break;
      }
      case 7:
      case 8: join(body); break;
      case 9:
        if (const auto joints = system.joints().ids(); !joints.empty()) system.joints().destroy(any(joints));
        break;
      case 10: {
        const ParticleId p = any(system.particles().ids()), q = any(system.particles().ids());
        if (p != q) (void)system.bonds().create(p, q, SpringLaw{5, 0.1, 0.3});
        break;
      }
      case 11:
        if (const auto bonds = system.bonds().ids(); !bonds.empty()) system.bonds().destroy(any(bonds));
        break;
      case 12: system.particles().set_position(any(system.particles().ids()), vector(2)); break;
      case 13: system.particles().set_velocity(any(system.particles().ids()), vector(2)); break;
      case 14: system.particles().set_mass(any(system.particles().ids()), number(0.1, 2)); break;
      case 15: {
        constexpr std::array kinds{BodyKind::static_, BodyKind::dynamic, BodyKind::dynamic, BodyKind::resting};
        system.bodies().set_kind(body, kinds[static_cast<std::size_t>(number(0, 3.99))]);
        break;
      }
      default:
        system.bodies().set_pose(body, system.bodies().center_of_mass(body) + vector(0.2),
                                 {number(-1, 1), 0.3, 0.1, 1});
    }
  }

  void join(BodyId body) {
    constexpr std::array kinds{ConstraintKind::revolute, ConstraintKind::ball, ConstraintKind::weld,
                               ConstraintKind::cylindrical, ConstraintKind::universal};
    JointSpec joint{
        .a = body, .b = any(system.bodies().ids()), .at = system.bodies().center_of_mass(body), .axis = vector(1)};
    joint.kind = kinds[static_cast<std::size_t>(number(0, 4.99))];
    joint.second_axis = cross(joint.axis, vector(1));
    if (joint.kind == ConstraintKind::revolute && number(0, 1) < 0.5) joint.angle.stiffness = 3;
    if (number(0, 1) < 0.2) joint.b = {};
    (void)system.joints().create(joint);
  }

  System system;

 private:
  std::mt19937 random_;
};

TEST(SolidProperty, random_edits_keep_the_structure_whole_and_momenta_where_they_say_so) {
  int kept = 0, edits = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Playground world(seed);
    System& system = world.system;
    for (int i = 0; i < 30; ++i) {
      const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
      const double energy = system.energy().total();
      try {
        const RestructureReport report = world.edit();
        ++edits;
        const double scale = 1 + norm(momentum) + norm(angular);
        EXPECT_LT(norm(system.momentum() - momentum - report.momentum_change), 1e-8 * scale) << seed << ' ' << i;
        EXPECT_LT(norm(system.angular_momentum() - angular - report.angular_momentum_change), 1e-8 * scale)
            << seed << ' ' << i;
        EXPECT_NEAR(system.energy().total() - energy, report.energy_change, 1e-9 * (1 + std::abs(energy)))
            << seed << ' ' << i;
        kept += norm(report.momentum_change) < 1e-8 * scale;
      } catch (const std::invalid_argument&) {  // what cannot be is refused, and changes nothing
        EXPECT_EQ(system.momentum(), momentum);
      }
      ASSERT_TRUE(system.validate().empty()) << "seed " << seed << " edit " << i << ": " << system.validate()[0];
      const StepReport report = system.step(0.01);
      ASSERT_TRUE(std::isfinite(report.energy.kinetic)) << seed << ' ' << i;
    }
  }
  EXPECT_GT(edits, 800);
  EXPECT_GT(kept, edits * 95 / 100);
}

TEST(SolidProperty, the_energy_book_adds_up_through_any_edits) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    Playground world(seed, {0, seed % 2 ? -9.81 : 0, 0});
    System& system = world.system;
    double largest = 0;
    for (int i = 0; i < 30; ++i) {
      try {
        if (i % 2)
          (void)world.edit();
        else
          world.upset();
      } catch (const std::invalid_argument&) {
      }
      ASSERT_TRUE(system.validate().empty()) << "seed " << seed << " edit " << i << ": " << system.validate()[0];
      ASSERT_NEAR(book(system), 0, 1e-6 * (1 + largest)) << "seed " << seed << " edit " << i;
      (void)system.step(0.01);
      largest = std::max(largest, std::abs(system.energy().kinetic));
      ASSERT_NEAR(book(system), 0, 1e-6 * (1 + largest)) << "seed " << seed << " step " << i;
    }
  }
}

}  // namespace
}  // namespace iota
