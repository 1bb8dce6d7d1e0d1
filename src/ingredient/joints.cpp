// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joints.h"

#include "base/sort_unique.h"
#include "base/text.h"
#include "ingredient/joint_forms.h"
#include "ingredient/joint_readings.h"
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "solver/largest.h"

#include <iota/scene.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace iota::ingredient {

using namespace joint;

namespace {

/// The nearer of the two limits, as a one-sided row.
template <class Row>
void load_limit(Row& row, const CoordinateOptions& o, double now, solver::RowLaw& law) {
  if (o.lower == o.upper) return set_target(row, now, o.lower);
  const bool at_lower = now - o.lower < o.upper - now;
  set_target(row, now, at_lower ? o.lower : o.upper);
  (at_lower ? law.upper : law.lower) = 0;
}

/// The speed of a motor, or the mean one in a step of h seconds of a servo, whose distance to the target falls by exp(-t/servo_time):
/// its way depends neither on the step nor ends beyond the target.
double motor_rate(const CoordinateOptions& o, double now, double h) {
  if (std::isnan(o.servo)) return o.motor_speed;
  const double most = std::abs(o.motor_speed), distance = o.servo - now;
  if (!(std::max(h, o.servo_time) > 0)) return 0;
  const double speed = h > 0 ? -std::expm1(-h / o.servo_time) * distance / h : distance / o.servo_time;
  return std::clamp(speed, -most, most);
}

/// Each once, in the order of slots. The list is this thread's, until the next call.
std::span<const std::uint32_t> active_joints_of(const IslandMap& map) {
  thread_local std::vector<std::uint32_t> joints;
  joints.clear();
  if (map.model.constraints.size() == 0) return joints;
  for (const std::uint32_t body : map.bodies)
    map.model.for_each_particle_of(body, [&](std::uint32_t p) {
      map.model.for_each_constraint_of(p, [&](std::uint32_t c, int place) {
        if ((place != a_origin && place != b_origin) || !map.model.constraints[c].active) return;
        joints.push_back(c);
        for_each_coupling_of(map.model, map.model.constraints[c], [&](std::uint32_t coupling) {
          if (map.model.constraints[coupling].active) joints.push_back(coupling);
        });
      });
    });
  sort_unique(joints);
  return joints;
}

solver::ItemKey key_of(std::uint8_t owner, std::uint32_t joint, RowUse use) {
  return {owner, {static_cast<std::uint8_t>(use.role), use.coordinate, use.first}, joint};
}

RowUse use_of(solver::ItemKey key) { return {static_cast<Role>(key.part[0]), key.part[1], key.part[2]}; }

}  // namespace

void Joints::build(const IslandMap& map, Problem& problem) {
  for (const std::uint32_t slot : active_joints_of(map)) add(map, slot, problem);
}

void Joints::leave(const IslandMap& map) {
  const Model& model = map.model;
  const std::span<const std::uint32_t> again = active_joints_of(map);
  // Some were destroyed, or belong to bodies that have left the island; a slot may have a new joint of other bodies.
  const auto is_elsewhere = [&](const Constraint& c) {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model, c, side); body != none) return !map.nodes.has(model, body);
    return false;
  };
  const auto goes = [&](std::uint32_t slot) {
    if (!model.constraints.is_alive(slot) || std::binary_search(again.begin(), again.end(), slot)) return true;
    const Constraint& c = model.constraints[slot];
    return !c.active ||
           is_elsewhere(c.first_term == none ? c : model.constraints[model.coupled_terms[c.first_term].joint]);
  };
  std::erase_if(joints_, goes), std::erase_if(pinned_, goes);
}

void Joints::add(const IslandMap& map, std::uint32_t slot, Problem& problem) {
  const Constraint& c = map.model.constraints[slot];
  auto sink = [&](const auto& row, RowUse use) { add_row(map, slot, row, use, problem); };
  with_form(c.kind, [&]<class F>() {
    if constexpr (requires { F::row_of(map, c); }) {
      const auto row = F::row_of(map, c);
      if (!row) return;
      joints_.push_back(slot);
      sink(*row, RowUse{});
    } else {
      const auto places = arms_of(map, c);
      if (!places) return;
      joints_.push_back(slot);
      const JointArms arms{c, map.model.geometry(slot), *places};
      build_rows(arms, sink);
      for (const int which : {angle, second_angle})
        if (has_coordinate(c.kind, joint_coordinates[which]))
          (void)with_coordinate(arms, joint_coordinates[which], [&]<class Row>(const Row& row) {
            if constexpr (std::is_same_v<Row, solver::AngleConstraint>)
              problem.count(row, key_of(owner, slot, {.coordinate = static_cast<std::uint8_t>(which)}));
          });
    }
  });
}

template <class Row>
void Joints::add_row(const IslandMap& map, std::uint32_t slot, const Row& row, RowUse use, Problem& problem) {
  const auto end = row.nodes.begin() + row.node_count();
  // Rows whose nodes are all pinned are only checked, as a step cannot change them.
  if (std::all_of(row.nodes.begin(), end, [&](std::uint32_t node) { return map.is_pinned(node); })) {
    if (use.role == Role::hold && (pinned_.empty() || pinned_.back() != slot)) pinned_.push_back(slot);
    return;
  }
  problem.add(row, key_of(owner, slot, use));
  const Constraint& c = map.model.constraints[slot];
  if (use.role != Role::hold || info(c.kind).sign != 0 || !c.compliance.is_exact()) (void)problem.pool_of<Row>().law(0);
}

void Joints::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  rate_jump_ = 0;
  if (joints_.empty()) return;
  for (auto& [angle, key] : problem.counted_angles)
    set_target(angle, model.constraints[key.slot].coordinate[use_of(key).coordinate], 0);
  problem.for_each_constraint_pool([&]<class C>(solver::ConstraintPool<C>& pool) {
    for_each_item_of<C>(owner, problem, [&](std::size_t item, solver::ItemKey key) {
      const Constraint& c = model.constraints[key.slot];
      const RowUse use = use_of(key);
      C& row = pool.items[item];
      if (use.role == Role::hold) {
        load_hold(row, model, c, use, pool.multiplier(item));
        if (h > 0 && (c.way != 0 || c.rate != 0)) {
          move_target(row, c.way);
          rate_jump_ = std::max(rate_jump_, std::abs(c.way / h - c.rate));
        }
        for (int r = 0; r < C::rows && pool.has_laws(); ++r) pool.law(item)[r] = law_of_hold(c, use, row, r);
        return;
      }
      const CoordinateOptions& o = c.options[use.coordinate];
      *pool.multiplier(item) = c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1];
      solver::RowLaw& law = *pool.law(item) = {};
      const double now = c.coordinate[use.coordinate];
      set_target(row, now, 0);
      switch (use.role) {
        case Role::limit: load_limit(row, o, now, law); break;
        case Role::motor:
          law = {.lower = -o.motor_max, .upper = o.motor_max, .rate = motor_rate(o, now, h), .is_rate = true};
          break;
        case Role::friction: law = {.lower = -o.friction, .upper = o.friction, .is_rate = true}; break;
        default:
          law.compliance = 1 / o.stiffness;  // infinite for a pure dashpot
          law.damping = o.damping;
          set_target(row, now, o.rest);
      }
    });
  });
}

void Joints::store(Model& model, const IslandNodes&, double h, const Problem& problem) const {
  if (joints_.empty()) return;
  for (const auto& [angle, key] : problem.counted_angles)
    model.constraints[key.slot].coordinate[use_of(key).coordinate] = angle.near;
  for (const std::uint32_t slot : joints_) {
    Constraint& c = model.constraints[slot];
    c.gap = 0, c.is_new = 0;
    if (c.way != 0 || c.rate != 0) c.rate = c.way / h, c.way = 0;
    refresh_coordinates(model, slot);
  }
  problem.for_each_constraint_pool([&]<class C>(const solver::ConstraintPool<C>& pool) {
    for_each_item_of<C>(owner, problem, [&](std::size_t item, solver::ItemKey key) {
      Constraint& c = model.constraints[key.slot];
      const RowUse use = use_of(key);
      if (use.role != Role::hold) {
        c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1] = *pool.multiplier(item);
        const CoordinateOptions& o = c.options[use.coordinate];
        if (use.role == Role::limit && o.lower < o.upper)
          c.carries.set(1 + use.coordinate, *pool.multiplier(item) != 0);
        return;
      }
      if (info(c.kind).sign != 0) c.carries.set(0, *pool.multiplier(item) != 0);
      store_hold(pool.items[item], c, use, pool.multiplier(item));
      double g[C::rows];
      pool.items[item].value(problem.position.data(), 1, g);
      for (int r = 0; r < C::rows; ++r) {
        const double off = pool.has_laws() ? pool.law(item)[r].violation(g[r]) : std::abs(g[r]);
        if (!(off <= c.gap)) c.gap = off;
      }
    });
  });
  for (const std::uint32_t slot : pinned_) {
    Constraint& c = model.constraints[slot];
    c.gap = std::max(c.gap, calc_violation(model, slot).absolute);
  }
}

bool Joints::prescribes_motion(const Model& model, const IslandNodes&) const {
  return std::ranges::any_of(joints_, [&](std::uint32_t slot) { return model.constraints[slot].way != 0; });
}

// A motor that turns or a length that runs, however slowly. A motor at its largest force stands, or moves as fast as that.
bool Joints::keeps_awake(const Model& model, const Problem&) const {
  return std::any_of(joints_.begin(), joints_.end(), [&](std::uint32_t slot) {
    const Constraint& c = model.constraints[slot];
    bool turns = c.way != 0;
    for (std::size_t k = 0; k < c.options.size(); ++k) {
      const CoordinateOptions& o = c.options[k];
      turns = turns || (std::isnan(o.servo) && o.motor_speed != 0 &&
                        std::abs(c.efforts[k][static_cast<std::size_t>(Role::motor) - 1]) < o.motor_max);
    }
    return turns;
  });
}

void Joints::refresh(Model& model, const IslandNodes&, bool) const {
  for (const std::uint32_t slot : joints_) refresh_coordinates(model, slot);
}

bool Joints::are_pinned_met(const Model& model) const {
  constexpr double met = 1e-6;
  return std::all_of(pinned_.begin(), pinned_.end(), [&](std::uint32_t slot) {
    return !is_in_force(model, model.constraints[slot]) || calc_violation(model, slot).relative <= met;
  });
}

std::string Joints::name_of_row(const Model& model, solver::ItemKey key) const {
  return text("the ", info(model.constraints[key.slot].kind).name, " constraint ", key.slot);
}

// Energy of its springs, at the coordinates of the last step, and of compliant rows.
void Joints::add_energy(const Scope& scope, Energies& sum) {
  const Model& model = scope.model;
  const auto add = [&](std::uint32_t slot) {
    const Constraint& c = model.constraints[slot];
    for (std::size_t i = 0; i < c.options.size() && c.active; ++i) {
      const double stretch = c.coordinate[i] - c.options[i].rest;
      sum.potential += 0.5 * c.options[i].stiffness * stretch * stretch;
    }
    if (!c.compliance.is_exact() && is_in_force(model, c)) sum.potential += calc_energy_of_holds(model, slot);
  };
  if (scope.is_whole())
    model.constraints.for_each([&](std::uint32_t slot, const Constraint&) { add(slot); });
  else if (model.constraints.size() > 0)
    scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
      model.for_each_constraint_of(p, [&](std::uint32_t slot, int place) {
        if (place == a_origin) add(slot);
      });
    });
}

double Joints::worst_gap(const Scope& scope) {
  const Model& model = scope.model;
  solver::Largest worst;
  const auto add = [&](const Constraint& c) {
    if (is_in_force(model, c)) worst.add(c.gap);
  };
  if (scope.is_whole())
    model.constraints.for_each([&](std::uint32_t, const Constraint& c) { add(c); });
  else if (model.constraints.size() > 0)
    scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
      model.for_each_constraint_of(p, [&](std::uint32_t slot, int) { add(model.constraints[slot]); });
    });
  return worst.value;
}

void Joints::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (model.constraints.size() == 0) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.for_each_constraint_of(p, [&](std::uint32_t slot, int place) {
      reader.take({.particle = p,
                   .force = calc_force_at(step, slot, place),
                   .through_basis = true,
                   .part = model.particles[p].part});
    });
  });
}

bool Joints::holds(const Model& model, std::uint32_t particle) { return model.places.has(particle); }

namespace {

bool tell_failure(const Model& model, std::uint32_t slot, Outcome& outcome) {
  for (const auto& surface : model.geometry(slot).surfaces) {
    if (!surface || surface->failure().empty()) continue;
    outcome.failed.push_back(model.constraints.id(slot));
    outcome.warnings.push_back(text("constraint ", slot, " (", info(model.constraints[slot].kind).name,
                                    "): the function of its surface ", surface->failure(),
                                    "; the constraint is switched off"));
    return true;
  }
  return false;
}

bool tell_overload(const Model& model, std::uint32_t slot, Outcome& outcome) {
  const BreakLimits& limits = model.constraints[slot].breaks;
  if (std::isinf(limits.force) && std::isinf(limits.torque)) return false;
  const Reaction reaction = calc_reaction(model, slot);
  const double force = norm(reaction.force), torque = norm(reaction.torque);
  if (!(force > limits.force || torque > limits.torque)) return false;
  outcome.overloaded.push_back(
      {.constraint = model.constraints.id(slot), .position = reaction.position, .force = force, .torque = torque});
  return true;
}

/// Tells the stops that began or ceased to carry a load since they were last told. `carries`: those that will carry one
/// after this step's edits.
void tell_stops(Model& model, std::uint32_t slot, Constraint::Bits carries, Outcome& outcome) {
  Constraint& c = model.constraints[slot];
  if (carries.bits == c.told.bits) return;
  for (int bit = 0; bit <= static_cast<int>(joint_coordinates.size()); ++bit) {
    if (carries[bit] == c.told[bit]) continue;
    StopEvent& event = outcome.stops.emplace_back();
    event.kind = carries[bit] ? StopEvent::Kind::met : StopEvent::Kind::parted;
    event.constraint = model.constraints.id(slot);
    if (bit > 0) event.coordinate = joint_coordinates[static_cast<std::size_t>(bit - 1)];
    event.position = calc_reaction(model, slot).position;
  }
  c.told = carries;
}

}  // namespace

void Joints::tell(Model& model, Outcome& outcome) {
  model.constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    const bool ends = c.active && (tell_failure(model, slot, outcome) || tell_overload(model, slot, outcome));
    tell_stops(model, slot, ends ? Constraint::Bits{} : c.carries, outcome);
  });
}

model::ChangedSlots* Joints::scene_log(Model& model) { return &model.changed_constraints; }

// Active constraints of a distance are drawn as ties.
void Joints::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto list = [&](std::uint32_t p, std::vector<std::uint32_t>& slots) {
    model.for_each_constraint_of(p, [&](std::uint32_t constraint, int) { slots.push_back(constraint); });
  };
  for (const std::uint32_t slot : view.slots(model.constraints, model.changed_constraints, list)) {
    const bool is_tie = model.constraints.is_alive(slot) && model.constraints[slot].active &&
                        info(model.constraints[slot].kind).form == Form::distance;
    const std::uint32_t tie = DrawnTie::slot_of_joint(slot);
    if (is_tie) {
      const Constraint& c = model.constraints[slot];
      // A piece of a rope over several points is drawn straight, as slack is a property of the whole rope.
      const bool is_rope = c.kind == ConstraintKind::rope || c.is_part;
      const double length = c.kind == ConstraintKind::span ? 0 : c.length;
      changes.ties.set.push_back({tie, is_rope ? DrawnTie::Kind::rope : DrawnTie::Kind::rod, length,
                                  view.anchor(c.particles[a_origin]), view.anchor(c.particles[b_origin])});
    } else {
      changes.ties.gone.push_back(tie);
    }
  }
}

}  // namespace iota::ingredient
