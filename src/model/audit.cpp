// SPDX-License-Identifier: Apache-2.0
#include "model/audit.h"

#include "model/solid.h"
#include "shape/shape.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace iota::model {

Audit::Audit(const Structure& model)
    : model_(model),
      uses_(model.particles.slot_count(), 0),
      in_body_(model.bodies.slot_count(), 0),
      in_ring_(model.rings.slot_count(), 0),
      in_articulate_(model.articulates.slot_count(), 0),
      connected_(model.bodies.slot_count()) {}

void Audit::require_group(const char* what, std::uint32_t slot, std::uint32_t group) {
  require(group == none || model_.groups.is_alive(group), what, " ", slot, " acts on no living group");
}

bool Audit::require_shape(const char* what, std::uint32_t slot, const shape::Data& data) {
  try {
    shape::check(shape::from_data(data));
    return true;
  } catch (const std::invalid_argument& error) {
    require(false, what, " ", slot, " has no shape: ", error.what());
    return false;
  }
}

void Audit::check_links() {
  const auto is_point = [&](std::uint32_t p) { return model_.particles.is_alive(p); };
  require(model_.groups.slot_count() <= 32, "there are ", model_.groups.slot_count(), " groups, more than 32");
  model_.groups.for_each([&](std::uint32_t slot, const Group& g) { require_text("group", slot, g.name); });
  model_.particles.for_each([&](std::uint32_t slot, const Particle& p) {
    require(model_.bodies.is_alive(p.body) && model_.rings.is_alive(p.ring), "particle ", slot,
            " is in no living body or ring");
    require(p.attributes == none || model_.attributes.is_alive(p.attributes), "particle ", slot,
            " has attributes that are gone");
    require(p.basis_index >= -1 && p.basis_index < 4, "particle ", slot, " is basis point ", int(p.basis_index));
  });
  model_.bodies.for_each([&](std::uint32_t slot, const Body& b) {
    require(b.kind <= BodyKind::resting && b.kind_before <= BodyKind::resting, "body ", slot, " is of no kind");
    require(model_.articulates.is_alive(b.articulate), "body ", slot, " is in no living articulate");
    require(b.rank <= 4 && b.row_count <= 6, "body ", slot, " has ", int(b.row_count), " rows at rank ", int(b.rank));
    require((b.row_count > 1) == model_.more_rows.has(slot), "body ", slot, " with ", int(b.row_count),
            " rows has a wrong table of them");
    for (int i = 0; i < std::min<int>(b.rank, 4); ++i)
      require(is_point(b.basis[i]), "body ", slot, " has a wrong basis point ", i);
  });
  model_.body_damping.for_each([&](std::uint32_t slot, double damping) {
    require(model_.bodies.is_alive(slot), "dead body ", slot, " has a damping");
    require(std::isfinite(damping) && damping >= 0, "body ", slot, " has damping ", damping);
  });
  model_.obstacles.for_each([&](std::uint32_t slot, const Obstacle& o) {
    require(model_.bodies.is_alive(slot), "dead body ", slot, " is an obstacle");
    if (!model_.bodies.is_alive(slot)) return;
    const Body& b = model_.bodies[slot];
    const BodyKind kind = b.kind == BodyKind::inactive ? b.kind_before : b.kind;
    require(kind == BodyKind::static_ && b.count == 0 && b.first_solid != none, "obstacle ", slot,
            " can move, has particles or no shape");
    const Quaternion& q = o.orientation;
    require(is_finite(o.position) && std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-6, "obstacle ",
            slot, " is at no place");
  });
  model_.radii.for_each([&](std::uint32_t slot, double radius) {
    require(model_.bodies.is_alive(slot), "dead body ", slot, " has a radius");
    require(std::isfinite(radius) && radius > 0, "body ", slot, " has radius ", radius);
  });
  model_.colors.for_each([&](std::uint32_t slot, std::uint32_t color) {
    require(model_.bodies.is_alive(slot), "dead body ", slot, " has a color");
    require(color <= 0xffffff, "body ", slot, " has color ", color);
  });
  const auto check = [this](const Material& m, std::string_view whose) {
    require(std::isfinite(m.friction) && m.friction >= 0, whose, " has friction ", m.friction);
    require(m.restitution >= 0 && m.restitution <= 1, whose, " has restitution ", m.restitution);
    require(std::isfinite(m.rolling) && m.rolling >= 0, whose, " has rolling resistance ", m.rolling);
    require(std::isfinite(m.spinning) && m.spinning >= 0, whose, " has friction against spinning ", m.spinning);
    require(std::isfinite(m.static_friction) && m.static_friction >= 0, whose, " has static friction ",
            m.static_friction);
    require(is_finite(m.surface_velocity), whose, " has no finite surface velocity");
    require(m.touches <= Touches::sensor, whose, " touches unknown bodies");
  };
  check(model_.usual_material, "the usual material");
  model_.materials.for_each([&](std::uint32_t slot, const Material& material) {
    require(model_.bodies.is_alive(slot), "dead body ", slot, " has a material");
    check(material, text("the material of body ", slot));
  });
  require(std::isfinite(model_.usual_radius) && model_.usual_radius >= 0, "the usual radius is ", model_.usual_radius);
  model_.attributes.for_each([&](std::uint32_t slot, const Attributes& a) {
    require(is_point(a.particle), "attributes ", slot, " are of no living particle");
  });
  model_.inertia_pairs.for_each([&](std::uint32_t slot, const InertiaPair& pair) {
    require(model_.bodies.is_alive(pair.body) && is_point(pair.p) && is_point(pair.q), "inertia pair ", slot,
            " is of nothing that lives");
  });
  model_.solids.for_each([&](std::uint32_t slot, const Solid& s) {
    require(model_.bodies.is_alive(s.body), "solid ", slot, " is not of body ", s.body);
    for (const std::uint32_t p : s.points)
      require(model_.obstacles.has(s.body) ? p == none : is_point(p), "solid ", slot, " stands on stranger ", p);
    if (require_shape("solid", slot, s.shape) && model_.bodies.is_alive(s.body))
      require(!is_free(model_.bodies[s.body].kind) || !lacks_volume(model_, s.shape), "solid ", slot,
              " has no volume, but its body can move");
  });
  check_meshes();
  check_structure_lists();
}

void Audit::check_meshes() {
  const std::uint32_t mesh_kind = shape::to_data(Mesh{}).kind;
  std::map<std::uint64_t, std::uint32_t> found;
  model_.solids.for_each([&](std::uint32_t slot, const Solid& s) {
    if (s.shape.kind != mesh_kind) return;
    ++found[s.shape.key];
    require(model_.meshes.find(s.shape.key) != nullptr, "solid ", slot, " has a mesh that is not there");
  });
  model_.meshes.for_each([&](std::uint64_t key, const Mesh& mesh, bool is_open, std::uint32_t uses) {
    const std::string complaint = complaint_about(key, mesh, is_open);
    require(complaint.empty(), "mesh ", key, ": ", complaint);
    require(found[key] == uses, "mesh ", key, " is of ", found[key], " solids, not of ", uses);
  });
}

void Audit::check_structure_lists() {
  const auto firsts_of = [](const auto& heads) {
    std::vector<std::uint32_t> firsts;
    heads.for_each([&](std::uint32_t, const auto& head) { firsts.push_back(head.first); });
    return firsts;
  };
  const auto& particles = model_.particles;
  const auto& bodies = model_.bodies;
  const auto is_particle = [&](std::uint32_t p) { return particles.is_alive(p); };
  check_lists(
      "particles", firsts_of(bodies), particles.slot_count(), is_particle,
      [&](std::uint32_t p) { return particles[p].next_in_body; },
      [&](std::uint32_t p) { return particles[p].previous_in_body; });
  check_lists(
      "particles", firsts_of(model_.rings), particles.slot_count(), is_particle,
      [&](std::uint32_t p) { return particles[p].next_in_ring; },
      [&](std::uint32_t p) { return particles[p].previous_in_ring; });
  check_lists(
      "bodies", firsts_of(model_.articulates), bodies.slot_count(), [&](std::uint32_t b) { return bodies.is_alive(b); },
      [&](std::uint32_t b) { return bodies[b].next_in_articulate; },
      [&](std::uint32_t b) { return bodies[b].previous_in_articulate; });
  const auto of_bodies = [&](std::uint32_t Body::* first) {
    return [this, first](auto lead_to) {
      model_.bodies.for_each([&](std::uint32_t, const Body& b) { lead_to(b.*first); });
    };
  };
  check_chains("inertia pair", model_.inertia_pairs, of_bodies(&Body::first_inertia));
  check_chains("solid", model_.solids, of_bodies(&Body::first_solid));
  check_chains("twin", model_.twins, [&](auto lead_to) {
    model_.first_twin.for_each([&](std::uint32_t, std::uint32_t first) { lead_to(first); });
  });
}

template <class Table, class Heads>
void Audit::check_chains(const char* what, const Table& items, Heads for_each_first) {
  std::vector<std::uint32_t> before(items.slot_count(), 0);  // number of links to each
  const auto lead_to = [&](std::uint32_t item) {
    if (item == none) return;
    require(items.is_alive(item) && ++before[item] == 1, what, " ", item, " is gone, or in two lists");
  };
  for_each_first(lead_to);
  items.for_each([&](std::uint32_t, const auto& item) { lead_to(item.next); });
  items.for_each(
      [&](std::uint32_t item, const auto&) { require(before[item] > 0, what, " ", item, " is in no list"); });
}

void Audit::check_structure() {
  check_particles();
  check_rings();
  check_bodies();
  require_owners("a fuse", model_.fuses, model_.particles);
  model_.twins.for_each([&](std::uint32_t slot, const Twin& t) {
    require(model_.particles.is_alive(t.particle) && t.mass >= 0, "twin ", slot, " is of no living particle");
    require(t.next == none || model_.twins[t.next].particle == t.particle, "twin ", slot, " leads to a stranger");
  });
  model_.first_twin.for_each([&](std::uint32_t particle, std::uint32_t first) {
    require(model_.twins[first].particle == particle, "the first twin of particle ", particle, " is a stranger");
  });
}

void Audit::check_particles() {
  std::uint32_t living_groups = 0;
  model_.groups.for_each([&](std::uint32_t slot, const Group&) { living_groups |= 1u << slot; });
  model_.particles.for_each([&](std::uint32_t slot, const Particle& p) {
    require(p.mass >= 0 && std::isfinite(p.mass), "particle ", slot, " has mass ", p.mass);
    require(!p.is_marker() || (p.basis_index < 0 && model_.bodies[p.body].rank > 0), "marker ", slot,
            " is in its body's basis, or alone in it");
    ++in_body_[p.body], ++in_ring_[p.ring];
    const Body& body = model_.bodies[p.body];
    require(p.basis_index < 0 || (p.basis_index < body.rank && body.basis[p.basis_index] == slot), "particle ", slot,
            " is not basis point ", int(p.basis_index), " of its body");
    require(p.attributes == none || model_.attributes[p.attributes].particle == slot, "particle ", slot,
            " has the attributes of another");
    require((p.groups & ~living_groups) == 0, "particle ", slot, " is in a group that is gone");
  });
}

void Audit::check_rings() {
  model_.rings.for_each([&](std::uint32_t slot, const Ring& r) {
    std::uint32_t walked = 0, last = none;
    std::vector<std::uint32_t> owners;
    model_.for_each_in_ring(slot, [&](std::uint32_t p) {
      ++walked, last = p;
      require(model_.particles.is_alive(p) && model_.particles[p].ring == slot, "ring ", slot, " lists stranger ", p);
      owners.push_back(model_.particles[p].body);
    });
    require(last == r.last, "ring ", slot, " ends with ", r.last, ", its list with ", last);
    require(walked == r.count && walked == in_ring_[slot] && walked > 0, "ring ", slot, " counts ", r.count,
            " particles, lists ", walked, ", has ", in_ring_[slot]);
    std::sort(owners.begin(), owners.end());
    require(std::adjacent_find(owners.begin(), owners.end()) == owners.end(), "ring ", slot,
            " holds two particles of one body");
    require(is_finite(r.position) && is_finite(r.velocity), "ring ", slot, " is not finite");
  });
}

void Audit::check_bodies() {
  model_.bodies.for_each([&](std::uint32_t slot, const Body& b) {
    std::uint32_t walked = 0, last = none;
    model_.for_each_particle_of(slot, [&](std::uint32_t p) {
      ++walked, last = p;
      require(model_.particles.is_alive(p) && model_.particles[p].body == slot, "body ", slot, " lists stranger ", p);
    });
    require(last == b.last, "body ", slot, " ends with ", b.last, ", its list with ", last);
    require(walked == b.count && walked == in_body_[slot], "body ", slot, " counts ", b.count, " particles, lists ",
            walked, ", has ", in_body_[slot]);
    ++in_articulate_[b.articulate];
    for (int i = 0; i < b.rank; ++i)
      require(model_.particles.is_alive(b.basis[i]) && model_.particles[b.basis[i]].body == slot &&
                  model_.particles[b.basis[i]].basis_index == i,
              "body ", slot, " has a wrong basis point ", i);
    model_.for_each_solid_of(slot, [&](std::uint32_t s) {
      require(model_.solids.is_alive(s) && model_.solids[s].body == slot, "solid ", s, " is not of body ", slot);
      if (model_.obstacles.has(slot)) return;
      for (const std::uint32_t p : model_.solids[s].points)
        require(model_.particles.is_alive(p) && model_.particles[p].body == slot, "solid ", s, " stands on stranger ",
                p);
    });
  });
}

void Audit::check_counts() {
  check_articulates();
  model_.particles.for_each([&](std::uint32_t slot, const Particle& p) {
    require(p.uses == uses_[slot], "particle ", slot, " counts ", p.uses, " uses, has ", uses_[slot]);
  });
  for (const auto& [item, count] : counts_)
    require(count.found == count.told, item.first, " ", item.second, " counts ", count.told, " uses, has ",
            count.found);
}

void Audit::check_articulates() {
  // Articulates are exactly the components of the hinge graph (an ingredient may tie bodies as hinges do).
  model_.rings.for_each([&](std::uint32_t, const Ring& r) {
    if (r.first == none) return;
    for (std::uint32_t p = model_.particles[r.first].next_in_ring; p != none; p = model_.particles[p].next_in_ring)
      connected_.join(model_.particles[p].body, model_.particles[r.first].body);
  });
  std::vector<std::uint32_t> articulate_of_root(model_.bodies.slot_count(), none),
      roots_of(model_.articulates.slot_count(), 0);
  model_.bodies.for_each([&](std::uint32_t slot, const Body& b) {
    const std::uint32_t r = connected_.root(slot);
    if (articulate_of_root[r] == none) articulate_of_root[r] = b.articulate, ++roots_of[b.articulate];
    require(articulate_of_root[r] == b.articulate, "bodies ", r, " and ", slot,
            " hang together but are in articulates ", articulate_of_root[r], " and ", b.articulate);
  });
  model_.articulates.for_each([&](std::uint32_t slot, const Articulate& a) {
    std::uint32_t walked = 0, last = none;
    model_.for_each_body_of(slot, [&](std::uint32_t b) {
      ++walked, last = b;
      require(model_.bodies.is_alive(b) && model_.bodies[b].articulate == slot, "articulate ", slot, " lists stranger ",
              b);
    });
    require(last == a.last, "articulate ", slot, " ends with ", a.last, ", its list with ", last);
    require(walked == a.count && walked == in_articulate_[slot] && walked > 0, "articulate ", slot, " counts ", a.count,
            " bodies, lists ", walked, ", has ", in_articulate_[slot]);
    require(roots_of[slot] == 1, "articulate ", slot, " holds ", roots_of[slot], " separate pieces");
  });
}

}  // namespace iota::model
