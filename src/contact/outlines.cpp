// SPDX-License-Identifier: Apache-2.0
#include "contact/outlines.h"

#include "model/outline.h"
#include "model/solid.h"

#include <algorithm>
#include <utility>

namespace iota::contact {

using model::none;

namespace {

/// Steps without an edit do not move it.
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
  if (is_edited_ && knows_edited) expect_flagged();
  for (std::uint32_t body = 0; body < tree_.count(); ++body) {
    if (!tree_.has(body)) continue;
    const bool is_frozen = structure_.is_frozen(body);
    const BodyKind kind = is_frozen ? BodyKind::resting : structure_.bodies[body].kind;
    // An obstacle that was moved has been described anew.
    const bool may_be_edited = is_edited_ && !(is_frozen && knows_edited) && !structure_.obstacles.has(body);
    if (!may_be_edited && kind == kinds_[body] && is_still(kind)) continue;
    kinds_[body] = kind;
    place(body);
    if (kind == BodyKind::inactive)
      tree_.hide(body);
    else
      tree_.show(body);
  }
  tree_.update();
  is_stale_ = false;
  return tree_;
}

/// Edits may have moved these.
void Outlines::expect_flagged() {
  for (const std::uint32_t articulate : structure_.flagged()) {
    if (!structure_.articulates.is_alive(articulate)) continue;
    structure_.for_each_body_of(articulate, [&](std::uint32_t body) {
      if (body < kinds_.size()) kinds_[body] = BodyKind::dynamic;
    });
  }
}

bool Outlines::is_described() const {
  const model::ChangedSlots& changed = structure_.changed_outlines;
  return changed.is_on && changed.slots().empty() && usual_radius_ == model::usual_radius(structure_);
}

void Outlines::describe() {
  if (is_described() && aging_.empty()) return;
  describe_changed();
  is_stale_ = true;
}

void Outlines::describe_changed() {
  model::ChangedSlots& changed = structure_.changed_outlines;
  const double usual_radius = model::usual_radius(structure_);
  // A restored structure has no log yet.
  if (!changed.is_on || usual_radius != usual_radius_) {
    usual_radius_ = usual_radius;
    tree_.clear();
    aging_.clear();
    structure_.bodies.for_each([&](std::uint32_t body, const model::Body&) { describe(body); });
    is_edited_ = true;
  } else {
    for (const std::uint32_t body : std::exchange(aging_, {})) describe(body);
    for (const std::uint32_t body : changed.slots()) describe(body);
  }
  std::ranges::sort(aging_);
  aging_.erase(std::ranges::unique(aging_).begin(), aging_.end());
  changed.clear();
  changed.is_on = true;
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
  measure(body);
}

void Outlines::measure(std::uint32_t body) {
  if (reaches_.size() <= body) reaches_.resize(body + std::size_t{1}, -1);
  reaches_[body] = -1;
  if (structure_.bodies[body].count == 0) return;
  place(body);
  reaches_[body] = contact::reach(tree_[body], structure_.position(structure_.bodies[body].first));
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

void Outlines::place(std::uint32_t body) {
  Outline& outline = tree_[body];
  for (Solid& solid : outline.solids) {
    const model::SolidPose pose = solid_pose(structure_, solid.number);
    solid.position = pose.position, solid.turn = pose.orientation;
  }
  for (Line& line : outline.lines) line.a = structure_.position(line.p), line.b = structure_.position(line.q);
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
