// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient_list.h"
#include "ingredient/model.h"
#include "ingredient/quantities.h"
#include "island/kept_orders.h"
#include "solver/advance_report.h"

#include <iota/solver.h>

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace iota {
struct Diagnosis;
struct IslandReport;
}  // namespace iota

namespace iota::solver {
class Integrator;
}

namespace iota::island {

/// The former states of moved rings. A ring may be listed more than once.
struct MovedRings {
  struct State {
    std::uint32_t ring;
    Vec3 position, velocity;
  };
  std::vector<State> before = {};
  bool is_asked_for = true;  ///< otherwise nothing is listed

  void put(model::Model&, std::uint32_t ring, const Vec3& position, const Vec3& velocity);
  /// Exchanges the rings' former and present states.
  void exchange(model::Model&);
};

/// Articulates that bonds and constraints tie together, as one problem for the solver: nodes, ingredients, an integrator.
/// The ingredients act on the nodes; the stages here are folds over them.
class Island {
 public:
  Island();
  ~Island();

  /// Builds the problem's structure; `node_of_ring` is scratch for all rings, `none` everywhere before and after.
  /// Islands have no ring in common, so they may be built in parallel with the same scratch.
  void assemble(const model::Model&, std::span<const std::uint32_t> articulates,
                std::vector<std::uint32_t>& node_of_ring, const KeptOrders& orders = {});

  /// A change of its bodies and of what acts on them.
  struct Change {
    model::Model::LocalChange local;          ///< bodies: changed and joined ones, in order
    std::vector<std::uint32_t> left, joined;  ///< bodies, in order
    std::vector<std::uint32_t> joined_rings;  ///< of islands that it takes over: in their order of elimination
    void clear() {
      local.bodies.clear(), local.rings.clear(), local.pulled.clear();
      left.clear(), joined.clear(), joined_rings.clear();
    }
  };
  /// Follows a change; `articulates`: those that it then has, in order. It is then as if assembled again, except for the
  /// order of elimination: joined points are eliminated first, in their order, so that the rest of the matrix keeps its
  /// slots. This takes the time of what has changed. False if so much has changed that it must be assembled.
  bool follow(model::Model&, std::span<const std::uint32_t> articulates, const Change&,
              std::vector<std::uint32_t>& node_of_ring, MovedRings&);
  /// Whether it should have its order of elimination again. With contacts it may not be analyzed yet, and is when it is
  /// solved; after many changes an order may have come to cost too much.
  bool keeps_order() const;
  double order_work() const;  ///< see KnownOrder
  /// Appends the rings of its nodes in order of elimination.
  void append_order(std::vector<std::uint32_t>& rings) const;
  /// Updates pulls that were added or removed: see Structure::mark_pull. False if it must be assembled.
  bool renew_pulls(const model::Model&, std::vector<std::uint32_t>& node_of_ring);
  std::span<const std::uint32_t> bodies() const { return nodes_.bodies; }
  /// visit(slot): each articulate of its bodies.
  template <class Visit>
  void for_each_articulate(const model::Model& model, Visit visit) const {
    for (const std::uint32_t body : nodes_.bodies)
      if (const std::uint32_t slot = model.bodies[body].articulate; model.articulates[slot].first == body) visit(slot);
  }

  /// Number of unknown points: a measure of the work.
  std::size_t size() const { return nodes_.size(); }
  /// The largest number of points for which it has room.
  std::size_t room() const { return nodes_.rings.capacity(); }

  /// Sets positions and velocities of carried particles from their basis. If these differed (assigned velocities,
  /// conflicts), their momentum is passed to the basis.
  void carry_along(model::Model&, MovedRings&);

  /// Loads the state of the model into the problem, for a step of h seconds (h = 0: for projections).
  void load(const model::Model&, double h);

  using Clock = std::chrono::steady_clock;
  struct Limits {
    Clock::time_point deadline = Clock::time_point::max();  ///< when to stop looking for a solution
    double share = 1;                                       ///< of StepBudget::contacts
    double part = 1;                                        ///< of a whole step
  };
  /// A step of h seconds, or of several of them at once, or none: see Strides. The rings of an island with a stride have
  /// rows in the table of tracks.
  const solver::AdvanceReport& advance(model::Model&, double h, const Limits&);
  /// A part of a step, in seconds, before `advance` takes the rest. Ends a stride.
  const solver::AdvanceReport& advance_part(model::Model&, double part, const Limits&);
  /// The stride of all its bodies, or the shortest one, which those with a longer one get. Reads them again if that was
  /// asked for, and gives rings tracks. Not while other islands step.
  std::uint32_t agree_on_stride(model::Model&);
  void read_stride() { stride_ = 0, is_still_ = is_still_ && !is_frozen_, is_frozen_ = false, book_epoch_ = 0; }
  /// Number of steps of the latest step that it was solved for, and a measure of the work of that.
  std::uint32_t solved_steps() const { return solved_steps_; }
  double work() const { return work_; }

  /// Tries a step of h seconds by the model's settings, in the island's own problem: the model does not change.
  /// Limits: see StepBudget. Another try begins where this one did, and from
  /// the same state of the model it gives the same bits (with large factors only if they are forgotten before both:
  /// those of an earlier step serve one try).
  void try_step(const model::Model&, double h, const Limits&);
  void try_step(const model::Model& model, double h) { try_step(model, h, {}); }
  /// Whether springs, motors or other rows with bounds may move it further in a step than its velocities tell.
  bool is_sprung() const;
  /// Tries a step that `advance` then stores, if it is as long and nothing of the island has changed until then.
  void try_ahead(const model::Model& model, double h, const Limits& limits) {
    try_step(model, h, limits), tried_ahead_ = h;
  }
  void drop_try() { tried_ahead_ = 0; }
  /// Drops a try to make another one of the same step, which has as much less work left.
  void try_again(model::Model&);
  /// visit(ring, way): how far each goes in the latest try, m.
  template <class Visit>
  void for_each_way(const model::Model&, Visit visit) const;
  /// Stores the latest try, of h seconds, in the model. Without a try since the last commit it stores nothing.
  const solver::AdvanceReport& commit(model::Model&, double h);

  /// The report of the latest try, or of the last step.
  const solver::AdvanceReport& latest() const { return last_; }
  /// `last`: of its last step; of a loose body, for whose state it is loaded, that of the body.
  IslandReport report(const model::Model&, const solver::AdvanceReport& last) const;
  bool has_stepped() const { return has_stepped_; }

  /// See System::diagnose; after `load(model, 0)`.
  Diagnosis diagnose(const model::Model&) const;

  bool is_driven(const model::Model&) const;  ///< by prescribed motion

  /// Wakes it in the next step.
  void wake() { to_wake_ = true, is_still_ = false, book_epoch_ = 0; }
  bool is_asleep(const model::Model&) const;
  void put_to_rest(model::Model&);
  /// Whether a step would change nothing: it sleeps, or no body of it can move by itself. Known since the latest step
  /// or change of its structure.
  bool is_still() const { return is_still_; }
  /// A step in which it is still.
  void skip_step() { last_ = {}, has_stepped_ = true; }
  /// The quantities of its bodies while it is still: measured once in an epoch, which is not 0.
  const ingredient::Book& still_book(const model::Model& model, std::uint64_t epoch) {
    if (book_epoch_ != epoch) still_book_ = ingredient::calc_book(model, bodies()), book_epoch_ = epoch;
    return still_book_;
  }
  /// Whether it has been still, as it is, since its book of this epoch, which is not 0.
  bool has_stayed_still(std::uint64_t epoch) const { return is_still_ && book_epoch_ == epoch; }
  std::size_t body_count() const { return nodes_.bodies.size(); }

  /// Projects velocities, and before that positions on request, on the constraints. False if no position satisfies all
  /// of them.
  bool project(model::Model&, bool positions);
  /// The same of velocities that were assigned, those of carried particles included: their momentum counts.
  void project_assigned(model::Model&);

  /// The same after an edit of some bodies (all alive), only around them if that is sufficient.
  bool settle(model::Model&, std::span<const std::uint32_t> bodies, bool positions, MovedRings& moved);
  /// Whether a point of an articulate is pinned.
  bool is_pinned(const model::Model&, std::uint32_t articulate) const;

 private:
  /// visit(ingredient) for each, in the order of the list.
  template <class Visit>
  void for_each_ingredient(Visit visit) {
    std::apply([&](auto&... ingredient) { (visit(ingredient), ...); }, ingredients_);
  }
  template <class Visit>
  void for_each_ingredient(Visit visit) const {
    std::apply([&](const auto&... ingredient) { (visit(ingredient), ...); }, ingredients_);
  }
  template <class Test>
  bool any_ingredient(Test test) const {
    return std::apply([&](const auto&... ingredient) { return (test(ingredient) || ...); }, ingredients_);
  }

  void clear();
  /// Passes the momentum of carried particles with velocities of their own to the basis. False if there are none.
  bool pass_on_assigned(model::Model&, MovedRings&);
  Vec3 choose_origin(const model::Model&) const;
  Vec3 way_of_node(const model::Model&, std::size_t node) const;  ///< see for_each_way
  bool has_finite_motion() const;
  void add_node(const model::Model&, std::uint32_t ring, std::uint32_t beside,
                std::vector<std::uint32_t>& node_of_ring);
  void find_changed_nodes(const model::Model&, const Change&, std::vector<std::uint32_t>& node_of_ring,
                          std::vector<std::uint32_t>& changed);
  bool has_no_free_body(const model::Model&) const;

  /// The kind of the latest try: it tells what a commit has to store.
  enum class Tried : std::uint8_t {
    nothing,
    still,       ///< it sleeps, or nothing moves it
    prescribed,  ///< its points have no motion of their own
    moved,
    overflown  ///< forces were too large for numbers: the points keep their places, at rest
  };
  Tried try_prescribed(const model::Model&, double h);
  Tried try_motion(const model::Model&, double h, const Limits&);
  void commit_motion(model::Model&, double h);
  bool may_owe_work(const model::Model&) const;
  double owed_work(const model::Model&) const;
  void set_owed_work(model::Model&, double) const;
  double velocity_jump(double h) const;  ///< see ingredient::NoAnswers
  double rate_jump() const;
  void impose_velocities(double h);
  double virtual_energy(const model::Model&) const;
  void store_step(model::Model&, double h, bool is_instant) const;
  void store_corrections(model::Model&) const;
  bool project_all(model::Model&, bool positions);
  void find_order(std::vector<std::uint32_t>& nodes) const;
  std::vector<std::uint32_t> nodes_of(const model::Model&, std::span<const std::uint32_t> bodies) const;
  void store_projection(model::Model&, bool moved, MovedRings&, std::span<const std::uint32_t> only = {}) const;
  void store_carried(model::Model&, MovedRings&) const;
  bool meets_pinned(const model::Model&) const;

  const solver::AdvanceReport& solve(model::Model&, double h, const Limits&);
  void begin_stride(model::Model&, double h, std::uint32_t steps, const Limits&);
  ingredient::Unused leave_stride(model::Model&);
  const solver::AdvanceReport& take_back(const ingredient::Unused&);
  template <class Visit>
  void for_each_ring(const model::Model& model, Visit visit) const {
    nodes_.for_each_ring(model, visit);
  }

  bool stays_asleep(const model::Model& model) const { return !to_wake_ && is_asleep(model); }
  void wake_bodies(model::Model&);
  /// Falls asleep once it has been slow for long enough, if sleep is on.
  void update_sleep_timer(model::Model&, double h, solver::AdvanceReport&);
  void look_whether_still(const model::Model&);
  /// Call it if its list of bodies has changed.
  void find_first_body();
  /// The articulate of its first body: it has the island's state between steps.
  model::Articulate& articulate(model::Model&) const;
  const model::Articulate& articulate(const model::Model&) const;
  void use_solver(const std::array<char, 32>& name);
  std::string name_of_row(const model::Model&, const solver::RowName&) const;

  ingredient::IslandNodes nodes_;
  ingredient::Ingredients ingredients_;
  solver::Problem problem_;
  std::unique_ptr<solver::Integrator> integrator_;  // a pointer, so that users of the header do not include it
  std::array<char, 32> solver_name_{};
  std::unique_ptr<Solver> solver_;          // replaces the integrator's own solver
  std::uint32_t first_body_ = model::none;  // with the lowest slot
  bool idle_ = false;                       // no body of it can move by itself: there is nothing to solve
  bool to_wake_ = false;
  bool is_still_ = false;
  ingredient::Book still_book_;
  std::uint64_t book_epoch_ = 0;  // of the book; 0: not known
  bool has_stepped_ = false;
  std::uint32_t stride_ = 0;  // steps; 0: not known
  bool is_frozen_ = false;    // and outside of a stride: still
  std::uint32_t solved_steps_ = 1;
  double paid_work_ = 0;  ///< of what was owed, by the latest try
  double work_ = 0;
  Tried tried_ = Tried::nothing;  // since the last commit
  double tried_ahead_ = 0;        // length of a step that was tried ahead, s
  solver::AdvanceReport last_;    // of the last step, or the latest try
};

template <class Visit>
void Island::for_each_way(const model::Model& model, Visit visit) const {
  for (std::size_t node = 0; node < nodes_.size(); ++node) visit(nodes_.rings[node], way_of_node(model, node));
  for (std::size_t i = 0; i < nodes_.carried.size(); ++i) {
    Vec3 way;
    for (const auto& [node, weight] : nodes_.carriers[i]) way += weight * way_of_node(model, node);
    visit(model.particles[nodes_.carried[i]].ring, way);
  }
}

}  // namespace iota::island
