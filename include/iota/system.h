// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/constraints.h>
#include <iota/emitters.h>
#include <iota/forces.h>
#include <iota/ids.h>
#include <iota/pose_snapshot.h>
#include <iota/reports.h>
#include <iota/scene.h>
#include <iota/shapes.h>
#include <iota/vec3.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Iota: worlds of particles, bonds and exactly jointed rigid bodies that can be restructured while they run.
/// SI units; world frame right-handed, y up. A `System` is used from one thread at a time.
namespace iota {

/// An id whose object is gone; the text says what became of it.
struct StaleIdError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The dial from plausible to accurate; may be turned at any time. docs/solver.md says what each costs and is worth.
enum class IntegrationMode : std::uint8_t {
  plausible,       ///< `robust` with gaps up to 1e-7 of a link: for what is far away
  robust,          ///< backward Euler: never fails, never gains energy, dissipates
  energy_keeping,  ///< mid-point discrete gradient with bisection; falls back to `robust` where it must, and says so
  accurate,        ///< `energy_keeping` in sub-steps whose estimated errors add up to 1e-4 of a link a second
};

enum class BodyKind : std::uint8_t {
  dynamic,
  static_,   ///< never moves
  scripted,  ///< moved by the script (set_position), infinite mass
  inactive,  ///< kept, neither stepped nor drawn
  resting,   ///< dynamic, asleep with all that hangs together with it; wakes when touched, see RestOptions
};

/// Bodies that hang together, by hinges or bonds, fall asleep as one when none of their particles has been faster than
/// `speed` for `after` seconds: they are then `resting`, stand still, and cost nothing. An edit, an assigned velocity, a
/// grip, an applied force (that of a scripted bond too), a moving nail or another gravity wakes them.
struct RestOptions {
  double after = 0;     ///< s; 0: never
  double speed = 0.01;  ///< m/s
};

struct SystemOptions {
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  IntegrationMode mode = IntegrationMode::energy_keeping;
  double damping = 0;  ///< 1/s, all bodies: velocities fall by exp(-damping t)
  int threads = 0;     ///< that share a step, 0: one a core. Results are the same bits for any number
  RestOptions rest;
};

struct BodyOptions {
  BodyKind kind = BodyKind::dynamic;
  double damping = 0;  ///< 1/s, adds to the system's
};

/// For bodies given as homogeneous solids.
struct SolidOptions {
  double density = 1000;                                   ///< kg/m^3
  double mass = std::numeric_limits<double>::quiet_NaN();  ///< kg; NaN: density times volume
  Vec3 position;                                           ///< of the shape's origin, m
  Quaternion orientation;                                  ///< of the shape's frame
  Vec3 velocity;                                           ///< of the center of mass, m/s
  Vec3 spin;                                               ///< angular velocity, world axes, rad/s
  std::vector<Vec3> attachments;                           ///< particles to hinge, nail or bond at; shape's frame, m
  BodyKind kind = BodyKind::dynamic;
  double damping = 0;  ///< 1/s
};

/// One of the solids that a body was given as: combining bodies makes it one of several.
struct SolidView {
  Shape shape;             ///< a Mesh made in another system, and restored here, comes back empty
  Vec3 position;           ///< of the shape's origin, world, m
  Quaternion orientation;  ///< of the shape's frame
};

struct GripOptions {
  std::uint32_t client = 0, hold = 0;  ///< whose hand; carried to the viewers
  double frequency = 2.5;              ///< Hz of the critically damped spring
  double max_acceleration = 60;        ///< m/s^2: caps the force at this times the mass it can feel
};

/// A whole system in bytes: everything but the functions of scripted bonds.
struct Snapshot {
  std::vector<std::byte> bytes;
  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

/// A snapshot and all that happened since: replaying it gives the same hash after every step.
struct Recording {
  Snapshot start;
  std::vector<std::byte> commands;    ///< one after the other, each as its number and its fields
  std::vector<std::uint64_t> hashes;  ///< one per step

  /// For a file: with a mark, the version of the format and a checksum.
  std::vector<std::byte> to_bytes() const;
  /// Throws std::invalid_argument for bytes that `to_bytes` did not make, or that were cut short or damaged since.
  static Recording from_bytes(std::span<const std::byte>);
  friend bool operator==(const Recording&, const Recording&) = default;
};

class System {
 public:
  explicit System(const SystemOptions& options = {});
  ~System();
  System(System&&) noexcept;
  System& operator=(System&&) noexcept;

  /// @name Making and destroying. Throws std::invalid_argument on bad numbers, StaleIdError on stale ids.
  /// Inside a scripted bond's function only destroy/combine/separate/nail/release are allowed, and are queued.
  ///@{
  BodyId create_body(const BodyOptions& options = {});
  /// A new particle of `body`. mass, kg. A body is the rigid set of its particles. A massless one (a marker) must lie
  /// where the massive ones carry it: anywhere on a body with four of them off one plane, in the plane of a flat one, on
  /// the line of a thin one. Its velocity is then the body's.
  ParticleId create_particle(BodyId body, const Vec3& position, double mass = 1, const Vec3& velocity = {});
  /// Gives a body of exactly two particles the mass and inertia of a solid cylinder between them, exact for
  /// whatever acts on its axis. What set_angular_velocity gives it about the axis it keeps: nothing there can turn it.
  /// Source: mass [A B; B A], A+B = m/2, A-B = 2 It/L^2.
  void set_rod(BodyId body, double mass, double radius);
  /// A body of four equal point masses that have exactly the mass, center and inertia of a solid, and one particle for
  /// each attachment. particles(): the four, then the attachments.
  BodyId create_body(const Shape& shape, const SolidOptions& options = {});
  /// A further particle of a body made of solids, anywhere (world, m); the body's mass, center, inertia and motion stay
  /// exactly what they are. Throws std::invalid_argument for bodies without a solid, and where something is hinged to
  /// the solid's own four points, which have to give.
  ParticleId create_attachment(BodyId body, const Vec3& position);
  CosmeticBondId create_cosmetic_bond(ParticleId p, ParticleId q);
  BondId create_bond(ParticleId p, ParticleId q, BondLaw law);
  /// A law for any number of bonds, or the pairs of a `create_pairs`. Throws std::invalid_argument, for an expression with the
  /// place of the error. Give it as a SharedLaw.
  LawId create_law(LawBody body, const LawOptions& options = {});
  /// A predefined law: spring, drag, dashpot, tether, soft_repulsion, gravity, coulomb, lennard_jones, morse, attract_repel.
  LawId find_law(std::string_view name) const;
  /// A named set of particles; at most 32 at a time.
  GroupId create_group(std::string_view name);
  void add(GroupId group, ParticleId particle);
  void remove(GroupId group, ParticleId particle);
  /// A force on each particle of a group, or on all, by itself; taken once a step and held.
  FieldId create_field(FieldBody body, const FieldOptions& options = {});
  /// A force between all pairs of particles of a group, or of all, that are nearer than a cut-off; taken once a step and held.
  /// Points of one body do not feel each other.
  PairsId create_pairs(const SharedLaw& law, const PairsOptions& options = {});
  void destroy(GroupId group);  ///< throws std::invalid_argument while a field or a pairwise force acts on it
  void destroy(FieldId field);
  void destroy(PairsId pairs);
  void destroy(LawId law);            ///< throws std::invalid_argument while bonds use it
  void destroy(BodyId body);          ///< with its particles and their bonds
  void destroy(ParticleId particle);  ///< with its bonds; its body too if it was the last one
  void destroy(BondId bond);
  /// Where that disconnects its body's cosmetic bonds the rigid body falls into two pieces (thesis, 5.1.1): one with the
  /// bond's first end, which stays this body, and one with the second. Particles that hang on neither end go with the
  /// nearer piece; a solid and its attachments are one piece. Velocities, and so momenta, stay.
  RestructureReport destroy(CosmeticBondId bond);
  ///@}

  /// @name Restructuring (thesis Tables 4.1-4.3)
  ///@{
  /// Same particle: nothing. Same body: q is absorbed by p. Hinged: the hinge becomes rigid, q's body is absorbed by
  /// p's. Unrelated: a hinge; particles that are apart meet at once (`over` = 0) or within `over` seconds.
  RestructureReport combine(ParticleId p, ParticleId q, double over = 0);
  /// Makes one rigid body of two, in place; b is absorbed.
  RestructureReport combine(BodyId a, BodyId b);
  /// Same particle: a second one at the same place, half the mass each. Same body: q becomes a one-particle body
  /// hinged to p. Hinged: q leaves the ring. Unrelated: nothing.
  RestructureReport separate(ParticleId p, ParticleId q);
  /// Makes one of a body's parts, see parts(), a body of its own again. Hinges that combining had made rigid are back.
  RestructureReport separate(BodyId body, BodyId part);
  void nail(ParticleId particle);                        ///< where it is
  void nail(ParticleId particle, const Vec3& position);  ///< there; calling it again moves the nail
  void release(ParticleId particle);
  /// Particles still on their way to each other after `combine(p, q, over)`.
  std::uint32_t closing_count() const;
  ///@}

  /// @name Constraints. Velocities and gaps are brought in line with a new one at the start of the next step.
  ///@{
  ConstraintId create_constraint(const JointSpec&);
  ConstraintId create_constraint(const DistanceSpec&);
  ConstraintId create_constraint(const PathSpec&);
  ConstraintId create_constraint(const SurfaceSpec&);
  ConstraintId create_constraint(const SurfacePairSpec&);
  void destroy(ConstraintId);
  void set_active(ConstraintId,
                  bool);  ///< true repairs a broken one; bodies keep the relative place they were joined in
  const CoordinateOptions& coordinate(ConstraintId, JointCoordinate) const;
  void set_coordinate(ConstraintId, JointCoordinate, const CoordinateOptions&);
  void set_length(ConstraintId, double);  ///< of a rod or rope, m: reached during the next step
  BreakLimits break_limits(ConstraintId) const;
  void set_break_limits(ConstraintId, const BreakLimits&);
  ConstraintState state(ConstraintId) const;
  std::vector<ParticleId> particles(ConstraintId) const;  ///< those that it refers to, markers included
  std::vector<ConstraintId> constraints() const;          ///< in order of slots
  bool contains(ConstraintId) const;
  ///@}

  /// @name Hands
  ///@{
  /// local_point: in the body's drawn frame, m; it is put on the nearest place that the body's particles span.
  GripId create_grip(BodyId body, const Vec3& local_point, const Vec3& target, const GripOptions& options = {});
  void move_grip(GripId grip, const Vec3& target);
  void destroy(GripId grip);
  bool contains(GripId) const;
  ///@}

  /// @name Reading and assigning
  ///@{
  Vec3 gravity() const;
  void set_gravity(const Vec3&);
  IntegrationMode mode() const;
  void set_mode(IntegrationMode);
  /// Who solves the equations of each step: "direct" (the built-in sparse Newton), or a solver by name (iota/solver.h),
  /// which is given them dense and is far slower. What it finds no root of is solved directly after all, with a warning.
  std::string solver() const;
  void set_solver(std::string_view name);
  double damping() const;
  void set_damping(double per_second);
  RestOptions rest() const;
  void set_rest(const RestOptions&);
  double time() const;
  std::uint64_t step_count() const;
  std::uint32_t structure_version() const;
  /// As `structure_version`, but births and deaths of sparks do not count: what a viewer's list of bodies depends on.
  std::uint32_t scene_version() const;
  /// A body of one particle that an emitter bore and that nothing ties: viewers see a dot that they cannot hold.
  bool is_spark(BodyId) const;
  Energy energy() const;
  Vec3 momentum() const;
  Vec3 angular_momentum() const;  ///< about the origin
  double worst_gap() const;       ///< m

  bool contains(BodyId) const;
  bool contains(ParticleId) const;
  bool contains(BondId) const;
  bool contains(CosmeticBondId) const;
  bool contains(LawId) const;
  bool contains(GroupId) const;
  bool contains(FieldId) const;
  bool contains(PairsId) const;
  /// What a retired id became (itself if alive), if it was absorbed within the last 65 536 retirements.
  std::optional<ParticleId> survivor_of(ParticleId) const;
  std::optional<BodyId> survivor_of(BodyId) const;

  std::vector<BodyId> bodies() const;         ///< in order of slots
  std::vector<ParticleId> particles() const;  ///< in order of slots
  std::vector<BondId> bonds() const;
  std::vector<CosmeticBondId> cosmetic_bonds() const;
  std::vector<std::vector<BodyId>> articulates() const;
  std::uint32_t articulate_count() const;

  std::vector<ParticleId> particles(BodyId) const;
  std::uint32_t articulate(BodyId) const;  ///< equal for bodies that hang together
  BodyKind kind(BodyId) const;
  void set_kind(BodyId, BodyKind);
  /// An inactive body is kept, but neither stepped nor drawn; its bonds do not act. Active again, it is what it was
  /// before, at rest where it was left, and its hinges close.
  bool is_active(BodyId) const;
  void set_active(BodyId, bool);
  void set_articulate_active(BodyId, bool);  ///< the body and all that hangs on it
  double damping(BodyId) const;
  void set_damping(BodyId, double per_second);
  double mass(BodyId) const;
  Vec3 center_of_mass(BodyId) const;
  Quaternion orientation(BodyId) const;  ///< of the drawn frame: that of its first solid, or of its basis
  /// Moves the body, and rigidly with it all that hangs on it, nails and velocities included. A scripted body arrives at the end of the
  /// next step. position: of the center of mass.
  void set_pose(BodyId, const Vec3& position, const Quaternion& orientation);
  Matrix3 inertia(BodyId) const;  ///< about the center of mass, world axes, kg m^2 (thesis, Eq. 2.28)
  Vec3 velocity(BodyId) const;    ///< of the center of mass, m/s
  void set_velocity(BodyId, const Vec3&);
  /// rad/s, world axes; no part of it along what has no inertia (one point, or the line that all points are on and that is
  /// no rod).
  Vec3 angular_velocity(BodyId) const;
  /// Throws std::invalid_argument for such a part.
  void set_angular_velocity(BodyId, const Vec3&);
  Vec3 angular_momentum(BodyId) const;  ///< about its center of mass, kg m^2/s
  /// What a body was combined from: ids of bodies, itself and those it absorbed.
  std::vector<BodyId> parts(BodyId) const;
  std::vector<ParticleId> particles(BodyId body, BodyId part) const;
  /// Sum of all forces from outside in the last step, and of their moments about the center of mass, N and N m: mass times
  /// acceleration. Of a part of a combined body: those that hold it to the rest included.
  Vec3 net_force(BodyId) const;
  Vec3 net_torque(BodyId) const;
  Vec3 net_force(BodyId body, BodyId part) const;
  Vec3 net_torque(BodyId body, BodyId part) const;
  /// Of a part: what acted on it from outside of the whole body in the last step, N, and its moments about the part's
  /// center of mass, N m. `net` minus `outside` is what the other parts do to it: the load on the lock.
  Vec3 outside_force(BodyId body, BodyId part) const;
  Vec3 outside_torque(BodyId body, BodyId part) const;
  std::vector<SolidView> solids(BodyId) const;        ///< empty for bodies of particles alone
  std::vector<ParticleId> attachments(BodyId) const;  ///< its particles with mass that are no solid's own points

  BodyId body(ParticleId) const;
  std::vector<ParticleId> ring(ParticleId) const;  ///< every particle hinged with it, itself included
  Vec3 position(ParticleId) const;
  void set_position(ParticleId, const Vec3&);  ///< moves the whole ring; its bodies take their rigid distances anew
  Vec3 velocity(ParticleId) const;
  void set_velocity(ParticleId, const Vec3&);
  double mass(ParticleId) const;  ///< its own share
  /// Bonds of an inactive particle do not act, and of its mass only a millionth (2^-20, so that its body keeps its shape);
  /// its hinges and nails hold on.
  bool is_active(ParticleId) const;
  void set_active(ParticleId, bool);
  void set_mass(ParticleId, double);
  Vec3 net_force(ParticleId) const;  ///< all that acted on its share of mass in the last step, N
  bool is_nailed(ParticleId) const;
  Vec3 nail_force(ParticleId) const;  ///< by the nail on the particle in the last step, N
  /// On the particle's body by all that shares or nails its place, in the last step, N: what the hinge carries. A force
  /// applied to the shared particle itself counts as held by all its bodies alike.
  Vec3 hinge_force(ParticleId) const;
  /// Beyond this `hinge_force` the particle leaves its ring, or its nail, at the end of a step (StepReport::broken).
  void set_break_force(ParticleId, double newtons);
  double break_force(ParticleId) const;       ///< N; infinite: never
  void apply_force(ParticleId, const Vec3&);  ///< added during the next step only, N

  std::pair<ParticleId, ParticleId> ends(BondId) const;
  std::pair<ParticleId, ParticleId> ends(CosmeticBondId) const;
  bool is_active(BondId) const;
  void set_active(BondId, bool);  ///< true repairs a broken one
  /// On the first particle, N (the second gets the opposite): of an implicit bond here and now, of a held one in the last step.
  Vec3 force(BondId) const;
  void set_break_force(BondId, double newtons);  ///< beyond it the bond is switched off at the end of a step
  double break_force(BondId) const;              ///< N; infinite: never
  bool is_broken(BondId) const;
  LawId law(BondId) const;
  std::string_view kind(LawId) const;   ///< predefined, expression, function (of one bond each), compiled, arrays
  std::string expression(LawId) const;  ///< its expression, empty for code
  std::string name(LawId) const;        ///< of a law
  std::vector<LawParameter> parameters(LawId) const;   ///< with its own values
  std::vector<LawParameter> parameters(BondId) const;  ///< with the bond's
  void set_parameter(BondId, std::string_view name, double value);
  bool is_implicit(BondId) const;

  /// Evaluates the forces of all active bonds of a law, of a field or of a pairwise force where everything is now, without
  /// applying them, to measure what they cost: implicit bonds once with their derivatives, as each iteration of the solver
  /// does. Functions of the script are called. Returns how many bonds or particles those were.
  std::size_t rehearse(LawId, double dt);
  std::size_t rehearse(FieldId, double dt);
  std::size_t rehearse(PairsId, double dt);

  std::vector<GroupId> groups() const;
  std::string name(GroupId) const;
  std::vector<ParticleId> particles(GroupId) const;
  bool contains(GroupId, ParticleId) const;
  std::vector<FieldId> fields() const;
  std::string name(FieldId) const;
  bool is_active(FieldId) const;
  void set_active(FieldId, bool);
  std::vector<LawParameter> parameters(FieldId) const;
  void set_parameter(FieldId, std::string_view name, double value);
  std::vector<PairsId> all_pairs() const;
  LawId law(PairsId) const;
  double cutoff(PairsId) const;  ///< m
  double energy(PairsId) const;  ///< of all pairs within the cut-off, now, J; a part of energy().potential
  bool is_active(PairsId) const;
  void set_active(PairsId, bool);
  std::vector<LawParameter> parameters(PairsId) const;
  void set_parameter(PairsId, std::string_view name, double value);

  /// (n, 3) in the order of particles(); out.size() == 3 n.
  void read_positions(std::span<double> out) const;
  void read_velocities(std::span<double> out) const;
  PoseSnapshot poses() const;
  /// What a viewer has to be told: all that changed since the last call, at first and after a restore everything, and on
  /// request (`whole`); `also` names bodies to be described though they have not changed. Costs what has changed. One caller
  /// at a time.
  SceneChanges take_scene_changes(bool whole = false, std::span<const BodyId> also = {});
  void stop_watching_scene();  ///< nothing is noted any more for the next call, which will be given everything
  ///@}

  /// @name Particles that live for a time
  ///@{
  EmitterId create_emitter(const EmitterOptions& options);
  void destroy(EmitterId emitter);  ///< its particles live on
  void set_active(EmitterId, bool);
  void set_rate(EmitterId, double per_second);
  void move_emitter(EmitterId, const Vec3& position, const Quaternion& orientation);
  bool contains(EmitterId) const;
  bool is_active(EmitterId) const;
  double rate(EmitterId) const;
  std::uint32_t count(EmitterId) const;  ///< alive now
  std::uint64_t born(EmitterId) const;   ///< so far
  std::vector<ParticleId> particles(EmitterId) const;
  /// Age, lifetime, radius and color; radius and color of an emitted particle are those of its emitter's curve.
  ParticleAttributes attributes(ParticleId) const;
  bool has_attributes(ParticleId) const;
  /// Any particle may get a lifetime: it is destroyed, with its bonds, in the step in which its age reaches it.
  void set_attributes(ParticleId, const ParticleAttributes&);
  ///@}

  /// @name Oriented particles (surfels; Szeliski and Tonnesen 1992). They turn like balls, each by itself, whatever body
  /// they are in; their local z is their preferred direction or normal. All but is_oriented and set_orientation throw
  /// std::invalid_argument for particles without an orientation.
  ///@{
  bool is_oriented(ParticleId) const;
  Quaternion orientation(ParticleId) const;
  /// Makes it oriented, with the moment of inertia of a ball of its radius (0.05 m where it has none).
  void set_orientation(ParticleId, const Quaternion&);
  Vec3 normal(ParticleId) const;  ///< its local z in the world frame
  Vec3 spin(ParticleId) const;    ///< rad/s, world; constant in free flight, to the last bit
  void set_spin(ParticleId, const Vec3&);
  double moment(ParticleId) const;  ///< of inertia, kg m^2
  void set_moment(ParticleId, double);
  void set_spin_damping(ParticleId, double per_second);
  void apply_torque(ParticleId, const Vec3&);  ///< during the next step only, N m
  /// Draws its normal to a direction: torque stiffness (normal x direction) - damping spin, N m; stiffness 0 ends it.
  void align(ParticleId, const Vec3& direction, double stiffness, double damping);
  ///@}

  /// @name Batches of edits: one report for all, and undone as one
  ///@{
  void begin_edit();  ///< batches within a batch are part of it
  /// What has been created, destroyed and absorbed since, and its energy; empty for a batch within a batch.
  RestructureReport end_edit();
  void cancel_edit();  ///< the system is what it was at begin_edit
  bool is_editing() const;
  /// Back to just before the last batch, time included: a batch is kept as the whole state before it. At most 64, and
  /// 256 MiB, are kept; restore() and start_recording() forget them. False when there is none.
  bool undo();
  bool redo();
  std::size_t undo_count() const;
  std::size_t redo_count() const;
  ///@}

  /// @name Time
  ///@{
  int threads() const;
  /// How many threads share a step; 0: one a core. No part of the state: it changes how soon, not what. Small steps are
  /// taken by the calling thread alone.
  void set_threads(int);
  /// Advances by dt seconds (0 < dt <= 1). Never throws for numerical reasons.
  StepReport step(double dt);
  bool is_stepping() const;
  ///@}

  /// @name Save, restore, replay
  ///@{
  Snapshot snapshot() const;
  /// Functions of scripted bonds stay those of this system. Throws std::invalid_argument on bytes that are no snapshot;
  /// the system is then unchanged.
  void restore(const Snapshot&);
  std::uint64_t state_hash() const;
  void start_recording();
  Recording stop_recording();
  /// Restores the recording's start and repeats it; returns the number of the first step whose hash differs, if any.
  /// Throws std::invalid_argument for a damaged recording: before anything has changed where bytes are no command, else
  /// after the last command that could be done.
  std::optional<std::uint64_t> replay(const Recording&);
  ///@}

  /// Looks at the constraints of a body and of all that is solved together with it. Takes seconds for hundreds of rows.
  /// Throws std::invalid_argument above 600 rows.
  Diagnosis diagnose(BodyId) const;
  /// Walks the whole structure; one sentence per inconsistency, empty when whole.
  std::vector<std::string> validate() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace iota
