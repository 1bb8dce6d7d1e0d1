// SPDX-License-Identifier: Apache-2.0
#include "ingredient/coupling_form.h"

#include "base/sort_unique.h"
#include "ingredient/joint_forms.h"
#include "ingredient/joint_frames.h"

#include <iota/constraints.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace iota::ingredient {

using namespace joint;

namespace {

/// visit(ratio, row) for the terms of a coupling, as rows of an island's nodes. False if it is not active.
template <class Visit>
bool for_each_coupled_row(const IslandMap& map, const Constraint& coupling, Visit visit) {
  const Model& model = map.model;
  bool complete = true;
  for_each_term(model, coupling, [&](const CoupledTerm& term) {
    const Constraint& c = model.constraints[term.joint];
    const auto places = c.active ? arms_of(map, c) : std::nullopt;
    complete = complete && places;
    if (!complete) return;
    complete = with_coordinate({c, model.geometry(term.joint), *places}, term.coordinate,
                               [&](const auto& row) { visit(term.ratio, row); });
  });
  return complete;
}

}  // namespace

// First the nodes of movable sides a (the wheels and not their carriers), and all of a rope: the gradients by these do
// not vanish together.
std::optional<solver::CouplingConstraint> CouplingForm::row_of(const IslandMap& map, const Constraint& c) {
  std::optional<solver::CouplingConstraint> coupling(std::in_place);
  bool fits = true;
  const bool complete = for_each_coupled_row(map, c, [&]<class Row>(double, const Row& row) {
    const bool all = std::is_same_v<Row, solver::SpanConstraint> || row.first_side == 0;
    for (std::uint32_t i = 0; i < (all ? row.count : row.first_side); ++i)
      if (!map.is_pinned(row.nodes[i])) fits = fits && coupling->list_node(row.nodes[i]);
  });
  if (!complete) return std::nullopt;
  coupling->first_side = coupling->count;
  for_each_coupled_row(map, c, [&](double, const auto& row) {
    for (std::uint32_t i = 0; i < row.count; ++i) fits = fits && coupling->list_node(row.nodes[i]);
  });
  if (!fits) return std::nullopt;  // edits prevent so many points: see `clean_up`
  if (coupling->first_side == coupling->count) coupling->first_side = 0;
  for_each_coupled_row(map, c, [&](double ratio, const auto& row) { coupling->add(ratio, row); });
  return coupling;
}

// Angles are counted from their joints' values.
void CouplingForm::load(solver::CouplingConstraint& row, const Model& model, const Constraint& c, double*) {
  row.target_start = row.target = c.length;
  auto term = row.terms.begin();
  for_each_term(model, c, [&](const CoupledTerm& t) {
    const double now = model.constraints[t.joint].coordinate[static_cast<std::size_t>(t.coordinate)];
    std::visit([&](auto& coordinate) { set_target(coordinate, now, 0); }, (term++)->coordinate);
  });
}

Violation CouplingForm::calc_violation(const Model& model, const Constraint& c) {
  double off = -c.length;
  for_each_term(model, c, [&](const CoupledTerm& term) {
    off += term.ratio * calc_coordinate(model, term.joint, term.coordinate).first;
  });
  const int sign = info(c.kind).sign;
  const double violation = sign == 0 ? std::abs(off) : std::max(0.0, sign * off);
  return {violation, violation / size_of(model, c)};
}

double CouplingForm::size_of(const Model& model, const Constraint& c) {
  double size = 0;
  for_each_term(model, c, [&](const CoupledTerm& term) {
    const bool is_slide = term.coordinate == JointCoordinate::slide;
    const auto& scale = model.constraints[term.joint].scale;
    size = std::max(size, std::abs(term.ratio) * (is_slide ? std::max(scale[0], scale[1]) : 1));
  });
  return size;
}

// ----------------------------------------------------------------------------------------------------- its two lists

namespace {

/// Appends a term to a coupling's list and adds it at the head of its joint's.
void add_term(Model& model, std::uint32_t coupling, CoupledTerm term) {
  Constraint& joint = model.constraints[term.joint];
  term.coupling = coupling, term.next = none, term.next_at_joint = joint.coupled;
  const std::uint32_t slot = joint.coupled = model.coupled_terms.create(term).slot;
  std::uint32_t* end = &model.constraints[coupling].first_term;
  while (*end != none) end = &model.coupled_terms[*end].next;
  *end = slot;
}

}  // namespace

void CouplingForm::remove_terms(Model& model, std::uint32_t coupling) {
  for (std::uint32_t t = std::exchange(model.constraints[coupling].first_term, none), next; t != none; t = next) {
    next = model.coupled_terms[t].next;
    std::uint32_t* link = &model.constraints[model.coupled_terms[t].joint].coupled;
    while (*link != t) link = &model.coupled_terms[*link].next_at_joint;
    *link = model.coupled_terms[t].next_at_joint;
    model.coupled_terms.destroy(t);
  }
}

void CouplingForm::check_terms(const Model& model, model::Audit& audit) {
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

// ------------------------------------------------------------------------------------------------------------ making

namespace {

std::uint32_t make_coupling(Model& model, ConstraintKind kind, std::span<const CoupledTerm> terms, double length,
                            const BreakLimits& breaks) {
  Constraint c;
  c.kind = kind;
  c.breaks = breaks;
  c.particles.fill(none);
  double sum = 0;
  for (const CoupledTerm& term : terms) sum += term.ratio * calc_coordinate(model, term.joint, term.coordinate).first;
  c.length = std::isnan(length) ? sum : length;
  const std::uint32_t slot = Joints::add(model, c);
  for (const CoupledTerm& term : terms) add_term(model, slot, term);
  const std::size_t points = coupled_points(model, model.constraints[slot]);
  if (points <= most_coupled_points) return slot;
  Joints::destroy(model, slot);
  cannot(info(kind).name, "its bodies have " + std::to_string(points) +
                              " points together (a particle 1, a rod 2, a solid 4), " + "and it may couple " +
                              std::to_string(most_coupled_points) + "; make two of it");
}

}  // namespace

std::uint32_t make_constraint(Model& model, const CouplingSpec& spec) {
  std::vector<CoupledTerm> terms;
  for (const CoupledCoordinate& given : spec.terms)
    terms.push_back({.joint = given.constraint.slot, .ratio = given.ratio, .coordinate = given.coordinate});
  return make_coupling(model, spec.kind, terms, spec.length, spec.breaks);
}

// Pieces between the same two particles are one span with a larger ratio.
std::uint32_t make_constraint(Model& model, const TackleSpec& spec) {
  std::vector<CoupledTerm> terms;
  for (std::size_t i = 0; i + 1 < spec.points.size(); ++i) {
    const ParticleId p = spec.points[i], q = spec.points[i + 1];
    const auto joins_them = [&](const CoupledTerm& term) {
      const Constraint& c = model.constraints[term.joint];
      return (c.particles[a_origin] == p.slot && c.particles[b_origin] == q.slot) ||
             (c.particles[a_origin] == q.slot && c.particles[b_origin] == p.slot);
    };
    if (const auto same = std::find_if(terms.begin(), terms.end(), joins_them); same != terms.end()) {
      same->ratio += 1;
      continue;
    }
    const std::uint32_t span = make_constraint(model, SpanSpec{.p = p, .q = q});
    model.constraints[span].is_part = 1;
    terms.push_back({.joint = span, .ratio = 1, .coordinate = JointCoordinate::slide});
  }
  return make_coupling(model, ConstraintKind::tackle, terms, spec.length, spec.breaks);
}

std::size_t coupled_points(const Model& model, const Constraint& coupling) {
  std::vector<std::uint32_t> bodies;
  for_each_term(model, coupling, [&](const CoupledTerm& term) {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model, model.constraints[term.joint], side); body != none)
        bodies.push_back(body);
  });
  sort_unique(bodies);
  std::size_t points = 0;
  for (const std::uint32_t body : bodies) points += model.bodies[body].rank;
  return points;
}

}  // namespace iota::ingredient
