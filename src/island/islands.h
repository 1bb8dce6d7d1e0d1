// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "island/free_particles.h"
#include "island/island.h"

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
  /// Number of islands of a task: all if threads would not be faster.
  std::size_t grain(const Parallel&);
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
  model::Model::Touched touched_;
  std::vector<std::uint32_t> waiting_, members_, fresh_;
  model::Model::LocalChange change_;  // of the island that follows
  std::vector<Followed> followed_;    // islands that have followed
  bool renew_ = false;
  std::vector<Island*> in_order_;
  std::size_t total_size_ = 0, largest_size_ = 0;  // of those in order, points
  std::vector<std::uint32_t> node_of_ring_;
  FreeParticles free_particles_;
  bool knows_all_ = false, order_is_old_ = true;
};

}  // namespace iota::island
