// SPDX-License-Identifier: Apache-2.0
// An island that follows when bodies are hinged otherwise: a few rows and masses move to other nodes.
#include "step/island.h"

#include <algorithm>

namespace iota::step {

using model::Body;
using model::Model;
using model::none;
using model::Particle;

namespace {

/// Bodies whose hinges all are basis points, without anything else hanging on them: rods, plates, four-point bodies.
bool is_plain(const Model& model, std::uint32_t slot) {
  const Body& body = model.bodies[slot];
  bool plain = body.kind == BodyKind::dynamic && body.rank >= 2 && body.count == body.rank;
  model.for_each_particle_of(slot, [&](std::uint32_t p) {
    const Particle& particle = model.particles[p];
    plain = plain && particle.uses == 0 && model.references[p].first_constraint == none && particle.mass > 0;
  });
  return plain;
}

void add_once(std::vector<std::uint32_t>& list, std::uint32_t value) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

}  // namespace

bool Island::relink(const Model& model, std::span<const std::uint32_t> bodies) {
  if (idle_ || solver_ || any_ingredient([](const auto& i) { return !i.can_follow(); })) return false;
  if (!std::all_of(bodies.begin(), bodies.end(), [&](std::uint32_t b) { return is_plain(model, b); })) return false;
  auto& rows = ingredient::constraints_in<solver::DistanceConstraint>(problem_);
  const auto rigid_rows = std::get<ingredient::RigidRows>(ingredients_).rows();

  // 1. Which node each basis point has had, by the rows of its body.
  struct Point {
    std::uint32_t particle, ring, before, now;
  };
  std::vector<Point> points;
  std::vector<std::uint32_t> own_rows;
  const auto point_of = [&](std::uint32_t particle) {
    return std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.particle == particle; });
  };
  for (const std::uint32_t b : bodies) {
    const Body& body = model.bodies[b];
    for (int i = 0; i < body.rank; ++i)
      points.push_back({body.basis[i], model.particles[body.basis[i]].ring, none, none});
  }
  for (std::uint32_t r = 0; r < rigid_rows.size(); ++r) {
    if (std::find(bodies.begin(), bodies.end(), rigid_rows[r].body) == bodies.end()) continue;
    own_rows.push_back(r);
    const auto& ends = model::basis_pairs[rigid_rows[r].row];
    for (int end = 0; end < 2; ++end)
      point_of(model.bodies[rigid_rows[r].body].basis[ends[end]])->before = rows[r].nodes[end];
  }
  // 2. Which node it has now: that of its ring if there is one, else a new one.
  std::vector<std::array<std::uint32_t, 2>> added;
  std::vector<std::uint32_t> new_rings, touched, left;
  for (Point& p : points) {
    if (p.before == none) return false;
    const auto same_ring = [&](const Point& q) { return nodes_.rings[q.before] == p.ring; };
    const auto known =
        std::find_if(points.begin(), points.end(), [&](const Point& q) { return q.before != none && same_ring(q); });
    const auto made = std::find(new_rings.begin(), new_rings.end(), p.ring);
    if (known != points.end()) {
      p.now = known->before;
    } else {
      p.now = static_cast<std::uint32_t>(nodes_.rings.size() + static_cast<std::size_t>(made - new_rings.begin()));
      if (made == new_rings.end()) new_rings.push_back(p.ring), added.push_back({p.now, p.before});
    }
    if (p.now == p.before) continue;
    add_once(left, p.before), add_once(touched, p.before), add_once(touched, p.now);
    if (nodes_.pinned[p.before] || model.is_pinned(p.ring)) return false;
  }
  if (touched.empty()) return true;
  std::vector<std::uint32_t> removed;
  for (const std::uint32_t node : left)
    if (std::none_of(points.begin(), points.end(), [&](const Point& p) { return p.now == node; }))
      removed.push_back(node);

  // 3. Nothing but these bodies may name the nodes that their points leave.
  std::size_t named = 0, expected = 0;
  const auto is_left = [&](std::uint32_t n) { return std::find(left.begin(), left.end(), n) != left.end(); };
  problem_.for_each_reference([&](std::uint32_t n) { named += is_left(n); });
  struct Pair {
    std::uint32_t p, q, inertia;
  };
  std::vector<Pair> pairs;
  for (const std::uint32_t b : bodies)
    model.for_each_inertia_of(b, [&](std::uint32_t i) {
      const auto p = point_of(model.inertia_pairs[i].p), q = point_of(model.inertia_pairs[i].q);
      pairs.push_back(
          {static_cast<std::uint32_t>(p - points.begin()), static_cast<std::uint32_t>(q - points.begin()), i});
      expected += is_left(p->before) + is_left(q->before);
    });
  for (const std::uint32_t r : own_rows) expected += is_left(rows[r].nodes[0]) + is_left(rows[r].nodes[1]);
  if (named != expected) return false;

  // 4. Rewire rows and couplings.
  for (const Pair& pair : pairs) {
    const Point &p = points[pair.p], &q = points[pair.q];
    if (p.now == p.before && q.now == q.before) continue;
    const double mass = -model.inertia_pairs[pair.inertia].inertia;
    const auto c = std::find_if(problem_.mass_couplings.begin(), problem_.mass_couplings.end(),
                                [&](const auto& m) { return m.a == p.before && m.b == q.before && m.mass == mass; });
    if (c == problem_.mass_couplings.end()) return false;
    c->a = p.now, c->b = q.now;
    add_once(touched, p.now), add_once(touched, q.now);
  }
  for (const std::uint32_t r : own_rows) {
    const auto& ends = model::basis_pairs[rigid_rows[r].row];
    const Body& body = model.bodies[rigid_rows[r].body];
    bool moves = false;
    for (int end = 0; end < 2; ++end) {
      const auto p = point_of(body.basis[ends[end]]);
      moves = moves || p->now != p->before;
      rows[r].nodes[end] = p->now;
    }
    if (moves) add_once(touched, rows[r].nodes[0]), add_once(touched, rows[r].nodes[1]);
  }

  // 5. Room for new nodes, and masses where points came or went.
  problem_.add_nodes(added.size());
  for (const std::uint32_t ring : new_rings) nodes_.rings.push_back(ring), nodes_.pinned.push_back(0);
  for (const Point& changed : points) {
    if (changed.now == changed.before && !is_left(changed.now)) continue;
    double mass = 0;
    for (const Point& p : points)
      if (p.now == changed.now) {
        mass += model.particles[p.particle].mass;
        for (const Pair& pair : pairs)
          if (points[pair.p].particle == p.particle || points[pair.q].particle == p.particle)
            mass += model.inertia_pairs[pair.inertia].inertia;
      }
    problem_.mass[changed.now] = mass;
  }
  integrator_.relink(problem_, added, removed, touched);

  // 6. The last nodes have taken the numbers of those that are gone.
  std::sort(removed.begin(), removed.end(), std::greater<>());
  for (const std::uint32_t node : removed) {
    const auto last = static_cast<std::uint32_t>(nodes_.rings.size() - 1);
    for_each_ingredient([&](auto& i) { i.renumber_node(last, node); });
    for (auto& carriers : nodes_.carriers)
      for (auto& carrier : carriers)
        if (carrier.first == last) carrier.first = node;
    nodes_.rings[node] = nodes_.rings.back(), nodes_.pinned[node] = nodes_.pinned.back();
    nodes_.rings.pop_back(), nodes_.pinned.pop_back();
  }
  return true;
}

}  // namespace iota::step
