// SPDX-License-Identifier: Apache-2.0
// Splits of rigid bodies. Nothing moves: positions and velocities belong to rings, so momenta are kept.
#include "model/restructure.h"

#include <iota/reports.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

namespace iota::model {

namespace {

bool contains(const std::vector<std::uint32_t>& sorted, std::uint32_t item) {
  return std::binary_search(sorted.begin(), sorted.end(), item);
}

/// Moves the items whose particles all leave to another list, and counts the items that are split.
template <class Table, class Leaves>
int hand_over(Table& items, std::uint32_t& from, std::uint32_t& to, std::uint32_t new_body, Leaves how_many_leave) {
  int torn = 0;
  std::uint32_t *link = &from, *end = &to;
  while (*link != none) {
    const std::uint32_t slot = *link;
    const auto [leaving, all] = how_many_leave(items[slot]);
    if (leaving == all) {
      *link = items[slot].next;
      items[slot].body = new_body;
      items[slot].next = none;
      *end = slot, end = &items[slot].next;
    } else {
      torn += leaving > 0;
      link = &items[slot].next;
    }
  }
  return torn;
}

/// Makes a new body of some particles, which stay in their rings. Split solids and inertia pairs are destroyed. Returns
/// the new body.
std::uint32_t split_off(Structure& model, std::uint32_t body, std::vector<std::uint32_t> leaving,
                        RestructureReport& report, bool& torn) {
  std::sort(leaving.begin(), leaving.end());
  const std::uint32_t own = model.make_body(model.bodies[body].kind, model.body_damping[body]);
  model.radii.copy(body, own), model.materials.copy(body, own), model.colors.copy(body, own);
  Body &from = model.bodies[body], &to = model.bodies[own];
  hand_over(model.solids, from.first_solid, to.first_solid, own, [&](const Solid& s) {
    return std::pair{
        std::count_if(s.points.begin(), s.points.end(), [&](std::uint32_t p) { return contains(leaving, p); }),
        std::ptrdiff_t{4}};
  });
  torn = hand_over(model.inertia_pairs, from.first_inertia, to.first_inertia, own, [&](const InertiaPair& i) {
           return std::pair{contains(leaving, i.p) + contains(leaving, i.q), 2};
         }) > 0;
  for (const std::uint32_t p : leaving) {
    model.take_from_body(p);
    model.add_to_body(p, own);
  }
  model.join_articulates(model.bodies[body].articulate, model.bodies[own].articulate);
  report.changed = true;
  report.created_bodies.push_back(model.bodies.id(own));
  return own;
}

/// The last part of a split, after the particles were moved.
/// `back`: particles that were restored since.
void finish_split(Structure& model, std::uint32_t body, std::uint32_t own, std::span<const ParticleId> back,
                  std::vector<std::string>& notes) {
  for (const std::uint32_t b : {body, own}) {
    std::vector<std::uint32_t> newcomers;
    for (const ParticleId p : back)
      if (model.particles[p.slot].body == b) newcomers.push_back(p.slot);
    if (!keeps_basis(model, b) || !carry_by_basis(model, b, model.bodies[b].count, newcomers)) model.rebuild_basis(b);
    model.mark_body(b);
  }
  split_where_apart(model, std::vector{body, own});  // before markers are destroyed, which splits, too
  for (const std::uint32_t b : {body, own}) destroy_stray_markers(model, b, notes);
}

/// Particles of a body in sets that are merged.
class Pieces {
 public:
  Pieces(const Structure& model, std::uint32_t body) {
    model.for_each_particle_of(body, [&](std::uint32_t p) { particles.push_back(p); });
    std::sort(particles.begin(), particles.end());
    parent_.resize(particles.size());
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  /// None for a particle of another body.
  void join(std::uint32_t p, std::uint32_t q) {
    if (has(p) && has(q)) parent_[piece(p)] = piece(q);
  }
  bool has(std::uint32_t p) const { return std::binary_search(particles.begin(), particles.end(), p); }
  /// A number of the piece of a particle.
  std::size_t piece(std::uint32_t p) const {
    auto i = static_cast<std::size_t>(std::lower_bound(particles.begin(), particles.end(), p) - particles.begin());
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::uint32_t> particles;

 private:
  mutable std::vector<std::size_t> parent_;
};

}  // namespace

std::vector<BodyId> parts_of(const Structure& model, std::uint32_t body) {
  std::vector<BodyId> parts;
  std::set<BodyId> known;
  const auto add = [&](BodyId part) {
    if (!parts.empty() && parts.back() == part) return;
    if (known.insert(part).second) parts.push_back(part);
  };
  std::vector<std::uint32_t> twins;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    add(model.particles[p].part);
    model.for_each_twin_of(p, [&](std::uint32_t t) { twins.push_back(t); });
  });
  std::sort(twins.begin(), twins.end());
  for (const std::uint32_t t : twins) add(model.twins[t].part);
  return parts;
}

Edit separate_part(Structure& model, std::uint32_t body, BodyId part, RestructureReport& report) {
  std::vector<std::uint32_t> leaving;
  bool goes = false, stays = false;              // something with mass
  bool is_part = false, has_other_part = false;  // any particle
  std::vector<std::uint32_t> parted;             // twins that go where their particle does not
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const bool leaves = model.particles[p].part == part;
    if (leaves) leaving.push_back(p);
    (leaves ? is_part : has_other_part) = true;
    if (!model.particles[p].is_marker()) (leaves ? goes : stays) = true;
    model.for_each_twin_of(p, [&](std::uint32_t t) {
      const bool twin_leaves = model.twins[t].part == part;
      (twin_leaves ? is_part : has_other_part) = true;
      (twin_leaves ? goes : stays) = true;
      if (twin_leaves != leaves) parted.push_back(t);
    });
  });
  std::sort(parted.begin(), parted.end());
  if (!is_part || !has_other_part) return {};
  if (!goes || !stays)
    throw std::invalid_argument("separate: part " + std::to_string(part.slot) + " of body " + std::to_string(body) +
                                (goes ? " has all of its mass" : " has no mass of its own"));
  bool torn = false;
  const std::uint32_t own = split_off(model, body, leaving, report, torn);
  for (const std::uint32_t p : leaving) model.particles[p].part = model.bodies.id(own);

  // A particle that had absorbed one of the other side releases it: the hinge is restored.
  bool shared = false;
  for (const std::uint32_t t : parted) {
    const Twin twin = model.twins[t];
    const std::uint32_t home = twin.part == part ? own : body;
    Particle& survivor = model.particles[twin.particle];
    const double share = twin.mass < survivor.mass ? twin.mass : 0.5 * survivor.mass;
    survivor.mass -= share;
    Particle back;
    back.mass = share, back.part = home == own ? model.bodies.id(own) : twin.part;
    const std::uint32_t ring = survivor.ring;
    const std::uint32_t slot = model.particles.create(back).slot;
    model.add_to_ring(slot, ring);
    model.add_to_body(slot, home);
    model.remove_twin(t);
    report.created_particles.push_back(model.particles.id(slot));
    shared = true;
  }
  finish_split(model, body, own, report.created_particles, report.notes);
  return {false, torn || shared};
}

Edit fall_apart(Structure& model, std::uint32_t p, std::uint32_t q, RestructureReport& report) {
  const std::uint32_t body = model.particles[p].body;
  Pieces pieces(model, body);
  for (const std::uint32_t particle : pieces.particles)
    model.visit_companions(particle, [&](std::uint32_t other) { pieces.join(particle, other); });
  model.for_each_solid_of(body, [&](std::uint32_t s) {
    const Solid& solid = model.solids[s];
    for (const std::uint32_t point : solid.points) pieces.join(point, solid.points[0]);
    const BodyId part = model.particles[solid.points[0]].part;
    for (const std::uint32_t particle : pieces.particles)  // its attachments
      if (model.particles[particle].part == part) pieces.join(particle, solid.points[0]);
  });
  const std::size_t stays = pieces.piece(p), leaves = pieces.piece(q);
  if (stays == leaves) return {};

  // Pieces connected to neither end go with the nearer one.
  struct Nearest {
    double to_stays = -1, to_leaves = -1;
  };
  std::vector<Nearest> nearest(pieces.particles.size());
  for (const std::uint32_t loose : pieces.particles) {
    const std::size_t piece = pieces.piece(loose);
    if (piece == stays || piece == leaves) continue;
    for (const std::uint32_t other : pieces.particles) {
      const std::size_t side = pieces.piece(other);
      if (side != stays && side != leaves) continue;
      const double d = norm(model.position(loose) - model.position(other));
      double& best = side == stays ? nearest[piece].to_stays : nearest[piece].to_leaves;
      if (best < 0 || d < best) best = d;
    }
  }
  std::vector<std::uint32_t> leaving;
  int followed = 0;
  double left = 0, gone = 0;
  for (const std::uint32_t particle : pieces.particles) {
    const std::size_t piece = pieces.piece(particle);
    const bool goes = piece == leaves || (piece != stays && nearest[piece].to_leaves < nearest[piece].to_stays);
    if (goes) leaving.push_back(particle);
    (goes ? gone : left) += model.particles[particle].mass;
    followed += goes && piece != leaves;
  }
  if (!(left > 0) || !(gone > 0)) {
    report.notes.push_back("body " + std::to_string(body) + " stays whole: one of its two pieces would have no mass");
    return {};
  }
  bool torn = false;
  const std::uint32_t own = split_off(model, body, leaving, report, torn);
  if (parts_of(model, own).size() == 1)
    for (const std::uint32_t particle : leaving) model.particles[particle].part = model.bodies.id(own);
  finish_split(model, body, own, {}, report.notes);
  if (followed > 0)
    report.notes.push_back(std::to_string(followed) + " particles without a cosmetic bond went with the nearer piece");
  return {false, torn};
}

}  // namespace iota::model
