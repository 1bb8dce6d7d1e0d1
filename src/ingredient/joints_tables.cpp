// SPDX-License-Identifier: Apache-2.0
#include "base/sort_unique.h"
#include "base/text.h"
#include "ingredient/joint_forms.h"
#include "ingredient/joint_frames.h"
#include "ingredient/joints.h"
#include "ingredient/model.h"
#include "model/restructure.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::ingredient {

using namespace joint;

namespace {

void link_place(Model& model, std::uint32_t slot, std::uint32_t place) {
  Constraint& c = model.constraints[slot];
  std::uint32_t& first = model.places.make(c.particles[place]).first;
  c.next[place] = first, c.previous[place] = none;
  if (first != none) model.constraints[first / place_count].previous[first % place_count] = place_count * slot + place;
  first = place_count * slot + place;
  model.mark_locally(model.particles[c.particles[place]].body);
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
  model.mark_locally(model.particles[c.particles[place]].body);
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
      if (const std::uint32_t p = model.constraints[term.joint].particles[origin]; p != none)
        model.mark_locally(model.particles[p].body);
  });
  CouplingForm::remove_terms(model, slot);
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

namespace {

/// visit(body): of those that an active joint and its couplings tie to the body of one of its sides.
void visit_other_sides(const Model& model, const Constraint& c, int side, Visit visit) {
  if (const std::uint32_t other = body_of_side(model, c, 1 - side); other != none) visit(other);
  for_each_coupling_of(model, c, [&](std::uint32_t coupling) {
    if (!model.constraints[coupling].active) return;
    for_each_term(model, model.constraints[coupling], [&](const CoupledTerm& term) {
      for (const int side_of_term : {0, 1})
        if (const std::uint32_t body = body_of_side(model, model.constraints[term.joint], side_of_term); body != none)
          visit(body);
    });
  });
}

/// visit(constraint, side): of the active ones with an origin at a particle.
template <class VisitSide>
void for_each_side_at(const Model& model, std::uint32_t particle, VisitSide visit) {
  model.for_each_constraint_of(particle, [&](std::uint32_t slot, int place) {
    const Constraint& c = model.constraints[slot];
    if (c.active && (place == a_origin || place == b_origin)) visit(c, place == a_origin ? 0 : 1);
  });
}

}  // namespace

void Joints::visit_tied(const Model& model, std::uint32_t particle, Visit visit) {
  for_each_side_at(model, particle, [&](const Constraint& c, int side) { visit_other_sides(model, c, side, visit); });
}

void Joints::visit_held(const Model& model, std::uint32_t particle, Visit visit) {
  for_each_side_at(model, particle, [&](const Constraint& c, int side) {
    if (info(c.kind).form != Form::distance) visit_other_sides(model, c, side, visit);
  });
}

void Joints::visit_welded(const Model& model, std::uint32_t particle, Visit visit) {
  for_each_side_at(model, particle, [&](const Constraint& c, int side) {
    if (c.kind == ConstraintKind::weld && c.compliance.is_exact() && is_in_force(model, c))
      visit(body_of_side(model, c, 1 - side));
  });
}

namespace {

/// The normal of the surface that holds a particle, at its place.
Vec3 normal_at(const Model& model, const Constraint& c, std::uint32_t slot) {
  const Vec3 origin = position_of(model, c, b_origin), away = position_of(model, c, a_origin) - origin;
  std::array<Vec3, 3> axes;
  for (int i = 0; i < 3; ++i) axes[i] = unit(position_of(model, c, b_axis + i) - origin);
  const Vec3 slope =
      model.geometry(slot).surfaces[1]->at({dot(away, axes[0]), dot(away, axes[1]), dot(away, axes[2])}).gradient;
  return slope.x * axes[0] + slope.y * axes[1] + slope.z * axes[2];
}

/// It slides along a line, or in the plane normal to it.
Joints::HeldPlace along(const Vec3& place, const Vec3& line) { return {place, {unit(line)}, 1}; }
Joints::HeldPlace across(const Vec3& place, const Vec3& normal) {
  const Vec3 first = any_perpendicular(normal);
  return {place, {first, unit(cross(normal, first))}, 2};
}

}  // namespace

void Joints::visit_held_places(const Model& model, std::uint32_t particle, FunctionRef<void(const HeldPlace&)> visit) {
  model.for_each_constraint_of(particle, [&](std::uint32_t slot, int place) {
    const Constraint& c = model.constraints[slot];
    if (place != a_origin || !c.active || body_of_side(model, c, 1) != none) return;
    const ConstraintKindInfo& kind = info(c.kind);
    // A guide or plane of the world stays where it is, while the body may have left its origin.
    if (kind.meet) visit({.place = model.position(particle)});
    if (kind.line) visit(along(position_of(model, c, b_origin), calc_axis(model, c)));
    if (kind.plane) visit(across(position_of(model, c, b_origin), calc_axis(model, c)));
    if (kind.form == Form::path)
      visit(along(model.position(particle), model.geometry(slot).curve->at(c.coordinate[slide]).d1));
    if (kind.form == Form::surface && kind.sign == 0)
      visit(across(model.position(particle), normal_at(model, c, slot)));
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

void Joints::clean_up(Model& model, std::span<const std::uint32_t> bodies, std::vector<std::string>& notes) {
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

void Joints::check_links(const Model& model, model::Audit& audit) {
  using Alignment = Constraint::Alignment;
  using Lock = Constraint::Lock;
  model.constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    const bool known = static_cast<std::size_t>(c.kind) < constraint_kinds.size() && c.alignment <= Alignment::axes &&
                       c.lock <= Lock::third_of_a && c.aligned <= 2 && c.line_side <= 1;
    audit.require(known, "constraint ", slot, " is of no kind");
    const bool is_line =
        c.kind == ConstraintKind::rod || c.kind == ConstraintKind::rope || c.kind == ConstraintKind::tackle;
    const bool may_run = is_line ? std::abs(c.way) <= c.length : c.kind == ConstraintKind::coupling || c.way == 0;
    audit.require(c.is_new <= 1 && c.is_hauled <= is_line && may_run && std::isfinite(c.way) && std::isfinite(c.rate),
                  "the length of constraint ", slot, " runs without an end");
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
  CouplingForm::check_terms(model, audit);
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

}  // namespace iota::ingredient
