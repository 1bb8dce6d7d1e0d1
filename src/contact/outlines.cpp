// SPDX-License-Identifier: Apache-2.0
#include "contact/outlines.h"

#include "base/sort_unique.h"
#include "model/outline.h"
#include "model/solid.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace iota::contact {

using model::none;

namespace {

bool is_still(BodyKind kind) { return kind == BodyKind::static_ || kind == BodyKind::resting; }

}  // namespace

const OutlineTree& Outlines::refresh(std::uint64_t steps) {
  // Births of sparks are edits of no outline.
  const std::uint32_t version = structure_.structure_version - structure_.spark_changes;
  is_edited_ = edits_ != structure_.edits || version_ != version;
  // Otherwise an edit of one body takes as long as all of them have outlines: half a millisecond for 6000 frozen ones.
  const bool knows_edited = version_ == version && !std::exchange(lacks_flags_, false);
  if (!is_edited_ && steps == steps_ && is_described() && !is_stale_) return tree_;
  steps_ = steps, edits_ = structure_.edits, version_ = version;
  describe_changed();
  take_out_frozen();
  if (is_edited_ && knows_edited) expect_flagged();
  if (is_edited_ && !knows_edited) {
    for (std::uint32_t body = 0; body < tree_.count(); ++body) look_for(body, false);
  } else {
    scratch_ = due_.slots();
    scratch_.insert(scratch_.end(), movable_.begin(), movable_.end());
    if (is_edited_) scratch_.insert(scratch_.end(), fixed_.begin(), fixed_.end());
    if (scratch_.size() > movable_.size()) sort_unique(scratch_);  // the tree hears of them in order
    for (const std::uint32_t body : scratch_) look_for(body, true);
  }
  due_.clear();
  tree_.update();
  is_stale_ = false;
  return tree_;
}

/// Looks where a body is that may have moved.
void Outlines::look_for(std::uint32_t body, bool spares_frozen) {
  if (!tree_.has(body)) return;
  const bool is_frozen = movers_[body] == Mover::nothing;
  const BodyKind kind = is_frozen ? BodyKind::resting : structure_.bodies[body].kind;
  // An obstacle that was moved has been described anew.
  const bool may_be_edited = is_edited_ && !(is_frozen && spares_frozen) && !structure_.obstacles.has(body);
  if (!may_be_edited && kind == kinds_[body] && is_still(kind)) return;
  kinds_[body] = kind;
  place(body);
  if (kind == BodyKind::inactive)
    tree_.hide(body);
  else
    tree_.show(body);
}

/// A body that was frozen within a stride has moved until its end, and is looked for once more.
void Outlines::take_out_frozen() {
  std::erase_if(movable_, [&](std::uint32_t body) {
    if (!structure_.is_frozen(body)) return false;
    movers_[body] = Mover::nothing;
    due_.note(body), ++lists_version_;
    return true;
  });
}

/// Edits may have moved these.
void Outlines::expect_flagged() {
  for (const std::uint32_t articulate : structure_.flagged()) {
    if (!structure_.articulates.is_alive(articulate)) continue;
    structure_.for_each_body_of(articulate, [&](std::uint32_t body) {
      if (body < kinds_.size()) kinds_[body] = BodyKind::dynamic, due_.note(body);
    });
  }
}

bool Outlines::is_described() const {
  const model::ChangedSlots& changed = structure_.changed_outlines;
  return changed.is_on && changed.slots().empty() && structure_.changed_freezes.slots().empty() &&
         usual_radius_ == model::usual_radius(structure_);
}

void Outlines::describe() {
  if (is_described() && aging_.empty()) return;
  describe_changed();
  is_stale_ = true;
}

void Outlines::describe_changed() {
  model::ChangedSlots& changed = structure_.changed_outlines;
  const double usual_radius = model::usual_radius(structure_);
  scratch_ = structure_.changed_freezes.slots();
  const std::size_t frozen = scratch_.size();
  // A restored structure has no log yet.
  if (!changed.is_on || usual_radius != usual_radius_) {
    usual_radius_ = usual_radius;
    tree_.clear();
    aging_.clear();
    structure_.bodies.for_each([&](std::uint32_t body, const model::Body&) { scratch_.push_back(body); });
    movable_.clear(), fixed_.clear();
    is_edited_ = true;
  } else {
    scratch_.insert(scratch_.end(), aging_.begin(), aging_.end());
    scratch_.insert(scratch_.end(), changed.slots().begin(), changed.slots().end());
    aging_.clear();
  }
  for (std::size_t i = frozen; i < scratch_.size(); ++i) describe(scratch_[i]), described_.note(scratch_[i]);
  list(scratch_);
  sort_unique(aging_);
  for (model::ChangedSlots* const log : {&changed, &structure_.changed_freezes}) log->clear(), log->is_on = true;
}

Outlines::Mover Outlines::mover_of(std::uint32_t body) const {
  if (!tree_.has(body) || structure_.is_frozen(body)) return Mover::nothing;
  return structure_.bodies[body].kind == BodyKind::static_ ? Mover::edits : Mover::steps;
}

void Outlines::list(std::span<const std::uint32_t> changed) {
  if (changed.empty()) return;
  ++lists_version_;
  movers_.resize(structure_.bodies.slot_count(), Mover::nothing);
  for (const std::uint32_t body : changed) {
    movers_[body] = mover_of(body);
    if (movers_[body] != Mover::steps) due_.note(body);  // the others are looked for in any case
  }
  for (const auto& [bodies, mover] : {std::pair(&movable_, Mover::steps), std::pair(&fixed_, Mover::edits)}) {
    std::erase_if(*bodies, [&](std::uint32_t body) { return movers_[body] != mover; });
    const auto before = static_cast<std::ptrdiff_t>(bodies->size());
    std::ranges::copy_if(changed, std::back_inserter(*bodies),
                         [&](std::uint32_t body) { return movers_[body] == mover; });
    std::sort(bodies->begin() + before, bodies->end());
    std::inplace_merge(bodies->begin(), bodies->begin() + before, bodies->end());
    bodies->erase(std::unique(bodies->begin(), bodies->end()), bodies->end());
  }
}

void Outlines::describe(std::uint32_t body) {
  if (!structure_.bodies.is_alive(body) || !structure_.is_visible(body)) {
    if (body < reaches_.size()) reaches_[body] = -1;
    return tree_.remove(body);
  }
  Outline& outline = tree_.make(body);
  if (kinds_.size() <= body) kinds_.resize(body + std::size_t{1}, BodyKind::dynamic);
  kinds_[body] = BodyKind::dynamic;  // not still: it will be placed
  structure_.for_each_solid_of(
      body, [&](std::uint32_t s) { outline.solids.push_back({form_of(structure_.solids[s].shape), s, {}, {}}); });
  if (outline.solids.empty()) add_lines(body, outline);
  if (reaches_.size() <= body) reaches_.resize(body + std::size_t{1}, -1);
  if (structure_.bodies[body].count > 0) place(body);
}

void Outlines::add_lines(std::uint32_t body, Outline& outline) {
  const double radius = model::radius_of(structure_, body);
  if (structure_.bodies[body].count > 1) {
    structure_.visit_lines(body,
                           [&](std::uint32_t p, std::uint32_t q) { outline.lines.push_back({p, q, radius, {}, {}}); });
    structure_.for_each_particle_of(body, [&](std::uint32_t p) {
      if (const double own = structure_.ball_radius(p); own > 0) outline.lines.push_back({p, p, own, {}, {}});
    });
  }
  const std::uint32_t first = structure_.bodies[body].first;
  if (outline.lines.empty()) outline.lines.push_back({first, first, radius, {}, {}});
  bool is_aging = false;
  structure_.for_each_particle_of(body, [&](std::uint32_t p) {
    const std::uint32_t slot = structure_.particles[p].attributes;
    is_aging = is_aging || (slot != none && structure_.attributes[slot].emitter != none);
  });
  if (is_aging) aging_.push_back(body);
}

// Hinges that close bend a body for a while, and bodies that are inactive: with the reach that it had then, contacts were missed.
void Outlines::place(std::uint32_t body) {
  Outline& outline = tree_[body];
  for (Solid& solid : outline.solids) {
    const model::SolidPose pose = solid_pose(structure_, solid.number);
    solid.position = pose.position, solid.turn = pose.orientation;
  }
  for (Line& line : outline.lines) line.a = structure_.position(line.p), line.b = structure_.position(line.q);
  const model::Body& record = structure_.bodies[body];
  reaches_[body] = record.count == 0 ? -1 : contact::reach(outline, structure_.position(record.first));
}

std::shared_ptr<const Form> Outlines::form_of(const shape::Data& data) {
  Shape shape = shape::from_data(data);
  const std::shared_ptr<const Mesh> mesh = structure_.meshes.find(data.key);
  if (!mesh && is_convex(shape)) return make_form(std::move(shape));
  std::weak_ptr<const Form>& known = forms_[{data.kind, data.sizes, data.key}];
  std::shared_ptr<const Form> form = known.lock();
  if (form) return form;
  if (mesh) shape = *mesh;
  known = form = structure_.meshes.is_open(data.key) ? make_open_form(std::get<Mesh>(std::move(shape)))
                                                     : make_form(std::move(shape));
  std::erase_if(forms_, [](const auto& each) { return each.second.expired(); });
  return form;
}

}  // namespace iota::contact
