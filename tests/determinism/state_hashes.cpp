// SPDX-License-Identifier: Apache-2.0
// Prints what a list of scenes ends up as, bit for bit: "scene hash hash ...", a hash each tenth of the run.
// Scenes named NAME@THREADS are to be equal. tools/check_determinism.py builds it with several compilers and compares.
#include "scenes/chain.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

namespace iota {
namespace {

/// The same numbers everywhere: standard distributions differ between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {  // splitmix64, Steele, Lea and Flood 2014
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) { return low + (high - low) * 0x1p-53 * static_cast<double>(next() >> 11); }
  std::size_t index(std::size_t n) { return static_cast<std::size_t>(next() % n); }
  Vec3 point() {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

using Frame = void (*)(System&, Random&, int);
void nothing(System&, Random&, int) {}

/// Runs a scene and prints its line; `frame` is called before each step.
void print(const char* name, System& system, int steps, double dt, Frame frame = nothing) {
  Random random(7);
  std::printf("%s", name);
  for (int i = 0; i < steps; ++i) {
    frame(system, random, i);
    (void)system.step(dt);
    if ((i + 1) % (steps / 10) == 0) std::printf(" %016llx", static_cast<unsigned long long>(system.state_hash()));
  }
  std::printf("\n");
  std::fflush(stdout);
  if (!system.validate().empty()) throw std::runtime_error(name + (": " + system.validate().front()));
}

void print_chain(const char* name, IntegrationMode mode, const scenes::ChainOptions& options) {
  System system({.mode = mode, .damping = 0.05});
  scenes::make_chain(system, options);
  print(name, system, 400, 1.0 / 120);
}

/// A square net of rods with springs across: loops everywhere.
void print_net(const char* name, int n) {
  System system;
  std::vector<ParticleId> knot(static_cast<std::size_t>(n * n));
  const auto join = [&](int a, const Vec3& x, int b, const Vec3& y) {
    const BodyId rod = system.bodies().create();
    const ParticleId ends[] = {system.particles().create(rod, x, 0.1), system.particles().create(rod, y, 0.1)};
    const int at[] = {a, b};
    for (int k = 0; k < 2; ++k) {
      ParticleId& here = knot[static_cast<std::size_t>(at[k])];
      if (here)
        (void)system.edits().combine(here, ends[k]);
      else
        here = ends[k];
    }
  };
  const auto place = [](int i, int k) { return Vec3{0.2 * i, 0, 0.2 * k + 0.01 * i}; };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      if (i + 1 < n) join(i * n + k, place(i, k), (i + 1) * n + k, place(i + 1, k));
      if (k + 1 < n) join(i * n + k, place(i, k), i * n + k + 1, place(i, k + 1));
    }
  for (int i = 0; i + 1 < n; ++i) {
    const auto a = static_cast<std::size_t>(i * n + i), b = static_cast<std::size_t>((i + 1) * n + i + 1);
    system.bonds().create(knot[a], knot[b], SpringLaw{.stiffness = 50, .damping = 0.5});
  }
  system.particles().nail(knot.front());
  system.particles().nail(knot[static_cast<std::size_t>(n - 1)]);
  print(name, system, 60, 1.0 / 60);
}

/// General bodies that fly, hinged, with a hand on one.
void print_bodies() {
  System system({.gravity = {0.3, -9.81, 0.1}});
  Random random(3);
  BodyId last;
  ParticleId end;
  for (int i = 0; i < 12; ++i) {
    const BodyId body = system.bodies().create();
    const Vec3 center{0.5 * i, 0.2 * random.uniform(-1, 1), 0};
    ParticleId first;
    for (int k = 0; k < 5; ++k) {
      const Vec3 place = center + 0.3 * random.point(), velocity = random.point();
      const double mass = random.uniform(0.1, 2);
      const ParticleId p = system.particles().create(body, place, mass, velocity);
      if (k == 0) first = p;
      if (k == 0 && i > 0) (void)system.edits().combine(end, first);
      if (k == 4) end = p;
    }
    last = body;
  }
  system.particles().nail(system.particles().ids().front());
  system.grips().create(last, {0.1, 0, 0}, {3, 1, 2});
  print("bodies", system, 200, 1.0 / 120);
}

/// Joints with limits, motors and friction, ropes, a path and surfaces, on solids of every shape.
void print_joints(const char* name, IntegrationMode mode) {
  System system({.mode = mode});
  const Shape shapes[] = {Box{{0.4, 0.1, 0.2}}, Sphere{0.15}, Cylinder{0.1, 0.5}, Capsule{0.1, 0.3}, Torus{0.2, 0.05}};
  const ConstraintKind kinds[] = {ConstraintKind::revolute,  ConstraintKind::universal, ConstraintKind::cylindrical,
                                  ConstraintKind::prismatic, ConstraintKind::ball,      ConstraintKind::weld};
  BodyId last;
  ParticleId end;
  for (int i = 0; i < 12; ++i) {
    const Vec3 place{0.5 * i, 1 + 0.05 * (i % 3), 0.02 * i};
    const BodyId body =
        system.bodies().create(shapes[i % 5], {.density = 200,
                                               .position = place,
                                               .orientation = {0, 0.05 * i, 0, std::sqrt(1 - 0.0025 * i * i)},
                                               .spin = {0.1, 0.2 * i, 0},
                                               .attachments = {{0.1, 0, 0}}});
    const ParticleId attached = system.bodies().attachments(body).front();
    if (i > 0 && i % 4 != 0) {
      JointSpec joint{
          .kind = kinds[i % 6], .a = last, .b = body, .at = place - Vec3{0.25, 0, 0}, .axis = {0, 0.6, 0.8}};
      if (has_coordinate(joint.kind, JointCoordinate::angle))
        joint.angle.lower = -0.3, joint.angle.upper = 0.4, joint.angle.friction = 0.1;
      if (has_coordinate(joint.kind, JointCoordinate::slide)) joint.slide.motor_speed = 0.2, joint.slide.motor_max = 5;
      (void)system.joints().create(joint);
    } else if (i > 0) {
      (void)system.joints().create(
          DistanceSpec{.kind = i % 8 ? ConstraintKind::rope : ConstraintKind::rod, .p = end, .q = attached});
    }
    if (i == 0) system.particles().nail(attached);
    last = body, end = attached;
  }
  PathSpec path{.particle = end};
  for (int i = 0; i < 8; ++i)
    path.points.push_back(system.particles().position(end) + Vec3{0.1 * i, -0.05 * i * i, 0.02 * i});
  (void)system.joints().create(path);
  for (const ParticleId p : system.particles().ids())
    if (system.particles().mass(p) == 0)
      (void)system.joints().create(
          SurfaceSpec{.kind = ConstraintKind::outside, .particle = p, .surface = {HalfSpace{}, {0, 0.2, 0}, {}}});
  print(name, system, 120, 1.0 / 120);
}

/// Many bodies on threads, with laws that are expressions.
void print_crowd(const char* name, int threads) {
  System system({.threads = threads});
  const LawId law = system.laws().create("energy = k * (r - l)^2 / 2 + c * exp(-r) * sin(3 * r)",
                                         {.name = "bumpy", .parameters = {{"k", 30}, {"l", 0.3}, {"c", 2}}});
  const LawId pair = system.laws().find("lennard_jones");
  for (int c = 0; c < 60; ++c) {
    const auto chain = scenes::make_chain(
        system,
        {.links = 8, .nailed = c % 2 == 0, .top = {0.7 * (c % 8), 0, 0.7 * (c / 8)}, .direction = {0.6, 0.8, 0}});
    system.bonds().create(chain.upper[0], chain.lower[5], SharedLaw{law, {}, {}});
    system.bonds().create(chain.upper[1], chain.lower[7], SharedLaw{pair, {}, c % 3 != 0});
  }
  print(name, system, 60, 1.0 / 120, [](System& s, Random& random, int) {
    const auto particles = s.particles().ids();
    const ParticleId p = particles[random.index(particles.size())], q = particles[random.index(particles.size())];
    try {
      random.index(2) ? (void)s.edits().combine(p, q, 0.05) : (void)s.edits().separate(p, s.particles().ring(p).back());
    } catch (const std::invalid_argument&) {  // closing already
    }
  });
}

/// Everything that restructuring knows, every frame.
void print_restless(IntegrationMode mode, const char* name) {
  System system({.mode = mode, .damping = 0.1});
  scenes::make_chain(system, {.links = 12});
  for (int i = 0; i < 8; ++i) {
    const BodyId body = system.bodies().create();
    for (int k = 0; k <= i % 5; ++k)
      system.particles().create(body, Vec3{0.3 * i, 0.2 * k, 0.1 * (k * i % 3)}, 0.2 + k);
  }
  print(name, system, 300, 1.0 / 60, [](System& s, Random& random, int step) {
    const auto particles = s.particles().ids();
    const ParticleId p = particles[random.index(particles.size())], q = particles[random.index(particles.size())];
    try {
      switch (random.index(12)) {
        case 0:
        case 1: (void)s.edits().combine(p, q); break;
        case 2: (void)s.edits().combine(p, q, 0.1); break;
        case 3:
        case 4: {
          const auto ring = s.particles().ring(p);
          (void)s.edits().separate(p, ring[random.index(ring.size())]);
          break;
        }
        case 5: (void)s.edits().separate(p, q); break;
        case 6: (void)s.edits().combine(s.particles().body(p), s.particles().body(q)); break;
        case 7: s.particles().is_nailed(p) ? s.particles().release(p) : s.particles().nail(p); break;
        case 8: s.bonds().create(p, q, SpringLaw{.stiffness = 20, .damping = 0.2}); break;
        case 9: s.particles().set_velocity(p, random.point()); break;
        case 10:
          if (const auto bonds = s.bonds().ids(); !bonds.empty()) s.bonds().destroy(bonds[random.index(bonds.size())]);
          break;
        default: {
          const BodyId body = s.bodies().create();
          for (int k = 0; k <= step % 5; ++k) {
            const Vec3 place = random.point();  // one after the other: compilers order arguments as they like
            s.particles().create(body, place, random.uniform(0.01, 10));
          }
        }
      }
    } catch (const std::invalid_argument&) {
      // Two particles of one body at one place, particles that are closing already: refused alike everywhere.
    }
  });
}

/// Forces of every make: expressions implicit and held, fields, noise, pairs with cell lists.
void print_cloud() {
  System system;
  Random random(5);
  std::vector<ParticleId> particles;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 place = 6 * random.point(), velocity = random.point();
    particles.push_back(system.particles().create(system.bodies().create(), place, random.uniform(0.5, 2), velocity));
  }
  const LawId law =
      system.laws().create("energy = a*exp(-r)*(r - 1)^2 + 0.1*cos(3*r); force = -tanh(v)", {"", {{"a", 5}}});
  for (std::size_t i = 0; i < 200; i += 2)
    system.bonds().create(particles[i], particles[i + 1], SharedLaw{law, {}, i % 4 == 0});
  system.fields().create("current", {"", {{"drag", 0.3}}, {}, false});
  system.fields().create("fx = -0.1*x*pow(abs(x), 0.3); fy = 9.81*m - 0.1*y; fz = -log(1 + z^2)*sign(z)");
  system.pairs().create({system.laws().find("morse"), {{"length", 0.3}, {"width", 4}}, {}}, {.cutoff = 0.9});
  print("cloud", system, 50, 1.0 / 120);
}

}  // namespace
}  // namespace iota

int main() {
  using namespace iota;
  const double c = std::numbers::sqrt2 / 2;
  print_chain("chain_energy_keeping", IntegrationMode::energy_keeping, {.links = 24});
  print_chain("chain_robust", IntegrationMode::robust, {.links = 24});
  print_chain("rods", IntegrationMode::energy_keeping, {.links = 64, .rods = true, .direction = {c, c, 0}});
  print_chain("heavy_end", IntegrationMode::energy_keeping, {.links = 16, .heavy_end = 1000});
  print_chain("free_flight", IntegrationMode::energy_keeping, {.links = 8, .nailed = false});
  print_net("net", 6);
  print_bodies();
  print_joints("joints_energy_keeping", IntegrationMode::energy_keeping);
  print_joints("joints_robust", IntegrationMode::robust);
  print_crowd("crowd@1", 1);
  print_crowd("crowd@2", 2);
  print_crowd("crowd@4", 4);
  print_cloud();
  print_restless(IntegrationMode::energy_keeping, "restless_energy_keeping");
  print_restless(IntegrationMode::robust, "restless_robust");
}
