// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "ingredient/model.h"
#include "ingredient/quantities.h"
#include "solver/advance_report.h"

#include <span>
#include <vector>

namespace iota::island {

/// Bodies that nothing holds and nothing ties to others: no hinge, nail, grip, constraint or implicit bond. They have no
/// islands. Single particles are integrated here, in closed form, with the results of an island up to round-off. The
/// others, the *loose* ones, borrow an island for each step: see Islands::advance.
class FreeBodies {
 public:
  static bool is_free(const model::Model&, std::uint32_t articulate);

  static bool is_particle(const model::Model& model, std::uint32_t articulate) {
    return model.bodies[model.articulates[articulate].first].count == 1;
  }

  void forget() { articulates_.clear(), awake_.clear(), loose_.clear(), still_.clear(), is_old_ = false; }
  void set(std::uint32_t articulate, bool free);
  bool contains(std::uint32_t articulate) const { return articulate < articulates_.size() && articulates_[articulate]; }

  /// Stops a particle until a force acts on it; see System::set_rest.
  void put_to_rest(model::Model&, std::uint32_t articulate);
  void wake(model::Model&, std::uint32_t articulate);
  static bool is_resting(const model::Model& model, std::uint32_t articulate) {
    return model.bodies[model.articulates[articulate].first].kind == BodyKind::resting;
  }
  /// Number of resting ones in the last step.
  std::uint32_t resting() const { return resting_; }

  /// False only if it is known that none rests.
  bool may_rest() const { return is_old_ || resting_ > 0 || !still_.empty(); }
  /// visit(body): of those that rested when the last step began; it did not look at them.
  std::uint32_t still() const { return static_cast<std::uint32_t>(still_.size()); }
  template <class Visit>
  void for_each_still(Visit visit) const {
    for (const std::uint32_t body : still_) visit(body);
  }
  /// Number of loose ones that were frozen in the last step.
  std::uint32_t frozen() const;
  /// The sums of the others, particles and loose ones, at the end of a step. Those of frozen ones are kept until they are woken or
  /// `epoch` is another one.
  void add_awake(const model::Model&, std::uint64_t epoch, ingredient::Book&);
  /// Another number whenever the still ones are others.
  std::uint64_t version() const { return version_; }
  /// Some were woken or put to rest.
  void note_change() { is_old_ = true; }

  /// One step of h seconds for all particles, after that of the loose bodies.
  solver::AdvanceReport advance(model::Model&, double h, const Parallel&);

  struct Loose {
    std::uint32_t articulate, body;
    bool rests = false;                 ///< it fell asleep in the last step
    solver::AdvanceReport report = {};  ///< of the last step
    std::uint32_t solved_steps = 1;     ///< see Island::solved_steps
    double work = 0;
    bool is_frozen = false;  ///< in the last step
    ingredient::Book book = {};
    std::uint64_t book_epoch = 0;  ///< of `book`, see add_awake

    /// Takes a step within a stride, or none if it is frozen, without an island.
    bool goes_on_by_itself(model::Model&, double h);
  };
  /// The loose bodies that were awake when the last step began, in order ...
  std::span<Loose> loose() { return loose_; }
  std::span<const Loose> loose() const { return loose_; }
  /// ... or that are now, at the begin of a step.
  std::span<Loose> loose(const model::Model& model) {
    refresh(model);
    return loose_;
  }
  std::size_t size(const model::Model&);

 private:
  struct FreeParticle {
    std::uint32_t articulate, body, particle, ring;
  };
  void refresh(const model::Model&);
  static void rest(model::Model&, std::uint32_t articulate);

  std::vector<std::uint8_t> articulates_;  // 1 where free, by slot
  std::vector<FreeParticle> awake_;        // particles, in order
  std::vector<Loose> loose_;               // in order
  std::vector<std::uint32_t> still_;       // bodies, in order
  std::uint64_t version_ = 0;
  struct Share {
    double dissipated = 0, lost = 0, work = 0;
    std::uint32_t resting = 0;  // fell asleep
    bool is_stuck = false;
  };
  std::vector<Share> shares_;
  std::uint32_t resting_ = 0;
  bool is_old_ = false;
};

}  // namespace iota::island
