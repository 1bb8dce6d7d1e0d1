// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/slack.h"
#include "solver/constraints/constraint_list.h"
#include "solver/forces/body_torque.h"
#include "solver/forces/force_list.h"
#include "solver/row_states.h"
#include "solver/sparse/block_pattern.h"

#include <iota/vec3.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace iota::solver {

/// The bounds of a row's multiplier. Default: none, an equation, g = 0. With bounds
///   lambda = upper => g >= 0,   lambda = lower => g <= 0,   in between g = 0
/// so that a rope, g = length - L <= 0, has lower = 0; a stop g >= 0 has upper = 0; both 0: switched off. A *rate row*
/// (dry friction, speed motors) measures g from its value at the start of each (sub-)step, plus `rate` times the time:
/// bounds are then the friction or the motor's strength. A compliant row is a spring, within its bounds:
///   lambda = g / compliance + damping dg/dt
struct RowLaw {
  static constexpr double unbounded = std::numeric_limits<double>::infinity();
  double lower = -unbounded, upper = unbounded;  ///< N (N m where g is an angle)
  double compliance = 0;                         ///< m/N; infinite for a pure dashpot
  double damping = 0;                            ///< N s/m, of compliant rows
  double rate = 0;                               ///< of a rate row, m/s
  bool is_rate = false;

  friend bool operator==(const RowLaw&, const RowLaw&) = default;
  bool is_off() const { return lower == upper; }  ///< both 0
  /// Whether it has a force, or may take one of either sign: not a slack rope, nor a stop that is not reached.
  bool acts(double multiplier) const { return !is_off() && (multiplier != 0 || (lower < 0 && upper > 0)); }
  bool is_compliant() const { return compliance > 0; }
  /// The bounds for positions or impulses, on which finite forces have no effect.
  double lower_impulse() const { return lower == -unbounded && !is_compliant() && !is_rate ? -unbounded : 0; }
  double upper_impulse() const { return upper == unbounded && !is_compliant() && !is_rate ? unbounded : 0; }
  /// Distance of g into the forbidden side.
  double violation(double g) const { return g > 0 ? (upper_impulse() > 0 ? g : 0) : (lower_impulse() < 0 ? -g : 0); }
  /// Whether only values of one sign have a force: a rope that yields, a soft stop.
  bool is_one_sided() const { return (lower == 0) != (upper == 0); }
  /// The value as far as it has a force: that of a slack rope is 0. Its dashpot does not act before its spring.
  double stretch(double g) const { return !is_one_sided() ? g : lower == 0 ? std::max(g, 0.0) : std::min(g, 0.0); }
  /// The force of a compliant row, by its value and its rate, N.
  double spring_force(double g, double speed) const {
    if (g != 0 && stretch(g) == 0) return 0;
    return std::clamp(g / compliance + damping * speed, lower, upper);
  }
  /// Energy that a spring row stores, J; a pure dashpot stores none.
  double energy(double g) const {
    if (!is_compliant() || is_rate || std::isinf(compliance)) return 0;
    const double force = std::clamp(g / compliance, lower, upper);
    return force * (g - 0.5 * compliance * force);
  }
};

/// Identifies a constraint or force for its owner, which finds it by this key in its pool; the solver does not read
/// it.
struct ItemKey {
  std::uint8_t owner = 0;  ///< a number for each kind of owner
  std::array<std::uint8_t, 3> part{};
  std::uint32_t slot = 0;

  friend bool operator==(const ItemKey&, const ItemKey&) = default;
};

/// Constraints of one type with their multipliers (warm start in, solution out) and their places in the matrix.
template <class C>
struct ConstraintPool {
  struct Slots {
    std::uint32_t unknown = CouplingGraph::no_unknown, diagonal = 0;
    std::uint8_t stride = 1;
    std::array<BlockPattern::GradientSlot, C::max_nodes> gradients{};
    std::array<BlockPattern::PairSlot, C::has_curvature ? C::max_nodes * (C::max_nodes - 1) / 2 : 0> pairs{};
  };
  std::vector<C> items;
  std::vector<ItemKey> keys;
  std::vector<double> multipliers;   ///< C::rows each, N
  std::vector<double> impulses;      ///< C::rows each, of a step, N s; or empty: see Problem::begin_impulses
  std::vector<double> offsets;       ///< C::rows each: held gaps that cannot be closed; or empty: none
  std::vector<RowLaw> laws;          ///< C::rows each; or empty: all are equations, which costs nothing. Of a cone the
                                     ///< tangents are rate rows, whose bounds it knows itself
  RowStates states;                  ///< beside laws
  std::vector<std::uint8_t> acting;  ///< of each item, if there were laws at the last Problem::note_acting
  std::vector<std::uint32_t>
      temporary;             ///< rows with a temporary bound that the integrator has set: Integrator::keep_offsets
  std::vector<Slots> slots;  ///< `clear` keeps them: a problem with the same structure has the same ones

  double* multiplier(std::size_t i) { return multipliers.data() + i * C::rows; }
  const double* multiplier(std::size_t i) const { return multipliers.data() + i * C::rows; }
  /// The laws of item i; the first call gives all rows of the pool laws.
  RowLaw* law(std::size_t i) {
    laws.resize(items.size() * C::rows);
    return laws.data() + i * C::rows;
  }
  const RowLaw* law(std::size_t i) const { return laws.data() + i * C::rows; }
  bool has_laws() const { return !laws.empty(); }
  /// See Problem::for_each_acting.
  bool acts(std::size_t i) const { return laws.empty() || i >= acting.size() || acting[i] != 0; }
  /// Whether row r of item i is an equation at present; otherwise its multiplier is at a bound.
  bool is_equation(std::size_t i, int r) const { return states.is_equation(i * C::rows + static_cast<std::size_t>(r)); }
  /// Whether any row of item i takes impulses in the latest projection of velocities.
  bool takes_impulses(std::size_t i) const {
    for (int r = 0; r < C::rows; ++r)
      if (is_equation(i, r)) return true;
    return false;
  }
  void reserve(std::size_t size) { items.reserve(size), keys.reserve(size); }
  static std::span<const std::uint32_t> nodes_of(const C& item) {
    return {item.nodes.data(), static_cast<std::size_t>(item.node_count())};
  }
  /// The function whose root the solver finds: the constraint minus its offset.
  void value(std::size_t i, const Vec3* x, double fraction, double* g) const {
    items[i].value(x, fraction, g);
    subtract_offsets(i, g);
  }
  void value(std::size_t i, const Gradients<C>& at, double* g) const {
    at.value(g);
    subtract_offsets(i, g);
  }

 private:
  void subtract_offsets(std::size_t i, double* g) const {
    if (offsets.empty()) return;
    for (int r = 0; r < C::rows; ++r) g[r] -= offsets[i * C::rows + r];
  }
};

template <class F>
struct ForcePool {
  struct Slots {
    std::array<BlockPattern::PairSlot, ForceArm::max_nodes*(ForceArm::max_nodes - 1) / 2> pairs{};
  };
  std::vector<F> items;
  std::vector<ItemKey> keys;
  std::vector<Slots> slots;

  static std::span<const std::uint32_t> nodes_of(const F& item) { return {item.arm.nodes.data(), item.arm.count}; }
};

/// A pool that is made when it is first written to: of twenty kinds a small problem has one or two.
template <class Pool>
class Lazy {
 public:
  Lazy() = default;
  Lazy(const Lazy& other) : pool_(other.pool_ ? std::make_unique<Pool>(*other.pool_) : nullptr) {}
  Lazy(Lazy&&) noexcept = default;
  Lazy& operator=(Lazy other) noexcept {
    pool_ = std::move(other.pool_);
    return *this;
  }
  Pool& get() {
    if (!pool_) pool_ = std::make_unique<Pool>();
    return *pool_;
  }
  const Pool& get() const { return pool_ ? *pool_ : none; }
  /// The pool, which has been made.
  Pool& operator*() { return *pool_; }
  const Pool& operator*() const { return *pool_; }

 private:
  static inline const Pool none = {};
  std::unique_ptr<Pool> pool_;
};
template <class C>
using LazyConstraintPool = Lazy<ConstraintPool<C>>;
template <class F>
using LazyForcePool = Lazy<ForcePool<F>>;

/// One independent problem: points with masses, constraints and forces. It knows no bodies; the step fills it from the
/// model and reads positions, velocities and multipliers back.
struct Problem {
  struct MassCoupling {
    std::uint32_t a, b;
    double mass = 0;  ///< off-diagonal entry of the constant mass matrix, kg
    BlockPattern::PairSlot slot{};
  };

  std::vector<Vec3> position, velocity;  ///< m, m/s
  std::vector<Vec3> force;               ///< explicit, held over the step, N; or empty: none
  std::vector<BodyTorque> torques;       ///< from outside, in the step
  std::vector<double> mass;              ///< diagonal of the mass matrix, kg
  double usual_damping = 0;              ///< of all velocities, 1/s
  std::vector<double> damping;           ///< of each velocity, 1/s, beside the usual one; or empty: none
  std::vector<MassCoupling> mass_couplings;
  /// Angles without a force, which are followed in each sub-step: so turns are counted above half of one in a step.
  struct CountedAngle {
    AngleConstraint angle;
    ItemKey key;
  };
  std::vector<CountedAngle> counted_angles;
  Vec3 gravity;
  Vec3 origin;  ///< see set_origin
  /// Velocities may violate a new row: they are projected at the start of the next step.
  bool has_new_rows = false;
  double standing_gap = 0;           ///< of a conflict that the last attempt could not close, relative; 0: none
  std::uint64_t standing_steps = 0;  ///< since then
  std::uint64_t unsolved_steps = 0;  ///< the latest ones in a row of which no part was solved
  double owed_work = 0;              ///< multiplications beyond the shares of the last steps: see IntegratorSettings

  std::size_t size() const { return position.size(); }

  /// The origin of positions and of the places of rows, m, which were added with that of the world. It keeps their precision far
  /// from there. Positions, and targets that are set for each step, are up to the caller.
  void set_origin(const Vec3&);

  /// @name Structure
  /// A problem is built by adding nodes and items that act on them; `compile` then makes its pattern. It is changed in
  /// this order: new nodes are added; the nodes with changes are opened, which removes all items on them; their items
  /// are added as if the whole problem were built again (other items are refused, as they exist already); nodes without
  /// items are marked for removal. `follow` then updates the pattern.
  ///@{
  void clear();                       ///< as a new one, but for the room of its lists
  void add_nodes(std::size_t count);  ///< without mass
  void add_mass(std::uint32_t node, double m) {
    if (is_open(node)) mass[node] += m;
  }
  void couple_masses(std::uint32_t a, std::uint32_t b, double m);
  /// A constraint or a force.
  template <class Item>
  void add(const Item&, ItemKey);
  /// An angle that is followed.
  void count(const AngleConstraint&, ItemKey);

  /// Returns the number of a new node, which is eliminated right after the one beside it.
  std::uint32_t add_node_beside(std::uint32_t);
  void open(std::span<const std::uint32_t> nodes);
  /// Whether items on a node are being added.
  bool is_open(std::uint32_t node) const { return is_open_.empty() || is_open_[node]; }
  void mark_for_removal(std::uint32_t node) { changes_.removed.push_back(node); }

  /// Changes since the pattern was made.
  const GraphChange& changes() const { return changes_; }
  /// Removes nodes without items; the last ones get their numbers, the highest first.
  void remove_nodes(std::span<const std::uint32_t> removed);
  /// Resizes all lists of the pools to their items.
  void fit_pools();
  void note_compiled() {
    changes_.clear(), is_open_.clear();
    structure_of_slots_ = std::exchange(structure_, 0);
  }
  /// A hash of what was added since `clear` until it is compiled; then 0. Problems with the same structure have the same
  /// places in the matrix: only their numbers differ.
  std::uint64_t structure() const { return structure_; }
  /// Whether the pools still have the slots of this structure.
  bool has_slots() const { return structure_ != 0 && structure_ == structure_of_slots_; }
  void forget_slots() { structure_of_slots_ = 0; }
  ///@}

  template <class Item>
  auto& pool_of() {
    if constexpr (requires { Item::rows; })
      return std::get<LazyConstraintPool<Item>>(constraints_).get();
    else
      return std::get<LazyForcePool<Item>>(forces_).get();
  }
  template <class Item>
  const auto& pool_of() const {
    if constexpr (requires { Item::rows; })
      return std::get<LazyConstraintPool<Item>>(constraints_).get();
    else
      return std::get<LazyForcePool<Item>>(forces_).get();
  }
  /// The items of a type; unlike those of its pool without making that or a look at it if there never was one.
  template <class Item>
  std::span<const Item> items_of() const {
    if (!has_used<Item>()) return {};
    return pool_of<Item>().items;
  }
  template <class Item>
  std::span<Item> items_of() {
    if (!has_used<Item>()) return {};
    return pool_of<Item>().items;
  }
  /// Whether there ever was an item of a type.
  template <class Item>
  bool has_used() const {
    return used_ >> index_of<Item>() & 1u;
  }
  bool has_used_springs() const { return has_used<SpringForce>() || has_used<RadialForce>(); }
  bool has_used_forces() const { return used_ >> constraint_types != 0; }
  bool has_used_constraints() const { return used_constraints() != 0; }
  /// The key of an item in a constraint pool, by the pool's place among those that the folds visit.
  ItemKey key_of(std::size_t pool, std::size_t item) const {
    ItemKey key;
    for_each_constraint_pool([&](const auto& p) {
      if (pool-- == 0) key = p.keys[item];
    });
    return key;
  }
  /// @name Folds over the pools, in the order of the lists
  /// Only over those that ever had an item: of thousands of small problems a look at each empty pool waits for memory.
  ///@{
  template <class Visit>
  void for_each_constraint_pool(Visit visit) {
    visit_used(constraints_, used_constraints(), visit);
  }
  template <class Visit>
  void for_each_constraint_pool(Visit visit) const {
    visit_used(constraints_, used_constraints(), visit);
  }
  template <class Visit>
  void for_each_force_pool(Visit visit) {
    visit_used(forces_, used_ >> constraint_types, visit);
  }
  template <class Visit>
  void for_each_force_pool(Visit visit) const {
    visit_used(forces_, used_ >> constraint_types, visit);
  }
  ///@}

  /// visit(pool, i): each constraint that acts. The others (slack ropes, stops that are not reached, what is switched
  /// off) have their places in the matrix, and no effect on how a problem moves: they do not hold it, join its pieces or
  /// bend its energy.
  template <class Visit>
  void for_each_acting(Visit visit) const {
    for_each_constraint_pool([&](const auto& pool) {
      for (std::size_t i = 0; i < pool.items.size(); ++i)
        if (pool.acts(i)) visit(pool, i);
    });
  }
  /// Finds out which constraints act: by the multipliers of the latest solution; where positions are given, what these
  /// violate does, too. Another set than that of the last call has another `acting_version`.
  void note_acting(const Vec3* x = nullptr);
  std::uint64_t acting_version() const { return acting_version_; }
  void forget_acting();  ///< the next time another version is noted, as of a new problem

  bool has_laws() const {
    bool any = false;
    for_each_constraint_pool([&](const auto& pool) { any = any || pool.has_laws(); });
    return any;
  }
  /// Whether the matrix of a step or a projection needs general storage in any scheme.
  bool is_unsymmetric() const {
    bool any = false;
    for_each_constraint_pool([&]<class C>(const ConstraintPool<C>&) { any = any || ConeConstraint<C>; });
    for (const VelocityForce& f : items_of<VelocityForce>()) any = any || f.part.turns;
    return any;
  }
  /// Whether forces from outside act in the step, other than gravity and grips.
  bool has_pushes() const {
    return !torques.empty() || !items_of<VelocityForce>().empty() ||
           std::any_of(force.begin(), force.end(), [](const Vec3& f) { return f != Vec3{}; });
  }
  /// Tells forces the velocities at the start of a (sub-)step of h seconds.
  void begin_forces(double h) {
    for (VelocityForce& f : items_of<VelocityForce>()) f.begin(velocity.data(), h);
  }
  /// The time at the start of the step, s, if a law depends on it.
  std::optional<double> time_of_laws() const {
    for (const RadialForce& f : items_of<RadialForce>())
      if (f.law->depends_on_time()) return f.time_before;
    return std::nullopt;
  }
  void set_times_of_laws(double before, double at_end) {
    for (RadialForce& f : items_of<RadialForce>()) f.time_before = before, f.time = at_end;
  }
  std::size_t multiplier_count() const {
    std::size_t count = 0;
    for_each_constraint_pool([&](const auto& pool) { count += pool.multipliers.size(); });
    return count;
  }
  /// In the order of the pools; `out` has room for all.
  void copy_multipliers_to(std::vector<double>& out) const {
    auto at = out.begin();
    for_each_constraint_pool(
        [&](const auto& pool) { at = std::copy(pool.multipliers.begin(), pool.multipliers.end(), at); });
  }
  void set_multipliers(const std::vector<double>& from) {
    auto at = from.begin();
    for_each_constraint_pool([&](auto& pool) {
      std::copy_n(at, pool.multipliers.size(), pool.multipliers.begin());
      at += static_cast<std::ptrdiff_t>(pool.multipliers.size());
    });
  }
  void clear_multipliers() {
    for_each_constraint_pool([](auto& pool) { std::fill(pool.multipliers.begin(), pool.multipliers.end(), 0.0); });
  }
  /// The rows add up what they give in a step, with what projections of velocities give. A target that changes its speed has only a part of
  /// that in its multipliers.
  void begin_impulses();
  bool adds_impulses() const { return adds_impulses_; }
  /// Adds the multipliers, for h seconds.
  void add_impulses(double h);
  /// The multipliers are not all that the rows give. Otherwise they stay, as they balance accelerations to round-off, and late impulses only
  /// to the turn within the step.
  void note_late_impulses() { has_late_impulses_ = true; }
  /// After a step of h seconds with late impulses: the multipliers of rigid rows become their means. 0: there is no solution, which
  /// has them. Returns whether they have.
  bool end_impulses(double h);
  void clear_offsets() {
    for_each_constraint_pool([](auto& pool) { pool.offsets.clear(); });
  }

  bool is_damped() const { return usual_damping > 0 || !damping.empty(); }
  double damping_of(std::size_t node) const { return usual_damping + (damping.empty() ? 0 : damping[node]); }
  /// visit(node, force): the momentum that damping takes from a node, N.
  template <class Visit>
  void for_each_drag_of_damping(Visit visit) const {
    if (!is_damped()) return;
    const auto slowed = [&](std::uint32_t node) { return damping_of(node) * velocity[node]; };
    for (std::uint32_t i = 0; i < size(); ++i) visit(i, mass[i] * slowed(i));
    for (const auto& c : mass_couplings) visit(c.a, c.mass * slowed(c.b)), visit(c.b, c.mass * slowed(c.a));
  }
  /// Velocities fall by exp(-damping time), but for those of nailed points, which are prescribed.
  void damp_velocities(double time);

  /// Whether no constraint that takes impulses is connected to the world, so that a projection keeps momentum.
  bool is_isolated() const {
    return is_isolated([](const auto& pool, std::size_t i) { return pool.takes_impulses(i); });
  }
  /// Whether none is at all. Sweeps do not tell which rows take impulses.
  bool has_no_world() const {
    return is_isolated([](const auto&, std::size_t) { return true; });
  }

  /// v' M v / 2, where v(node) is the velocity of a node.
  template <class Velocity>
  double kinetic_energy(Velocity v) const {
    double twice = 0;
    for (std::size_t i = 0; i < size(); ++i) twice += mass[i] * dot(v(i), v(i));
    for (const auto& c : mass_couplings) twice += 2 * c.mass * dot(v(c.a), v(c.b));
    return 0.5 * twice;
  }
  double kinetic_energy() const {
    return kinetic_energy([&](std::size_t i) -> const Vec3& { return velocity[i]; });
  }
  /// The part of it that is the motion of the center of mass.
  template <class Velocity>
  double flight_energy(Velocity v) const {
    double total = 0;
    Vec3 momentum;
    const auto add = [&](double m, const Vec3& velocity) { total += m, momentum += m * velocity; };
    for (std::size_t i = 0; i < size(); ++i) add(mass[i], v(i));
    for (const auto& c : mass_couplings) add(c.mass, v(c.a)), add(c.mass, v(c.b));
    return total > 0 ? 0.5 / total * dot(momentum, momentum) : 0;
  }
  /// Gravity and implicit forces; external ones (grips) are not in the world's energy, only in Newton's merit.
  double potential_energy(const Vec3* x, bool with_external = false) const;
  struct Potential {
    double energy = 0;
    /// Sum of the weights times the distances to the origin, J: the round-off of the energy is a share of it, also where the terms
    /// cancel. A wheel on its axle has no potential energy.
    double size = 0;
  };
  Potential potential(const Vec3* x) const;
  /// Stored in spring rows, with targets as at `fraction` of the step, and in the compliance of cones.
  double row_energy(const Vec3* x, double fraction) const;
  enum class Rows { all, but_contacts };
  /// Largest violation at x, m, with targets as at `fraction` of the step; with `relative`, as a fraction of each constraint's reference length.
  double worst_gap(const Vec3* x, double fraction = 1, bool relative = false, Rows = Rows::all) const;

 private:
  void add_energies_of_forces(const Vec3* x, bool with_external, double& energy) const;
  /// takes_part(pool, i): whether a constraint counts.
  template <class TakesPart>
  bool is_isolated(TakesPart takes_part) const {
    bool internal = true;
    for_each_constraint_pool([&](const auto& pool) {
      for (std::size_t i = 0; i < pool.items.size(); ++i)
        internal = internal && (pool.items[i].is_internal() || !takes_part(pool, i));
    });
    return internal;
  }

  bool is_any_open(std::span<const std::uint32_t> nodes) const {
    return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return is_open(node); });
  }
  bool is_changing() const { return !is_open_.empty(); }
  void note_change(std::span<const std::uint32_t> nodes) {
    changes_.changed.insert(changes_.changed.end(), nodes.begin(), nodes.end());
  }

  void note_structure(std::uint64_t word) {
    if (structure_ == 0) return;
    structure_ = (structure_ ^ word) * 0x9e3779b97f4a7c15u;
    structure_ ^= structure_ >> 32;
  }
  template <class Item>
  void note_structure(const Item& item, std::span<const std::uint32_t> nodes) {
    note_structure(index_of<Item>() << 32 | nodes.size());
    for (const std::uint32_t node : nodes) note_structure(node);
    if constexpr (GeneralConstraint<Item>) note_structure(static_cast<std::uint64_t>(item.first_side));
  }

  static constexpr std::size_t constraint_types = std::tuple_size_v<ConstraintPools<ConstraintPool>>;

  /// The index of a type in the lists, constraints first.
  template <class Item>
  static constexpr std::size_t index_of() {
    std::size_t index = 0;
    const auto find = [&]<class... Pool>(std::type_identity<std::tuple<Pool...>>) {
      return ((std::is_same_v<decltype(Pool::items), std::vector<Item>> || (++index, false)) || ...);
    };
    if (!find(std::type_identity<ConstraintPools<ConstraintPool>>{})) find(std::type_identity<ForcePools<ForcePool>>{});
    return index;
  }
  std::uint32_t used_constraints() const { return used_ & ((std::uint32_t{1} << constraint_types) - 1); }
  template <class Pools, class Visit>
  static void visit_used(Pools& pools, std::uint32_t used, Visit& visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      // The common types come first, so that most problems end the walk after a few of them.
      ((used >> i != 0 && ((used >> i & 1u ? static_cast<void>(visit(*std::get<i>(pools))) : void()), true)) && ...);
    }(std::make_index_sequence<std::tuple_size_v<Pools>>{});
  }

  template <class Visit>
  void for_each_place(Visit visit) {
    for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
      if constexpr (requires(C& c) { c.visit_places(visit); })
        for (C& c : pool.items) c.visit_places(visit);
    });
  }

  std::vector<Vec3>
      places_;  // of rows, in the order of the pools, as they were added; or none: the origin is the world's
  bool adds_impulses_ = false, has_late_impulses_ = false;
  std::uint32_t used_ = 0;  // a bit for each pool that ever had an item
  GraphChange changes_;
  static constexpr std::uint64_t no_structure = 1;  // is not 0
  std::uint64_t structure_ = no_structure, structure_of_slots_ = 0;
  std::uint64_t acting_version_ = 0;
  std::vector<std::uint8_t> is_open_;  // of each node, while the structure changes; else empty
  ConstraintPools<LazyConstraintPool> constraints_;
  ForcePools<LazyForcePool> forces_;
};

template <class Item>
void Problem::add(const Item& item, ItemKey key) {
  auto& pool = pool_of<Item>();
  const auto nodes = pool.nodes_of(item);
  note_structure(item, nodes);
  if (is_changing()) {
    if (!is_any_open(nodes)) return;
    note_change(nodes);
    reserve_with_slack(pool.items, pool.items.size() + 1);
    reserve_with_slack(pool.keys, pool.items.size() + 1);
  }
  if (structure_ == 0 && !has_used<Item>()) pool.slots.clear();  // of an earlier structure
  used_ |= std::uint32_t{1} << index_of<Item>();
  pool.items.push_back(item);
  pool.keys.push_back(key);
}

}  // namespace iota::solver
