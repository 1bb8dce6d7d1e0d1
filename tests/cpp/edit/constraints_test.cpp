// SPDX-License-Identifier: Apache-2.0
// Random constraints of every kind among random bodies, through random edits: whole, finite, the same again.

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota {
namespace {

struct JointedWorld {
  std::mt19937_64 random;
  System system;
  int made = 0, refused = 0;

  double uniform(double low, double high) {  // the standard distributions differ between libraries
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  }
  std::size_t index(std::size_t n) { return random() % n; }
  Vec3 point() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }

  JointedWorld(std::uint64_t seed, IntegrationMode mode) : random(seed), system({.mode = mode, .damping = 0.1}) {
    for (int i = 0; i < 10; ++i) add_body();
  }
  void add_body() {
    const bool is_fixed = index(8) == 0;
    const BodyId body = system.bodies().create({.kind = is_fixed ? BodyKind::static_ : BodyKind::dynamic});
    const std::size_t count = 1 + index(5);
    for (std::size_t i = 0; i < count; ++i)
      system.particles().create(body, point(), std::pow(10, uniform(-1, 1)), is_fixed ? Vec3{} : point());
  }
  BodyId any_body() {
    const auto all = system.bodies().ids();
    return all[index(all.size())];
  }
  ParticleId any_particle() {
    const auto all = system.particles().ids();
    return all[index(all.size())];
  }
  CoordinateOptions any_options() {
    CoordinateOptions o;
    if (index(3) == 0) o.lower = uniform(-2, 0), o.upper = uniform(0, 2);
    if (index(3) == 0) o.motor_speed = uniform(-3, 3), o.motor_max = uniform(0, 20);
    if (index(3) == 0) o.friction = uniform(0, 5);
    if (index(3) == 0) o.stiffness = uniform(0, 100), o.damping = uniform(0, 5), o.rest = uniform(-1, 1);
    return o;
  }
  Surface any_surface() {
    const Shape shapes[] = {HalfSpace{point()}, Sphere{uniform(0.1, 2)}, Ellipsoid{{2, 1, 1.4}}, Box{{1, 2, 1}},
                            Cylinder{0.5, 1},   Capsule{0.3, 1},         Torus{1, 0.2},          Cone{0.5, 1}};
    return {shapes[index(std::size(shapes))], point(), {}};
  }

  Surface any_convex() {
    const Shape shapes[] = {HalfSpace{point()}, Sphere{uniform(0.1, 0.5)}, Ellipsoid{{0.6, 0.4, 0.2}}};
    return {shapes[index(std::size(shapes))], point(), {}};
  }

  void make_constraint() {
    const auto kind = static_cast<ConstraintKind>(index(20));
    const BodyId world_or_body = index(3) == 0 ? BodyId{} : any_body();
    BreakLimits breaks;
    if (index(4) == 0) breaks = {uniform(1, 1000), uniform(1, 1000)};
    switch (kind) {
      case ConstraintKind::rod:
      case ConstraintKind::rope:
        system.joints().create(DistanceSpec{.kind = kind, .p = any_particle(), .q = any_particle(), .breaks = breaks});
        break;
      case ConstraintKind::span:
        system.joints().create(SpanSpec{any_particle(), any_particle(), any_options(), breaks});
        break;
      case ConstraintKind::coupling: {
        const auto joints = system.joints().ids();
        std::vector<CoupledCoordinate> terms;
        for (const ConstraintId joint : joints)
          for (const JointCoordinate which : joint_coordinates)
            if (index(joints.size()) < 2 && has_coordinate(system.joints().state(joint).kind, which))
              terms.push_back({joint, which, uniform(-2, 2)});
        system.joints().create(CouplingSpec{.terms = terms, .breaks = breaks});
        break;
      }
      case ConstraintKind::tackle:
        system.joints().create(
            TackleSpec{.points = {any_particle(), any_particle(), any_particle()}, .breaks = breaks});
        break;
      case ConstraintKind::path:
        system.joints().create(PathSpec{.particle = any_particle(),
                                        .body = world_or_body,
                                        .curve = index(2) ? CurveKind::spline : CurveKind::polyline,
                                        .points = {point(), point(), point(), point()},
                                        .closed = index(2) == 0,
                                        .slide = any_options(),
                                        .breaks = breaks});
        break;
      case ConstraintKind::surface:
      case ConstraintKind::inside:
      case ConstraintKind::outside:
        system.joints().create(SurfaceSpec{kind, any_particle(), world_or_body, any_surface(), breaks});
        break;
      case ConstraintKind::touching:
      case ConstraintKind::apart:
        system.joints().create(SurfacePairSpec{kind, any_body(), world_or_body, any_convex(), any_convex(), breaks});
        break;
      default: {
        const BodyId a = any_body();
        JointSpec spec{.kind = kind, .a = a, .b = world_or_body, .axis = point(), .breaks = breaks};
        spec.at = index(2) ? system.particles().position(system.bodies().particles(a)[0]) : point();
        spec.lead = uniform(-1, 1);
        if (has_coordinate(kind, JointCoordinate::angle)) spec.angle = any_options();
        if (has_coordinate(kind, JointCoordinate::slide)) spec.slide = any_options();
        system.joints().create(spec);
      }
    }
    ++made;
  }

  void edit() {
    const auto constraints = system.joints().ids();
    const ParticleId p = any_particle(), q = any_particle();
    try {
      switch (index(14)) {
        case 0:
        case 1:
        case 2:
        case 3:
        case 4: make_constraint(); break;
        case 5: (void)system.edits().combine(p, q); break;
        case 6: (void)system.edits().separate(p, q); break;
        case 7: (void)system.edits().combine(system.particles().body(p), system.particles().body(q)); break;
        case 8:
          system.particles().is_nailed(p) ? system.particles().release(p)
          : index(4) == 0                 ? system.particles().nail(p)
                                          : void();
          break;
        case 9:
          if (!constraints.empty()) system.joints().destroy(constraints[index(constraints.size())]);
          break;
        case 10:
          if (!constraints.empty()) system.joints().set_active(constraints[index(constraints.size())], index(2) == 0);
          break;
        case 11:
          if (!constraints.empty()) {
            const auto which = static_cast<JointCoordinate>(index(2));
            system.joints().set_coordinate(constraints[index(constraints.size())], which, any_options());
          }
          break;
        case 12: (void)system.particles().create(system.particles().body(p), system.particles().position(q), 0); break;
        default:
          if (system.bodies().ids().size() > 8)
            index(2) ? system.particles().destroy(p) : system.bodies().destroy(system.particles().body(q));
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
    while (system.bodies().ids().size() < 6) add_body();
  }
};

TEST(RandomConstraints, keep_the_structure_whole_and_finite_through_random_edits) {
  int made = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    JointedWorld world(seed, seed % 2 ? IntegrationMode::energy_keeping : IntegrationMode::robust);
    for (int i = 0; i < 80; ++i) {
      world.edit();
      ASSERT_EQ(world.system.validate(), std::vector<std::string>{}) << "seed " << seed << " edit " << i;
      if (i % 4) continue;
      const Energy before = world.system.energy();
      const StepReport report = world.system.step(1.0 / 60);
      ASSERT_TRUE(std::isfinite(report.energy.total())) << "seed " << seed << " edit " << i;
      for (const ParticleId p : world.system.particles().ids())
        ASSERT_TRUE(is_finite(world.system.particles().position(p)) && is_finite(world.system.particles().velocity(p)))
            << "seed " << seed << " edit " << i;
      ASSERT_LT(report.energy.kinetic, 1e4 + 100 * before.kinetic) << "seed " << seed << " edit " << i;
      for (const ConstraintId c : world.system.joints().ids())
        ASSERT_TRUE(is_finite(world.system.joints().state(c).force)) << "seed " << seed << " edit " << i;
    }
    made += world.made;
  }
  EXPECT_GT(made, 150) << "most of what was asked for was possible";
}

TEST(RandomConstraints, replay_to_the_same_bits) {
  JointedWorld world(7, IntegrationMode::energy_keeping);
  world.system.record().start();
  for (int i = 0; i < 60; ++i) {
    world.edit();
    (void)world.system.step(1.0 / 60);
  }
  const Recording recording = world.system.record().stop();
  System other;
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
  EXPECT_EQ(other.state_hash(), world.system.state_hash());
}

}  // namespace
}  // namespace iota
