// SPDX-License-Identifier: Apache-2.0
#include "scenes/script.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace iota::scenes {

namespace {

/// Reads the words of a line in order.
class Words {
 public:
  explicit Words(const std::string& line) : in_(line) {}

  std::string word() {
    std::string text;
    if (!(in_ >> text)) throw std::logic_error("the line is too short");
    return text;
  }
  double number() { return std::strtod(word().c_str(), nullptr); }  // streams do not read infinity
  int integer() { return std::atoi(word().c_str()); }
  Vec3 vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  template <class IdType>
  IdType id() {
    const std::string text = word();
    const std::size_t dot = text.find('.');
    if (dot == std::string::npos) throw std::logic_error("an id is slot.generation, got " + text);
    return {static_cast<std::uint32_t>(std::strtoul(text.c_str(), nullptr, 10)),
            static_cast<std::uint32_t>(std::strtoul(text.c_str() + dot + 1, nullptr, 10))};
  }
  bool at_end() { return (in_ >> std::ws).eof(); }

 private:
  std::istringstream in_;
};

CoordinateOptions coordinate(Words& words) {
  CoordinateOptions options;
  options.lower = words.number(), options.upper = words.number(), options.friction = words.number();
  options.stiffness = words.number(), options.damping = words.number();
  return options;
}

template <class... Parts>
std::string say(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

}  // namespace

void WatchedSystem::perform(const std::string& line) {
  Words words(line);
  const std::string verb = words.word();
  System& s = system_;
  const auto particle_id = [&] { return words.id<ParticleId>(); };
  const auto body_id = [&] { return words.id<BodyId>(); };
  if (verb == "body") {
    body = s.bodies().create();
  } else if (verb == "particle") {
    const BodyId of = body_id();
    const Vec3 position = words.vector();
    const double mass = words.number();
    particle = s.particles().create(of, position, mass, words.vector());
  } else if (verb == "rod") {
    const BodyId of = body_id();
    const double mass = words.number();
    s.bodies().set_rod(of, mass, words.number());
  } else if (verb == "solid") {
    const std::string shape = words.word();
    const Vec3 size = words.vector();
    SolidOptions options;
    options.mass = words.number(), options.position = words.vector();
    options.velocity = words.vector(), options.spin = words.vector();
    options.attachments = {words.vector()};
    options.attachments.push_back(words.vector());
    body = shape == "box"        ? s.bodies().create(Box{size}, options)
           : shape == "sphere"   ? s.bodies().create(Sphere{size.x}, options)
           : shape == "cylinder" ? s.bodies().create(Cylinder{size.x, size.y}, options)
                                 : s.bodies().create(Torus{size.x, size.y}, options);
  } else if (verb == "combine") {
    const ParticleId p = particle_id(), q = particle_id();
    (void)s.edits().combine(p, q, words.number());
  } else if (verb == "combine_bodies") {
    const BodyId a = body_id();
    (void)s.edits().combine(a, body_id());
  } else if (verb == "separate") {
    const ParticleId p = particle_id();
    (void)s.edits().separate(p, particle_id());
  } else if (verb == "nail") {
    s.particles().nail(particle_id());
  } else if (verb == "move_nail") {
    const ParticleId p = particle_id();
    s.particles().nail(p, words.vector());
    disturbed_ = true;
  } else if (verb == "release") {
    s.particles().release(particle_id());
  } else if (verb == "spring") {
    const ParticleId p = particle_id(), q = particle_id();
    const double stiffness = words.number();
    s.bonds().create(p, q, SpringLaw{.stiffness = stiffness, .damping = words.number()});
  } else if (verb == "drag") {
    const ParticleId p = particle_id(), q = particle_id();
    s.bonds().create(p, q, DragLaw{words.number()});
  } else if (verb == "law") {
    const ParticleId p = particle_id(), q = particle_id();
    s.bonds().create(p, q, SharedLaw{.law = s.laws().find(words.word())});
  } else if (verb == "destroy_bond") {
    s.bonds().destroy(words.id<BondId>());
  } else if (verb == "joint") {
    JointSpec joint{.kind = static_cast<ConstraintKind>(words.integer())};
    joint.a = body_id(), joint.b = body_id(), joint.at = words.vector(), joint.axis = words.vector();
    joint.angle = coordinate(words), joint.slide = coordinate(words);
    s.joints().create(joint);
    jointed_ = true;
  } else if (verb == "distance") {
    DistanceSpec spec{.kind = static_cast<ConstraintKind>(words.integer())};
    spec.p = particle_id(), spec.q = particle_id();
    s.joints().create(spec);
    jointed_ = true;
  } else if (verb == "on_sphere" || verb == "on_plane") {
    SurfaceSpec spec{.kind = static_cast<ConstraintKind>(words.integer()), .particle = particle_id()};
    spec.surface.position = words.vector();
    if (verb == "on_sphere")
      spec.surface.shape = Sphere{words.number()};
    else
      spec.surface.shape = HalfSpace{words.vector()};
    s.joints().create(spec);
    jointed_ = true;
  } else if (verb == "path") {
    PathSpec path{.particle = particle_id(), .curve = static_cast<CurveKind>(words.integer())};
    path.slide.friction = words.number();
    while (!words.at_end()) path.points.push_back(words.vector());
    s.joints().create(path);
    jointed_ = true;
  } else if (verb == "switch_constraint") {
    const auto constraint = words.id<ConstraintId>();
    s.joints().set_active(constraint, words.integer() != 0);
  } else if (verb == "destroy_constraint") {
    s.joints().destroy(words.id<ConstraintId>());
  } else if (verb == "grip") {
    const BodyId of = body_id();
    const Vec3 local = words.vector();
    grips_.push_back(s.grips().create(of, local, words.vector()));
    disturbed_ = true;
  } else if (verb == "move_grip") {
    const auto grip = words.id<GripId>();
    s.grips().move(grip, words.vector());
  } else if (verb == "let_go") {
    s.grips().destroy(words.id<GripId>());
  } else if (verb == "push") {
    const ParticleId p = particle_id();
    s.particles().apply_force(p, words.vector());
    disturbed_ = true;
  } else if (verb == "set_velocity") {
    const ParticleId p = particle_id();
    s.particles().set_velocity(p, words.vector());
  } else if (verb == "set_mass") {
    const ParticleId p = particle_id();
    s.particles().set_mass(p, words.number());
  } else if (verb == "set_kind") {
    const BodyId of = body_id();
    s.bodies().set_kind(of, static_cast<BodyKind>(words.integer()));
    disturbed_ = true;
  } else if (verb == "destroy_particle") {
    s.particles().destroy(particle_id());
  } else if (verb == "destroy_body") {
    s.bodies().destroy(body_id());
  } else if (verb == "set_mode") {
    s.set_mode(static_cast<IntegrationMode>(words.integer()));
  } else {
    throw std::logic_error("no such verb: " + verb);
  }
  forget_dead_grips();
  if (!words.at_end()) throw std::logic_error("the line is too long");
  if (log_) *log_ += line + '\n';
}

std::optional<std::string> WatchedSystem::step(double dt) {
  const Energy before = system_.energy();
  if (log_) {
    std::ostringstream line;
    line.precision(17);
    line << "step " << dt << '\n';
    *log_ += line.str();
  }
  const StepReport report = system_.step(dt);
  ++tally_.steps;
  tally_.unconverged += report.unconverged > 0;
  tally_.fallbacks += static_cast<std::uint64_t>(report.fallbacks);
  const Energy& after = report.energy;
  if (!std::isfinite(after.total()) || !std::isfinite(after.dissipated) || !std::isfinite(report.worst_gap))
    return "a step ended with numbers that are not finite";
  if (report.unconverged == 0 && report.resting == 0) {  // a body that sleeps with a conflict keeps it
    tally_.gap = std::max(tally_.gap, report.worst_gap);
    // 1e-6 of a body, which may be 3 m long.
    if (report.worst_gap > 3e-6) return say("a gap of ", report.worst_gap, " m, and the step says that it converged");
  }
  const double book = after.balance() - before.balance();
  const double size = before.kinetic + after.kinetic + std::abs(before.potential) + std::abs(after.potential) +
                      std::abs(after.edits) + std::abs(after.external_work) + std::abs(after.dissipated) +
                      std::abs(after.lost) + std::abs(after.made);
  // Joints that are closed from far away in one step may turn by more than half a turn: one scene in ten thousand.
  const double exact = jointed_ ? 1e-2 : 1e-9;
  if (std::abs(book) > exact * size) return say("the energy book does not add up: ", book, " J of ", size);
  // Gaps of 1e-9 of a link times the forces of a thousand kilograms: energy may wander a little, not jump.
  const double made_up = after.made - before.made;
  const double motion = before.kinetic + after.kinetic + std::abs(after.potential - before.potential) +
                        std::abs(after.edits - before.edits) + 1e-6 * std::abs(after.potential) + 1e-6;
  if (!disturbed_) {
    const bool rescued = report.fallbacks > 0 || report.unconverged > 0;  // had fall-backs, as the report says
    double& most = jointed_ ? tally_.made_up_with_joints : rescued ? tally_.made_up_by_rescues : tally_.made_up;
    most = std::max(most, made_up / motion);
    // Curves and surfaces are not quadratic: at the default accuracy a fast step round a bend may gain energy.
    const double allowed = jointed_ ? 0.5 : rescued ? 0.2 : 2e-3;
    if (made_up > allowed * motion) return say("a step made up ", made_up, " J of ", motion, " J");
  }
  forget_dead_grips();
  disturbed_ = !grips_.empty();
  return check();
}

std::optional<std::string> WatchedSystem::check() const {
  const std::vector<std::string> complaints = system_.validate();
  if (!complaints.empty()) return complaints.front();
  if (!std::isfinite(system_.energy().total())) return "the energy is not finite";
  return std::nullopt;
}

void WatchedSystem::forget_dead_grips() {
  std::erase_if(grips_, [&](GripId grip) { return !system_.grips().contains(grip); });
}

std::optional<std::string> play(std::string_view lines, Tally& tally) {
  WatchedSystem watched(tally);
  std::istringstream in{std::string(lines)};
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::optional<std::string> wrong;
    try {
      if (line.rfind("step ", 0) == 0) {
        wrong = watched.step(std::strtod(line.c_str() + 5, nullptr));
      } else {
        watched.perform(line);
        ++tally.edits;
        wrong = watched.check();
      }
    } catch (const std::exception& error) {
      wrong = error.what();
    }
    if (wrong) return say("line ", number, " (", line, "): ", *wrong);
  }
  ++tally.scenes;
  return std::nullopt;
}

}  // namespace iota::scenes
