// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Two particles that are closing.
struct Closing : model::Ends {
  double distance = 0;               ///< at the start, m
  double duration = 0, elapsed = 0;  ///< s
  double multiplier = 0;
};

/// Pairs of particles that meet after some time and are then combined: distance rows with a decreasing length.
class Closings : public NoAnswers {
 public:
  struct Tables {
    model::EndTable<Closing, Id<"closing">> closings;

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      closings.archive(ar, structure.particles.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static bool holds(const Model&, std::uint32_t particle);
  static bool uses(const Model& model, std::uint32_t particle) { return holds(model, particle); }
  static void visit_joined(const Model&, std::uint32_t particle, Visit);
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static bool call_off(Model&, std::uint32_t p, std::uint32_t q);
  static void clean_up(Model&, std::span<const std::uint32_t> bodies, std::vector<std::string>& notes);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static void end_step(Model&, double h);
  static void tell(Model&, Outcome&);

  static std::uint32_t add(Model&, const Closing&);  ///< returns the slot; the two articulates must become one
  static void remove(Model&, std::uint32_t closing);
  /// The slot of the closing between two particles, in either order; `none` if there is none.
  static std::uint32_t between(const Model&, std::uint32_t p, std::uint32_t q);
  /// Ends one before its particles have met. Its articulate may split.
  static void end(Model&, std::uint32_t closing);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;
};

}  // namespace iota::ingredient
