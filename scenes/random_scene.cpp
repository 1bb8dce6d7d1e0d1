// SPDX-License-Identifier: Apache-2.0
#include "scenes/random_scene.h"

#include "scenes/dice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace iota::scenes {

namespace {

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

/// Converts deeds to calls.
class Player {
 public:
  explicit Player(Tally& tally, std::string* log = nullptr) : tally_(tally), watched_(tally, log) {}

  std::optional<std::string> act(const Deed& deed) {
    Dice dice{deed.seed};
    const bool compare = dice.below(4) == 0;
    const std::uint64_t hash = compare ? system_.state_hash() : 0;
    try {
      if (deed.kind == DeedKind::step) {
        constexpr std::array<double, 4> steps{1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240};
        return watched_.step(steps[dice.below(4)]);
      }
      edit(deed, dice);
      ++tally_.edits;
    } catch (const std::invalid_argument& refusal) {
      ++tally_.refused;
      if (compare && system_.state_hash() != hash)
        return std::string("changed something and then refused: ") + refusal.what();
    } catch (const std::exception& error) {
      return std::string("an error of our own: ") + error.what();
    }
    return watched_.check();
  }

 private:
  template <class... Arguments>
  void call(std::string_view verb, const Arguments&... arguments) {
    watched_.call(verb, arguments...);
  }

  void edit(const Deed& deed, Dice& dice) {
    std::vector<ParticleId> particles = system_.particles().ids();
    if (particles.empty() && deed.kind != DeedKind::make_body) return;
    const auto pick = [&](std::uint32_t n) { return n == newest ? particles.back() : particles[n % particles.size()]; };
    const ParticleId p = particles.empty() ? ParticleId{} : pick(deed.a),
                     q = particles.empty() ? ParticleId{} : pick(deed.b);
    switch (deed.kind) {
      case DeedKind::make_body: {
        call("body");
        const BodyId body = watched_.body;
        const Vec3 center = dice.point(1), velocity = dice.point(2);
        const std::uint32_t count = 1 + dice.below(5);
        for (std::uint32_t i = 0; i < count; ++i) {
          const Vec3 own = dice.point(1);
          const double mass = dice.mass();
          call("particle", body, center + dice.point(0.4), mass, velocity + own);
        }
        break;
      }
      case DeedKind::make_solid: make_solid(p, dice); break;
      case DeedKind::make_link: {
        const Vec3 from = system_.particles().position(p);
        Vec3 along = dice.point(1);
        along = (dice.uniform(0.05, 0.4) / (norm(along) + 1e-3)) * along;
        link(p, from, from + along, dice);
        break;
      }
      case DeedKind::bridge: {
        const Vec3 from = system_.particles().position(p), to = system_.particles().position(q);
        if (norm(to - from) < 1e-3) break;
        call("combine", link(p, from, to, dice), q, 0);
        break;
      }
      case DeedKind::combine:
        if (may_meet(p, q, dice)) call("combine", p, q, 0);
        break;
      case DeedKind::combine_slowly:
        if (may_meet(p, q, dice)) call("combine", p, q, dice.uniform(0.02, 0.3));
        break;
      case DeedKind::combine_bodies:
        call("combine_bodies", system_.particles().body(p), system_.particles().body(q));
        break;
      case DeedKind::cut: {
        const std::vector<ParticleId> ring = system_.particles().ring(p);
        if (ring.size() > 1) call("separate", p, ring[dice.below(static_cast<std::uint32_t>(ring.size()))]);
        break;
      }
      case DeedKind::separate:
        if (particles.size() < 60) call("separate", p, q);
        break;
      case DeedKind::nail: call("nail", p); break;
      case DeedKind::move_nail:
        if (system_.particles().is_nailed(p)) call("move_nail", p, system_.particles().position(p) + dice.point(0.2));
        break;
      case DeedKind::release: call("release", p); break;
      case DeedKind::spring:
        if (p != q) {
          const double stiffness = std::pow(10, dice.uniform(-1, 5));
          call("spring", p, q, stiffness, dice.uniform(0, 2));
        }
        break;
      case DeedKind::drag:
        if (p != q) call("drag", p, q, dice.uniform(0, 5));
        break;
      case DeedKind::law: {
        constexpr std::array laws{"tether", "soft_repulsion", "gravity", "attract_repel", "morse", "dashpot"};
        if (p != q) call("law", p, q, laws[dice.below(laws.size())]);
        break;
      }
      case DeedKind::joint: make_joint(p, q, dice); break;
      case DeedKind::distance:
        if (p != q) call("distance", number(dice.below(2) == 0 ? ConstraintKind::rod : ConstraintKind::rope), p, q);
        break;
      case DeedKind::surface: make_surface(p, dice); break;
      case DeedKind::path: {
        const Vec3 from = system_.particles().position(p);
        const CurveKind curve = dice.below(2) == 0 ? CurveKind::spline : CurveKind::polyline;
        const Vec3 before = from - dice.point(0.5), next = from + dice.point(0.5), last = from + dice.point(1);
        const double friction = dice.below(2) == 0 ? 0 : dice.uniform(0, 5);
        call("path", p, number(curve), friction, before, from, next, last);
        break;
      }
      case DeedKind::switch_constraint: {
        const std::vector<ConstraintId> all = system_.joints().ids();
        if (all.empty()) break;
        const ConstraintId constraint = all[deed.a % all.size()];
        call("switch_constraint", constraint, system_.joints().state(constraint).active ? 0 : 1);
        break;
      }
      case DeedKind::destroy_constraint: {
        const std::vector<ConstraintId> all = system_.joints().ids();
        if (!all.empty()) call("destroy_constraint", all[deed.a % all.size()]);
        break;
      }
      case DeedKind::destroy_bond: {
        const std::vector<BondId> bonds = system_.bonds().ids();
        if (!bonds.empty()) call("destroy_bond", bonds[deed.a % bonds.size()]);
        break;
      }
      case DeedKind::grip: {
        const Vec3 target = system_.particles().position(p) + dice.point(0.5);
        call("grip", system_.particles().body(p), dice.point(0.1), target);
        break;
      }
      case DeedKind::move_grip:
        if (!grips().empty()) call("move_grip", grips()[deed.a % grips().size()], dice.point(1));
        break;
      case DeedKind::let_go:
        if (!grips().empty()) call("let_go", grips()[deed.a % grips().size()]);
        break;
      case DeedKind::push: call("push", p, 10 * dice.point(1)); break;
      case DeedKind::set_velocity: call("set_velocity", p, dice.point(3)); break;
      case DeedKind::set_mass: call("set_mass", p, dice.mass()); break;
      case DeedKind::set_kind: {
        constexpr std::array kinds{BodyKind::dynamic,  BodyKind::dynamic,  BodyKind::static_,
                                   BodyKind::scripted, BodyKind::inactive, BodyKind::resting};
        call("set_kind", system_.particles().body(p), number(kinds[dice.below(kinds.size())]));
        break;
      }
      case DeedKind::destroy_particle: call("destroy_particle", p); break;
      case DeedKind::destroy_body: call("destroy_body", system_.particles().body(p)); break;
      case DeedKind::set_mode:
        call("set_mode", number(dice.below(2) == 0 ? IntegrationMode::robust : IntegrationMode::energy_keeping));
        break;
      case DeedKind::step: break;
    }
  }

  template <class Enum>
  static int number(Enum value) {
    return static_cast<int>(value);
  }
  const std::vector<GripId>& grips() const { return watched_.grips(); }

  /// Particles of connected bodies can seldom meet; one pair in eight may try.
  bool may_meet(ParticleId p, ParticleId q, Dice& dice) const {
    return dice.below(8) == 0 || system_.bodies().articulate(system_.particles().body(p)) !=
                                     system_.bodies().articulate(system_.particles().body(q));
  }

  /// A two-point body whose first end is combined with p; returns its second end.
  ParticleId link(ParticleId p, const Vec3& from, const Vec3& to, Dice& dice) {
    const double mass = dice.mass();
    const Vec3 velocity = system_.particles().velocity(p);
    call("body");
    const BodyId body = watched_.body;
    call("particle", body, from, mass, velocity);
    const ParticleId first = watched_.particle;
    call("particle", body, to, mass, velocity);
    const ParticleId second = watched_.particle;
    if (dice.below(3) == 0) call("rod", body, mass, 0.02);
    call("combine", p, first, 0);
    return second;
  }

  void make_solid(ParticleId p, Dice& dice) {
    const double mass = dice.mass();
    const Vec3 position = dice.point(1), velocity = dice.point(1), spin = dice.point(3);
    const double size = dice.uniform(0.05, 0.3);
    const std::array<std::pair<const char*, Vec3>, 4> shapes{{{"box", {size, 2 * size, 0.3 * size}},
                                                              {"sphere", {size, 0, 0}},
                                                              {"cylinder", {0.1 * size, size, 0}},
                                                              {"torus", {size, 0.2 * size, 0}}}};
    const auto& [shape, sizes] = shapes[dice.below(4)];
    call("solid", shape, sizes, mass, position, velocity, spin, Vec3{size, 0, 0}, Vec3{-size, 0.5 * size, 0.2 * size});
    call("combine", p, system_.bodies().attachments(watched_.body).front(), 0);
  }

  void make_joint(ParticleId p, ParticleId q, Dice& dice) {
    constexpr std::array kinds{ConstraintKind::ball,        ConstraintKind::universal, ConstraintKind::revolute,
                               ConstraintKind::cylindrical, ConstraintKind::prismatic, ConstraintKind::orientation,
                               ConstraintKind::weld};
    const ConstraintKind kind = kinds[dice.below(kinds.size())];
    const BodyId b = dice.below(4) == 0 ? BodyId{} : system_.particles().body(q);
    const Vec3 at = system_.particles().position(p) + dice.point(0.05), axis = dice.point(1);
    CoordinateOptions angle, slide;
    for (CoordinateOptions* coordinate : {&angle, &slide}) {
      if (dice.below(4) == 0) coordinate->lower = -dice.uniform(0, 1), coordinate->upper = dice.uniform(0, 1);
      if (dice.below(4) == 0) coordinate->friction = dice.uniform(0, 5);
      if (dice.below(4) == 0) coordinate->stiffness = dice.uniform(0, 100), coordinate->damping = dice.uniform(0, 1);
    }
    call("joint", number(kind), system_.particles().body(p), b, at, axis, angle.lower, angle.upper, angle.friction,
         angle.stiffness, angle.damping, slide.lower, slide.upper, slide.friction, slide.stiffness, slide.damping);
  }

  /// A particle on a sphere or half-space through its place, or inside or outside of one, as it is at present.
  void make_surface(ParticleId p, Dice& dice) {
    constexpr std::array kinds{ConstraintKind::surface, ConstraintKind::inside, ConstraintKind::outside};
    const ConstraintKind kind = kinds[dice.below(kinds.size())];
    const double radius = dice.uniform(0.2, 1);
    Vec3 away = dice.point(1);
    away = (radius / (norm(away) + 1e-9)) * away;
    const double part = kind == ConstraintKind::surface ? 1 : kind == ConstraintKind::inside ? 0.5 : 1.5;
    const Vec3 place = system_.particles().position(p);
    if (dice.below(2) == 0)
      call("on_sphere", number(kind), p, place + part * away, radius);
    else
      call("on_plane", number(kind), p, place - (part - 1) * away, away);
  }

  Tally& tally_;
  WatchedSystem watched_;
  const System& system_ = watched_.system();
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

  // Frequencies of deeds; joining is more frequent than cutting, as a scene of single particles tests little. Every
  // other scene has joints and constraints.
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
  Player player(tally);
  ++tally.scenes;
  for (std::size_t i = 0; i < script.size(); ++i)
    if (std::optional<std::string> wrong = player.act(script[i]))
      return "after deed " + std::to_string(i) + " (" + names[static_cast<std::size_t>(script[i].kind)] +
             "): " + *wrong;
  return std::nullopt;
}

std::function<bool(const std::vector<Deed>&)> same_complaint_as(const std::vector<Deed>& script) {
  // The text up to the first number, without the place in the script.
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
  std::string lines;
  Tally ignored;
  Player player(ignored, &lines);
  for (const Deed& deed : script)
    if (player.act(deed)) break;
  return lines;
}

}  // namespace iota::scenes
