// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "island/free_particles.h"
#include "island/island.h"

#include <optional>

namespace iota::island {

/// All islands of a model, rebuilt only if articulates or their ties changed: an edit costs what it touches.
class Islands {
 public:
  /// True if any was built, which may change carried particles slightly.
  bool update(model::Model& model, const Parallel& parallel) {
    MovedRings moved{.is_asked_for = false};
    return update(model, parallel, moved);
  }
  bool update(model::Model&, const Parallel&, MovedRings&);
  void forget();
  /// The next steps depend on the model alone: rebuilds islands that have followed edits, and forgets factors.
  void renew();
  /// In the order of the lowest slot among their articulates, so that a restored model has the same.
  std::span<Island* const> all();
  /// The islands that are not still: a step costs what moves, not what rests.
  std::span<Island* const> awake(const model::Model&);
  /// Number of awake islands of a task: all if threads would not be faster.
  std::size_t grain(const Parallel&) const;
  /// The islands of these articulates are awake in the next step.
  void wake(model::Model&, std::span<const std::uint32_t> articulates);
  /// So are those that ingredients stir: forces on their points, moving nails.
  void wake_stirred(model::Model&);
  void put_to_rest(model::Model&, std::uint32_t articulate);
  /// Bodies that sleep, free particles included, in the latest step.
  std::uint32_t resting(const model::Model&) const;

  /// The quantities of the model. If most bodies are still, each island of them is measured only once. After edits,
  /// which may change what is still, all are measured anew.
  ingredient::Book book(const model::Model&);
  /// Null for a free particle.
  Island* of_articulate(std::uint32_t articulate) const {
    const std::uint32_t leader = leader_of_[articulate];
    return leader == model::none ? nullptr : island_of_leader_[leader].get();
  }
  /// Replaces a list of articulates by the leaders of their islands, each once, in order: a net of particles is one
  /// island with an articulate for each particle.
  void replace_by_leaders(std::vector<std::uint32_t>& articulates) const;
  FreeParticles& free_particles() { return free_particles_; }

 private:
  struct Followed {
    std::uint32_t leader;
    std::uint64_t step;  // of its last follow
  };

  void drop(std::uint32_t leader);
  void put_on_waiting_list(std::uint32_t articulate);
  void set_members(std::uint32_t leader);
  bool find_members(const Island&, const model::Model&);
  bool follow(model::Model&, std::uint32_t leader, MovedRings&);
  static void make_ready(model::Model&, std::uint32_t body);
  void refresh_awake(const model::Model&);
  bool is_due(const Followed&, const model::Model&) const;
  void follow_or_drop_touched(model::Model&, MovedRings&);
  void renew_pulls(const model::Model&);
  void gather_waiting(const model::Model&);
  void build_fresh(model::Model&, const Parallel&, MovedRings&);

  // All by articulate slot. The leader of an island is the lowest of its articulates.
  std::vector<std::unique_ptr<Island>> island_of_leader_;
  std::vector<std::uint32_t> leader_of_;
  std::vector<std::uint32_t> next_member_;  // list of the articulates of one island, from its leader on
  std::vector<std::uint8_t> is_waiting_;    // without an island
  std::vector<std::uint8_t> is_member_;     // listed in `members_` by find_members
  model::Model::Touched touched_;
  std::vector<std::uint32_t> waiting_, members_, fresh_;
  model::Model::LocalChange change_;  // of the island that follows
  std::vector<Followed> followed_;    // islands that have followed
  bool renew_ = false;
  std::vector<Island*> in_order_;
  std::vector<Island*> awake_;                       // of those in order
  std::size_t total_size_ = 0, largest_size_ = 0;    // of those awake, points
  std::uint32_t asleep_ = 0, still_bodies_ = 0;      // bodies of the others: those that could move, all
  std::optional<ingredient::Book> still_book_;       // of the others, and of the still free particles
  std::uint64_t book_epoch_ = 1, book_version_ = 0;  // see Island::still_book, FreeParticles::version
  std::vector<std::uint32_t> node_of_ring_;
  FreeParticles free_particles_;
  bool knows_all_ = false, order_is_old_ = true, awake_is_old_ = true;
};

}  // namespace iota::island
