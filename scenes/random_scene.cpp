// SPDX-License-Identifier: Apache-2.0
#include "scenes/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace iota::scenes {

namespace {

/// splitmix64: the same numbers with every standard library.
struct Dice {
  std::uint64_t state;
  std::uint64_t next() {
    std::uint64_t z = state += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(next() % n); }
  double uniform(double low, double high) { return low + (high - low) * 0x1p-53 * static_cast<double>(next() >> 11); }
  Vec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  double mass() { return std::pow(10, uniform(-3, 3)); }
};

constexpr std::array<const char*, 33> names{"make_body",
                                            "make_solid",
                                            "make_link",
                                            "bridge",
                                            "combine",
                                            "combine_slowly",
                                            "combine_bodies",
                                            "cut",
                                            "separate",
                                            "nail",
                                            "move_nail",
                                            "release",
                                            "spring",
                                            "drag",
                                            "law",
                                            "destroy_bond",
                                            "joint",
                                            "distance",
                                            "surface",
                                            "path",
                                            "switch_constraint",
                                            "destroy_constraint",
                                            "grip",
                                            "move_grip",
                                            "let_go",
                                            "push",
                                            "set_velocity",
                                            "set_mass",
                                            "set_kind",
                                            "destroy_particle",
                                            "destroy_body",
                                            "set_mode",
                                            "step"};

constexpr std::uint32_t newest = 0xffffffff;  // as a or b: the particle in the last slot

/// A system under a script, and what the script made.
class Player {
 public:
  Player(Tally& tally, bool jointed) : tally_(tally), jointed_(jointed) {}

  std::optional<std::string> act(const Deed& deed) {
    Dice dice{deed.seed};
    const bool compare = dice.below(4) == 0;
    const std::uint64_t hash = compare ? system_.state_hash() : 0;
    try {
      if (deed.kind == DeedKind::step) return step(dice);
      edit(deed, dice);
      ++tally_.edits;
    } catch (const std::invalid_argument& refusal) {
      ++tally_.refused;
      if (compare && system_.state_hash() != hash)
        return std::string("changed something and then refused: ") + refusal.what();
    } catch (const std::exception& error) {
      return std::string("an error of our own: ") + error.what();
    }
    const std::vector<std::string> complaints = system_.validate();
    if (!complaints.empty()) return complaints.front();
    if (!std::isfinite(system_.energy().total())) return "the energy is not finite";
    return std::nullopt;
  }

 private:
  std::optional<std::string> step(Dice& dice) {
    constexpr std::array<double, 4> steps{1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240};
    const Energy before = system_.energy();
    const StepReport report = system_.step(steps[dice.below(4)]);
    ++tally_.steps;
    tally_.unconverged += report.unconverged > 0;
    tally_.fallbacks += static_cast<std::uint64_t>(report.fallbacks);
    const Energy& after = report.energy;
    if (!std::isfinite(after.total()) || !std::isfinite(after.dissipated) || !std::isfinite(report.worst_gap))
      return "a step ended with numbers that are not finite";
    if (report.unconverged == 0 && report.resting == 0) {  // who was put to rest in a conflict keeps it
      tally_.gap = std::max(tally_.gap, report.worst_gap);
      // 1e-6 of a body, which may be 3 m long.
      if (report.worst_gap > 3e-6) return say("a gap of ", report.worst_gap, " m, and the step says that it converged");
    }
    const double book = after.total() + after.dissipated - after.external_work - after.edits -
                        (before.total() + before.dissipated - before.external_work - before.edits);
    const double size = before.kinetic + after.kinetic + std::abs(before.potential) + std::abs(after.potential) +
                        std::abs(after.edits) + std::abs(after.external_work) + std::abs(after.dissipated);
    // Joints that are pulled together at once from far away may turn by more than half a turn: one scene in ten thousand.
    const double exact = jointed_ ? 1e-2 : 1e-9;
    if (std::abs(book) > exact * size) return say("the energy book does not add up: ", book, " J of ", size);
    // Gaps of 1e-9 of a link times the forces of a thousand kilogrammes: energy may wander a little, not jump.
    const double made_up = before.dissipated - after.dissipated;
    const double motion = before.kinetic + after.kinetic + std::abs(after.potential - before.potential) +
                          std::abs(after.edits - before.edits) + 1e-6 * std::abs(after.potential) + 1e-6;
    if (!disturbed_) {
      const bool rescued = report.fallbacks > 0 || report.unconverged > 0;  // had to fall back, and says so
      double& most = jointed_ ? tally_.made_up_with_joints : rescued ? tally_.made_up_by_rescues : tally_.made_up;
      most = std::max(most, made_up / motion);
      // Curves and surfaces are no quadratic constraints: at the default accuracy a fast step round a bend may gain.
      const double allowed = jointed_ ? 0.5 : rescued ? 0.2 : 2e-3;
      if (made_up > allowed * motion) return say("a step made up ", made_up, " J of ", motion, " J");
    }
    disturbed_ = !grips_.empty();
    const std::vector<std::string> complaints = system_.validate();
    if (!complaints.empty()) return complaints.front();
    return std::nullopt;
  }

  template <class... Parts>
  static std::string say(const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
  }

  void edit(const Deed& deed, Dice& dice) {
    std::vector<ParticleId> particles = system_.particles();
    if (particles.empty() && deed.kind != DeedKind::make_body) return;
    const auto pick = [&](std::uint32_t n) { return n == newest ? particles.back() : particles[n % particles.size()]; };
    const ParticleId p = particles.empty() ? ParticleId{} : pick(deed.a),
                     q = particles.empty() ? ParticleId{} : pick(deed.b);
    switch (deed.kind) {
      case DeedKind::make_body: {
        const BodyId body = system_.create_body();
        const Vec3 center = dice.point(1), velocity = dice.point(2);
        const std::uint32_t count = 1 + dice.below(5);
        for (std::uint32_t i = 0; i < count; ++i)
          system_.create_particle(body, center + dice.point(0.4), dice.mass(), velocity + dice.point(1));
        break;
      }
      case DeedKind::make_solid: make_solid(p, dice); break;
      case DeedKind::make_link: {
        const Vec3 from = system_.position(p);
        Vec3 along = dice.point(1);
        along = (dice.uniform(0.05, 0.4) / (norm(along) + 1e-3)) * along;
        link(p, from, from + along, dice);
        break;
      }
      case DeedKind::bridge: {
        const Vec3 from = system_.position(p), to = system_.position(q);
        if (norm(to - from) < 1e-3) break;
        (void)system_.combine(link(p, from, to, dice), q);
        break;
      }
      case DeedKind::combine:
        if (may_meet(p, q, dice)) (void)system_.combine(p, q);
        break;
      case DeedKind::combine_slowly:
        if (may_meet(p, q, dice)) (void)system_.combine(p, q, dice.uniform(0.02, 0.3));
        break;
      case DeedKind::combine_bodies: (void)system_.combine(system_.body(p), system_.body(q)); break;
      case DeedKind::cut: {
        const std::vector<ParticleId> ring = system_.ring(p);
        if (ring.size() > 1) (void)system_.separate(p, ring[dice.below(static_cast<std::uint32_t>(ring.size()))]);
        break;
      }
      case DeedKind::separate:
        if (particles.size() < 60) (void)system_.separate(p, q);
        break;
      case DeedKind::nail: system_.nail(p); break;
      case DeedKind::move_nail:
        disturbed_ = disturbed_ || system_.is_nailed(p);
        if (system_.is_nailed(p)) system_.nail(p, system_.position(p) + dice.point(0.2));
        break;
      case DeedKind::release: system_.release(p); break;
      case DeedKind::spring:
        if (p != q)
          system_.create_bond(p, q,
                              SpringLaw{.stiffness = std::pow(10, dice.uniform(-1, 5)), .damping = dice.uniform(0, 2)});
        break;
      case DeedKind::drag:
        if (p != q) system_.create_bond(p, q, DragLaw{dice.uniform(0, 5)});
        break;
      case DeedKind::law: {
        constexpr std::array laws{"tether", "soft_repulsion", "gravity", "attract_repel", "morse", "dashpot"};
        if (p != q) system_.create_bond(p, q, SharedLaw{.law = system_.find_law(laws[dice.below(laws.size())])});
        break;
      }
      case DeedKind::joint: make_joint(p, q, dice); break;
      case DeedKind::distance:
        if (p != q)
          system_.create_constraint(DistanceSpec{
              .kind = dice.below(2) == 0 ? ConstraintKind::rod : ConstraintKind::rope,
              .p = p,
              .q = q,
          });
        break;
      case DeedKind::surface: make_surface(p, dice); break;
      case DeedKind::path: {
        const Vec3 from = system_.position(p);
        PathSpec path{.particle = p, .curve = dice.below(2) == 0 ? CurveKind::spline : CurveKind::polyline};
        path.points = {from - dice.point(0.5), from, from + dice.point(0.5), from + dice.point(1)};
        path.slide.friction = dice.below(2) == 0 ? 0 : dice.uniform(0, 5);
        system_.create_constraint(path);
        break;
      }
      case DeedKind::switch_constraint: {
        const std::vector<ConstraintId> all = system_.constraints();
        if (all.empty()) break;
        const ConstraintId constraint = all[deed.a % all.size()];
        system_.set_active(constraint, !system_.state(constraint).active);
        break;
      }
      case DeedKind::destroy_constraint: {
        const std::vector<ConstraintId> all = system_.constraints();
        if (!all.empty()) system_.destroy(all[deed.a % all.size()]);
        break;
      }
      case DeedKind::destroy_bond: {
        const std::vector<BondId> bonds = system_.bonds();
        if (!bonds.empty()) system_.destroy(bonds[deed.a % bonds.size()]);
        break;
      }
      case DeedKind::grip:
        grips_.push_back(system_.create_grip(system_.body(p), dice.point(0.1), system_.position(p) + dice.point(0.5)));
        disturbed_ = true;
        break;
      case DeedKind::move_grip:
        forget_dead_grips();
        if (!grips_.empty()) system_.move_grip(grips_[deed.a % grips_.size()], dice.point(1));
        break;
      case DeedKind::let_go:
        forget_dead_grips();
        if (!grips_.empty()) system_.destroy(grips_[deed.a % grips_.size()]);
        forget_dead_grips();
        break;
      case DeedKind::push:
        system_.apply_force(p, 10 * dice.point(1));
        disturbed_ = true;
        break;
      case DeedKind::set_velocity: system_.set_velocity(p, dice.point(3)); break;
      case DeedKind::set_mass: system_.set_mass(p, dice.mass()); break;
      case DeedKind::set_kind: {
        constexpr std::array kinds{BodyKind::dynamic,  BodyKind::dynamic,  BodyKind::static_,
                                   BodyKind::scripted, BodyKind::inactive, BodyKind::resting};
        system_.set_kind(system_.body(p), kinds[dice.below(kinds.size())]);
        disturbed_ = true;
        break;
      }
      case DeedKind::destroy_particle: system_.destroy(p); break;
      case DeedKind::destroy_body: system_.destroy(system_.body(p)); break;
      case DeedKind::set_mode:
        system_.set_mode(dice.below(2) == 0 ? IntegrationMode::robust : IntegrationMode::energy_keeping);
        break;
      case DeedKind::step: break;
    }
  }

  /// Particles of bodies that hang together already can seldom meet; one pair in eight may try.
  bool may_meet(ParticleId p, ParticleId q, Dice& dice) const {
    return dice.below(8) == 0 || system_.articulate(system_.body(p)) != system_.articulate(system_.body(q));
  }

  /// A two-point body whose first end is combined with p; returns its second end.
  ParticleId link(ParticleId p, const Vec3& from, const Vec3& to, Dice& dice) {
    const BodyId body = system_.create_body();
    const double mass = dice.mass();
    const Vec3 velocity = system_.velocity(p);
    const ParticleId first = system_.create_particle(body, from, mass, velocity);
    const ParticleId second = system_.create_particle(body, to, mass, velocity);
    if (dice.below(3) == 0) system_.set_rod(body, mass, 0.02);
    (void)system_.combine(p, first);
    return second;
  }

  void make_solid(ParticleId p, Dice& dice) {
    SolidOptions options;
    options.mass = dice.mass();
    options.position = dice.point(1);
    options.velocity = dice.point(1), options.spin = dice.point(3);
    const double size = dice.uniform(0.05, 0.3);
    options.attachments = {{size, 0, 0}, {-size, 0.5 * size, 0.2 * size}};
    BodyId body;
    switch (dice.below(4)) {
      case 0: body = system_.create_body(Box{{size, 2 * size, 0.3 * size}}, options); break;
      case 1: body = system_.create_body(Sphere{size}, options); break;
      case 2: body = system_.create_body(Cylinder{0.1 * size, size}, options); break;
      default: body = system_.create_body(Torus{size, 0.2 * size}, options); break;
    }
    (void)system_.combine(p, system_.attachments(body).front());
  }

  void make_joint(ParticleId p, ParticleId q, Dice& dice) {
    constexpr std::array kinds{ConstraintKind::ball,        ConstraintKind::universal, ConstraintKind::revolute,
                               ConstraintKind::cylindrical, ConstraintKind::prismatic, ConstraintKind::orientation,
                               ConstraintKind::weld};
    JointSpec joint{.kind = kinds[dice.below(kinds.size())], .a = system_.body(p), .b = system_.body(q)};
    if (dice.below(4) == 0) joint.b = {};
    joint.at = system_.position(p) + dice.point(0.05), joint.axis = dice.point(1);
    for (CoordinateOptions* coordinate : {&joint.angle, &joint.slide}) {
      if (dice.below(4) == 0) coordinate->lower = -dice.uniform(0, 1), coordinate->upper = dice.uniform(0, 1);
      if (dice.below(4) == 0) coordinate->friction = dice.uniform(0, 5);
      if (dice.below(4) == 0) coordinate->stiffness = dice.uniform(0, 100), coordinate->damping = dice.uniform(0, 1);
    }
    system_.create_constraint(joint);
  }

  /// A particle on a sphere or plane through its place, inside or outside of one that it is inside or outside of.
  void make_surface(ParticleId p, Dice& dice) {
    constexpr std::array kinds{ConstraintKind::surface, ConstraintKind::inside, ConstraintKind::outside};
    SurfaceSpec spec{.kind = kinds[dice.below(kinds.size())], .particle = p};
    const double radius = dice.uniform(0.2, 1);
    Vec3 away = dice.point(1);
    away = (radius / (norm(away) + 1e-9)) * away;
    const double part = spec.kind == ConstraintKind::surface ? 1 : spec.kind == ConstraintKind::inside ? 0.5 : 1.5;
    if (dice.below(2) == 0)
      spec.surface.shape = Sphere{radius}, spec.surface.position = system_.position(p) + part * away;
    else
      spec.surface.shape = Plane{away}, spec.surface.position = system_.position(p) - (part - 1) * away;
    system_.create_constraint(spec);
  }

  void forget_dead_grips() {
    std::erase_if(grips_, [&](GripId grip) { return !system_.contains(grip); });
  }

  Tally& tally_;
  System system_;
  std::vector<GripId> grips_;
  bool jointed_;
  bool disturbed_ = false;  // somebody outside does work in the next step
};

}  // namespace

std::vector<Deed> random_script(std::uint64_t seed, const RandomSceneOptions& options) {
  Dice dice{seed * 0x2545f4914f6cdd1d + 1};
  std::vector<Deed> script;
  const auto add = [&](DeedKind kind, std::uint32_t a, std::uint32_t b) {
    script.push_back({kind, a, b, dice.next()});
  };
  const auto add_anywhere = [&](DeedKind kind) { add(kind, dice.below(1u << 20), dice.below(1u << 20)); };

  add(DeedKind::set_mode, 0, 0);
  const auto bodies = 2 + dice.below(static_cast<std::uint32_t>(options.bodies));
  const auto graph = static_cast<Graph>(dice.below(static_cast<std::uint32_t>(Graph::count)));
  add(DeedKind::make_body, 0, 0);
  if (dice.below(2) == 0) add(DeedKind::nail, 0, 0);
  for (std::uint32_t i = 1; i < bodies; ++i) {
    switch (graph) {
      case Graph::soup: add_anywhere(DeedKind::make_body); break;
      case Graph::star: add(DeedKind::make_link, 0, 0); break;
      case Graph::tree: add_anywhere(dice.below(4) == 0 ? DeedKind::make_solid : DeedKind::make_link); break;
      default: add(DeedKind::make_link, newest, 0); break;
    }
  }
  if (graph == Graph::ring || graph == Graph::net)
    for (std::uint32_t i = 0; i < (graph == Graph::ring ? 1 : bodies / 2); ++i) add_anywhere(DeedKind::bridge);
  if (graph == Graph::soup)
    for (std::uint32_t i = 0; i < bodies; ++i) add_anywhere(DeedKind::combine);

  // What happens how often; a scene that falls to dust tests little, so joining outweighs cutting.
  // Every other scene has joints and all that.
  const bool jointed = seed % 2 == 0;
  const std::vector<std::pair<DeedKind, int>> weights{
      {DeedKind::make_body, 2},
      {DeedKind::make_solid, 2},
      {DeedKind::make_link, 8},
      {DeedKind::bridge, 4},
      {DeedKind::combine, 10},
      {DeedKind::combine_slowly, 4},
      {DeedKind::combine_bodies, 2},
      {DeedKind::cut, 8},
      {DeedKind::separate, 4},
      {DeedKind::nail, 2},
      {DeedKind::move_nail, 6},
      {DeedKind::release, 4},
      {DeedKind::spring, 4},
      {DeedKind::drag, 2},
      {DeedKind::law, 2},
      {DeedKind::destroy_bond, 3},
      {DeedKind::grip, 2},
      {DeedKind::move_grip, 3},
      {DeedKind::let_go, 3},
      {DeedKind::push, 2},
      {DeedKind::set_velocity, 2},
      {DeedKind::set_mass, 2},
      {DeedKind::set_kind, 3},
      {DeedKind::destroy_particle, 2},
      {DeedKind::destroy_body, 1},
      {DeedKind::set_mode, 1},
      {DeedKind::joint, jointed ? 8 : 0},
      {DeedKind::distance, jointed ? 5 : 0},
      {DeedKind::surface, jointed ? 3 : 0},
      {DeedKind::path, jointed ? 2 : 0},
      {DeedKind::switch_constraint, jointed ? 3 : 0},
      {DeedKind::destroy_constraint, jointed ? 4 : 0},
  };
  int total = 0;
  for (const auto& [kind, weight] : weights) total += weight;
  for (int frame = 0; frame < options.frames; ++frame) {
    for (std::uint32_t i = dice.below(static_cast<std::uint32_t>(options.edits) + 1); i > 0; --i) {
      int lot = static_cast<int>(dice.below(static_cast<std::uint32_t>(total)));
      for (const auto& [kind, weight] : weights)
        if ((lot -= weight) < 0) {
          add_anywhere(kind);
          break;
        }
    }
    add(DeedKind::step, 0, 0);
  }
  return script;
}

std::optional<std::string> play(const std::vector<Deed>& script, Tally& tally) {
  const bool jointed = std::any_of(script.begin(), script.end(), [](const Deed& deed) {
    return deed.kind == DeedKind::joint || deed.kind == DeedKind::distance || deed.kind == DeedKind::surface ||
           deed.kind == DeedKind::path;
  });
  Player player(tally, jointed);
  ++tally.scenes;
  for (std::size_t i = 0; i < script.size(); ++i)
    if (std::optional<std::string> wrong = player.act(script[i]))
      return "after deed " + std::to_string(i) + " (" + names[static_cast<std::size_t>(script[i].kind)] +
             "): " + *wrong;
  return std::nullopt;
}

std::function<bool(const std::vector<Deed>&)> same_complaint_as(const std::vector<Deed>& script) {
  // Its words up to the first number, without the place in the script.
  const auto gist = [](const std::vector<Deed>& played) {
    Tally ignored;
    const std::string text = play(played, ignored).value_or(": nothing");
    const std::size_t begin = text.find(": ");
    return text.substr(begin, text.find_first_of("0123456789", begin) - begin);
  };
  return [gist, wrong = gist(script)](const std::vector<Deed>& played) { return gist(played) == wrong; };
}

std::vector<Deed> shrink(std::vector<Deed> script, const std::function<bool(const std::vector<Deed>&)>& fails) {
  for (std::size_t size = script.size() / 2; size > 0; size /= 2) {
    for (std::size_t begin = 0; begin < script.size();) {
      std::vector<Deed> shorter = script;
      shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(begin),
                    shorter.begin() + static_cast<std::ptrdiff_t>(std::min(begin + size, script.size())));
      if (fails(shorter))
        script = std::move(shorter);
      else
        begin += size;
    }
  }
  return script;
}

std::string tell(const std::vector<Deed>& script) {
  std::ostringstream text;
  text << "std::vector<Deed> script{\n";
  for (const Deed& deed : script)
    text << "    {DeedKind::" << names[static_cast<std::size_t>(deed.kind)] << ", " << deed.a << ", " << deed.b << ", "
         << deed.seed << "u},\n";
  text << "};\n";
  return text.str();
}

}  // namespace iota::scenes
