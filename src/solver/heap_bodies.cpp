// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_bodies.h"

#include "solver/pieces.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace iota::solver {

namespace {

/// The rotation about a vector by its length, rad: by series where that is short, as in sub-steps.
Quaternion short_turn(const Vec3& v) {
  const double square = 0.25 * dot(v, v);  // of half the angle
  if (!(square < 0.01)) return turn_by(v);
  const double sine = 0.5 * (1 - square / 6 * (1 - square / 20 * (1 - square / 42 * (1 - square / 72))));
  const double cosine = 1 - square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
  return {sine * v.x, sine * v.y, sine * v.z, cosine};
}

bool are_equations(const ConstraintPool<DistanceConstraint>& pool, std::size_t i) {
  return !pool.has_laws() || *pool.law(i) == RowLaw{};
}

}  // namespace

void HeapBody::turn_to(const Quaternion& to, const Vec3& angular_momentum, HeapMotion& motion) {
  turn = to, turned = matrix_of(turn);
  if (is_even) return;
  motion.by_inertia = turned * (by_inertia_at_begin * turned.transposed());
  motion.spin = motion.by_inertia * angular_momentum;
}

// The turn is that of the spin in the middle. An even body keeps its spin.
void HeapBody::move(double h, HeapMotion& motion) {
  moved += h * motion.velocity;
  if (is_even) return turn_to(normalized(multiply(short_turn(h * motion.spin), turn)), {}, motion);
  const Vec3 angular = angular_momentum(motion.spin);
  const Quaternion half = short_turn((0.5 * h) * motion.spin);
  const Vec3 spin =
      rotate(half, turned * (by_inertia_at_begin * transposed_times(turned, rotate(conjugate(half), angular))));
  turn_to(normalized(multiply(short_turn(h * spin), turn)), angular, motion);
}

bool HeapBodies::find(const Problem& problem) {
  all.clear(), copies.clear(), couplings.clear();
  is_target.assign(problem.size(), 0);
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>())
    if (c.is_nail()) is_target[c.nodes[0]] = 1;
  const std::uint32_t count = find_pieces(problem, Connection::lengths, pieces_);
  const std::span<const std::uint32_t> piece_of = pieces_.of;
  std::vector<std::uint32_t> sizes(count, 0), lengths(count, 0);
  for (const std::uint32_t piece : piece_of) ++sizes[piece];
  const auto for_each_length = [&](auto visit) {
    if (!problem.has_used<DistanceConstraint>()) return;
    const auto& pool = problem.pool_of<DistanceConstraint>();
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (are_equations(pool, i)) visit(pool.items[i].nodes[0], pool.items[i].nodes[1]);
  };
  for_each_length([&](std::uint32_t a, std::uint32_t) { ++lengths[piece_of[a]]; });
  const auto is_body = [&](std::uint32_t piece) {
    return sizes[piece] <= HeapBody::most_points && lengths[piece] == sizes[piece] * (sizes[piece] - 1) / 2;
  };
  // Most pieces are a body.
  owner.assign(problem.size(), none);
  std::vector<std::uint32_t> body_of_piece(count, none);
  bool are_bodies = true;
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    std::uint32_t& number = body_of_piece[piece_of[node]];
    if (!is_body(piece_of[node])) {
      are_bodies = false;
      continue;
    }
    if (number == none) number = static_cast<std::uint32_t>(all.size()), all.emplace_back();
    owner[node] = number;
    all[number].nodes[all[number].count++] = node;
  }
  if (!are_bodies) {
    std::vector<std::vector<std::uint32_t>> neighbors(problem.size());
    for_each_length([&](std::uint32_t a, std::uint32_t b) {
      if (!is_body(piece_of[a])) neighbors[a].push_back(b), neighbors[b].push_back(a);
    });
    for (auto& list : neighbors) std::sort(list.begin(), list.end());
    bodies_at_.assign(problem.size(), {});
    for (std::uint32_t a = 0; a < problem.size(); ++a) {
      if (is_body(piece_of[a])) continue;
      if (neighbors[a].empty()) add_body(a, a, neighbors);
      for (const std::uint32_t b : neighbors[a])
        if (b > a && !have_body(a, b)) add_body(a, b, neighbors);
    }
  }
  for (HeapBody& body : all) {
    const auto nodes = std::span(body.nodes).first(body.count);
    body.is_driven = std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return is_target[node]; });
  }
  const bool drives_copies = std::any_of(copies.begin(), copies.end(), [&](const Copy& copy) {
    return all[copy.body].is_driven || all[owner[copy.node]].is_driven;
  });
  return !drives_copies && share_masses(problem);
}

bool HeapBodies::have_body(std::uint32_t a, std::uint32_t b) const {
  return std::any_of(bodies_at_[a].begin(), bodies_at_[a].end(), [&](std::uint32_t body) {
    return std::find(bodies_at_[b].begin(), bodies_at_[b].end(), body) != bodies_at_[b].end();
  });
}

// A pair of points with a length, and up to two more that have lengths to all of it.
void HeapBodies::add_body(std::uint32_t a, std::uint32_t b, const std::vector<std::vector<std::uint32_t>>& neighbors) {
  HeapBody body;
  body.nodes[body.count++] = a;
  if (b != a) body.nodes[body.count++] = b;
  for (const std::uint32_t c : neighbors[a]) {
    if (body.count == HeapBody::most_points) break;
    const auto nodes = std::span(body.nodes).first(body.count);
    if (std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
          return node != c && std::binary_search(neighbors[node].begin(), neighbors[node].end(), c);
        }))
      body.nodes[body.count++] = c;
  }
  const auto number = static_cast<std::uint32_t>(all.size());
  for (std::uint32_t k = 0; k < body.count; ++k) {
    std::uint32_t& first = owner[body.nodes[k]];
    if (first == none)
      first = number;
    else
      copies.push_back({body.nodes[k], number, k});
    bodies_at_[body.nodes[k]].push_back(number);
  }
  all.push_back(body);
}

bool HeapBodies::share_masses(const Problem& problem) {
  for (HeapBody& body : all) body.shares.fill(1);
  if (copies.empty()) {
    for (std::uint32_t i = 0; i < problem.mass_couplings.size(); ++i)
      couplings.push_back({i, owner[problem.mass_couplings[i].a], 1});
    return true;
  }
  for (const Copy& copy : copies)
    for (const std::uint32_t body : bodies_at_[copy.node]) all[body].shares[place_of(body, copy.node)] = 0;
  for (std::uint32_t i = 0; i < problem.mass_couplings.size(); ++i) {
    const auto& c = problem.mass_couplings[i];
    const std::size_t first = couplings.size();
    if (bodies_at_[c.a].empty()) {
      couplings.push_back({i, owner[c.a], 1});
      continue;
    }
    for (const std::uint32_t body : bodies_at_[c.a])
      if (place_of(body, c.b) < all[body].count) couplings.push_back({i, body, 1});
    if (couplings.size() == first) return false;  // masses of two bodies are coupled
    const double share = 1 / static_cast<double>(couplings.size() - first);
    for (std::size_t k = first; k < couplings.size(); ++k) {
      couplings[k].share = share;
      for (const std::uint32_t node : {c.a, c.b})
        if (bodies_at_[node].size() > 1)
          all[couplings[k].body].shares[place_of(couplings[k].body, node)] += share * std::abs(c.mass);
    }
  }
  for (const Copy& copy : copies) {
    if (copy.body != bodies_at_[copy.node][1]) continue;  // once for each point
    double sum = 0;
    bool are_coupled = true;
    const std::vector<std::uint32_t>& bodies = bodies_at_[copy.node];
    for (const std::uint32_t body : bodies) {
      const double share = all[body].shares[place_of(body, copy.node)];
      sum += share, are_coupled = are_coupled && share > 0;
    }
    for (const std::uint32_t body : bodies) {
      double& share = all[body].shares[place_of(body, copy.node)];
      share = are_coupled ? share / sum : 1 / static_cast<double>(bodies.size());
    }
  }
  const std::vector<double> of_all = masses(problem);
  return std::all_of(of_all.begin(), of_all.end(), [](double mass) { return mass > 0; });
}

std::vector<double> HeapBodies::masses(const Problem& problem) const {
  std::vector<double> masses(all.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::uint32_t k = 0; k < all[i].count; ++k) masses[i] += all[i].shares[k] * problem.mass[all[i].nodes[k]];
  for (const Coupling& c : couplings) masses[c.body] += 2 * c.share * problem.mass_couplings[c.item].mass;
  return masses;
}

void HeapBodies::find_places(const Problem& problem, double from, double to, std::vector<Vec3>& now,
                             std::vector<Vec3>& next) const {
  now = problem.position;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const HeapBody& body = all[i];
    if (body.is_driven) continue;
    for (std::uint32_t k = 0; k < body.count; ++k)
      if (owner[body.nodes[k]] == i) now[body.nodes[k]] = body.center_now() + body.arm_now(k);
  }
  next = now;
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>()) {
    if (!c.is_nail() || !all[owner[c.nodes[0]]].is_driven) continue;
    now[c.nodes[0]] = c.target_start + from * (c.target - c.target_start);
    next[c.nodes[0]] = c.target_start + to * (c.target - c.target_start);
  }
}

std::uint32_t HeapBodies::with(std::span<const std::uint32_t> nodes) const {
  const std::uint32_t first = owner[nodes[0]];
  if (copies.empty() || bodies_at_[nodes[0]].size() < 2) return first;
  for (const std::uint32_t body : bodies_at_[nodes[0]])
    if (std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return have(body, node); })) return body;
  return first;
}

std::uint32_t HeapBodies::place_of(std::uint32_t body, std::uint32_t node) const {
  const auto begin = all[body].nodes.begin(), end = begin + all[body].count;
  return static_cast<std::uint32_t>(std::find(begin, end, node) - begin);
}

}  // namespace iota::solver
