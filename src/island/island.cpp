// SPDX-License-Identifier: Apache-2.0
#include "island/island.h"

#include "ingredient/quantities.h"
#include "solver/integrator.h"

#include <iota/reports.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace iota::island {

using model::is_free;
using model::Model;
using model::none;
using model::Ring;

namespace {

solver::IntegratorSettings settings_of_mode(const Model& model) {
  switch (model.mode) {
    case IntegrationMode::plausible: return solver::IntegratorSettings::plausible();
    case IntegrationMode::robust: return solver::IntegratorSettings::robust();
    case IntegrationMode::energy_keeping: return solver::IntegratorSettings::energy_keeping();
    case IntegrationMode::accurate: return solver::IntegratorSettings::accurate(model.tolerance);
  }
  return {};
}

solver::IntegratorSettings settings_of(const Model& model, const Island::Limits& limits = {}) {
  solver::IntegratorSettings settings = settings_of_mode(model);
  settings.max_iterations = model.budget_iterations, settings.deadline = limits.deadline;
  if (model.budget_contacts > 0) settings.contact_budget = model.contacts_share * model.budget_contacts;
  settings.contact_share = limits.share, settings.part = limits.part;
  return settings;
}

}  // namespace

Island::Island() : integrator_(std::make_unique<solver::Integrator>()) {}
Island::~Island() = default;

void MovedRings::put(Model& model, std::uint32_t ring, const Vec3& position, const Vec3& velocity) {
  Ring& r = model.rings[ring];
  if (r.position == position && r.velocity == velocity) return;
  if (is_asked_for) before.push_back({ring, r.position, r.velocity});
  r.position = position, r.velocity = velocity;
}

// Later entries are restored first.
void MovedRings::exchange(Model& model) {
  std::reverse(before.begin(), before.end());
  for (State& state : before) {
    Ring& r = model.rings[state.ring];
    std::swap(state.position, r.position), std::swap(state.velocity, r.velocity);
  }
}

// It keeps the room of its lists: bodies that are tied and parted need new islands all the time.
void Island::clear() {
  nodes_.clear();
  for_each_ingredient([](auto& i) { i.clear(); });
  problem_.clear();
  solver_name_ = {}, solver_.reset(), integrator_->set_external(nullptr);
  idle_ = to_wake_ = is_still_ = has_stepped_ = is_frozen_ = false;
  first_body_ = none, book_epoch_ = 0, tried_ahead_ = 0, last_ = {}, stride_ = 0, solved_steps_ = 1, work_ = 0;
}

void Island::assemble(const Model& model, std::span<const std::uint32_t> articulates,
                      std::vector<std::uint32_t>& node_of_ring, const KeptOrders& orders) {
  clear();
  nodes_.build(model, articulates, node_of_ring);
  find_first_body();
  idle_ = has_no_free_body(model);
  problem_.add_nodes(nodes_.size());
  std::uint8_t owner = 0;
  for_each_ingredient([&](auto& i) { i.owner = ++owner; });
  const ingredient::IslandMap map(model, nodes_, nodes_.bodies, node_of_ring);
  for_each_ingredient([&](auto& i) { i.build(map, problem_); });
  for (std::size_t i = 0; i < nodes_.size(); ++i) problem_.position[i] = model.rings[nodes_.rings[i]].position;
  thread_local solver::KnownOrder order;
  orders.find(nodes_.rings, order);
  integrator_->compile(problem_, order);
  for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
  look_whether_still(model);
}

bool Island::has_no_free_body(const Model& model) const {
  return std::none_of(nodes_.bodies.begin(), nodes_.bodies.end(),
                      [&](std::uint32_t b) { return is_free(model.bodies[b].kind); });
}

void Island::carry_along(Model& model, MovedRings& moved) {
  for_each_ingredient([&](const auto& i) { i.accept_assigned(model, nodes_); });
  if (pass_on_assigned(model, moved)) return;
  store_carried(model, moved);
  for_each_ingredient([&](const auto& i) { i.refresh(model, nodes_, false); });  // a new basis has other places
}

bool Island::pass_on_assigned(Model& model, MovedRings& moved) {
  bool differs = false;
  std::vector<Vec3> impulses;
  for (std::size_t i = 0; i < nodes_.carried.size(); ++i) {
    const std::uint32_t p = nodes_.carried[i];
    const Vec3 v = model.velocity(p), ahead = v - model.carried(p).second;
    if (norm(ahead) <= 1e-12 * norm(v)) continue;
    if (!differs) impulses.assign(nodes_.size(), Vec3{});
    differs = true;
    for (const auto& [node, weight] : nodes_.carriers[i])
      if (weight != 0) impulses[node] += (weight * model.particles[p].mass) * ahead;
  }
  if (!differs || idle_) return false;
  load(model, 0);
  if (!integrator_->project_heap(problem_, settings_of(model), {.impulses = impulses}))
    integrator_->project_velocities(problem_, 0, impulses);
  store_projection(model, false, moved);
  return true;
}

// Both, as of an island that is made for this step, to the bit.
void Island::project_assigned(Model& model) {
  MovedRings moved{.is_asked_for = false};
  (void)pass_on_assigned(model, moved);
  (void)project(model, false);
}

// Zero near the world's origin. Far from it, the place of the first point: differences of neighbors are then exact, and
// a step has the precision of the island's size instead of the place's. At 1e7 m a chain of 2 cm links did not move.
Vec3 Island::choose_origin(const Model& model) const {
  constexpr double far = 1e4;  // mean lengths of links: closer by, 1e-12 of one is resolved
  if (nodes_.size() == 0) return {};
  const Vec3& first = model.rings[nodes_.rings.front()].position;
  const double distance = std::max({std::abs(first.x), std::abs(first.y), std::abs(first.z)});
  return distance > far * integrator_->reference_length() ? first : Vec3{};
}

void Island::load(const Model& model, double h) {
  drop_try();
  problem_.gravity = model.acting_gravity();
  problem_.set_origin(choose_origin(model));
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Ring& r = model.rings[nodes_.rings[i]];
    problem_.position[i] = r.position - problem_.origin;
    problem_.velocity[i] = r.velocity;
  }
  for_each_ingredient([&](auto& i) { i.load(model, nodes_, h, problem_); });
  integrator_->set_slots_of_velocity_forces(problem_);
}

void Island::store_carried(Model& model, MovedRings& moved) const {
  for (const std::uint32_t p : nodes_.carried) {
    const auto [position, velocity] = model.carried(p);
    moved.put(model, model.particles[p].ring, position, velocity);
  }
}

namespace {

/// The sum over the nodes that carry a particle, by their weights: of(node).
template <class Of>
Vec3 sum_over(const ingredient::WeightedNodes& carriers, Of of) {
  Vec3 sum;
  for (const auto& [node, weight] : carriers) sum += weight * of(node);
  return sum;
}

}  // namespace

void Island::store_step(Model& model, double h, bool is_instant) const {
  const auto put = [&](std::uint32_t ring, const Vec3& position, const Vec3& velocity, const Vec3& correction,
                       const Vec3& start) {
    Ring& r = model.rings[ring];
    r.acceleration = (1 / h) * (velocity - correction - start);
    r.position = position, r.velocity = velocity, r.is_instant = is_instant;
  };
  const std::span<const Vec3> corrections = integrator_->velocity_corrections();
  const auto correction_of = [&](std::size_t node) { return corrections.empty() ? Vec3{} : corrections[node]; };
  // With the accelerations at an instant: the velocity from which these would lead to the end's.
  const auto start_of = [&](std::size_t node) { return integrator_->instant_start(node, h); };
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    put(nodes_.rings[i], problem_.origin + problem_.position[i], problem_.velocity[i], correction_of(i),
        is_instant ? start_of(i) : model.rings[nodes_.rings[i]].velocity);
  for (std::size_t i = 0; i < nodes_.carried.size(); ++i) {
    const std::uint32_t p = nodes_.carried[i], ring = model.particles[p].ring;
    const auto [position, velocity] = model.carried(p);
    put(ring, position, velocity, sum_over(nodes_.carriers[i], correction_of),
        is_instant ? sum_over(nodes_.carriers[i], start_of) : model.rings[ring].velocity);
  }
  store_corrections(model);
  for_each_ingredient([&](const auto& i) { i.store(model, nodes_, h, problem_); });
}

void Island::store_corrections(Model& model) const {
  const std::span<const Vec3> corrections = integrator_->velocity_corrections();
  if (corrections.empty() && model.corrections.are_none()) return;
  const auto correction_of = [&](std::size_t node) { return corrections.empty() ? Vec3{} : corrections[node]; };
  for (std::size_t i = 0; i < nodes_.size(); ++i) model.corrections.set(nodes_.rings[i], correction_of(i));
  for (std::size_t i = 0; i < nodes_.carried.size(); ++i)
    model.corrections.set(model.particles[nodes_.carried[i]].ring, sum_over(nodes_.carriers[i], correction_of));
}

// Stores all nodes, or some.
void Island::store_projection(Model& model, bool positions, MovedRings& moved,
                              std::span<const std::uint32_t> only) const {
  const auto put = [&](std::uint32_t node) {
    moved.put(model, nodes_.rings[node], problem_.origin + problem_.position[node], problem_.velocity[node]);
  };
  if (only.empty())
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) put(node);
  else
    for (const std::uint32_t node : only) put(node);
  store_carried(model, moved);
  for_each_ingredient([&](const auto& i) { i.refresh(model, nodes_, positions); });
}

void Island::use_solver(const std::array<char, 32>& name) {
  struct Missing final : Solver {
    Ending search(NonlinearProblem&, std::span<double>, const SolverOptions&) override { return {}; }
  };
  if (name == solver_name_) return;
  solver_name_ = name;
  solver_.reset();
  if (name[0] != 0) {
    try {
      solver_ = make_solver(name.data());
    } catch (const std::exception&) {  // a snapshot of another process: reported as one that finds nothing
      solver_ = std::make_unique<Missing>();
    }
  }
  integrator_->set_external(solver_.get());
  if (!solver_) return;
  solver::KnownOrder order;
  find_order(order.nodes);
  integrator_->compile(problem_, order);  // it needs unknowns without gaps, unlike an island that follows
}

bool Island::is_driven(const Model& model) const {
  return any_ingredient([&](const auto& i) { return i.prescribes_motion(model, nodes_); });
}

double Island::velocity_jump(double h) const {
  double largest = 0;
  for_each_ingredient([&](const auto& i) { largest = std::max(largest, i.velocity_jump(problem_, h)); });
  return largest;
}

double Island::rate_jump() const {
  double largest = 0;
  for_each_ingredient([&](const auto& i) { largest = std::max(largest, i.rate_jump()); });
  return largest;
}

void Island::impose_velocities(double h) {
  for_each_ingredient([&](const auto& i) { i.impose_velocities(problem_, h); });
}

double Island::virtual_energy(const Model& model) const {
  double sum = 0;
  for_each_ingredient([&](const auto& i) { sum += i.virtual_energy(model); });
  return sum;
}

bool Island::meets_pinned(const Model& model) const {
  return !any_ingredient([&](const auto& i) { return !i.meets_pinned(model); });
}

// The order of bodies depends on which islands have met; a restored one has another.
void Island::find_first_body() {
  const auto first = std::min_element(nodes_.bodies.begin(), nodes_.bodies.end());
  first_body_ = first == nodes_.bodies.end() ? none : *first;
}

model::Articulate& Island::articulate(Model& model) const {
  return model.articulates[model.bodies[first_body_].articulate];
}

const model::Articulate& Island::articulate(const Model& model) const {
  return model.articulates[model.bodies[first_body_].articulate];
}

void Island::try_step(const Model& model, double h, const Limits& limits) {
  if (tried_ != Tried::nothing) integrator_->take_back();
  last_ = {};
  if (idle_)
    tried_ = try_prescribed(model, h);
  else
    tried_ = stays_asleep(model) ? Tried::still : try_motion(model, h, limits);
}

bool Island::is_sprung() const {
  bool is = false;
  problem_.for_each_force_pool([&](const auto& pool) { is = is || !pool.items.empty(); });
  problem_.for_each_constraint_pool([&]<class C>(const solver::ConstraintPool<C>& pool) {
    is = is || (pool.has_laws() && !solver::ConeConstraint<C>);
  });
  return is;
}

Vec3 Island::way_of_node(const Model& model, std::size_t node) const {
  if (tried_ != Tried::moved) return {};
  return problem_.origin + problem_.position[node] - model.rings[nodes_.rings[node]].position;
}

Island::Tried Island::try_prescribed(const Model& model, double h) {
  if (!is_driven(model)) return Tried::still;
  load(model, h);
  const auto energy = [&] { return problem_.kinetic_energy() + problem_.potential_energy(problem_.position.data()); };
  last_.external_work -= energy();
  impose_velocities(h);
  for_each_ingredient([&](const auto& i) { i.impose_positions(problem_); });
  last_.external_work += energy();
  return Tried::prescribed;
}

Island::Tried Island::try_motion(const Model& model, double h, const Limits& limits) {
  load(model, h);
  use_solver(model.solver);
  const solver::IntegratorSettings settings = settings_of(model, limits);
  double given = 0;  // by jumps of prescribed velocities, J
  // With the mid-point rule a jump of a prescribed velocity would cause a permanent oscillation of the reactions.
  const double little = 1e-10 * integrator_->reference_length();
  const bool speeds_up = rate_jump() * h > little;
  if (speeds_up || velocity_jump(h) * h > little) {
    given -= problem_.kinetic_energy();
    impose_velocities(h);
    if (!integrator_->project_heap(problem_, settings, {.h = h})) {
      if (speeds_up) problem_.begin_impulses(), problem_.note_late_impulses();  // a winch that starts pulls by that
      integrator_->project_velocities(problem_, h);
    }
    given += problem_.kinetic_energy();
  }
  const model::Articulate& memory = articulate(model);
  problem_.standing_gap = memory.standing_gap, problem_.standing_steps = memory.standing_steps;
  problem_.unsolved_steps = memory.unsolved_steps;
  const double owed = owed_work(model);
  paid_work_ = std::min(owed, settings.contact_allowance());
  problem_.owed_work = owed - paid_work_;
  last_ = integrator_->advance(problem_, h, settings);
  if (const double jump = velocity_jump(h); jump > 0) {
    // Unless there was no solution, it is round-off: of nails at rest it has no energy to tell.
    const auto nails = problem_.items_of<solver::AffineConstraint>();
    const bool has_energy =
        jump * h > little || std::ranges::any_of(nails, [](const auto& nail) { return nail.is_moving(); });
    if (has_energy) given -= problem_.kinetic_energy();
    impose_velocities(h);
    if (has_energy) given += problem_.kinetic_energy();
  }
  last_.external_work += given;
  if (!std::isfinite(last_.dissipated + last_.lost + last_.made + last_.external_work) || !has_finite_motion()) {
    // Extreme forces (1e300 N) overflow doubles: the report counts the step as unconverged.
    load(model, h);
    last_ = {};
    last_.converged = false;
    last_.lost = problem_.kinetic_energy() + virtual_energy(model);
    std::fill(problem_.velocity.begin(), problem_.velocity.end(), Vec3{});
    return Tried::overflown;
  }
  return Tried::moved;
}

const solver::AdvanceReport& Island::commit(Model& model, double h) {
  const Tried tried = std::exchange(tried_, Tried::nothing);
  if (tried == Tried::moved || tried == Tried::overflown) wake_bodies(model);
  if (tried == Tried::moved) commit_motion(model, h);
  if (tried == Tried::overflown) articulate(model).try_again();
  if (tried == Tried::overflown || tried == Tried::prescribed) store_step(model, h, false);
  has_stepped_ = true;
  if (idle_) look_whether_still(model);
  constexpr double overhead = 3;  // iterations: loading, storing, finding contacts
  if (tried != Tried::still) work_ = static_cast<double>(size()) * (last_.iterations + overhead);
  return last_;
}

bool Island::may_owe_work(const Model& model) const {
  return problem_.has_used<solver::ContactConstraint>() || articulate(model).owed_work > 0;
}

double Island::owed_work(const Model& model) const {
  double work = 0;
  if (!may_owe_work(model)) return work;
  for_each_articulate(model, [&](std::uint32_t slot) { work += model.articulates[slot].owed_work; });
  return work;
}

// Articulates share it by their bodies, as islands of contacts come together and apart all the time.
void Island::set_owed_work(Model& model, double work) const {
  if (!may_owe_work(model)) return;
  double bodies = 0;
  for_each_articulate(model, [&](std::uint32_t slot) { bodies += model.articulates[slot].count; });
  for_each_articulate(model, [&](std::uint32_t slot) {
    model::Articulate& a = model.articulates[slot];
    a.owed_work = work * a.count / bodies;
  });
}

void Island::try_again(Model& model) {
  if (tried_ == Tried::moved) set_owed_work(model, problem_.owed_work + paid_work_);
  drop_try();
}

void Island::commit_motion(Model& model, double h) {
  model::Articulate& memory = articulate(model);
  memory.standing_gap = problem_.standing_gap, memory.standing_steps = problem_.standing_steps;
  memory.unsolved_steps = problem_.unsolved_steps;
  set_owed_work(model, problem_.owed_work);
  const double virtual_before = virtual_energy(model);
  double dissipated = 0;
  for_each_ingredient([&](auto& i) { dissipated += i.after_step(model, h, problem_); });
  last_.dissipated += dissipated;
  store_step(model, h, integrator_->is_instant());
  last_.lost += virtual_energy(model) - virtual_before;
  last_.converged = last_.converged && meets_pinned(model);
  update_sleep_timer(model, h, last_);
}

IslandReport Island::report(const Model& model, const solver::AdvanceReport& last) const {
  IslandReport report{.points = static_cast<std::uint32_t>(nodes_.size()),
                      .resting = is_asleep(model),
                      .iterations = last.iterations,
                      .substeps = last.substeps,
                      .fallbacks = last.fallbacks,
                      .converged = last.converged,
                      .cut_short = last.cut_short,
                      .approximate = last.is_approximate,
                      .gap = ingredient::worst_gap(model, nodes_.bodies),
                      .error = last.error,
                      .lost = last.lost,
                      .made = last.made};
  for (const std::uint32_t body : nodes_.bodies)
    if (model.bodies.is_alive(body)) report.bodies.push_back(model.bodies.id(body));
  return report;
}

bool Island::has_finite_motion() const {
  double sum = 0;  // zero times infinity is not a number
  for (std::size_t i = 0; i < problem_.size(); ++i) {
    const Vec3 both = problem_.position[i] + problem_.velocity[i];
    sum += 0 * (both.x + both.y + both.z);
  }
  return sum == 0;
}

bool Island::project(Model& model, bool positions) {
  if (!nodes_.bodies.empty()) articulate(model).try_again();
  load(model, 0);
  const bool met = project_all(model, positions);
  MovedRings moved{.is_asked_for = false};
  store_projection(model, positions && !idle_, moved);
  return met && (!positions || meets_pinned(model));
}

// Projects what has been loaded.
bool Island::project_all(Model& model, bool positions) {
  if (idle_) {
    std::fill(problem_.velocity.begin(), problem_.velocity.end(), Vec3{});
    return true;
  }
  std::optional<bool> met = integrator_->project_heap(problem_, settings_of(model), {.positions = positions});
  if (!met) {
    met = !positions || integrator_->project_positions(problem_);
    integrator_->project_velocities(problem_);
  }
  if (has_finite_motion()) return *met;
  load(model, 0);  // as in a step: nothing has been stored in the model yet
  std::fill(problem_.velocity.begin(), problem_.velocity.end(), Vec3{});
  return false;
}

bool Island::settle(Model& model, std::span<const std::uint32_t> bodies, bool positions, MovedRings& moved) {
  if (nodes_.bodies.empty()) return true;  // inactive
  articulate(model).try_again();
  (void)pass_on_assigned(model, moved);
  load(model, 0);
  std::vector<std::uint32_t> edited;
  if (!idle_ && !integrator_->is_projected_as_heap(problem_, settings_of(model))) edited = nodes_of(model, bodies);
  const bool is_local = !edited.empty() && integrator_->project_locally(problem_, positions, edited);
  const bool met = is_local || project_all(model, positions);
  store_projection(model, positions && !idle_, moved,
                   is_local ? integrator_->moved_locally() : std::span<const std::uint32_t>{});
  return met && (!positions || meets_pinned(model));
}

// None if there are many: searching each would take longer than the whole projection.
std::vector<std::uint32_t> Island::nodes_of(const Model& model, std::span<const std::uint32_t> bodies) const {
  constexpr std::size_t most = 32;
  std::size_t count = 0;
  for (const std::uint32_t body : bodies) count += model.bodies[body].count;
  std::vector<std::uint32_t> found;
  if (count > most) return found;
  for (const std::uint32_t body : bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      const auto node = std::find(nodes_.rings.begin(), nodes_.rings.end(), model.particles[p].ring);
      if (node != nodes_.rings.end()) found.push_back(static_cast<std::uint32_t>(node - nodes_.rings.begin()));
    });
  return found;
}

bool Island::is_pinned(const Model& model, std::uint32_t articulate) const {
  bool any = false;
  nodes_.for_each_pinned([&](std::uint32_t ring) {
    any = any || model.bodies[model.particles[model.rings[ring].first].body].articulate == articulate;
  });
  return any;
}

}  // namespace iota::island
