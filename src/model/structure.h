// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/function_ref.h"
#include "base/side_table.h"
#include "base/slot_table.h"
#include "model/attributes.h"
#include "model/corrections.h"
#include "model/end_table.h"
#include "model/meshes.h"
#include "model/scene_log.h"
#include "shape/data.h"

#include <iota/ids.h>
#include <iota/kinds.h>
#include <iota/materials.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace iota {
struct RestructureReport;
}

namespace iota::model {

/// A structure with the tables of all ingredients: see ingredient/model.h.
class Model;

inline constexpr double inactive_share = 0x1p-20;  ///< of its mass that an inactive particle keeps

inline bool is_free(BodyKind kind) { return kind == BodyKind::dynamic || kind == BodyKind::resting; }

// Memory and speed at a hundred thousand links depend on the size of these three records: rare data are in side tables
// beside them.

/// One body's point. Points of different bodies in one ring share position and velocity; each has its share of mass.
struct Particle {
  std::uint32_t body = none, ring = none;
  std::uint32_t next_in_body = none, previous_in_body = none;
  std::uint32_t next_in_ring = none, previous_in_ring = none;
  std::uint32_t uses = 0;           ///< number of items (bonds, closings) that need it as an unknown
  std::uint32_t groups = 0;         ///< a bit for each of its groups
  std::uint32_t attributes = none;  ///< see `Attributes`
  /// Its index in the body's basis of at most four points; -1 for an affine combination of these, see
  /// `AffineParticle`.
  std::int8_t basis_index = -1;
  std::uint8_t inactive = 0;  ///< its mass is then inactive_share of the assigned one
  std::array<std::uint8_t, 2> padding{};
  BodyId part;      ///< its first body: identifies the parts of a combined body
  double mass = 1;  ///< kg

  /// A massless place on a body, an affine combination of its massive particles.
  bool is_marker() const { return mass == 0; }
};

/// The affine combination of a particle outside of the basis.
struct AffineParticle {
  std::array<double, 4> weights{};  ///< of the basis points
  std::array<double, 3>
      multiplier{};  ///< of the rows that keep it at its place, if it is an unknown of its own, N; warm start
};

/// The shared state of the particles of a ring: one position, one unknown of the solver. (The thesis: a particle is a
/// ring of points.)
struct Ring {
  std::uint32_t first = none, last = none, count = 0;
  std::uint16_t nailed = 0;
  /// Whether forces and multipliers of the last step are those at its end, and not means: see LastStep.
  std::uint16_t is_instant = 0;
  Vec3 position, velocity;
  Vec3 acceleration;  ///< change of velocity in the last step without the correction, divided by h, m/s^2
};

/// The distance of two basis points of a body.
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
  std::uint32_t first_solid = none;    ///< list of its solids
  std::uint32_t basis_needs = 0;       ///< number of particles that were unknowns when the basis was chosen
  std::array<std::uint32_t, 4> basis{none, none, none, none};
  RigidRow first_row;      ///< of the basis pairs; see Structure::row
  Quaternion orientation;  ///< of the drawn frame
};
using MoreRows = std::array<RigidRow, 5>;  ///< of bodies with more than two basis points

/// The two basis points of the k-th rigidity row of a body.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> basis_pairs{
    {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Kinetic energy 1/2 inertia |v_p - v_q|^2 in addition to that of the particles' masses: with it two points have the
/// exact inertia of a rod.
struct InertiaPair {
  std::uint32_t body = none, next = none;
  std::uint32_t p = none, q = none;
  double inertia = 0;  ///< kg, may be negative
};

/// A homogeneous solid of a body or a part of it. Four ordinary, equal point masses represent it, at
///   x_k = center + R diag(half) t_k,   t_k the corners of a cube with an even number of minus signs,
/// whose mass, center and second moments are those of the solid: half_i^2 = second moment i / mass. So a solid needs no
/// other physics; the rest of the record is for drawing and for the body's frame.
struct Solid {
  std::array<std::uint32_t, 4> points{none, none, none, none};
  std::uint32_t body = none, next = none;
  shape::Data shape;
  Vec3 half;             ///< m
  Vec3 center;           ///< of the four, in the shape's frame, m
  Quaternion principal;  ///< turns vectors of the frame of `half` into the shape's frame
};

/// The place of an obstacle: a static body given by shape that has no particles, so that nothing can be tied to it. Its
/// solid has no points. Energies, extents and all that particles have know nothing of it.
struct Obstacle {
  Vec3 position;  ///< of its shape's origin, world, m
  Quaternion orientation;
};

/// The place of a body when its contacts were found anew: until it leaves it they are those of the step before.
struct Stand {
  double reach = 0;            ///< of its outline then, m
  std::array<Vec3, 3> places;  ///< of the first points of its basis
};

/// A particle that was absorbed when a hinge became rigid: restored, hinged, when its part leaves the body again.
struct Twin {
  std::uint32_t particle = none;  ///< that absorbed it
  std::uint32_t next = none;      ///< of the same particle
  BodyId part;
  double mass = 0;  ///< its share, kg
};

/// Bodies connected by hinges: one independent problem.
struct Articulate {
  std::uint32_t first = none, last = none, count = 0;
  std::uint32_t version = 0;  ///< of its structure
  // Both are set by Structure::wake and mark_velocities, which list it for the next step.
  std::uint32_t velocity_dirty =
      0;                      ///< velocities were assigned and may violate constraints: project before the next step
  std::uint32_t to_wake = 0;  ///< it was changed since the last step
  double slow_time = 0;       ///< s; of an island, at the articulate of its body with the lowest slot
  std::uint64_t standing_steps = 0;  ///< since the last attempt to close a conflict
  double standing_gap = 0;           ///< remaining gap then, relative; 0: no conflict
  std::uint64_t unsolved_steps = 0;  ///< in a row, of which no part was solved
  /// Its part of the multiplications by which steps have gone beyond StepBudget::contacts: the next ones have so many fewer.
  double owed_work = 0;

  /// Ends the back-off: after a change, a conflict or a step without a solution is tried in full again.
  void try_again() { standing_gap = 0, unsolved_steps = 0; }
};

/// A named set of particles; its slot is its bit in Particle::groups.
struct Group {
  std::array<char, 32> name{};
};

/// Particles, rings, bodies and articulates: memberships, positions, and their changes. It does not know the
/// ingredients that act on them, but notifies these of changes.
class Structure {
 public:
  SlotTable<Particle, ParticleId> particles;
  SideTable<AffineParticle> affine;  ///< of particles outside of a basis
  SideTable<double> fuses;           ///< breaking load of the hinge or nail of a particle, N
  SlotTable<Ring, Id<"ring">> rings;
  SlotTable<Body, BodyId> bodies;
  SideTable<MoreRows> more_rows;        ///< of bodies
  SideTable<double> body_damping;       ///< of bodies, 1/s
  SideTable<Obstacle> obstacles;        ///< of bodies
  SideTable<double> radii;              ///< of bodies that have one of their own, m; see outline.h
  double usual_radius = 0;              ///< of all other bodies, m; 0: not chosen yet
  SideTable<std::uint32_t> colors;      ///< of bodies that have one instead of that of their material, 0xRRGGBB
  SideTable<Material> materials;        ///< of bodies that have one of their own ...
  Material usual_material;              ///< ... and of all others,
  std::uint8_t has_usual_material = 0;  ///< if there is one
  SideTable<Stand> stands;              ///< of bodies near others
  Corrections corrections;              ///< of rings
  SlotTable<InertiaPair, Id<"inertia pair">> inertia_pairs;
  SlotTable<Solid, Id<"solid">> solids;
  Meshes meshes;  ///< of solids
  /// The rings of islands in their orders of elimination, one after the other, the end of each and its usual work: when a
  /// snapshot is taken, until the islands are built from it.
  struct {
    std::vector<std::uint32_t> rings, ends;
    std::vector<double> work;
    template <class Archive>
    void archive(Archive& ar) {
      ar.vector(rings), ar.vector(ends), ar.vector(work);
    }
  } eliminations;
  SlotTable<Twin, Id<"twin">> twins;
  SideTable<std::uint32_t> first_twin;  ///< of particles
  SlotTable<Attributes, Id<"attributes">> attributes;
  SlotTable<Articulate, Id<"articulate">> articulates;
  SlotTable<Group, GroupId> groups;
  std::uint32_t structure_version = 1;
  std::uint32_t spark_changes = 0;     ///< rises of `structure_version` by births and deaths of sparks
  std::uint64_t members_revision = 0;  ///< rises when a group or the set of active particles changes; not saved
  std::uint64_t edits = 0;             ///< rises with each command that may move something; not saved
  std::vector<std::string> notes;      ///< of edits that have no report, for the next step's; not saved
  SceneLog scene;                      ///< log for viewers; not saved
  ChangedSlots changed_outlines;       ///< bodies whose outline may be another one; not saved
  ChangedSlots changed_freezes;        ///< bodies that were frozen, or are not any more; not saved
  /// The usual radius as it would be chosen now, as of some edits; not saved. See outline.h.
  struct ExpectedRadius {
    std::uint64_t edits = 0;
    std::uint32_t version = 0;
    double value = 0;
  };
  ExpectedRadius expected_radius;

  /// @name Membership: cheap links only, no physics
  ///@{
  std::uint32_t make_particle(std::uint32_t body, const Vec3& position, double mass, const Vec3& velocity);
  std::uint32_t make_body(BodyKind kind, double damping);  ///< in a new articulate
  void remove_particle(std::uint32_t particle);            ///< from body and ring; the caller must update both
  void add_to_body(std::uint32_t particle, std::uint32_t body);
  void take_from_body(std::uint32_t particle);
  void add_to_ring(std::uint32_t particle, std::uint32_t ring);
  void take_from_ring(std::uint32_t particle);  ///< an empty ring is destroyed
  void stop_ring(std::uint32_t ring);           ///< its velocity, and the change of that in the last step, become zero
  void add_to_articulate(std::uint32_t body, std::uint32_t articulate);
  void take_from_articulate(std::uint32_t body);                       ///< an empty articulate is destroyed
  void remove_body(std::uint32_t body);                                ///< must have no particles
  void remove_inertia_of(std::uint32_t body, std::uint32_t particle);  ///< pairs with the particle (none: all)
  void remove_solids_of(std::uint32_t body, std::uint32_t particle);   ///< solids with the particle (none: all)
  ///@}

  /// Without obstacles, each of which is in one of its own.
  std::uint32_t articulate_count() const { return articulates.size() - obstacles.size(); }

  /// @name Articulates (Algorithms 1 and 2 of the thesis, without the recursion)
  ///@{
  void join_articulates(std::uint32_t a, std::uint32_t b);  ///< the smaller is relabeled
  /// After a cut between two bodies of one articulate: searches from both at once and, when the smaller side is
  /// exhausted without meeting the other, gives it an articulate of its own. O(smaller side). True if split.
  bool split_articulate(std::uint32_t body_a, std::uint32_t body_b);
  /// Its island is awake in the next step.
  void wake(std::uint32_t articulate) {
    Articulate& a = articulates[articulate];
    if (!a.to_wake && !a.velocity_dirty) flagged_.push_back(articulate);
    a.to_wake = 1;
  }
  void wake_all();
  /// The same, and its velocities are projected at the begin of the next step.
  void mark_velocities(std::uint32_t articulate) { wake(articulate), articulates[articulate].velocity_dirty = 1; }
  /// Moves the articulates of the last two to `taken`, in the order of slots; their flags remain.
  void take_flagged(std::vector<std::uint32_t>& taken);
  /// Articulates that were flagged since then, as they come; some may be destroyed, or listed twice.
  std::span<const std::uint32_t> flagged() const { return flagged_; }
  /// Lists them anew by their flags, which are saved; the list is not.
  void list_flagged();
  void mark(std::uint32_t articulate) { mark(articulate, anything); }
  /// A body was created or changed: viewers and outlines are told, and its contacts are found anew.
  void note_body(std::uint32_t body, bool is_new = false) {
    scene.bodies.note(body, is_new), changed_outlines.note(body, is_new), stands.erase(body);
  }
  void mark_body(std::uint32_t body) { note_body(body), mark(bodies[body].articulate); }
  void mark_particle(std::uint32_t particle) { mark_body(particles[particle].body); }
  /// Marks a change of only one body and the bodies at its rings: their problem can follow.
  void mark_locally(std::uint32_t body);
  /// The same for transient rows that viewers do not see. wakes: false if they tell nothing of how fast it is.
  void mark_rows(std::uint32_t body, bool wakes = true);
  /// Marks that a pull on a body was added or removed that couples only points that are coupled anyway: the body's
  /// problem keeps its structure.
  void mark_pull(std::uint32_t body);
  /// The same for the bodies at a ring, before or after a change of their hinges. `split_from`: the former ring of a
  /// new ring's particles.
  void mark_ring(std::uint32_t ring, std::uint32_t split_from = none);
  bool is_marked() const { return !marked_.empty(); }
  /// Changed bodies and rings; some are listed more than once, some were destroyed.
  struct LocalChange {
    struct ChangedRing {
      std::uint32_t ring, split_from;
    };
    std::vector<std::uint32_t> bodies;
    std::vector<ChangedRing> rings;
    std::vector<std::uint32_t> pulled;  ///< bodies: see mark_pull
    std::vector<std::uint32_t> reborn;  ///< new bodies in slots of destroyed ones
  };
  /// The changes since the last call.
  struct Marked {
    std::vector<std::uint32_t> articulates;  ///< slots, destroyed ones too, each once
    std::vector<std::uint8_t> only_locally;  ///< of each of those: only membership and `local` changed
    LocalChange local;
  };
  void take_marked(Marked&);
  ///@}

  void set_fuse(std::uint32_t particle, double force);      ///< infinite: none
  void set_damping(std::uint32_t body, double per_second);  ///< 0: none

  /// Drops inertia pairs of a body that could make its mass matrix indefinite; its point masses remain.
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
  /// The weights of the basis points whose sum is the particle's place.
  std::array<double, 4> weights(std::uint32_t particle) const;

  /// Chooses a body's basis from the present places of its particles, and sets its rigid distances.
  void rebuild_basis(std::uint32_t body);
  /// Before it is solved: a body that is tiny beside what is hinged to it becomes a point. For a body made of solids, which has
  /// more points than a basis needs, chooses those that are unknowns anyway (hinged, nailed, bonded), if there are new ones
  /// and they span it well. Saves unknowns and rows.
  void prefer_unknowns(std::uint32_t body);
  /// A new massless particle; the body's basis does not change.
  std::uint32_t make_marker(std::uint32_t body, const Vec3& position);
  /// Moment of inertia of a rod (two points with an inertia pair) about its axis, kg m^2; 0 for other bodies.
  double axial_inertia(std::uint32_t body) const;
  Vec3 rod_axis(std::uint32_t body) const;  ///< of a rod, unit vector

  /// The part that the massive particle nearest to a place belongs to.
  BodyId part_at(std::uint32_t body, const Vec3& place) const;
  /// Whether the body's massive particles span a place, which a marker needs.
  bool spans(std::uint32_t body, const Vec3& place) const;

  /// Whether a particle is an unknown of its own in the solver (basis points always are).
  bool is_unknown(const Particle& p) const { return p.basis_index >= 0 || is_needed(p); }
  /// Whether something is attached to it: another body, a nail, a bond.
  bool is_needed(const Particle& p) const {
    const Ring& r = rings[p.ring];
    return r.count > 1 || r.nailed || p.uses > 0;
  }

  /// With which it touches others; null: nothing.
  const Material* material(std::uint32_t body) const {
    const Material* const own = materials.find(body);
    const Material* const material = !own && has_usual_material ? &usual_material : own;
    return material && material->touches != Touches::nothing ? material : nullptr;
  }

  /// Whether it has an outline: an obstacle or a body with particles, but no spark.
  bool is_visible(std::uint32_t body) const {
    return obstacles.has(body) || (bodies[body].count > 0 && !is_spark(bodies[body].first));
  }

  /// Whether a particle is active: neither it nor its body was switched off.
  bool acts(std::uint32_t particle) const {
    const Particle& p = particles[particle];
    return !p.inactive && bodies[p.body].kind != BodyKind::inactive;
  }

  /// Whether a nail or a static or scripted body in its ring holds it in place.
  bool is_pinned(std::uint32_t ring) const;

  /// Whether a particle has the position and velocity of its body's basis. It has not only in a conflict, which matters
  /// when the particle ceases to be an unknown of its own.
  bool follows_basis(std::uint32_t particle) const;
  /// Position and velocity of a particle from its body's basis.
  std::pair<Vec3, Vec3> carried(std::uint32_t particle) const;

  Vec3 position(std::uint32_t particle) const { return rings[particles[particle].ring].position; }
  Vec3 velocity(std::uint32_t particle) const { return rings[particles[particle].ring].velocity; }
  double body_mass(std::uint32_t body) const;  ///< kg; 0 of an obstacle
  double ring_mass(std::uint32_t ring) const;
  Vec3 center_of_mass(std::uint32_t body) const;  ///< of an obstacle: its shape's origin

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
  template <class Visit>
  void for_each_inertia_of(std::uint32_t body, Visit visit) const {
    for (std::uint32_t i = bodies[body].first_inertia; i != none; i = inertia_pairs[i].next) visit(i);
  }

  void add_twin(Twin);
  void remove_twin(std::uint32_t twin);
  void move_twins(std::uint32_t from, std::uint32_t to);  ///< to another particle
  template <class Visit>
  void for_each_twin_of(std::uint32_t particle, Visit visit) const {
    const std::uint32_t* const first = first_twin.find(particle);
    for (std::uint32_t t = first ? *first : none; t != none; t = twins[t].next) visit(t);
  }

  template <class Visit>
  void for_each_solid_of(std::uint32_t body, Visit visit) const {
    for (std::uint32_t s = bodies[body].first_solid; s != none; s = solids[s].next) visit(s);
  }

  /// Stores what a retired id became.
  void record_survivor(ParticleId retired, ParticleId survivor);
  void record_survivor(BodyId retired, BodyId survivor);
  std::optional<ParticleId> survivor_of(ParticleId) const;
  /// A free particle of an emitter, which viewers cannot grab.
  bool is_spark(std::uint32_t particle) const;
  std::optional<BodyId> survivor_of(BodyId) const;

  template <class Archive>
  void archive(Archive& ar);

  /// @name Notifications of changes of the structure; `Model` passes each on to its ingredients.
  ///@{
  virtual void absorb_uses(std::uint32_t q, std::uint32_t p) = 0;  ///< p replaces q, which will be destroyed
  virtual void drop_uses(std::uint32_t particle) = 0;              ///< it will be destroyed; may destroy other things
  virtual void forget_particle(std::uint32_t particle) = 0;        ///< it was destroyed, with everything attached to it
  virtual void forget_body(std::uint32_t body) = 0;
  /// The first particle of a ring has changed, or the empty ring was destroyed.
  virtual void ring_changed(std::uint32_t ring) = 0;
  /// A ring is merged into another one; `replaces`: the pin of `from` now holds `into`.
  virtual void ring_merged(std::uint32_t into, std::uint32_t from, bool replaces) = 0;
  virtual void inertia_changed(std::uint32_t body) = 0;     ///< its basis or its inertia pairs have changed
  virtual void acting_changed(std::uint32_t particle) = 0;  ///< see `acts`
  /// Ends the closing of two particles. False if there is none.
  virtual bool call_off(std::uint32_t p, std::uint32_t q) = 0;
  virtual bool is_used(std::uint32_t particle) const = 0;  ///< by anything except its body, ring and groups
  /// Whether steps do not move it although it could move: it is frozen.
  virtual bool is_frozen(std::uint32_t body) const = 0;
  virtual Vec3 inner_momentum(std::uint32_t body) const = 0;  ///< angular, beside that of its points, kg m^2/s
  using Visit = FunctionRef<void(std::uint32_t)>;
  /// visit(body): of the bodies joined with the particle's body in one articulate other than by a hinge.
  virtual void visit_joined(std::uint32_t particle, Visit visit) const = 0;
  /// visit(particle): of the particles of its body that stay with it when the body is split.
  virtual void visit_companions(std::uint32_t particle, Visit visit) const = 0;
  using VisitLine = FunctionRef<void(std::uint32_t p, std::uint32_t q)>;
  /// visit(p, q): of the lines between particles of a body, with which it touches if it has no solid.
  virtual void visit_lines(std::uint32_t body, VisitLine visit) const = 0;
  virtual double ball_radius(std::uint32_t particle) const = 0;  ///< a particle's own, m; 0: it has none
                                                                 ///@}

 protected:
  Structure() = default;
  Structure(const Structure&) = default;
  Structure(Structure&&) = default;
  Structure& operator=(const Structure&) = default;
  Structure& operator=(Structure&&) = default;
  ~Structure() = default;

 private:
  /// Bodies marked in the present search: those with the current mark. Not saved.
  struct Marks {
    std::vector<std::uint32_t> of;
    std::uint32_t current = 0;
  };
  Marks body_marks_;
  std::array<std::vector<std::uint32_t>, 2> floods_;  ///< of split_articulate
  enum Mark : std::uint8_t { unmarked, locally, anything };
  /// A longer list would take as long as to assemble all islands anew: while a scene is built, everything changes.
  bool lists_local_changes() const {
    return local_change_.bodies.size() < std::max<std::size_t>(1024, bodies.size() / 4);
  }
  void mark(std::uint32_t articulate, Mark, bool wakes = true);
  void leave_articulate(std::uint32_t body);
  void enter_articulate(std::uint32_t body, std::uint32_t articulate);
  std::vector<std::uint32_t> flagged_;  // articulates, since take_flagged
  std::vector<std::uint32_t> marked_;
  LocalChange local_change_;
  std::vector<Mark> mark_of_;  ///< of each articulate

  /// The last 65 536 retirements; the oldest is dropped first.
  template <class IdType>
  struct Survivors {
    std::map<IdType, IdType> became;
    std::deque<IdType> in_order;
    void record(IdType retired, IdType survivor);
    std::optional<IdType> find(IdType id) const;
    template <class Archive>
    void archive(Archive& ar);
  };
  Survivors<ParticleId> particle_survivors_;
  Survivors<BodyId> body_survivors_;
};

template <class IdType>
void Structure::Survivors<IdType>::record(IdType retired, IdType survivor) {
  constexpr std::size_t remembered = 65536;
  became[retired] = survivor;
  in_order.push_back(retired);
  if (in_order.size() > remembered) {
    became.erase(in_order.front());
    in_order.pop_front();
  }
}

template <class IdType>
std::optional<IdType> Structure::Survivors<IdType>::find(IdType id) const {
  const auto found = became.find(id);
  if (found == became.end()) return std::nullopt;
  return found->second;
}

template <class IdType>
template <class Archive>
void Structure::Survivors<IdType>::archive(Archive& ar) {
  struct Pair {
    IdType retired, survivor;
  };
  std::vector<Pair> pairs;
  for (const IdType id : in_order) pairs.push_back({id, became.at(id)});
  ar.vector(pairs);
  became.clear(), in_order.clear();
  for (const auto& [retired, survivor] : pairs) {
    if (became.contains(retired)) return ar.fail();
    record(retired, survivor);
  }
}

template <class Archive>
void Structure::archive(Archive& ar) {
  const auto table = [&](std::string_view name, auto& each, auto... slots) {
    ar.name(name), each.archive(ar, slots...);
  };
  const auto value = [&](std::string_view name, auto& each) { ar.name(name), ar.value(each); };
  table("particles", particles), table("rings", rings), table("bodies", bodies), table("solids", solids);
  table("twins", twins), table("articulates", articulates), table("groups", groups);
  table("inertia_pairs", inertia_pairs), table("attributes", attributes);
  table("ties", affine, particles.slot_count()), table("fuses", fuses, particles.slot_count());
  table("first_twin", first_twin, particles.slot_count());
  table("more_rows", more_rows, bodies.slot_count()), table("body_damping", body_damping, bodies.slot_count());
  table("obstacles", obstacles, bodies.slot_count());
  table("radii", radii, bodies.slot_count()), value("usual_radius", usual_radius);
  table("colors", colors, bodies.slot_count());
  table("materials", materials, bodies.slot_count()), value("usual_material", usual_material);
  value("has_usual_material", has_usual_material), table("stands", stands, bodies.slot_count());
  table("corrections", corrections, rings.slot_count());
  value("structure_version", structure_version), value("spark_changes", spark_changes);
  table("particle_survivors", particle_survivors_), table("body_survivors", body_survivors_);
  table("meshes", meshes), table("eliminations", eliminations);
}

}  // namespace iota::model
