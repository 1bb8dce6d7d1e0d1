// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/constraint.h"
#include "ingredient/ingredient.h"

#include <map>
#include <vector>

namespace iota::ingredient {

struct RowUse;

/// Joints, rods, ropes, paths and surfaces with their limits, motors, friction and springs.
class Joints : public NoAnswers {
 public:
  struct Tables {
    SlotTable<Constraint, ConstraintId> constraints;
    SideTable<model::ListHead> places;  ///< of particles: the head of the list of their places
    std::vector<Vec3> curve_points;     ///< of paths, m
    SlotTable<CoupledTerm, Id<"coupled term">> coupled_terms;
    /// The functions of function surfaces, by key; not saved.
    std::map<std::uint64_t, SurfaceFunction> surface_functions;
    std::vector<ConstraintGeometry> geometries;  ///< by slot of the constraint; not saved
    model::ChangedSlots changed_constraints;     ///< not saved

    const auto& table_of(ConstraintId) const { return constraints; }
    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      constraints.archive(ar), places.archive(ar, structure.particles.slot_count());
      ar.vector(curve_points), coupled_terms.archive(ar);
    }
    const ConstraintGeometry& geometry(std::uint32_t constraint) const { return geometries[constraint]; }
    /// visit(slot of the constraint, place): once for each place of the particle.
    template <class Visit>
    void for_each_constraint_of(std::uint32_t particle, Visit visit) const {
      for (std::uint32_t link = places[particle].first, next; link != none; link = next) {
        next = constraints[link / place_count].next[link % place_count];
        visit(link / place_count, static_cast<int>(link % place_count));
      }
    }
  };
  static void take_over(Model& restored, Model& before);
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static double worst_gap(const Scope&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static bool uses(const Model& model, std::uint32_t particle) { return holds(model, particle); }
  static constexpr bool ties_rigidly = true;
  static bool ties_any(const Model&);
  static void visit_tied(const Model&, std::uint32_t particle, Visit);
  static bool ties_to_world(const Model&, std::uint32_t body);
  /// visit(body): of those at which a joint, surfaces or a coupling hold a particle's body, so that these may overlap, and
  /// perhaps of that itself. Distances do not.
  static void visit_held(const Model&, std::uint32_t particle, Visit);
  /// visit(body): of those to which an exact weld ties a particle's body, `none` for the world.
  static void visit_welded(const Model&, std::uint32_t particle, Visit);
  /// A place in the world at which a joint holds a body, and the directions in which it lets the body leave it.
  struct HeldPlace {
    Vec3 place;
    std::array<Vec3, 2> ways;  ///< unit vectors
    std::size_t freedom = 0;   ///< the number of them
  };
  /// Visits the joints with an origin at a particle that hold it: a joint of directions alone does not, nor do one-sided ones,
  /// distances, couplings and pairs of surfaces.
  static void visit_held_places(const Model&, std::uint32_t particle, FunctionRef<void(const HeldPlace&)> visit);
  static void visit_companions(const Model&, std::uint32_t particle, Visit);
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static void clean_up(Model&, std::span<const std::uint32_t> bodies, std::vector<std::string>& notes);
  static void tell(Model&, Outcome&);
  static model::ChangedSlots* scene_log(Model&);
  static void describe(const SceneView&, SceneChanges&);

  static std::uint32_t add(Model&, const Constraint&);  ///< returns the slot
  /// With its own markers and spans, and the couplings of its coordinates.
  static void destroy(Model&, std::uint32_t constraint);
  static void renew_geometry(Model&, std::uint32_t constraint);

  void build(const IslandMap&, Problem&);
  void leave(const IslandMap&);
  void clear() { joints_.clear(), pinned_.clear(); }
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  void refresh(Model&, const IslandNodes&, bool moved) const;
  bool meets_pinned(const Model& model) const { return pinned_.empty() || are_pinned_met(model); }
  bool keeps_awake(const Model&, const Problem&) const;
  /// A length that a script changes moves rows, as a nail that it moves: see Constraint::way.
  bool prescribes_motion(const Model&, const IslandNodes&) const;
  double rate_jump() const { return rate_jump_; }
  std::string name_of_row(const Model&, solver::ItemKey) const;

 private:
  bool are_pinned_met(const Model&) const;
  void add(const IslandMap&, std::uint32_t joint, Problem&);
  template <class Row>
  void add_row(const IslandMap&, std::uint32_t joint, const Row&, RowUse, Problem&);

  std::vector<std::uint32_t> joints_;
  std::vector<std::uint32_t> pinned_;  // joints with left-out rows, whose nodes are all pinned
  double rate_jump_ = 0;               // of the lengths that run, from the last step to this one, m/s
};

}  // namespace iota::ingredient
