// SPDX-License-Identifier: Apache-2.0
#include "scenes/promises.h"

#include "base/text.h"
#include "math/mat3.h"
#include "scenes/chain.h"
#include "scenes/dice.h"
#include "scenes/held_promises.h"
#include "scenes/measured_scene.h"

#include <iota/system.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

namespace iota::scenes {

namespace {

constexpr std::array modes{IntegrationMode::plausible, IntegrationMode::robust, IntegrationMode::energy_keeping,
                           IntegrationMode::accurate};

IntegrationMode mode_of(std::uint64_t seed) { return modes[seed % modes.size()]; }
bool keeps_energy(IntegrationMode mode) {
  return mode == IntegrationMode::energy_keeping || mode == IntegrationMode::accurate;
}

using Complaint = std::optional<std::string>;

// The first step projects the velocities, which are random, on the joints.
Complaint check_energy(std::uint64_t seed) {
  MeasuredScene scene(seed, mode_of(seed));
  (void)scene.step();
  for (int i = 0; i < 30; ++i) {
    const double before = scene.kinetic() + scene.potential(), size = scene.size();
    const Energy book = scene.system.energy();
    const StepReport report = scene.step();
    const double gained = scene.kinetic() + scene.potential() - before;
    if (gained > 1e-8 * size) return text("a step has made ", gained, " J of ", size, " J");
    if (report.energy.made - book.made > 1e-9 * size) return text("a step reports ", report.energy.made, " J as made");
    const double lost = report.energy.lost - book.lost - (report.energy.made - book.made);
    if (!(std::abs(gained + lost) <= 1e-8 * size))
      return text("a step has gained ", gained, " J of ", size, ", and reports ", lost, " J as lost");
  }
  return {};
}

// Directions are those of the places that the system gives, so velocities are as rigid as these.
Complaint check_velocities(std::uint64_t seed) {
  MeasuredScene scene(seed, mode_of(2 + seed % 2));  // the modes that keep energy
  std::vector<std::vector<double>> lengths;
  for (const auto& body : scene.bodies) lengths.push_back(scene.lengths(body));
  for (int i = 0; i < 30; ++i) {
    const StepReport report = scene.step();
    if (report.fallbacks > 0 || report.unconverged > 0) continue;
    const double speed = scene.speed();
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const std::vector<double> now = scene.lengths(scene.bodies[b]), rates = scene.stretch_rates(scene.bodies[b]);
      const double extent = *std::max_element(now.begin(), now.end());
      double gap = 0, rate = 0;
      for (std::size_t k = 0; k < now.size(); ++k)
        gap = std::max(gap, std::abs(now[k] - lengths[b][k]) / extent), rate = std::max(rate, std::abs(rates[k]));
      if (!(gap <= 1e-8)) return text("a rigid body is longer by ", gap, " of its extent");
      if (!(rate <= (1e-9 + 10 * gap) * speed))
        return text("a rigid body is stretched by ", rate, " m/s, at a speed of ", speed);
    }
  }
  return {};
}

Complaint check_momenta(std::uint64_t seed) {
  MeasuredScene scene(seed, mode_of(seed), {.gravity = false, .nailed = false});
  (void)scene.step();
  const Vec3 momentum = scene.momentum(), angular = scene.angular_momentum();
  const bool is_plausible = scene.mode == IntegrationMode::plausible;  // residuals a hundred times as large
  const double most = is_plausible ? 1e-7 : 1e-10;
  const double most_spin = keeps_energy(scene.mode) ? 1e-9 : is_plausible ? 1e-5 : 1e-6;
  for (int i = 0; i < 30; ++i) {
    (void)scene.step();
    const double size = scene.total_mass() * scene.speed();
    const double lost = norm(scene.momentum() - momentum), lost_spin = norm(scene.angular_momentum() - angular);
    if (!(lost <= most * size)) return text("momentum has changed by ", lost, " of ", size, " kg m/s");
    if (!(lost_spin <= most_spin * size * scene.extent()))
      return text("angular momentum has changed by ", lost_spin, " of ", size * scene.extent(), " kg m^2/s");
  }
  return {};
}

// A single force on one particle, and then a pair of opposite forces, which only turns.
Complaint check_force(std::uint64_t seed) {
  MeasuredScene scene(seed, mode_of(seed), {.gravity = false, .nailed = false, .springs = false});
  (void)scene.step();
  Dice dice{seed + 1};
  const Vec3 force = dice.point(scene.mass * scene.length / (scene.time * scene.time));
  const std::size_t last = scene.particles.size() - 1;
  const double tolerance = scene.mode == IntegrationMode::plausible ? 1e-5 : 1e-6;
  for (int i = 0; i < 10; ++i) {
    const bool is_pair = i >= 5;
    const Vec3 momentum = scene.momentum(), angular = scene.angular_momentum();
    Vec3 torque = cross(scene.place(last), force);
    if (is_pair) torque -= cross(scene.place(0), force);
    scene.system.particles().apply_force(scene.particles[last], force);
    if (is_pair) scene.system.particles().apply_force(scene.particles[0], -force);
    (void)scene.step();
    Vec3 torque_after = cross(scene.place(last), force);
    if (is_pair) torque_after -= cross(scene.place(0), force);
    const Vec3 gained = scene.momentum() - momentum, expected = is_pair ? Vec3{} : scene.dt * force;
    const double size = scene.total_mass() * scene.speed();
    // The accurate mode returns the momenta that redundant rows take only where no force acts.
    if (!(norm(gained - expected) <= (scene.mode == IntegrationMode::accurate ? 1e-7 : 1e-9) * size))
      return text("a force of ", norm(force), " N changes the momentum by ", norm(gained), " instead of ",
                  norm(expected), " kg m/s");
    const Vec3 turned = scene.angular_momentum() - angular, wanted = (0.5 * scene.dt) * (torque + torque_after);
    // Right to first order, as the end-point rule takes the torque at the end. It returns the angular momentum that it loses
    // only as far as the lost energy suffices: in one of a thousand scenes some percent are missing.
    const double allowed = 2 * norm(scene.dt * (torque_after - torque)) + tolerance * size * scene.extent() +
                           (keeps_energy(scene.mode) ? 0 : 0.1 * norm(wanted));
    if (!(norm(turned - wanted) <= allowed))
      return text("a torque changes the angular momentum by ", norm(turned), " instead of ", norm(wanted), " kg m^2/s");
  }
  return {};
}

// A chain of links between two nails that are too far apart.
Complaint check_conflict(std::uint64_t seed) {
  Dice dice{seed};
  const double length = std::pow(10, dice.uniform(-3, 3)), mass = std::pow(10, dice.uniform(-3, 3));
  const int links = static_cast<int>(std::pow(10, dice.uniform(0.4, seed % 16 == 0 ? 2 : 1.3)));
  const double pull = 1 + std::pow(10, dice.uniform(-2, 0.3)), dt = std::sqrt(length) / 120;
  System system({.mode = mode_of(seed)});
  const Chain chain = make_chain(system, {.links = links, .link_length = length, .link_mass = 2 * mass});
  system.particles().nail(chain.lower.back());
  system.particles().nail(chain.lower.back(), {pull * links * length, 0, 0});
  StepReport report;
  for (int i = 0; i < 3; ++i) report = system.step(dt);
  if (report.unconverged == 0) return text("a chain pulled to ", pull, " times its length is not reported");
  double worst = 0, sum = 0;
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Vec3 link = system.particles().position(chain.lower[i]) - system.particles().position(chain.upper[i]);
    const double gap = std::abs(norm(link) / length - 1);
    worst = std::max(worst, gap), sum += gap / links;
  }
  if (!(worst <= 3 * sum + 1e-6)) return text("one of ", links, " links takes ", worst / sum, " times the mean gap");
  if (!(sum <= 1.1 * (pull - 1) + 1e-6)) return text("links are ", sum, " too long instead of ", pull - 1);
  return {};
}

Complaint check_order(std::uint64_t seed) {
  MeasuredScene scene(seed, mode_of(seed)), swapped(seed, mode_of(seed), {.swapped = true});
  for (int i = 0; i < 5; ++i) (void)scene.step(), (void)swapped.step();
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    const double off = norm(scene.place(i) - swapped.place(i));
    if (!(off <= 1e-5 * scene.extent())) return text("a particle is ", off / scene.length, " lengths off after a swap");
  }
  return {};
}

/// An angle about z between -pi and pi.
double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

/// The direction of a body that turns about z.
double direction(const System& system, BodyId body) {
  const Vec3 x = rotate(system.bodies().orientation(body), {1, 0, 0});
  return std::atan2(x.y, x.x);
}

// A shaft that turns by itself, two geared wheels and a screw, all about z in empty space. The end-point rule brakes what
// something else notices: gears and screws.
Complaint check_turns(std::uint64_t seed) {
  Dice dice{seed};
  const bool is_accurate = seed % 3 == 0, is_robust = seed % 3 == 1;
  System system({.gravity = {},
                 .mode = is_accurate ? IntegrationMode::accurate
                         : is_robust ? IntegrationMode::robust
                                     : IntegrationMode::energy_keeping});
  const double h = 1.0 / 60, pi = std::numbers::pi;
  const double speed =
      (seed % 2 ? 1 : -1) * 2 * pi * std::pow(10, dice.uniform(-2, is_accurate || is_robust ? 1 : 0.5)) / h;
  const double ratio = dice.uniform(-1, 1), lead = dice.uniform(-0.2, 0.2);
  const auto make = [&](double x, ConstraintKind kind, double spin, double rise) {
    const Vec3 at{x, 0, 0};
    const BodyId body =
        system.bodies().create(Box{{dice.uniform(0.1, 0.3), 0.2, 0.1}},
                               {.mass = dice.uniform(0.1, 10), .position = at, .velocity = {0, 0, rise}});
    const ConstraintId joint = system.joints().create({.kind = kind, .a = body, .at = at, .lead = lead});
    system.bodies().set_angular_velocity(body, {0, 0, spin});
    return std::pair{body, joint};
  };
  const auto [shaft, bearing] = make(0, ConstraintKind::revolute, speed, 0);
  const auto [wheel, first] = make(1, ConstraintKind::revolute, speed, 0);
  const auto [other, second] = make(2, ConstraintKind::revolute, ratio * speed, 0);
  const auto [screw, thread] = make(3, ConstraintKind::screw, speed, lead / (2 * pi) * speed);
  (void)system.joints().create({.terms = {{.constraint = first, .ratio = ratio}, {.constraint = second, .ratio = -1}}});
  (void)system.step(h);
  const auto turn = [&](ConstraintId joint) { return system.joints().state(joint).coordinate[0]; };
  const Energy before = system.energy();
  const double shaft_start = turn(bearing), rise_start = system.bodies().center_of_mass(screw).z;
  const double said = system.bodies().angular_velocity(shaft).z;
  constexpr int steps = 20;
  double says = 0;
  for (int i = 0; i < steps; ++i) {
    (void)system.step(h);
    says += h * system.bodies().angular_velocity(shaft).z;
  }
  const double angle = steps * h * speed, close = is_accurate ? 1e-3 : 0.2;
  const double turned = turn(bearing) - shaft_start;
  if (!(std::abs(wrapped(turned - (direction(system, shaft) - 0) + shaft_start)) <= 1e-6 * (1 + std::abs(turned))))
    return text("a shaft has turned to ", direction(system, shaft), " and counts ", turned + shaft_start);
  if (!(std::abs(turned - says) <= (is_robust ? 0.02 : close) * std::abs(angle)))
    return text("a shaft says ", says, " rad and counts ", turned);
  if (!is_robust && !(std::abs(system.bodies().angular_velocity(shaft).z - said) <= 1e-6 * std::abs(speed)))
    return text("a free shaft has changed its speed from ", said);
  const double edits = is_robust ? 0 : system.energy().edits - before.edits;
  if (!(std::abs(edits) <= 1e-6 * before.kinetic)) return text("edits have ", edits, " J of ", before.kinetic);
  if (is_robust) return {};
  const double speed_now = system.bodies().angular_velocity(wheel).z,
               other_now = system.bodies().angular_velocity(other).z;
  if (!(std::abs(speed_now / speed - 1) <= close))
    return text("a geared wheel keeps ", speed_now / speed, " of its speed");
  if (!(std::abs(other_now - ratio * speed) <= close * std::abs(speed)))
    return text("a geared wheel turns ", other_now / speed, " times as fast, not ", ratio);
  const double gap = wrapped(direction(system, other) - ratio * turn(first));
  if (!(std::abs(gap) <= 1e-6 * (1 + std::abs(angle)))) return text("gears have slipped by ", gap, " rad");
  const double rise = (system.bodies().center_of_mass(screw).z - rise_start) / (lead / (2 * pi) * angle);
  if (!(std::abs(rise - 1) <= close)) return text("a screw slides ", rise, " of its way");
  return {};
}

// A chain of boxes about z with motors far below their speed, friction and stops, from rest or spinning.
Complaint check_bounds(std::uint64_t seed) {
  Dice dice{seed};
  const IntegrationMode mode = mode_of(seed);
  System system({.gravity = {}, .mode = mode});
  struct Link {
    BodyId body;
    double mass = 0, inertia = 0, motor = 0, friction = 0, angle = 0, moved = 0;
  };
  std::vector<Link> links(2 + dice.below(3));
  double reach = 0;
  const bool has_stops = dice.below(3) == 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    Link& link = links[i];
    const double length = dice.uniform(0.3, 1), width = dice.uniform(0.05, 0.2);
    link.mass = dice.uniform(0.2, 2), link.inertia = link.mass * (length * length + width * width) / 12;
    link.body =
        system.bodies().create(Box{{length, width, 0.1}}, {.mass = link.mass, .position = {reach + length / 2, 0, 0}});
    if (dice.below(2)) link.motor = dice.uniform(-2, 2);
    if (dice.below(2)) link.friction = dice.uniform(0, 1);
    CoordinateOptions options{
        .motor_speed = std::copysign(1e7, link.motor), .motor_max = std::abs(link.motor), .friction = link.friction};
    if (has_stops) options.lower = -1, options.upper = 1;
    (void)system.joints().create(
        {.a = link.body, .b = i > 0 ? links[i - 1].body : BodyId{}, .at = {reach, 0, 0}, .angle = options});
    reach += length;
  }
  const auto kinetic = [&] {
    double sum = 0;
    for (const Link& link : links) {
      const Vec3 v = system.bodies().velocity(link.body);
      const double spin = system.bodies().angular_velocity(link.body).z;
      sum += 0.5 * link.mass * dot(v, v) + 0.5 * link.inertia * spin * spin;
    }
    return sum;
  };
  system.bodies().set_angular_velocity(links[0].body, {0, 0, dice.uniform(-3, 3)});
  (void)system.step(1e-6);
  constexpr double h = 1.0 / 120;
  double work = 0, paths = 0, inner_spin = 0, by_tolerance = 1e-12;
  const double angle_tolerance = mode == IntegrationMode::plausible ? 2e-9 : 2e-11;  // of a row, rad
  for (Link& link : links) {
    by_tolerance += angle_tolerance * (std::abs(link.motor) + link.friction);
    const double spin = system.bodies().angular_velocity(link.body).z;
    link.angle = direction(system, link.body), link.moved = h * std::abs(spin - std::exchange(inner_spin, spin));
    paths += link.friction * link.moved;
  }
  const double start = kinetic();
  double size = start;
  for (int i = 0; i < 60; ++i) {
    const StepReport report = system.step(h);
    if (report.unconverged > 0 || report.fallbacks > 0) return {};
    double inner = 0;
    for (Link& link : links) {
      const double turned = wrapped(direction(system, link.body) - link.angle);
      link.angle += turned;
      // The step in which friction stops a motion may have hardly any, by the mid-point rule half of it.
      const double moved = std::abs(turned - inner);
      work += link.motor * (turned - inner), paths += link.friction * std::max(moved, std::exchange(link.moved, moved));
      size += std::abs(link.motor * (turned - inner));
      inner = turned;
    }
    const double taken = work - (kinetic() - start);
    if (!(taken >= -1e-6 * size - by_tolerance))
      return text("motors with friction have made ", -taken, " J of ", size, " J");
    if (!keeps_energy(mode) || has_stops) continue;
    if (!(taken <= (mode == IntegrationMode::accurate ? 1.1 : 2) * paths + 1e-5 * size))
      return text("motors with friction have lost ", taken, " J, and ", paths, " J rubbed");
  }
  return {};
}

struct Momenta {
  Vec3 linear, angular;          ///< angular: about the origin
  double speed = 0, extent = 0;  ///< the largest
  double mass = 0;
};
Momenta momenta_of(const System& system) {
  Momenta sum;
  for (const ParticleId p : system.particles().ids()) {
    const double mass = system.particles().mass(p);
    const Vec3 x = system.particles().position(p), v = system.particles().velocity(p);
    sum.linear += mass * v, sum.angular += mass * cross(x, v);
    sum.speed = std::max(sum.speed, norm(v)), sum.extent = std::max(sum.extent, norm(x));
    sum.mass += mass;
  }
  return sum;
}

// Random combines in empty space, most of which ask for what cannot be, with masses over decades, links that are far too short
// for their neighbors, and budgets that end before a solution. No step changes their momenta.
Complaint check_rescue(std::uint64_t seed) {
  Dice dice{seed};
  System system({.gravity = {}, .mode = mode_of(seed)});
  // Without a limit an accurate step that nothing solves takes 10 000 iterations.
  const int most = system.mode() == IntegrationMode::accurate ? 100 : 0;
  system.set_budget({.iterations = dice.below(3) == 0 ? 1 + static_cast<int>(dice.below(6)) : most});
  const double decades = dice.below(2) == 0 ? 0 : 3;
  const int bodies = 3 + static_cast<int>(dice.below(6));
  for (int b = 0; b < bodies; ++b) {
    const BodyId body = system.bodies().create();
    const Vec3 place = dice.point(1), velocity = dice.point(1), turning = dice.point(4);
    const bool is_needle = dice.below(4) == 0;
    const double size = is_needle ? std::pow(10, dice.uniform(-16, -3)) : 0.3;
    for (std::uint32_t k = is_needle ? 2 : 2 + dice.below(3); k > 0; --k) {
      const Vec3 arm = dice.point(size);
      (void)system.particles().create(body, place + arm, std::pow(10, dice.uniform(-decades, decades)),
                                      velocity + cross(turning, arm));
    }
  }
  const double most_spin = system.mode() == IntegrationMode::plausible ? 1e-5 : 1e-6;
  for (int i = 0; i < 16; ++i) {
    const std::vector<ParticleId> particles = system.particles().ids();
    const auto pick = [&] { return particles[dice.below(static_cast<std::uint32_t>(particles.size()))]; };
    try {
      if (i % 2 == 0) (void)system.edits().combine(pick(), pick());
    } catch (const std::invalid_argument&) {  // one body at both, or both are hinged already
    }
    const Momenta before = momenta_of(system);
    const StepReport report = system.step(1.0 / 60);
    const Momenta after = momenta_of(system);
    const double size = before.mass * std::max(before.speed, after.speed);
    const double lost = norm(after.linear - before.linear), lost_spin = norm(after.angular - before.angular);
    const bool is_solved = report.unconverged == 0;
    const char* const how = is_solved ? "a step" : "a step that was not solved";
    if (!(lost <= 1e-9 * size)) return text(how, " changes the momentum by ", lost, " of ", size, " kg m/s");
    // Bodies that are drawn into one place cannot keep it, which is told.
    if (report.warnings.empty() && !(lost_spin <= most_spin * size * before.extent))
      return text(how, " changes the angular momentum by ", lost_spin, " of ", size * before.extent, " kg m^2/s");
  }
  return {};
}

}  // namespace

const char* name_of(Promise promise) {
  constexpr std::array names{"energy", "velocities", "momenta", "force", "conflict", "order",
                             "turns",  "bounds",     "rescue",  "field", "torque"};
  return names[static_cast<std::size_t>(promise)];
}

std::optional<std::string> break_promise(Promise promise, std::uint64_t seed) {
  switch (promise) {
    case Promise::energy: return check_energy(seed);
    case Promise::velocities: return check_velocities(seed);
    case Promise::momenta: return check_momenta(seed);
    case Promise::force: return check_force(seed);
    case Promise::conflict: return check_conflict(seed);
    case Promise::order: return check_order(seed);
    case Promise::turns: return check_turns(seed);
    case Promise::bounds: return check_bounds(seed);
    case Promise::rescue: return check_rescue(seed);
    case Promise::field: return check_field(seed);
    case Promise::torque: return check_torque(seed);
    case Promise::count: break;
  }
  return {};
}

}  // namespace iota::scenes
