// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "island/cut_search.h"
#include "island/free_bodies.h"
#include "island/island.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace iota::island {

/// Islands that no body owns, for as many as borrow one at the same time.
class Lenders {
 public:
  struct Loan {
    std::unique_ptr<Island> island = std::make_unique<Island>();
    std::uint32_t articulate = model::none;  ///< of the latest borrower
    std::uint64_t epoch = 0;                 ///< of the structure for which it was assembled
  };
  Loan take() {
    const std::lock_guard lock(mutex_);
    if (loans_.empty()) return {};
    Loan loan = std::move(loans_.back());
    loans_.pop_back();
    return loan;
  }
  void give(Loan loan) {
    const std::lock_guard lock(mutex_);
    loans_.push_back(std::move(loan));
  }

 private:
  std::mutex mutex_;
  std::vector<Loan> loans_;
};

/// All islands of a model. They follow edits, and an edit costs what it touches: an island that is tied to others takes
/// the smaller ones over, and a part that was cut off leaves it after some steps. It is assembled anew where too much of
/// it has changed. Free bodies have none: a loose one borrows an island for the moment in which it needs one, with the
/// results of an island of its own, to the bit. With one each, ten thousand flying boxes took 126 MB.
class Islands {
 public:
  /// True if any was built, which may change carried particles slightly.
  bool update(model::Model& model, const Parallel& parallel) {
    MovedRings moved{.is_asked_for = false};
    return update(model, parallel, moved);
  }
  bool update(model::Model&, const Parallel&, MovedRings&);
  void forget();
  /// The next steps depend on the model alone, for a snapshot of it: the next update begins as one of a restored model. The
  /// orders of elimination become part of the model until then.
  void renew(model::Model&);
  /// In the order of the lowest slot among their articulates, so that a restored model has the same.
  std::span<Island* const> all();
  /// The islands that are not still: a step costs what moves, not what rests.
  std::span<Island* const> awake(const model::Model&);
  /// Rises whenever another set of bodies may be awake, but for edits since the last step.
  std::uint64_t awake_version() const { return awake_version_ + free_bodies_.version(); }
  /// The loose bodies that are awake.
  std::span<const FreeBodies::Loose> loose(const model::Model& model) { return free_bodies_.loose(model); }
  /// Number of awake islands and loose bodies of a task: all if threads would not be faster.
  std::size_t grain(const Parallel&) const;
  /// A part of a step, before `advance` takes the rest of it. Its contacts are those of this part.
  const solver::AdvanceReport& advance_part(model::Model&, Island&, double part, double h,
                                            Island::Clock::time_point deadline);
  /// The time that it has advanced in parts since the last step, s.
  double ahead(const model::Model&, const Island&) const;
  /// Tries a step of h seconds or a part of it, which `advance` or `advance_part` then stores: see Island::try_ahead.
  void try_ahead(const model::Model& model, Island& island, double part, double h,
                 Island::Clock::time_point deadline) const {
    island.try_ahead(model, part, {deadline, share_of(island), part / h});
  }
  /// A step of h seconds of one of them: of `awake`, then of `loose`. Those of others may run at the same time.
  void advance(model::Model&, std::size_t index, double h, Island::Clock::time_point deadline);
  /// visit(body, report): of all of them, in this order; the body is the island's first.
  template <class Visit>
  void for_each_advanced(Visit visit) const {
    for (const Island* const island : awake_) visit(island->bodies().front(), island->latest());
    for (const FreeBodies::Loose& loose : free_bodies_.loose()) visit(loose.body, loose.report);
  }
  /// Ends a step, which some took in parts.
  void end_step() {
    ahead_.clear();
    some_became_still_ = std::ranges::any_of(awake_, &Island::is_still);
  }
  /// How the last step was for each island and loose body.
  std::vector<IslandReport> reports(const model::Model&);
  /// The islands of these articulates are awake in the next step.
  void wake(model::Model&, std::span<const std::uint32_t> articulates);
  /// So are those that ingredients stir in a step of h seconds: forces on their points, moving nails, laws of the time.
  void wake_stirred(model::Model&, double h);
  /// Flags those of them that rest, before contacts are looked for: a body that a force throws looks at what is in its way.
  void flag_stirred_sleepers(model::Model&, double h);
  /// Before islands step: they agree on strides that have changed, and their rings get tracks.
  void plan_strides(model::Model&);
  struct Work {
    double work;          ///< of the latest solution of an island, see Island::work; the share of an articulate
    std::uint32_t steps;  ///< that it was for; 0: the island is still
  };
  Work work_of(const model::Model&, std::uint32_t articulate) const;
  void put_to_rest(model::Model&, std::uint32_t articulate);
  /// Bodies that sleep, free particles included, in the latest step.
  std::uint32_t resting(const model::Model&) const;

  /// The quantities of the model. If most bodies are still, each island of them is measured only once. After edits
  /// that may change what is still, all are measured anew.
  ingredient::Book book(const model::Model&);
  /// The energies alone, before a step and after `update`.
  ingredient::Energies energies(const model::Model&);
  /// Null for a free body.
  Island* of_articulate(std::uint32_t articulate) const {
    return entries_[articulate].home ? &entries_[articulate].home->island : nullptr;
  }
  /// Replaces a list of articulates by the leaders of their islands, each once, in order: a net of particles is one
  /// island with an articulate for each particle. A free body is its own leader.
  void replace_by_leaders(std::vector<std::uint32_t>& articulates) const;
  /// visit(island): of the islands of some articulates, each once, in the order of their leaders, which replace them. A
  /// loose body borrows one; a free particle has none.
  template <class Visit>
  void for_each_of(const model::Model& model, std::vector<std::uint32_t>& articulates, Visit visit) {
    replace_by_leaders(articulates);
    for (const std::uint32_t a : articulates)
      if (Island* const island = of_articulate(a))
        visit(*island);
      else if (!FreeBodies::is_particle(model, a))
        borrow(model, a, visit);
  }
  FreeBodies& free_bodies() { return free_bodies_; }
  /// Checks, if the model was not changed since the last update, that each active body is in one island or free, that
  /// islands and their articulates agree, and that what is tied together is in one island.
  void validate(const model::Model&, model::Audit&) const;

 private:
  static constexpr std::uint32_t none = model::none;

  /// Something that no force explains moves a body: all that is solved with it takes every step.
  void end_strides_with(model::Model&, std::uint32_t body);

  /// An island, and what the others have to know of it.
  struct Home {
    Island island;
    std::uint32_t leader = none;             ///< the lowest of its articulates, after the latest update
    std::vector<std::uint32_t> articulates;  ///< in order
    std::vector<std::uint32_t> marked;       ///< in an update: those with changes
    std::vector<std::uint32_t> leaving;      ///< in an update: those that it is about to lose
    std::vector<std::uint32_t> suspects;     ///< those at which something may have been cut, each once
    std::uint64_t suspected_at = 0;          ///< step of the first of these
    std::uint32_t unit = none;               ///< while units are grouped
    bool is_changed = false;                 ///< it must follow
    bool has_followed = false;
    bool is_built = false;       ///< until then its island is still that of its earlier owner
    std::uint32_t index = none;  ///< in the order of islands, if that is not old

    void clear() {
      articulates.clear(), marked.clear(), leaving.clear(), suspects.clear();
      leader = unit = index = none, suspected_at = 0, is_changed = has_followed = is_built = false;
    }
    /// Whether it is assembled anew as quickly as it could follow.
    bool is_small() const { return island.size() <= 24; }
  };
  struct Entry {
    Home* home = nullptr;
    std::uint32_t unit = none;       ///< while units are grouped, of one that waits
    bool is_waiting = false;         ///< for a home
    bool is_suspect = false;         ///< listed by its home
    bool has_other_changes = false;  ///< in an update, without a home: than local ones
  };
  /// A home, or an articulate that waits for one.
  struct Unit {
    Home* home;
    std::uint32_t articulate, parent;
  };
  /// Units that are tied together, which become one island.
  struct Group {
    std::uint32_t lowest = none;  ///< of its articulates
    std::vector<Home*> homes;
    std::vector<std::uint32_t> waiting;  ///< articulates
    std::vector<std::uint32_t> bodies;   ///< changed ones
    void clear() { lowest = none, homes.clear(), waiting.clear(), bodies.clear(); }
  };

  /// visit(island): one of the loose body's, for the moment. Others may borrow theirs at the same time.
  template <class Visit>
  void borrow(const model::Model& model, std::uint32_t articulate, Visit visit) {
    Lenders::Loan loan = lenders_.take();
    if (loan.articulate != articulate || loan.epoch != epoch_ || loan.island->is_still()) {
      loan.island->assemble(model, {&articulate, 1}, node_of_ring_);
      loan.articulate = articulate, loan.epoch = epoch_;
    }
    visit(*loan.island);
    lenders_.give(std::move(loan));
  }

  Home& new_home(std::uint32_t leader, std::size_t points);
  std::unique_ptr<Home> take_spare(std::size_t points);
  void retire(std::uint32_t leader);
  void wait(std::uint32_t articulate);
  void drop(Home&);
  void set_leader(Home&);
  void set_members(Home&, std::span<const std::uint32_t> articulates);
  void note_changed(Home&);
  void add_suspect(Home&, std::uint32_t articulate, std::uint64_t step);
  void forget_suspects(Home&);
  static bool is_due(const Home&, const model::Model&);
  static void make_ready(model::Model&, std::uint32_t body);
  void note_still(std::uint32_t articulate);
  /// Puts changed islands into the order. False, without a change, if their leaders are others.
  bool replace_in_order();
  void list_in_order();
  void look_whether_still(const model::Model&, std::uint32_t index);
  /// Forgets what edits may have changed. Whether the books of still islands, and of so many frozen loose bodies, make a sum
  /// shorter.
  bool renew_books(const model::Model&, std::uint32_t frozen);
  ingredient::Book sum_books(const model::Model&);
  /// False only if it is known that nothing rests, or stands still with nothing to solve: after edits it is not.
  bool may_be_still(const model::Model&) const;
  void refresh_awake(const model::Model&);
  double share_of(const Island&) const;

  void drop_marked(const model::Model&);
  void find_changed(const model::Model&);
  void find_members(const model::Model&, Home&);
  void take_parts_out(const model::Model&);
  void take_parts_out(const model::Model&, Home&, std::span<const std::uint32_t> suspects, std::size_t most_bodies);
  void find_groups(const model::Model&);
  void collect_groups(const model::Model&);
  Group& group_of(std::uint32_t unit);
  std::uint32_t unit_of(Home&);
  std::uint32_t unit_of(std::uint32_t articulate);
  std::uint32_t root_of(std::uint32_t unit);
  void form_groups(model::Model&, MovedRings&);
  bool follow(model::Model&, const Group&, MovedRings&);
  void renew_pulls(const model::Model&);
  void build_fresh(model::Model&, const Parallel&, MovedRings&);
  void note_suspects(const model::Model&);

  // By articulate slot.
  std::vector<Entry> entries_;
  std::vector<std::unique_ptr<Home>> home_of_leader_;
  /// With room for the next ones, by the bits of the number of points for which they have it.
  std::array<std::vector<std::unique_ptr<Home>>, 14> spare_;
  std::vector<Home*> suspected_;  // homes with suspects
  bool renew_ = false;            // in the next update

  // State of the present update.
  model::Model::Marked marked_;
  std::vector<std::uint32_t> waiting_, members_;
  std::vector<Home*> changed_, fresh_, homes_;
  std::vector<std::uint32_t> fresh_loose_;              // articulates
  std::vector<MovedRings> moved_by_;                    // by each fresh one
  std::vector<std::pair<Home*, std::uint32_t>> joins_;  // homes with a body of an articulate that is elsewhere
  std::vector<Unit> units_;
  std::vector<Group> groups_;             // the first ones; others keep their room
  std::vector<std::uint32_t> group_of_;   // unit
  std::vector<std::uint32_t> by_lowest_;  // of groups
  std::size_t group_count_ = 0;
  Island::Change change_;             // of the home that follows
  std::vector<std::uint8_t> is_own_;  // by body slot, in the home that follows; zeros before and after
  CutSearch cut_search_;

  std::vector<double> ahead_;  // by articulate slot, s; empty if no island is advanced in parts

  /// Known of an island that is still, so that a step need not look at each.
  struct Still {
    bool is = false, is_asleep = false;
    std::uint32_t bodies = 0;
    std::uint64_t book_epoch = 0;
    ingredient::Book book;
  };
  std::vector<Island*> in_order_;
  std::vector<std::uint32_t> leaders_;               // of these
  std::vector<std::uint32_t> changed_leaders_;       // of those that may be others since they were listed
  std::vector<Still> stills_, stills_before_;        // of each of these, and of the order before
  std::vector<std::uint32_t> changed_stills_;        // indices in the order, if that is not old
  std::vector<Island*> awake_;                       // of those in order
  std::vector<std::uint32_t> awake_indices_;         // of these in the order
  std::size_t total_size_ = 0, largest_size_ = 0;    // of those awake, points
  std::uint32_t asleep_ = 0, still_bodies_ = 0;      // bodies of the others: those that could move, all
  std::optional<ingredient::Book> still_book_;       // of the others, and of the still free particles
  std::uint64_t book_epoch_ = 1, book_version_ = 0;  // see Island::still_book, FreeBodies::version
  std::vector<std::uint32_t> node_of_ring_;
  FreeBodies free_bodies_;
  Lenders lenders_;
  KeptOrders kept_orders_;  // of the present update
  std::uint64_t awake_version_ = 0;
  std::uint64_t epoch_ = 1;  // another one after each change of structure
  bool knows_all_ = false, order_is_old_ = true, awake_is_old_ = true;
  bool some_became_still_ = false;  // in the last step, and are still listed as awake
};

}  // namespace iota::island
