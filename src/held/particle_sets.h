// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "held/chunks.h"
#include "ingredient/model.h"
#include "math/mat3.h"
#include "neighbors/pair_sum.h"

#include <memory>
#include <vector>

namespace iota::held {

/// The particles of a field or a pairwise force, as arrays; hinged particles are one row, with their total mass.
struct ParticleSet {
  std::uint32_t group = model::none;  ///< none: all
  std::uint32_t other = model::none;  ///< the second group; none: no second group
  bool has_normals = false;           ///< only oriented particles, with their normals
  std::vector<std::uint8_t> sides;    ///< of pairs between two groups: bit 0 of `group`, bit 1 of `other`; else empty
  std::vector<std::uint32_t> rings, family;
  std::vector<std::uint32_t> attributes;  ///< of oriented particles
  std::vector<ParticleId> ids;            ///< the first of each ring
  std::vector<std::uint8_t> is_pushed;    ///< 0 for static and scripted bodies, which only act on others
  /// Rows of bodies that are not solved in this step, as they are frozen or within a stride: no field is evaluated there.
  std::vector<std::uint32_t> waiting;
  laws::ParticleArrays arrays;
  std::vector<double> position_rows, velocity_rows, force_rows, rate_rows;  // for fields
  std::vector<Mat3> rates;  ///< derivatives of the forces by the velocities, N s/m; or empty: none
  bool is_loaded = false;

  void find(const model::Model&);
  /// The state with positions `ahead` and normals `normals_ahead` seconds on, and no forces.
  void load(const model::Model&, double ahead, double normals_ahead, const Parallel&);
  /// Finds the rows that wait in a step of h seconds.
  void find_waiting(const model::Model&, double h);
  /// Calls visit(first, last) for the rows between them, in pieces for several threads.
  template <class Visit>
  void for_each_acting(const Parallel& parallel, Visit visit) const {
    if (waiting.empty()) return in_chunks(rings.size(), parallel, visit);
    std::size_t first = 0;
    for (const std::size_t row : waiting) {
      if (row > first) visit(first, row);
      first = row + 1;
    }
    if (first < rings.size()) visit(first, rings.size());
  }
  /// Loads present positions; the rest does not change.
  void follow(const model::Model&);
  /// Adds the forces to those on the rings during the next step.
  void unload(model::Model&, const Parallel&) const;

 private:
  void load_normals(const model::Model&, double ahead);
};

/// All sets in use, and the pairs found among them. Nothing here is saved.
struct ParticleSets {
  void update(const model::Model&);
  void forget() { sets.clear(), sums.clear(), seen_structure = seen_members = ~0ull; }
  ParticleSet& of(const model::Model&, std::uint32_t group, std::uint32_t other = model::none,
                  bool has_normals = false);
  neighbors::PairSum& sum(std::uint32_t pairs);

  std::vector<std::unique_ptr<ParticleSet>> sets;
  std::vector<std::unique_ptr<neighbors::PairSum>> sums;  // by slot of the pairwise force
  std::uint64_t seen_structure = ~0ull, seen_members = ~0ull;
};

}  // namespace iota::held
