// SPDX-License-Identifier: Apache-2.0
// Describes to viewers what has changed: the bodies that the scene log names, what hangs on them, and what has vanished.
#include "math/mat3.h"
#include "system/core.h"

#include <iota/scene.h>

#include <algorithm>
#include <limits>

namespace iota {

namespace {

using model::none;

/// Springs and constraints are tables of their own: a tie's slot tells which one it is of.
constexpr std::uint32_t slot_of_spring(std::uint32_t bond) { return 2 * bond; }
constexpr std::uint32_t slot_of_distance(std::uint32_t constraint) { return 2 * constraint + 1; }

class SceneDescriber {
 public:
  explicit SceneDescriber(Core& core) : core_(core), model_(core.model) {}

  /// Everything that there is.
  SceneChanges describe_all() {
    changes_.is_whole = true;
    changes_.extent = extent();
    const auto all = [](const auto& table) {
      std::vector<std::uint32_t> slots;
      table.for_each([&](std::uint32_t slot, const auto&) { slots.push_back(slot); });
      return slots;
    };
    for (const std::uint32_t slot : all(model_.bodies)) add_body(slot), add_membership(slot);
    for (const std::uint32_t slot : all(model_.bonds)) add_spring(slot);
    for (const std::uint32_t slot : all(model_.constraints)) add_constraint(slot);
    for (const std::uint32_t slot : all(model_.rings)) add_nail(slot);
    for (const std::uint32_t slot : all(model_.emitters)) add_particle_set(slot);
    return std::move(changes_);
  }

  SceneChanges describe_changed() {
    const model::SceneLog& log = model_.scene;
    changes_.is_whole = false;
    std::vector<std::uint32_t> bonds = log.bonds.slots(), constraints = log.constraints.slots(),
                               rings = log.rings.slots();
    for (const std::uint32_t body : log.bodies.slots()) {
      add_body(body);
      if (!model_.bodies.is_alive(body)) continue;
      model_.for_each_particle_of(body, [&](std::uint32_t p) {
        model_.for_each_bond_of(p, [&](std::uint32_t bond) { bonds.push_back(bond); });
        model_.for_each_constraint_of(p, [&](std::uint32_t constraint, int) { constraints.push_back(constraint); });
        rings.push_back(model_.particles[p].ring);
      });
    }
    for (const std::uint32_t body : log.memberships.slots()) add_membership(body);
    for (const std::uint32_t slot : each_once(bonds)) add_spring(slot);
    for (const std::uint32_t slot : each_once(constraints)) add_constraint(slot);
    for (const std::uint32_t slot : each_once(rings)) add_nail(slot);
    for (const std::uint32_t slot : log.emitters.slots()) add_particle_set(slot);
    return std::move(changes_);
  }

 private:
  static std::vector<std::uint32_t>& each_once(std::vector<std::uint32_t>& slots) {
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    return slots;
  }

  double extent() const {
    constexpr double far = std::numeric_limits<double>::infinity();
    Vec3 low{far, far, far}, high{-far, -far, -far};
    model_.rings.for_each([&](std::uint32_t, const model::Ring& ring) {
      const Vec3& r = ring.position;
      low = {std::min(low.x, r.x), std::min(low.y, r.y), std::min(low.z, r.z)};
      high = {std::max(high.x, r.x), std::max(high.y, r.y), std::max(high.z, r.z)};
    });
    return model_.rings.size() > 0 ? norm(high - low) : 0;
  }

  static DrawnLine line(const Vec3& from, const Vec3& to) {
    const double length = norm(to - from);
    return {0.5 * (from + to), length > 0 ? shortest_turn({1, 0, 0}, (1 / length) * (to - from)) : Quaternion{},
            length};
  }

  bool is_drawn(std::uint32_t body) const {
    if (!model_.bodies.is_alive(body)) return false;
    const model::Body& b = model_.bodies[body];
    return b.count > 0 && !model_.is_spark(b.first);
  }
  Vec3 into_body(std::uint32_t body, const Vec3& direction) const {
    const Quaternion& q = model_.bodies[body].orientation;
    return rotate({-q.x, -q.y, -q.z, q.w}, direction);
  }
  Vec3 point_in(std::uint32_t body, const Vec3& place) const {
    return into_body(body, place - model_.center_of_mass(body));
  }
  Anchor anchor(std::uint32_t body, const Vec3& place) const {
    if (body == none) return {{}, place};
    return {model_.bodies.id(body), point_in(body, place)};
  }
  Anchor anchor(std::uint32_t particle) const {
    return anchor(model_.particles[particle].body, model_.position(particle));
  }

  void add_body(std::uint32_t slot) {
    if (!is_drawn(slot)) return changes_.bodies.gone.push_back(slot);
    const model::Body& body = model_.bodies[slot];
    DrawnBody& drawn = changes_.bodies.set.emplace_back();
    drawn.id = model_.bodies.id(slot);
    drawn.is_new = model_.scene.bodies.is_new(slot);
    drawn.kind = body.kind;
    drawn.particles = body.count;
    const Quaternion& q = body.orientation;
    for (SolidView& solid : Bodies(core_).solids(drawn.id))
      drawn.solids.push_back({std::move(solid.shape), point_in(slot, solid.position),
                              multiply({-q.x, -q.y, -q.z, q.w}, solid.orientation)});
    if (body.count == 1) {
      const ParticleId only = model_.particles.id(body.first);
      if (Particles(core_).has_attributes(only)) drawn.attributes = Particles(core_).attributes(only);
    } else {
      add_lines(slot, drawn);
    }
  }

  void add_lines(std::uint32_t slot, DrawnBody& drawn) const {
    const Vec3 center = model_.center_of_mass(slot);
    const auto local = [&](std::uint32_t p) { return into_body(slot, model_.position(p) - center); };
    model_.for_each_particle_of(slot, [&](std::uint32_t p) {
      model_.for_each_cosmetic_bond_of(p, [&](std::uint32_t bond) {
        const model::CosmeticBond& b = model_.cosmetic_bonds[bond];
        if (b.p == p) drawn.lines.push_back(line(local(b.p), local(b.q)));
      });
    });
    if (!drawn.lines.empty()) return;
    std::uint32_t before = none;
    model_.for_each_particle_of(slot, [&](std::uint32_t p) {
      if (before != none) drawn.lines.push_back(line(local(before), local(p)));
      before = p;
    });
  }

  void add_membership(std::uint32_t body) {
    if (is_drawn(body)) changes_.memberships.push_back({body, model_.bodies[body].articulate});
  }

  void add_spring(std::uint32_t slot) {
    if (!model_.bonds.is_alive(slot) || !model_.bonds[slot].active || model_.bonds[slot].law != model::spring_law)
      return changes_.ties.gone.push_back(slot_of_spring(slot));
    const model::Bond& bond = model_.bonds[slot];
    constexpr std::size_t length = 2;  // of the spring's parameters
    static_assert(laws::Spring::parameters[length].name == std::string_view("length"));
    changes_.ties.set.push_back(
        {slot_of_spring(slot), DrawnTie::Kind::spring, bond.parameters[length], anchor(bond.p), anchor(bond.q)});
  }

  /// A constraint is a tie, a joint or, while it is inactive, neither.
  void add_constraint(std::uint32_t slot) {
    const bool is_there = model_.constraints.is_alive(slot) && model_.constraints[slot].active;
    const ConstraintKind kind = is_there ? model_.constraints[slot].kind : ConstraintKind::ball;
    const bool is_tie = is_there && (kind == ConstraintKind::rod || kind == ConstraintKind::rope);
    if (is_tie) {
      const model::Constraint& c = model_.constraints[slot];
      const std::vector<ParticleId> ends = Joints(core_).particles(model_.constraints.id(slot));
      const auto tie = kind == ConstraintKind::rod ? DrawnTie::Kind::rod : DrawnTie::Kind::rope;
      changes_.ties.set.push_back({slot_of_distance(slot), tie, c.length, anchor(ends[0].slot), anchor(ends[1].slot)});
    } else {
      changes_.ties.gone.push_back(slot_of_distance(slot));
    }
    if (is_there && !is_tie) {
      const ConstraintState state = Joints(core_).state(model_.constraints.id(slot));
      const std::uint32_t b = state.b ? state.b.slot : none;
      changes_.joints.set.push_back({slot, model::info(kind).name, anchor(state.a.slot, state.position),
                                     anchor(b, state.position), into_body(state.a.slot, state.axis)});
    } else {
      changes_.joints.gone.push_back(slot);
    }
  }

  void add_nail(std::uint32_t ring) {
    if (!model_.rings.is_alive(ring) || !model_.rings[ring].nailed) return changes_.nails.gone.push_back(ring);
    changes_.nails.set.push_back({ring, anchor(model_.rings[ring].first)});
  }

  void add_particle_set(std::uint32_t slot) {
    if (!model_.emitters.is_alive(slot)) return changes_.particle_sets.gone.push_back(slot);
    const model::Emitter& emitter = model_.emitters[slot];
    changes_.particle_sets.set.push_back({slot, emitter.active != 0, emitter.max_count});
  }

  Core& core_;
  const model::Model& model_;
  SceneChanges changes_;
};

}  // namespace

SceneChanges Viewer::take_scene_changes(bool whole, std::span<const BodyId> also) {
  core_.orientations.refresh(core_.model);
  model::Model& model = core_.model;
  for (const BodyId body : also)
    if (model.bodies.contains(body)) model.scene.bodies.note(body.slot);
  SceneDescriber describer(core_);
  SceneChanges changes = whole || model.scene.is_whole ? describer.describe_all() : describer.describe_changed();
  changes.events = std::move(model.scene.events);
  model.scene.clear();
  model.scene.watch();
  return changes;
}

void Viewer::stop_watching_scene() { core_.model.scene = {}; }

}  // namespace iota
