// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/side_table.h"
#include "base/slot_table.h"
#include "laws/field_law.h"
#include "laws/pair_law.h"
#include "model/attributes.h"
#include "model/constraint.h"
#include "model/scene_log.h"

#include <iota/system.h>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace iota::model {

inline constexpr std::uint32_t none = 0xffffffff;
inline constexpr double inactive_share = 0x1p-20;  ///< of its mass that an inactive particle keeps

inline bool is_free(BodyKind kind) { return kind == BodyKind::dynamic || kind == BodyKind::resting; }

// A model of a hundred thousand links lives or dies by the size of these three records: what few items have is in side
// tables beside them.

/// One body's point. Points of different bodies in one ring share position and velocity; each holds its share of mass.
struct Particle {
  std::uint32_t body = none, ring = none;
  std::uint32_t next_in_body = none, previous_in_body = none;
  std::uint32_t next_in_ring = none, previous_in_ring = none;
  std::uint32_t uses = 0;           ///< bonds and closings that need it as an unknown of its own
  std::uint32_t groups = 0;         ///< a bit for each group that it is in
  std::uint32_t attributes = none;  ///< see `Attributes`
  /// In a body's basis: which of its (at most four) basis points it is; else -1 and an affine combination of them, see
  /// `Tie`.
  std::int8_t basis_index = -1;
  std::uint8_t inactive = 0;  ///< its mass is then inactive_share of what it was given
  std::array<std::uint8_t, 2> padding{};
  BodyId part;      ///< the body it was first in: what a body was combined from can still be told apart
  double mass = 1;  ///< kg

  /// A massless place on a body that its massive particles carry.
  bool is_marker() const { return mass == 0; }
};

/// How a particle that is in no basis hangs on its body's.
struct Tie {
  std::array<double, 4> weights{};  ///< of the basis points
  std::array<double, 3>
      multiplier{};  ///< of the rows that tie it to them, where it is an unknown of its own, N; warm start
};

/// Where the lists begin of what refers to a particle: see `Ends` and `Constraint`.
struct References {
  std::uint32_t first_bond = none, first_closing = none, first_cosmetic_bond = none, first_constraint = none;
};

/// What the particles of a ring share: one position, one unknown of the solver. (The thesis: a particle is a ring of
/// points.)
struct Ring {
  std::uint32_t first = none, last = none, count = 0;
  std::uint32_t nailed = 0;
  Vec3 position, velocity;
  Vec3 acceleration;  ///< change of velocity in the last step by its length, m/s^2
};

/// What holds a ring that is nailed or a static or scripted body's.
struct Nail {
  /// Where it is, and where it was at the last step, m; of a ring that a static body holds: where that was put.
  Vec3 position, position_before;
  Vec3 multiplier;  ///< minus its force, N; warm start and reaction
};

/// Forces that were applied to a ring, N.
struct Push {
  Vec3 force;   ///< for the next step only
  Vec3 before;  ///< in the last step
};

/// Two basis points of a body keep their distance.
struct RigidRow {
  double length = 0;      ///< m
  double multiplier = 0;  ///< N; warm start
};

/// A rigid set of particles, held by distance rows between its basis points.
struct Body {
  BodyKind kind = BodyKind::dynamic;
  std::uint8_t rank = 0;  ///< basis points: 1 point, 2 on a line, 3 in a plane, 4 general
  std::uint8_t row_count = 0;
  BodyKind kind_before = BodyKind::dynamic;  ///< of an inactive one
  std::uint32_t first = none, last = none, count = 0;
  std::uint32_t articulate = none;
  std::uint32_t next_in_articulate = none, previous_in_articulate = none;
  std::uint32_t first_inertia = none;  ///< list of inertia pairs
  std::uint32_t first_solid = none;    ///< list of the solids it was given as
  std::uint32_t basis_needs = 0;       ///< particles that were unknowns anyway when the basis was chosen
  std::array<std::uint32_t, 4> basis{none, none, none, none};
  double damping = 0;      ///< 1/s
  RigidRow first_row;      ///< of the basis pairs; see Model::row
  Quaternion orientation;  ///< of the drawn frame
};
using MoreRows = std::array<RigidRow, 5>;  ///< of bodies whose basis is more than two points

/// Which two basis points the k-th rigidity row of a body joins.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> basis_pairs{
    {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Kinetic energy 1/2 inertia |v_p - v_q|^2 beside that of the particles' own masses: with it two points carry the exact
/// inertia of a rod.
struct InertiaPair {
  std::uint32_t body = none, next = none;
  std::uint32_t p = none, q = none;
  double inertia = 0;  ///< kg, may be negative
};

/// The turning of a rod about itself, of which its two points know nothing.
struct RodSpin {
  double momentum =
      0;             ///< about the line from the first to the second particle of its inertia pair, kg m^2/s; constant
  double angle = 0;  ///< turned by since it began, rad
  double drawn = 0;  ///< of that, what the drawn frame shows
};

/// A homogeneous solid that a body, or a part of it, was given as. Four ordinary, equal point masses stand for it, at
///   x_k = center + R diag(half) t_k,   t_k the corners of a cube with an even number of minus signs,
/// whose mass, center and second moments are those of the solid: half_i^2 = second moment i / mass. So a solid is nothing
/// new to the physics; the rest of the record is for drawing and for the body's frame.
struct Solid {
  std::array<std::uint32_t, 4> points{none, none, none, none};
  std::uint32_t body = none, next = none;
  shape::Data shape;
  Vec3 half;             ///< m
  Vec3 center;           ///< of the four, in the shape's frame, m
  Quaternion principal;  ///< turns vectors of the frame of `half` into the shape's frame
};

/// A particle that was absorbed when a hinge became rigid: comes back, hinged, when its part leaves the body again.
struct Twin {
  std::uint32_t particle = none;  ///< that absorbed it
  std::uint32_t padding = 0;
  BodyId part;
  double mass = 0;  ///< its share, kg
};

/// The bodies that hang together through hinges: one independent problem.
struct Articulate {
  std::uint32_t first = none, last = none, count = 0;
  std::uint32_t version = 0;    ///< of its structure
  std::uint32_t jolted = 0;     ///< velocities were assigned and may violate constraints: project before the next step
  std::uint32_t disturbed = 0;  ///< since the last step: wakes it
  double slow_time = 0;         ///< s; of an island, at the articulate of its first body
  std::uint64_t standing_steps = 0;  ///< since a conflict was last tried to be closed
  double standing_gap = 0;           ///< that was left then, relative; 0: no conflict
};

/// What joins two particles is in a list of each of them, so that looking after one particle's uses costs what it has.
/// A link is slot * 2 + end: which end of the next item is at this particle.
struct Ends {
  std::uint32_t p = none, q = none;
  std::array<std::uint32_t, 2> next{none, none}, previous{none, none};
};

enum class LawKind : std::uint32_t {
  listed,      ///< of laws::PairLaws
  expression,  ///< its text
  scripted,    ///< each bond has a function of its own
  radial,      ///< compiled code for one bond
  batch,       ///< a function for all bonds at once
};

/// A law of force that bonds share. The first ones, in fixed slots, are the predefined ones and `scripted`.
struct Law {
  LawKind kind = LawKind::listed;
  std::uint32_t number = 0;  ///< of a listed law
  std::uint32_t parameter_count = 0;
  std::uint32_t uses = 0;      ///< bonds that have it
  std::uint64_t function = 0;  ///< key of the compiled code, which lives outside the tables
  std::array<double, laws::max_parameters> standard{};
  std::array<std::array<char, 24>, laws::max_parameters> parameters{};  ///< names
  std::array<char, 32> name{};
  std::array<char, 1000> text{};

  bool has_derivative() const { return kind == LawKind::listed || kind == LawKind::expression; }
};
inline constexpr std::uint32_t spring_law = 0, drag_law = 1, scripted_law = laws::pair_law_count;

struct Bond : Ends {
  std::uint32_t law = spring_law;
  std::uint8_t active = 1;
  std::uint8_t implicit = 1;
  std::uint8_t muted = 0;   ///< one of its ends does not act
  std::uint8_t broken = 0;  ///< by more than `break_force`
  std::array<double, laws::max_parameters> parameters{};
  double break_force = std::numeric_limits<double>::infinity();  ///< N
  Vec3 held_force;           ///< on p in the last step, N; of bonds that are not implicit
  std::uint64_t script = 0;  ///< key of its own function, which lives outside the tables

  /// Whether it is solved implicitly, so that its two ends belong to one problem.
  bool ties() const { return acts() && implicit; }
  bool acts() const { return active && !muted; }
};

/// A named set of particles; its slot is its bit in Particle::groups.
struct Group {
  std::array<char, 32> name{};
};

enum class FieldKind : std::uint32_t { listed, expression, function };

/// A force on each particle by itself.
struct Field {
  FieldKind kind = FieldKind::listed;
  std::uint32_t number = 0;    ///< of a listed one
  std::uint32_t group = none;  ///< none: all particles
  std::uint32_t parameter_count = 0;
  std::uint8_t active = 1, replaces_gravity = 0;
  std::array<std::uint8_t, 6> padding{};
  std::uint64_t function = 0;  ///< key of the function, which lives outside the tables
  std::array<double, laws::max_field_parameters> parameters{};
  std::array<std::array<char, 24>, laws::max_field_parameters> names{};
  std::array<char, 32> name{};
  std::array<char, 1000> text{};
};

/// A force between all pairs of a group that are nearer than a cut-off.
struct Pairs {
  std::uint32_t law = none;
  std::uint32_t group = none;  ///< none: all particles
  std::uint8_t active = 1;
  std::array<std::uint8_t, 7> padding{};
  double cutoff = 1;  ///< m
  std::array<double, laws::max_parameters> parameters{};
};

struct CosmeticBond : Ends {};

struct Grip {
  std::uint32_t body = none, count = 0;
  std::array<std::uint32_t, 4> points{};
  std::array<double, 4> weights{};
  Vec3 target;
  std::uint32_t client = 0, hold = 0;
  double frequency = 0, max_acceleration = 0;
  Vec3 force;  ///< in the last step, N
};

/// Two particles on their way to each other.
struct Closing : Ends {
  double distance = 0;               ///< at the start, m
  double duration = 0, elapsed = 0;  ///< s
  double multiplier = 0;
};

/// All of a system that is saved: plain tables under stable ids. It knows structure and book-keeping, not time stepping.
class Model {
 public:
  Model();

  SlotTable<Particle, ParticleId> particles;
  SideTable<Tie> ties;               ///< of particles in no basis
  SideTable<References> references;  ///< of particles
  SideTable<double> fuses;           ///< how much the hinge or nail of a particle bears, N
  SlotTable<Ring, Id<Ring>> rings;
  SideTable<Nail> nails;   ///< of rings
  SideTable<Push> pushes;  ///< of rings
  SlotTable<Body, BodyId> bodies;
  SideTable<MoreRows> more_rows;  ///< of bodies
  SideTable<RodSpin> spins;       ///< of bodies that are rods
  SlotTable<InertiaPair, Id<InertiaPair>> inertia_pairs;
  SlotTable<Solid, Id<Solid>> solids;
  SlotTable<Twin, Id<Twin>> twins;
  SlotTable<Attributes, Id<Attributes>> attributes;
  SlotTable<Emitter, EmitterId> emitters;
  SlotTable<Articulate, Id<Articulate>> articulates;
  SlotTable<Law, LawId> laws;
  SlotTable<Group, GroupId> groups;
  SlotTable<Field, FieldId> fields;
  SlotTable<Pairs, PairsId> pairs;
  SlotTable<Bond, BondId> bonds;
  SlotTable<CosmeticBond, CosmeticBondId> cosmetic_bonds;
  SlotTable<Grip, GripId> grips;
  SlotTable<Closing, Id<Closing>> closings;
  SlotTable<Constraint, ConstraintId> constraints;
  std::vector<Vec3> curve_points;  ///< of paths, m
  /// Of function surfaces, by key; not saved.
  std::map<std::uint64_t, SurfaceFunction> surface_functions;

  Vec3 gravity{0, -9.81, 0};
  IntegrationMode mode = IntegrationMode::energy_keeping;
  /// Whether forces are those at the end of a step (backward Euler), not in its middle.
  bool steps_to_end_point() const { return mode == IntegrationMode::plausible || mode == IntegrationMode::robust; }
  double damping = 0;
  /// Name of who solves the equations of steps, ended by zeros; empty: the built-in one.
  std::array<char, 32> solver{};
  double rest_after = 0, rest_speed = 0;  ///< s, m/s; see RestOptions
  double time = 0, last_dt = 0;
  std::uint64_t step = 0;
  std::uint32_t structure_version = 1;
  std::uint32_t spark_changes = 0;  ///< how often `structure_version` has risen for births and deaths of sparks
  double dissipated = 0, external_work = 0, edit_energy = 0;
  double booked_energy = 0;        ///< kinetic and potential energy when edits were last booked, J
  std::uint64_t has_edits = 0;     ///< since then
  double held_energy = 0;          ///< of forces that are held, which `energy` leaves out, when it was last booked, J
  std::vector<std::string> notes;  ///< of edits that have no report, for the next step's; not saved
  SceneLog scene;                  ///< what viewers have to be told; not saved

  /// @name Membership: cheap links only, no physics
  ///@{
  std::uint32_t make_particle(std::uint32_t body, const Vec3& position, double mass, const Vec3& velocity);
  std::uint32_t make_body(BodyKind kind, double damping);  ///< in an articulate of its own
  void remove_particle(std::uint32_t particle);            ///< from body and ring; both must be tidied by the caller
  void add_to_body(std::uint32_t particle, std::uint32_t body);
  void take_from_body(std::uint32_t particle);
  void add_to_ring(std::uint32_t particle, std::uint32_t ring);
  void take_from_ring(std::uint32_t particle);  ///< an empty ring is destroyed
  void add_to_articulate(std::uint32_t body, std::uint32_t articulate);
  void take_from_articulate(std::uint32_t body);                       ///< an empty articulate is destroyed
  void remove_body(std::uint32_t body);                                ///< must have no particles left
  void remove_inertia_of(std::uint32_t body, std::uint32_t particle);  ///< pairs that name the particle (none: all)
  void remove_solids_of(std::uint32_t body, std::uint32_t particle);   ///< solids that it stands for (none: all)
  ///@}

  /// @name Articulates (Algorithms 1 and 2 of the thesis, without the recursion)
  ///@{
  void join_articulates(std::uint32_t a, std::uint32_t b);  ///< the smaller is relabeled
  /// After a cut between two bodies of one articulate: searches from both at once and, when the smaller side is
  /// exhausted without meeting the other, gives it an articulate of its own. O(smaller side). True if split.
  bool split_articulate(std::uint32_t body_a, std::uint32_t body_b);
  void touch(std::uint32_t articulate) { touch(articulate, anything); }
  void touch_body(std::uint32_t body) { scene.bodies.note(body), touch(bodies[body].articulate); }
  void touch_particle(std::uint32_t particle) { touch_body(particles[particle].body); }
  /// Notes a change that concerns one body and the bodies at its rings only: a problem that holds them can follow.
  void touch_locally(std::uint32_t body);
  /// The same for the bodies at a ring, which are about to be hinged otherwise or have been. `split_from`: the ring where a
  /// new ring's particles were before.
  void touch_ring(std::uint32_t ring, std::uint32_t split_from = none);
  bool is_touched() const { return !touched_.empty(); }
  /// Bodies and rings that have changed; some are listed more than once, some are gone.
  struct LocalChange {
    struct ChangedRing {
      std::uint32_t ring, split_from;
    };
    std::vector<std::uint32_t> bodies;
    std::vector<ChangedRing> rings;
  };
  /// What has changed since the last call.
  struct Touched {
    std::vector<std::uint32_t> articulates;  ///< slots, destroyed ones too, each once
    std::vector<std::uint8_t> only_locally;  ///< of each of those: nothing changed but membership and what `local` has
    LocalChange local;
  };
  void take_touched(Touched&);
  enum class Ties { all, constraints };
  /// The bodies of the articulates of `bodies` and of all that constraints and implicit bonds tie to those: what one
  /// problem solves. In order of discovery.
  std::vector<std::uint32_t> tied_bodies(std::span<const std::uint32_t> bodies, Ties ties = Ties::all) const;
  bool is_tied_to_world(std::uint32_t body) const;  ///< by an active constraint
  ///@}

  /// @name What joins two particles. Adding and removing keeps the particles' lists and touches the articulates.
  ///@{
  std::uint32_t add_bond(const Bond&);
  std::uint32_t add_closing(const Closing&);
  std::uint32_t add_cosmetic_bond(const CosmeticBond&);
  void remove_bond(std::uint32_t bond);
  void remove_closing(std::uint32_t closing);
  void remove_cosmetic_bond(std::uint32_t bond);
  std::uint64_t bonds_revision = 0;  ///< rises when a bond is added, removed, moved or switched; not saved
  std::uint32_t add_constraint(const Constraint&);
  void remove_constraint(std::uint32_t constraint);     ///< its markers stay
  void set_fuse(std::uint32_t particle, double force);  ///< infinite: none
  const ConstraintGeometry& geometry(std::uint32_t constraint) const { return geometries_[constraint]; }
  void make_geometries();  ///< anew, after a restore
  void make_geometry_anew(std::uint32_t constraint) {
    geometries_[constraint] = make_geometry(*this, constraints[constraint]);
  }
  /// Bonds, closings and constraints of q become p's; those that would join p to itself are removed.
  void redirect_uses(std::uint32_t q, std::uint32_t p);
  ///@}

  /// @name Laws
  ///@{
  std::uint32_t make_law(const Law&);  ///< throws expression::ExpressionError for a text that is no law
  /// Ready for use; only laws with a derivative have one.
  const laws::PairLaw& compiled(std::uint32_t law) const { return *compiled_laws_[law]; }
  std::uint32_t make_field(const Field&);  ///< throws expression::ExpressionError for a text that is no field
  const laws::FieldLaw& compiled_field(std::uint32_t field) const { return *compiled_fields_[field]; }
  void compile_laws();    ///< anew, after a restore
  void compile_fields();  ///< anew, after a restore
  /// What pulls on all masses: gravity, unless an active field replaces it.
  Vec3 acting_gravity() const;
  std::uint64_t members_revision = 0;  ///< rises when a group changes; not saved
  ///@}

  /// Drops inertia pairs of a body (it is then its point masses) that could leave its mass matrix indefinite.
  void keep_inertia_positive(std::uint32_t body);

  /// The k-th rigidity row of a body, between the k-th of `basis_pairs`.
  RigidRow& row(std::uint32_t body, int k) {
    return k == 0 ? bodies[body].first_row : more_rows.at(body)[static_cast<std::size_t>(k - 1)];
  }
  const RigidRow& row(std::uint32_t body, int k) const {
    return k == 0 ? bodies[body].first_row : more_rows.at(body)[static_cast<std::size_t>(k - 1)];
  }
  /// Longest of its rigid distances, m; 0: a point.
  double extent(std::uint32_t body) const;
  /// Of the basis points in a particle's place.
  std::array<double, 4> weights(std::uint32_t particle) const;

  /// Chooses a body's basis from where its particles are now, and takes its rigid distances.
  void rebuild_basis(std::uint32_t body);
  /// A body made of solids has more points than a basis needs: makes those its basis that are unknowns anyway (hinged,
  /// nailed, bonded), where there are new ones and they span it well. Saves unknowns and ties.
  void prefer_unknowns(std::uint32_t body);
  /// A new massless particle; the body's basis stays as it is.
  std::uint32_t make_marker(std::uint32_t body, const Vec3& position);
  /// Moment of inertia of a rod about itself, kg m^2; 0 of a body that is no rod: two points with an inertia pair.
  double axial_inertia(std::uint32_t body) const;
  Vec3 rod_axis(std::uint32_t body) const;                     ///< of a rod, unit vector
  Vec3 spin_momentum(std::uint32_t body) const;                ///< of a rod's turning about itself, kg m^2/s
  void set_spin(std::uint32_t body, double angular_velocity);  ///< of a rod about itself, rad/s

  /// Of the massive particle nearest to a place.
  BodyId part_at(std::uint32_t body, const Vec3& place) const;
  /// Whether the body's massive particles span a place: only there can they carry a marker.
  bool spans(std::uint32_t body, const Vec3& place) const;

  /// Whether a particle is an unknown of its own in the solver (basis points always are).
  bool is_unknown(const Particle& p) const { return p.basis_index >= 0 || is_needed(p); }
  /// Whether something holds on to it: another body, a nail, a bond.
  bool is_needed(const Particle& p) const {
    const Ring& r = rings[p.ring];
    return r.count > 1 || r.nailed || p.uses > 0;
  }

  /// Whether a particle takes part: not where it, or its body, was switched off.
  bool acts(std::uint32_t particle) const {
    const Particle& p = particles[particle];
    return !p.inactive && bodies[p.body].kind != BodyKind::inactive;
  }
  void set_bond_active(std::uint32_t bond, bool active);  ///< true repairs a broken one
  void mute_bonds_of(std::uint32_t particle);             ///< after it has changed whether it acts

  /// Held in place by a nail or by a static or scripted body in its ring.
  bool is_pinned(std::uint32_t ring) const;

  /// Whether a particle is where and as fast as its body's basis says. Not so only in a conflict; it then matters when the
  /// particle ceases to be an unknown of its own.
  bool follows_basis(std::uint32_t particle) const;
  /// Position and velocity that its body's basis gives a particle.
  std::pair<Vec3, Vec3> carried(std::uint32_t particle) const;

  Vec3 position(std::uint32_t particle) const { return rings[particles[particle].ring].position; }
  Vec3 velocity(std::uint32_t particle) const { return rings[particles[particle].ring].velocity; }
  double body_mass(std::uint32_t body) const;
  double ring_mass(std::uint32_t ring) const;
  Vec3 center_of_mass(std::uint32_t body) const;

  template <class Visit>
  void for_each_particle_of(std::uint32_t body, Visit visit) const {
    for (std::uint32_t p = bodies[body].first, next; p != none; p = next) next = particles[p].next_in_body, visit(p);
  }
  template <class Visit>
  void for_each_in_ring(std::uint32_t ring, Visit visit) const {
    for (std::uint32_t p = rings[ring].first, next; p != none; p = next) next = particles[p].next_in_ring, visit(p);
  }
  template <class Visit>
  void for_each_body_of(std::uint32_t articulate, Visit visit) const {
    for (std::uint32_t b = articulates[articulate].first, next; b != none; b = next)
      next = bodies[b].next_in_articulate, visit(b);
  }
  /// visit(slot of the bond); it may remove that bond.
  template <class Visit>
  void for_each_bond_of(std::uint32_t particle, Visit visit) const {
    visit_uses(bonds, references[particle].first_bond, visit);
  }
  template <class Visit>
  void for_each_closing_of(std::uint32_t particle, Visit visit) const {
    visit_uses(closings, references[particle].first_closing, visit);
  }
  template <class Visit>
  void for_each_cosmetic_bond_of(std::uint32_t particle, Visit visit) const {
    visit_uses(cosmetic_bonds, references[particle].first_cosmetic_bond, visit);
  }
  /// visit(slot of the constraint, place): once for each place that the particle is at.
  template <class Visit>
  void for_each_constraint_of(std::uint32_t particle, Visit visit) const {
    for (std::uint32_t link = references[particle].first_constraint, next; link != none; link = next) {
      next = constraints[link / place_count].next[link % place_count];
      visit(link / place_count, static_cast<int>(link % place_count));
    }
  }
  /// visit(body): the bodies that active constraints tie to a particle's.
  template <class Visit>
  void for_each_body_tied_to(std::uint32_t particle, Visit visit) const {
    for_each_constraint_of(particle, [&](std::uint32_t c, int place) {
      if (!constraints[c].active || (place != a_origin && place != b_origin)) return;
      const std::uint32_t other = body_of_side(*this, constraints[c], place == a_origin ? 1 : 0);
      if (other != none) visit(other);
    });
  }
  template <class Visit>
  void for_each_inertia_of(std::uint32_t body, Visit visit) const {
    for (std::uint32_t i = bodies[body].first_inertia; i != none; i = inertia_pairs[i].next) visit(i);
  }

  template <class Visit>
  void for_each_solid_of(std::uint32_t body, Visit visit) const {
    for (std::uint32_t s = bodies[body].first_solid; s != none; s = solids[s].next) visit(s);
  }

  /// Remembers what a retired id became.
  void record_survivor(ParticleId retired, ParticleId survivor);
  void record_survivor(BodyId retired, BodyId survivor);
  std::optional<ParticleId> survivor_of(ParticleId) const;
  /// An emitter's particle that nothing ties: it comes and goes, and no viewer can hold it.
  bool is_spark(std::uint32_t particle) const;
  std::optional<BodyId> survivor_of(BodyId) const;

  std::uint64_t hash() const;

  /// Settings, points, bodies and articulates with what refers to them. The tables of ingredients are archived by these:
  /// see ingredient::archive.
  template <class Archive>
  void archive(Archive& ar);

 private:
  void compile_law(std::uint32_t law);
  void compile_field(std::uint32_t field);
  std::vector<std::shared_ptr<const laws::PairLaw>> compiled_laws_;  // by slot; not saved, made from the table
  std::vector<std::shared_ptr<const laws::FieldLaw>> compiled_fields_;

  template <class Table, class Visit>
  static void visit_uses(const Table& items, std::uint32_t link, Visit visit) {
    for (std::uint32_t next; link != none; link = next) next = items[link / 2].next[link % 2], visit(link / 2);
  }
  /// Bodies marked in the search at hand: those with the current mark. Not saved.
  struct Marks {
    std::vector<std::uint32_t> of;
    std::uint32_t current = 0;
  };
  Marks body_marks_;
  std::array<std::vector<std::uint32_t>, 2> floods_;  ///< of split_articulate
  enum Touch : std::uint8_t { untouched, locally, anything };
  void touch(std::uint32_t articulate, Touch);
  void leave_articulate(std::uint32_t body);
  void enter_articulate(std::uint32_t body, std::uint32_t articulate);
  std::vector<std::uint32_t> touched_;
  LocalChange local_change_;
  std::vector<Touch> touch_of_;  ///< of each articulate

  /// The last 65 536 retirements, oldest forgotten first.
  template <class IdType>
  struct Survivors {
    std::map<IdType, IdType> became;
    std::deque<IdType> in_order;
    void record(IdType retired, IdType survivor);
    std::optional<IdType> find(IdType id) const;
    template <class Archive>
    void archive(Archive& ar);
  };
  std::vector<ConstraintGeometry> geometries_;  // by slot of the constraint; not saved
  void link_place(std::uint32_t constraint, std::uint32_t place);
  void unlink_place(std::uint32_t constraint, std::uint32_t place);
  Survivors<ParticleId> particle_survivors_;
  Survivors<BodyId> body_survivors_;
};

template <class IdType>
void Model::Survivors<IdType>::record(IdType retired, IdType survivor) {
  constexpr std::size_t remembered = 65536;
  became[retired] = survivor;
  in_order.push_back(retired);
  if (in_order.size() > remembered) {
    became.erase(in_order.front());
    in_order.pop_front();
  }
}

template <class IdType>
std::optional<IdType> Model::Survivors<IdType>::find(IdType id) const {
  const auto found = became.find(id);
  if (found == became.end()) return std::nullopt;
  return found->second;
}

template <class IdType>
template <class Archive>
void Model::Survivors<IdType>::archive(Archive& ar) {
  struct Pair {
    IdType retired, survivor;
  };
  std::vector<Pair> pairs;
  for (const IdType id : in_order) pairs.push_back({id, became.at(id)});
  ar.vector(pairs);
  became.clear(), in_order.clear();
  for (const auto& [retired, survivor] : pairs) record(retired, survivor);
}

template <class Archive>
void Model::archive(Archive& ar) {
  particles.archive(ar), rings.archive(ar), bodies.archive(ar), solids.archive(ar), twins.archive(ar);
  articulates.archive(ar), groups.archive(ar), cosmetic_bonds.archive(ar);
  references.archive(ar, particles.slot_count()), fuses.archive(ar, particles.slot_count());
  ar.value(gravity), ar.value(mode), ar.value(damping), ar.value(solver), ar.value(rest_after), ar.value(rest_speed);
  ar.value(time), ar.value(last_dt), ar.value(step), ar.value(structure_version), ar.value(spark_changes);
  ar.value(dissipated), ar.value(external_work), ar.value(edit_energy), ar.value(booked_energy), ar.value(has_edits);
  ar.value(held_energy);
  particle_survivors_.archive(ar), body_survivors_.archive(ar);
}

}  // namespace iota::model
