// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joints.h"

#include "base/text.h"
#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "model/restructure.h"
#include "solver/largest.h"

#include <iota/scene.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

namespace iota::ingredient {

using namespace joint;

namespace {

using Form = ConstraintKindInfo::Form;

/// The nearer of the two limits, as a one-sided row.
template <class Row>
void load_limit(Row& row, const CoordinateOptions& o, double now, solver::RowLaw& law) {
  if (o.lower == o.upper) return set_target(row, now, o.lower);
  const bool at_lower = now - o.lower < o.upper - now;
  set_target(row, now, at_lower ? o.lower : o.upper);
  (at_lower ? law.upper : law.lower) = 0;
}

/// The speed of a motor, or the one that brings a servo to its target.
double motor_rate(const CoordinateOptions& o, double now, double h) {
  if (std::isnan(o.servo)) return o.motor_speed;
  const double time = std::max(h, o.servo_time), most = std::abs(o.motor_speed);
  return time > 0 ? std::clamp((o.servo - now) / time, -most, most) : 0;
}

/// Each once, in the order of slots.
std::vector<std::uint32_t> active_joints_of(const IslandMap& map) {
  std::vector<std::uint32_t> joints;
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

/// The places of a joint by the nodes of an island; none if one of its sides is inactive.
std::optional<PlaceArms> arms_of(const IslandMap& map, const Constraint& c) {
  const Model& model = map.model;
  PlaceArms places{};
  for (int place = 0; place < place_count; ++place) {
    if (!c.has(place)) continue;
    if (c.particles[place] == none) {
      places[place].constant = c.fixed[place - b_origin];
      continue;
    }
    // Through the basis, even if the particle is an unknown of its own: so a row couples only two bodies.
    const model::Body& body = model.bodies[model.particles[c.particles[place]].body];
    const std::array<double, 4> weights = model.weights(c.particles[place]);
    int used = 0;
    for (int i = 0; i < body.rank; ++i) {
      if (weights[i] == 0) continue;
      const std::uint32_t node = map.node_of(body.basis[i]);
      if (node == none) return std::nullopt;
      places[place].nodes[used++] = {node, weights[i]};
    }
  }
  return places;
}

/// visit(ratio, row) for the terms of a coupling, as rows of an island's nodes. False if it is not active.
template <class Visit>
bool for_each_coupled_row(const IslandMap& map, const Constraint& coupling, Visit visit) {
  const Model& model = map.model;
  bool complete = true;
  auto ignore = [](const auto&, RowUse) {};
  for_each_term(model, coupling, [&](const CoupledTerm& term) {
    const Constraint& c = model.constraints[term.joint];
    const auto places = c.active ? arms_of(map, c) : std::nullopt;
    complete = complete && places;
    if (!complete) return;
    const JointRowBuilder<decltype(ignore)> rows(c, model.geometry(term.joint), *places, ignore);
    complete = rows.with_coordinate(term.coordinate, [&](const auto& row) { visit(term.ratio, row); });
  });
  return complete;
}

RowUse use_of(solver::ItemKey key) { return {static_cast<Role>(key.part[0]), key.part[1], key.part[2]}; }

}  // namespace

RowsOf rows_of(const CoordinateOptions& o) {
  return {std::isfinite(o.lower) || std::isfinite(o.upper), o.motor_max > 0, o.friction > 0,
          o.stiffness > 0 || o.damping > 0};
}

void Joints::build(const IslandMap& map, Problem& problem) {
  for (const std::uint32_t slot : active_joints_of(map)) add(map, slot, problem);
}

void Joints::leave(const IslandMap& map) {
  const std::vector<std::uint32_t> again = active_joints_of(map);
  const auto goes = [&](std::uint32_t slot) { return std::binary_search(again.begin(), again.end(), slot); };
  std::erase_if(joints_, goes), std::erase_if(pinned_, goes);
}

void Joints::add(const IslandMap& map, std::uint32_t slot, Problem& problem) {
  const Constraint& c = map.model.constraints[slot];
  if (info(c.kind).form == ConstraintKindInfo::Form::coupling) return add_coupling(map, slot, problem);
  const auto places = arms_of(map, c);
  if (!places) return;
  joints_.push_back(slot);
  auto sink = [&](const auto& row, RowUse use) { add_row(map, slot, row, use, problem); };
  JointRowBuilder<decltype(sink)>(c, map.model.geometry(slot), *places, sink).run();
}

// First the nodes of movable sides a (the wheels and not their carriers), and all of a rope: the gradients by these do
// not vanish together.
void Joints::add_coupling(const IslandMap& map, std::uint32_t slot, Problem& problem) {
  const Constraint& c = map.model.constraints[slot];
  solver::CouplingConstraint coupling;
  bool fits = true;
  const bool complete = for_each_coupled_row(map, c, [&]<class Row>(double, const Row& row) {
    const bool all = std::is_same_v<Row, solver::SpanConstraint> || row.first_side == 0;
    for (std::uint32_t i = 0; i < (all ? row.count : row.first_side); ++i)
      if (!map.is_pinned(row.nodes[i])) fits = fits && coupling.list_node(row.nodes[i]);
  });
  if (!complete) return;
  coupling.first_side = coupling.count;
  for_each_coupled_row(map, c, [&](double, const auto& row) {
    for (std::uint32_t i = 0; i < row.count; ++i) fits = fits && coupling.list_node(row.nodes[i]);
  });
  if (!fits) return;  // edits prevent so many points: see `settle`
  if (coupling.first_side == coupling.count) coupling.first_side = 0;
  for_each_coupled_row(map, c, [&](double ratio, const auto& row) { coupling.add(ratio, row); });
  joints_.push_back(slot);
  add_row(map, slot, coupling, {}, problem);
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

namespace {

/// Angles are counted from their joints' values.
void follow_coordinates(const Model& model, const Constraint& c, solver::CouplingConstraint& coupling) {
  auto term = coupling.terms.begin();
  for_each_term(model, c, [&](const CoupledTerm& t) {
    const double now = model.constraints[t.joint].coordinate[static_cast<std::size_t>(t.coordinate)];
    std::visit([&](auto& row) { set_target(row, now, 0); }, (term++)->coordinate);
  });
}

}  // namespace

void Joints::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  if (joints_.empty()) return;
  problem.for_each_constraint_pool([&]<class C>(solver::ConstraintPool<C>& pool) {
    for_each_item_of<C>(owner, problem, [&](std::size_t item, solver::ItemKey key) {
      const Constraint& c = model.constraints[key.slot];
      const RowUse use = use_of(key);
      C& row = pool.items[item];
      if (use.role == Role::hold) {
        load_held(row, c, use, pool.multiplier(item));
        const ConstraintKindInfo& kind = info(c.kind);
        if (kind.form == Form::distance || kind.form == Form::coupling) set_length(row, c.length);
        if constexpr (std::is_same_v<C, solver::CouplingConstraint>)
          if (kind.form == Form::coupling) follow_coordinates(model, c, row);
        if (pool.has_laws()) std::fill_n(pool.law(item), C::rows, law_of_hold(c, use, row));
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
          law = {.lower = -o.motor_max, .upper = o.motor_max, .rate = motor_rate(o, now, h), .hold = true};
          break;
        case Role::friction: law = {.lower = -o.friction, .upper = o.friction, .hold = true}; break;
        default:
          law.compliance = 1 / o.stiffness;  // infinite for a pure dashpot
          law.damping = o.damping;
          set_target(row, now, o.rest);
      }
    });
  });
}

void Joints::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  if (joints_.empty()) return;
  for (const std::uint32_t slot : joints_) {
    model.constraints[slot].gap = 0;
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
      save_held(pool.items[item], c, use, pool.multiplier(item));
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

void Joints::refresh(Model& model, const IslandNodes&, bool) const {
  for (const std::uint32_t slot : joints_) refresh_coordinates(model, slot);
}

bool Joints::meets_pinned(const Model& model) const {
  constexpr double met = 1e-6;
  return std::all_of(pinned_.begin(), pinned_.end(), [&](std::uint32_t slot) {
    return !is_in_force(model, model.constraints[slot]) || calc_violation(model, slot).relative <= met;
  });
}

std::string Joints::name_of_row(const Model& model, solver::ItemKey key) const {
  return text("the ", info(model.constraints[key.slot].kind).name, " constraint ", key.slot);
}

namespace {

/// Each term of a coupling must be once in its coupling's list, and once in its joint's.
void check_terms(const Model& model, model::Audit& audit) {
  std::vector<std::uint8_t> seen(model.coupled_terms.slot_count());
  const auto check_list = [&](std::uint32_t slot, std::uint32_t first, std::uint8_t list, auto owner, auto next) {
    for (std::uint32_t t = first; t != none;) {
      const bool is_good =
          model.coupled_terms.is_alive(t) && owner(model.coupled_terms[t]) == slot && (seen[t] & list) == 0;
      audit.require(is_good, "constraint ", slot, " has a term of another, or a list of terms without an end");
      if (!is_good) return;
      seen[t] |= list;
      t = next(model.coupled_terms[t]);
    }
  };
  model.constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    check_list(slot, c.first_term, 1, [](auto& t) { return t.coupling; }, [](auto& t) { return t.next; });
    check_list(slot, c.coupled, 2, [](auto& t) { return t.joint; }, [](auto& t) { return t.next_at_joint; });
  });
  model.coupled_terms.for_each([&](std::uint32_t t, const CoupledTerm& term) {
    audit.require(seen[t] == 3, "term ", t, " of a coupling is not listed");
    const ConstraintKind kind =
        model.constraints.is_alive(term.joint) ? model.constraints[term.joint].kind : ConstraintKind::ball;
    const bool is_known = static_cast<std::size_t>(kind) < constraint_kinds.size() &&
                          static_cast<std::size_t>(term.coordinate) < joint_coordinates.size();
    audit.require(is_known && has_coordinate(kind, term.coordinate) && std::isfinite(term.ratio), "term ", t,
                  " of a coupling refers to no coordinate of a joint");
  });
}

}  // namespace

void Joints::check_links(const Model& model, model::Audit& audit) {
  using Alignment = Constraint::Alignment;
  using Lock = Constraint::Lock;
  model.constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    const bool known = static_cast<std::size_t>(c.kind) < constraint_kinds.size() && c.alignment <= Alignment::axes &&
                       c.lock <= Lock::third_of_a && c.aligned <= 2 && c.line_side <= 1;
    audit.require(known, "constraint ", slot, " is of no kind");
    for (int place = 0; place < place_count; ++place) {
      const std::uint32_t p = c.particles[place];
      audit.require(p == none ? (c.owned >> place & 1) == 0 : model.particles.is_alive(p), "constraint ", slot,
                    " holds a stranger at place ", place);
    }
    const bool couples = known && info(c.kind).form == Form::coupling;
    audit.require(couples || (c.particles[a_origin] != none && c.has(b_origin) && (c.in_world & 0x0f) == 0),
                  "constraint ", slot, " joins nothing");
    audit.require(couples == (c.first_term != none), "constraint ", slot, " couples nothing, or is not a coupling");
    const bool has_curve = c.kind == ConstraintKind::path;
    audit.require(has_curve || c.curve.count == 0, "constraint ", slot, " has a curve");
    audit.require(std::uint64_t{c.curve.first} + c.curve.count <= model.curve_points.size(), "constraint ", slot,
                  " has ", c.curve.count, " points of a curve from ", c.curve.first, "; there are ",
                  model.curve_points.size());
    audit.require(c.curve.kind <= CurveKind::polyline, "constraint ", slot, " has a curve of no kind");
  });
  std::vector<std::uint32_t> firsts;
  model.places.for_each([&](std::uint32_t, const model::ListHead& head) { firsts.push_back(head.first); });
  audit.check_lists(
      "places of constraints", firsts, place_count * model.constraints.slot_count(),
      [&](std::uint32_t link) {
        return model.constraints.is_alive(link / place_count) &&
               model.constraints[link / place_count].particles[link % place_count] != none;
      },
      [&](std::uint32_t link) { return model.constraints[link / place_count].next[link % place_count]; },
      [&](std::uint32_t link) { return model.constraints[link / place_count].previous[link % place_count]; });
  check_terms(model, audit);
}

void Joints::validate(const Model& model, model::Audit& audit) {
  std::uint32_t places = 0, listed = 0;
  model.constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    for (int place = 0; place < place_count; ++place) {
      const std::uint32_t p = c.particles[place];
      if (p == none) continue;
      const bool own =
          model.particles.is_alive(p) && model.particles[p].body == body_of_side(model, c, place >= b_origin);
      audit.require(own, info(c.kind).name, " ", slot, " holds a stranger at place ", place);
      ++places;
    }
    const bool may_be_within = info(c.kind).form == Form::coupling || c.kind == ConstraintKind::span;
    audit.require(may_be_within || body_of_side(model, c, 0) != body_of_side(model, c, 1), info(c.kind).name, " ", slot,
                  " joins a body to itself");
  });
  audit.require_owners("lists", model.places, model.particles);
  model.places.for_each([&](std::uint32_t slot, const model::ListHead& head) {
    for (std::uint32_t link = head.first; link != none;) {
      const std::uint32_t joint = link / place_count, place = link % place_count;
      const bool good = model.constraints.is_alive(joint) && model.constraints[joint].particles[place] == slot;
      audit.require(good, "particle ", slot, " lists constraint ", joint, ", which is not there");
      if (!good || ++listed > places) return;
      link = model.constraints[joint].next[place];
    }
  });
  audit.require(listed == places, "the particles list ", listed, " of ", places, " places of constraints");
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

void link_place(Model& model, std::uint32_t slot, std::uint32_t place) {
  Constraint& c = model.constraints[slot];
  std::uint32_t& first = model.places.make(c.particles[place]).first;
  c.next[place] = first, c.previous[place] = none;
  if (first != none) model.constraints[first / place_count].previous[first % place_count] = place_count * slot + place;
  first = place_count * slot + place;
  model.touch_particle(c.particles[place]);
}

void unlink_place(Model& model, std::uint32_t slot, std::uint32_t place) {
  const Constraint& c = model.constraints[slot];
  const std::uint32_t before = c.previous[place], after = c.next[place];
  if (after != none) model.constraints[after / place_count].previous[after % place_count] = before;
  if (before != none)
    model.constraints[before / place_count].next[before % place_count] = after;
  else if (after != none)
    model.places.at(c.particles[place]).first = after;
  else
    model.places.erase(c.particles[place]);
  model.touch_particle(c.particles[place]);
}

/// Removes the terms of a coupling from the lists of their joints.
void remove_terms(Model& model, std::uint32_t coupling) {
  for (std::uint32_t t = std::exchange(model.constraints[coupling].first_term, none), next; t != none; t = next) {
    next = model.coupled_terms[t].next;
    std::uint32_t* link = &model.constraints[model.coupled_terms[t].joint].coupled;
    while (*link != t) link = &model.coupled_terms[*link].next_at_joint;
    *link = model.coupled_terms[t].next_at_joint;
    model.coupled_terms.destroy(t);
  }
}

/// Removes it from the tables; its markers stay.
void remove(Model& model, std::uint32_t slot) {
  for (std::uint32_t place = 0; place < place_count; ++place)
    if (model.constraints[slot].particles[place] != none) unlink_place(model, slot, place);
  const CurveData curve = model.constraints[slot].curve;
  model.geometries[slot] = {};
  model.constraints.destroy(slot);
  model.changed_constraints.note(slot);
  if (curve.count == 0) return;
  const auto first = model.curve_points.begin() + curve.first;
  model.curve_points.erase(first, first + curve.count);
  model.constraints.for_each([&](std::uint32_t, Constraint& c) {
    if (c.curve.first > curve.first) c.curve.first -= curve.count;
  });
}

/// The reason why an edit has made a joint meaningless; null: it has not.
const char* reason_to_end(const Model& model, const Constraint& c) {
  if (c.kind == ConstraintKind::span) return nullptr;
  const std::uint32_t a = body_of_side(model, c, 0), b = body_of_side(model, c, 1);
  for (int place = 0; place < place_count; ++place)
    if (c.particles[place] != none && model.particles[c.particles[place]].body != (place < b_origin ? a : b))
      return "one of its bodies came apart there";
  const std::uint32_t p = c.particles[a_origin], q = c.particles[b_origin];
  if (c.kind == ConstraintKind::rod && p != none && q != none && are_on_one_ring(model, p, q))
    return "its two ends are hinged together now";
  return a == b ? "its two bodies are one rigid body now" : nullptr;
}

}  // namespace

std::uint32_t Joints::add(Model& model, const Constraint& constraint) {
  const std::uint32_t slot = model.constraints.create(constraint).slot;
  for (std::uint32_t place = 0; place < place_count; ++place)
    if (constraint.particles[place] != none) link_place(model, slot, place);
  if (model.geometries.size() <= slot) model.geometries.resize(slot + 1);
  renew_geometry(model, slot);
  return slot;
}

void Joints::destroy(Model& model, std::uint32_t slot) {
  while (model.constraints[slot].coupled != none) {
    destroy(model, model.coupled_terms[model.constraints[slot].coupled].coupling);
    if (!model.constraints.is_alive(slot)) return;  // a span of a destroyed tackle
  }
  const Constraint c = model.constraints[slot];
  std::vector<std::uint32_t> parts;
  for_each_term(model, c, [&](const CoupledTerm& term) {
    if (model.constraints[term.joint].is_part) parts.push_back(term.joint);
    for (const int origin : {a_origin, b_origin})
      if (const std::uint32_t p = model.constraints[term.joint].particles[origin]; p != none) model.touch_particle(p);
  });
  remove_terms(model, slot);
  remove(model, slot);
  for (const std::uint32_t part : parts) remove(model, part);
  for (int place = 0; place < place_count; ++place) {
    if (!(c.owned >> place & 1)) continue;
    const model::Particle& p = model.particles[c.particles[place]];
    // A marker that was hinged, bonded, constrained or given a mass since is not used by the constraint only.
    if (p.is_marker() && !model.is_needed(p) && !model.places.has(c.particles[place]))
      model::destroy_particle(model, c.particles[place]);
  }
}

void Joints::renew_geometry(Model& model, std::uint32_t constraint) {
  model.geometries[constraint] = make_geometry(model, model.constraints[constraint]);
}

void Joints::take_over(Model& restored, Model& before) {
  restored.surface_functions.swap(before.surface_functions);
  restored.geometries.assign(restored.constraints.slot_count(), {});
  try {
    restored.constraints.for_each([&](std::uint32_t slot, const Constraint&) { renew_geometry(restored, slot); });
  } catch (...) {  // bytes may contain an invalid curve or surface
    restored.surface_functions.swap(before.surface_functions);
    throw;
  }
}

bool Joints::ties_any(const Model& model) { return model.constraints.size() > 0; }

void Joints::visit_tied(const Model& model, std::uint32_t particle, Visit visit) {
  model.for_each_constraint_of(particle, [&](std::uint32_t slot, int place) {
    const Constraint& c = model.constraints[slot];
    if (!c.active || (place != a_origin && place != b_origin)) return;
    if (const std::uint32_t other = body_of_side(model, c, place == a_origin ? 1 : 0); other != none) visit(other);
    for_each_coupling_of(model, c, [&](std::uint32_t coupling) {
      if (!model.constraints[coupling].active) return;
      for_each_term(model, model.constraints[coupling], [&](const CoupledTerm& term) {
        for (const int side : {0, 1})
          if (const std::uint32_t body = body_of_side(model, model.constraints[term.joint], side); body != none)
            visit(body);
      });
    });
  });
}

bool Joints::ties_to_world(const Model& model, std::uint32_t body) {
  bool tied = false;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.for_each_constraint_of(p, [&](std::uint32_t slot, int) {
      tied = tied || (model.constraints[slot].active && body_of_side(model, model.constraints[slot], 1) == none);
    });
  });
  return tied;
}

// The places of one side stay with its origin.
void Joints::visit_companions(const Model& model, std::uint32_t particle, Visit visit) {
  model.for_each_constraint_of(particle, [&](std::uint32_t slot, int place) {
    const std::uint32_t origin = model.constraints[slot].particles[place < b_origin ? a_origin : b_origin];
    if (origin != none && model.particles[origin].body == model.particles[particle].body) visit(origin);
  });
}

void Joints::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  while (model.places.has(q)) {
    const std::uint32_t link = model.places[q].first, slot = link / place_count, place = link % place_count;
    Constraint& c = model.constraints[slot];
    if (std::find(c.particles.begin(), c.particles.end(), p) != c.particles.end()) {  // two places at one particle
      for (std::uint32_t i = 0; i < place_count; ++i)                                 // both stay
        if (c.particles[i] == p || c.particles[i] == q) c.owned &= static_cast<std::uint8_t>(~(1u << i));
      destroy(model, slot);
      continue;
    }
    unlink_place(model, slot, place);
    c.particles[place] = p;
    c.owned &= static_cast<std::uint8_t>(~(1u << place));
    link_place(model, slot, place);
  }
}

void Joints::drop(Model& model, std::uint32_t particle) {
  while (model.places.has(particle)) {
    const std::uint32_t link = model.places[particle].first;
    model.constraints[link / place_count].owned &= static_cast<std::uint8_t>(~(1u << link % place_count));
    destroy(model, link / place_count);
  }
}

void Joints::settle(Model& model, std::span<const std::uint32_t> bodies, std::vector<std::string>& notes) {
  if (model.constraints.size() == 0) return;
  std::vector<std::uint32_t> candidates, too_large;
  for (const std::uint32_t body : bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {  // a hinge joins all bodies of its particles' rings
      model.for_each_in_ring(model.particles[p].ring, [&](std::uint32_t r) {
        model.for_each_constraint_of(r, [&](std::uint32_t c, int) { candidates.push_back(c); });
      });
    });
  sort_unique(candidates);
  for (const std::uint32_t slot : candidates) {
    if (!model.constraints.is_alive(slot)) continue;
    for_each_coupling_of(model, model.constraints[slot], [&](std::uint32_t coupling) {
      if (coupled_points(model, model.constraints[coupling]) > most_coupled_points) too_large.push_back(coupling);
    });
    const char* const reason = reason_to_end(model, model.constraints[slot]);
    if (!reason) continue;
    notes.push_back(text(info(model.constraints[slot].kind).name, " ", slot, " ended: ", reason));
    for_each_coupling_of(model, model.constraints[slot], [&](std::uint32_t coupling) {
      notes.push_back(text(info(model.constraints[coupling].kind).name, " ", coupling, " ended with it"));
    });
    destroy(model, slot);
  }
  sort_unique(too_large);
  for (const std::uint32_t slot : too_large) {
    if (!model.constraints.is_alive(slot)) continue;
    notes.push_back(text(info(model.constraints[slot].kind).name, " ", slot, " ended: its bodies have more than ",
                         most_coupled_points, " points together now"));
    destroy(model, slot);
  }
}

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

// A constraint is drawn as a tie, as a joint or, while it is inactive, as neither.
void Joints::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto list = [&](std::uint32_t p, std::vector<std::uint32_t>& slots) {
    model.for_each_constraint_of(p, [&](std::uint32_t constraint, int) { slots.push_back(constraint); });
  };
  for (const std::uint32_t slot : view.slots(model.constraints, model.changed_constraints, list)) {
    const bool is_there = model.constraints.is_alive(slot) && model.constraints[slot].active;
    const Form form = is_there ? info(model.constraints[slot].kind).form : Form::joint;
    const bool is_tie = is_there && form == Form::distance;
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
    if (is_there && !is_tie && form != Form::coupling) {
      const Constraint& c = model.constraints[slot];
      const std::uint32_t a = body_of_side(model, c, 0), b = body_of_side(model, c, 1);
      const Vec3 place = model.carried(c.particles[a_origin]).first;
      changes.joints.set.push_back({slot, info(c.kind).name, view.anchor(a, place), view.anchor(b, place),
                                    view.into_body(a, calc_axis(model, c))});
    } else {
      changes.joints.gone.push_back(slot);
    }
  }
}

}  // namespace iota::ingredient
