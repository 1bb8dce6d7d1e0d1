// SPDX-License-Identifier: Apache-2.0
#include "solver/local_projection.h"

#include "base/sort_unique.h"
#include "solver/largest.h"
#include "solver/row_rates.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

constexpr std::uint32_t none = 0xffffffff;
constexpr std::size_t largest_center = 64;  // points
constexpr std::size_t share = 8;            // a part has at most this share of the points
constexpr std::uint32_t first_reach = 32;   // couplings
constexpr double died_out = 1e-12;          // of the largest change
constexpr double largest_speed_ratio = 10;  // of changes to speeds: above it the rows are nearly redundant

constexpr std::uint8_t rim = 1, kept = 2, wanted = 3;  // owners of the rows of a part: what they are

/// A copy of an item with node numbers of the part.
template <class C>
C renumbered(C item, const std::vector<std::uint32_t>& number) {
  for (int i = 0; i < item.node_count(); ++i) item.nodes[i] = number[item.nodes[i]];
  return item;
}

}  // namespace

bool LocalProjection::project(Problem& problem, std::span<const std::uint32_t> center, bool positions) {
  if (!is_worthwhile(problem) || center.empty() || center.size() > largest_center) return false;
  next_center_.assign(center.begin(), center.end());
  sort_unique(next_center_);
  bool is_built = std::exchange(is_known_, false) && next_center_ == center_;
  center_ = next_center_;
  if (!is_built) list_neighbors(problem);
  for (std::uint32_t reach = first_reach;; is_built = false) {
    if (!is_built && !(choose_part(problem, reach) && build_part(problem))) return false;
    load_part(problem);
    find_row_rates(part_, 0, rates_before_);
    Outcome outcome = positions ? solve_positions() : Outcome::done;
    if (outcome == Outcome::done) {
      find_row_rates(part_, 0, rates_);
      std::size_t row = 0;
      part_.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
        for (std::size_t i = 0; i < pool.items.size(); ++i)
          for (int r = 0; r < C::rows; ++r, ++row)
            if (pool.keys[i].owner != wanted) rates_[row] -= rates_before_[row];
      });
      outcome = solve_velocities(rates_);
    }
    if (outcome == Outcome::done) break;
    if (outcome == Outcome::none || !(decay_ > 0 && decay_ < 1)) return false;
    // Extends the reach until the decay suffices at the same rate; if that is far, the whole problem costs less.
    const double farther = reach * std::log(died_out) / std::log(decay_);
    if (!(farther < 8 * first_reach) || reach > first_reach) return false;
    reach = static_cast<std::uint32_t>(1.25 * farther) + 1;
  }
  for (std::size_t i = 0; i < inner_count_; ++i)
    problem.position[nodes_[i]] = part_.position[i], problem.velocity[nodes_[i]] = part_.velocity[i];
  return is_known_ = true;
}

// --- the part ------------------------------------------------------------------------------------------------------------

// For each node those coupled with it by constraints, in one list.
void LocalProjection::list_neighbors(const Problem& problem) {
  const auto for_each_pair = [&](auto visit) {
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const auto& c : pool.items)
        for (int i = 0; i < c.node_count(); ++i)
          for (int j = i + 1; j < c.node_count(); ++j) visit(c.nodes[i], c.nodes[j]);
    });
    for (const auto& c : problem.mass_couplings) visit(c.a, c.b);
  };
  first_neighbor_.assign(problem.size() + 1, 0);
  for_each_pair([&](std::uint32_t a, std::uint32_t b) { ++first_neighbor_[a], ++first_neighbor_[b]; });
  std::uint32_t sum = 0;
  for (std::uint32_t& first : first_neighbor_) first = sum += first;  // each list is filled from its end
  neighbors_.resize(sum);
  for_each_pair([&](std::uint32_t a, std::uint32_t b) {
    neighbors_[--first_neighbor_[a]] = b, neighbors_[--first_neighbor_[b]] = a;
  });
}

// A search from the center, layer by layer. False if the part would be large.
bool LocalProjection::choose_part(const Problem& problem, std::uint32_t reach) {
  number_in_part_.resize(problem.size(), none);
  for (const std::uint32_t node : nodes_) number_in_part_[node] = none;
  nodes_.clear();
  const auto take = [&](std::uint32_t node) {
    if (number_in_part_[node] != none) return;
    number_in_part_[node] = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
  };
  for (const std::uint32_t node : center_) take(node);
  std::size_t begin = 0, end = nodes_.size();
  for (std::uint32_t layer = 0; layer <= reach && begin < end; ++layer) {
    skin_begin_ = begin, inner_count_ = end;
    for (std::size_t i = begin; i < end; ++i)
      for (std::uint32_t k = first_neighbor_[nodes_[i]]; k < first_neighbor_[nodes_[i] + 1]; ++k) take(neighbors_[k]);
    begin = end, end = nodes_.size();
    if (end * share > problem.size()) return false;
  }
  return true;
}

// False if it has bounded rows.
bool LocalProjection::build_part(const Problem& problem) {
  part_ = {};
  part_.add_nodes(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) part_.mass[i] = problem.mass[nodes_[i]];
  const auto is_inner = [&](std::uint32_t node) { return number_in_part_[node] < inner_count_; };
  for (const auto& c : problem.mass_couplings)
    if (is_inner(c.a) || is_inner(c.b)) part_.couple_masses(number_in_part_[c.a], number_in_part_[c.b], c.mass);
  const auto is_center = [&](std::uint32_t node) { return number_in_part_[node] < center_.size(); };
  bool are_equations = true;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const auto nodes = pool.nodes_of(pool.items[k]);
      if (std::none_of(nodes.begin(), nodes.end(), is_inner)) continue;
      if (pool.has_laws())
        are_equations = are_equations && std::all_of(pool.law(k), pool.law(k) + C::rows,
                                                     [](const RowLaw& law) { return law == RowLaw{}; });
      const bool is_wanted = std::any_of(nodes.begin(), nodes.end(), is_center);
      part_.add(renumbered(pool.items[k], number_in_part_),
                {is_wanted ? wanted : kept, {}, static_cast<std::uint32_t>(k)});
    }
  });
  for (std::size_t i = inner_count_; i < nodes_.size(); ++i) {
    AffineConstraint nail;
    nail.nodes[0] = static_cast<std::uint32_t>(i), nail.weights[0] = 1, nail.count = 1;
    part_.add(nail, {rim, {}, 0});
  }
  if (are_equations) newton_.compile(part_);
  return are_equations;
}

void LocalProjection::load_part(const Problem& problem) {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    part_.position[i] = problem.position[nodes_[i]], part_.velocity[i] = problem.velocity[nodes_[i]];
  part_.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (pool.keys[i].owner != rim)
        pool.items[i] = renumbered(problem.pool_of<C>().items[pool.keys[i].slot], number_in_part_);
      else if constexpr (std::is_same_v<C, AffineConstraint>)
        pool.items[i].target = pool.items[i].target_start = part_.position[pool.items[i].nodes[0]];
  });
}

// --- its solution --------------------------------------------------------------------------------------------------------

LocalProjection::Outcome LocalProjection::solve_positions() {
  part_.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    pool.offsets.assign(pool.multipliers.size(), 0);
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (pool.keys[i].owner != wanted)
        pool.items[i].value(part_.position.data(), 0, pool.offsets.data() + i * C::rows);
  });
  part_.clear_multipliers();
  Stage stage = Stage::projection();
  stage.fraction = 0, stage.max_iterations = 20;
  const auto displacement = newton_.displacement();
  std::fill(displacement.begin(), displacement.end(), Vec3{});
  const bool found = newton_.solve(part_, stage).converged;
  part_.clear_offsets();
  if (!found) return Outcome::none;
  const Outcome outcome = judge(newton_.displacement());
  if (outcome == Outcome::done) std::copy_n(newton_.solution().begin(), inner_count_, part_.position.begin());
  return outcome;
}

LocalProjection::Outcome LocalProjection::solve_velocities(std::span<const double> rates) {
  change_.resize(nodes_.size());
  newton_.find_velocity_change(part_, {}, rates, 0, change_);
  Largest speed, largest_change;
  for (const Vec3& v : part_.velocity) speed.add(largest_component(v));
  for (const Vec3& v : change_) largest_change.add(largest_component(v));
  if (!(largest_change.value <= largest_speed_ratio * speed.value)) return Outcome::none;
  const Outcome outcome = judge(change_);
  if (outcome == Outcome::done)
    for (std::size_t i = 0; i < inner_count_; ++i) part_.velocity[i] += change_[i];
  return outcome;
}

LocalProjection::Outcome LocalProjection::judge(std::span<const Vec3> change) {
  Largest anywhere, in_skin;
  for (std::size_t i = 0; i < inner_count_; ++i) {
    anywhere.add(largest_component(change[i]));
    if (i >= skin_begin_) in_skin.add(largest_component(change[i]));
  }
  if (!std::isfinite(anywhere.value)) return Outcome::none;
  const bool is_whole = nodes_.size() == inner_count_;  // without a rim
  if (is_whole || in_skin.value <= died_out * anywhere.value) return Outcome::done;
  decay_ = in_skin.value / anywhere.value;
  return Outcome::reaches_further;
}

}  // namespace iota::solver
