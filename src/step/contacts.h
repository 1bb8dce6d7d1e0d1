// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/approach.h"
#include "contact/outlines.h"
#include "contact/seams.h"
#include "contact/touches.h"
#include "ingredient/model.h"
#include "model/basis_weights.h"
#include "step/contact_pairs.h"
#include "step/joined_bodies.h"

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace iota::step {

/// Two bodies of which one is a sensor, with the place where the other one is deepest in it.
struct Sensed {
  std::uint32_t body, other;
  Vec3 position, normal;   ///< the latter towards the body
  double gap;              ///< m
  double speed;            ///< of the approach, m/s
  bool is_passed = false;  ///< met on the way within the step, apart at its start
};

/// Finds the contacts of moving bodies with each other and with obstacles at the begin of a step. Both have a material.
/// Bodies that are hinged or jointed to each other do not touch (see `JoinedBodies`), nor do two particles with the usual
/// material.
class ContactFinder {
 public:
  /// Whether something has a material, or had one in the last step.
  static bool may_find_any(const model::Model&);
  /// For a step of h seconds. awake_version: of the islands. Costs nothing while nothing has a material, and next to nothing
  /// while all is asleep or frozen.
  void find(model::Model&, contact::Outlines&, double h, std::uint64_t awake_version);
  /// The bodies that may touch and were neither asleep nor within a stride when the step began.
  const std::vector<std::uint32_t>& movers() const { return movers_; }
  /// Articulates of bodies that meet others so fast on their way that their islands take the step in parts.
  const std::vector<std::uint32_t>& hasty() const { return hasty_; }
  /// Whether it may move and touch others, and what it touches was looked for in this step.
  bool is_watched(const model::Model&, std::uint32_t body) const;
  /// Before the two that follow: the length of the step or the part that they are about, s.
  void set_length(const model::Model&, double h);
  /// Whether a watched body goes further beside its straight way, m, than that was looked for.
  bool is_beyond(const model::Model&, std::uint32_t body, double beside) const;
  /// Adds contacts of the bodies of an island with what they meet on their ways. For the moment the velocities in the model are those
  /// of these ways. is_part: others may have taken another part of the step, so they are left out. Returns whether there are any.
  bool find_on_ways(model::Model&, contact::Outlines&, std::span<const std::uint32_t> bodies, bool is_part);
  struct Part {
    bool is_first, may_cut, of_sweeps;
  };
  /// The contacts of an island for the next part of its step, of which `left` seconds are left: those of pairs that `find`
  /// has listed. Returns the length of the part, s, if it is not the last one: the next body is met at its end, or it is so
  /// short that what meets now moves by a part of its size.
  std::optional<double> find_part(model::Model&, contact::Outlines&, std::span<const std::uint32_t> bodies, double left,
                                  const Part&);
  /// At the end of a step of h seconds: adds to `sensed` the fast pairs that have met on their ways, which are taken for straight.
  void sense_on_the_way(const model::Model&, contact::Outlines&, double h);
  /// The pairs with a sensor whose gap is small or negative at the start of the step, or was on their way in it.
  const std::vector<Sensed>& sensed() const { return sensed_; }

 private:
  struct Obstacle {
    std::uint64_t look = 0;  ///< in which it was measured
    geometry::Bounds box{};
    bool is_half_space = false, is_sensor = false;
    Vec3 origin{}, normal{};             ///< of a half-space
    double distance(const Vec3&) const;  ///< m, at most
  };
  /// A body that may touch others.
  struct Mover {
    std::uint32_t body = 0;
    double reach = 0;      ///< m
    Vec3 place, velocity;  ///< of its first particle; mean
    double spread = 0;     ///< of the velocities of its points, m/s
    double thrust =
        0;  ///< speed that other forces than gravity and contacts give in this time, as far as they are known, m/s
    double thrown = 0;       ///< how far an impact in this step may move it beside its way, m
    bool is_hasty = false;   ///< it takes the step in parts then
    double jump = 0;         ///< speed of a scripted body in this step beside that of the last one: for sensors, m/s
    double steps = 1;        ///< that it may take at once
    double ahead = -1;       ///< how far beyond its outline others are looked for, m; negative: it does not look
    std::uint64_t look = 0;  ///< in which it was measured
    bool is_placed = false;  ///< its outline is where the body is now; this and the following: where asked for
    std::optional<geometry::Bounds> box;
    std::optional<Vec3> spin;  ///< rad/s
    std::optional<model::BasisWeights> basis;
    std::optional<bool> of_sweeps;  ///< see ingredient::Contacts::is_of_sweeps
  };
  using Pair = BodyPair;
  // Shares of the size of the smaller body. With 1 and 0.5 instead of `far` and `near` twice as many shots (docs/contact.md) get
  // through walls.
  static constexpr double of_size = 0.02;  ///< what it may turn further
  static constexpr double far =
      0.5;  ///< a body that goes or swings further in the rest of a step is followed on its way

  const Obstacle& obstacle_at(const model::Model&, contact::Outlines&, std::uint32_t body);
  /// A body at the time of this look, the begin of the step or of a part of it.
  Mover& mover_at(const model::Model&, contact::Outlines&, std::uint32_t body);
  void begin_look(const model::Model&, double h, bool are_placed);
  void note_changes(model::Model&, contact::Outlines&);
  /// Static bodies that were made, moved or changed since the last step wake what they overlap.
  void wake_at_edited_obstacles(model::Model&, contact::Outlines&);
  void list_candidates(const model::Model&, const contact::Outlines&, std::uint64_t awake_version);
  void list_movers(const model::Model&);
  /// Into pairs_: what the movers may touch.
  void list_pairs(model::Model&, contact::Outlines&);
  void find_obstacles(model::Model&, contact::Outlines&);
  void find_pairs(model::Model&, contact::Outlines&);
  /// A pair as it moves now, measured once for a step or a part of it.
  struct Meeting {
    Mover* first;
    Mover* second;  ///< of what moves
    double size;    ///< of the smaller one that moves, m
    double speed() const;
    bool is_thrown() const { return first->thrown > 0 || (second && second->thrown > 0); }
    double jump() const { return first->jump + (second ? second->jump : 0); }  ///< see Mover
  };
  const contact::Outline& placed(contact::Outlines&, Mover&);
  bool is_of_sweeps(const model::Model&, Mover*);
  bool is_of_sweeps(const model::Model&, const Meeting&);
  Meeting meeting_of(const model::Model&, contact::Outlines&, const Pair&);
  /// former: the contacts that they have. False: they do not touch.
  bool touch(model::Model&, contact::Outlines&, const Pair&, const Meeting&, std::span<const std::uint32_t> former);
  /// Their touches, into found_: without seams, and with the faces beyond these.
  void find_touches(const model::Model&, contact::Outlines&, const Pair&, const Meeting&);
  /// The same by these two alone.
  void find_touches_of_two(const model::Model&, contact::Outlines&, const Pair&, const Meeting&);
  /// The touches of the first one with all that is static, into around_.
  void look_around(const model::Model&, contact::Outlines&, const Meeting&);
  void add_faces_of_seams(const model::Model&, contact::Outlines&, const Meeting&);
  /// The contacts that they have stay, where neither has moved. False, without a change: they have moved, or have none.
  bool renew(model::Model&, const contact::Outlines&, const Pair&, const Meeting&,
             std::span<const std::uint32_t> former);
  /// share: of the size of the body.
  bool has_moved(model::Model&, const contact::Outlines&, std::uint32_t body, double share);
  ingredient::Contacts::Motion motion_in(const model::Model&, const Meeting&) const;
  void sense(const model::Model&, contact::Outlines&, const Pair&);
  double within(const Mover&, const Mover* other, double steps = 1) const;
  /// How much farther a scripted body is looked for by sensors, m.
  double way_of_jump(double jump) const;
  /// The box that a body stays in for its stride.
  geometry::Bounds way_of_stride(const model::Model&, contact::Outlines&, const Mover&) const;

  /// A pair on its way.
  struct Ahead {
    double apart;  ///< the bodies do not touch before, s; 0: they may from now on
    double part;   ///< the step should be cut there, s
  };
  Ahead look_ahead(const model::Model&, contact::Outlines&, const Pair&, const Meeting&);
  contact::Motion motion_of(const model::Model&, const contact::Outlines&, std::uint32_t body) const;
  /// How two bodies with these touches, in found_, come nearer to each other, m/s: towards each other, and by their turns.
  struct Approach {
    double speed = 0, swing = 0;
  };
  Approach approach_of(const contact::Motion (&)[2], double slack) const;
  /// Two bodies hit each other in this step with at most this speed, m/s: that throws them.
  void note_impact(const model::Model&, const Meeting&, std::uint32_t second, double speed, bool is_hasty);
  void note_touches(const model::Model&, contact::Outlines&, const Pair&, const Meeting&);
  /// Adds pairs and contacts of what impacts throw with what it may meet then in the same step.
  void look_around_thrown(model::Model&, contact::Outlines&);
  void throw_in_part(const model::Model&, contact::Outlines&);
  void list_pairs_of(const model::Model&, contact::Outlines&, std::span<const std::uint32_t> bodies);
  void list_contacts_of(const model::Model&, std::span<const std::uint32_t> bodies);
  void add_pairs_of_woken(const model::Model&);

  contact::TouchFinder touches_;
  contact::ApproachFinder approaches_{touches_};
  Touches usually_touches_ = Touches::nothing;
  bool are_placed_ = false;         ///< all outlines, where their bodies are at this look
  bool is_any_extended_ = false;    ///< more than a plain particle, now or earlier
  double step_ = 0, shortest_ = 0;  ///< of the step, and of a part of it by sweeps, s
  double h_ = 0, fall_ = 0;         ///< of the step or the rest of it, s; speed that gravity gives in this time, m/s
  /// The contacts of pairs. Those of one body are looked at together: pairs are in order.
  class Known {
   public:
    /// Before contacts other than those of the pairs that follow may have changed.
    void forget() { body_ = none; }
    std::span<const std::uint32_t> of(const model::Model&, const Pair&);

   private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    void look(const model::Model&, std::uint32_t body);

    std::uint32_t body_ = none;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> items_;  ///< the other body, and the contact
    std::vector<std::uint32_t> slots_;
  };
  // Scratch, kept for its capacity.
  Known known_;
  JoinedBodies joined_;
  std::vector<std::uint32_t> contacts_;                ///< of an island
  std::vector<std::uint32_t> obstacles_, candidates_;  ///< the latter: those that may touch, and were awake when listed
  std::array<std::uint64_t, 3> listed_at_{};           ///< versions of islands, edits and outlines
  std::vector<Obstacle> all_obstacles_;                ///< by body slot
  std::vector<Mover> all_movers_;                      ///< by body slot
  struct Moved {
    std::uint64_t look = 0;  ///< in which it was measured
    bool is = true;
  };
  std::vector<Moved> all_moved_;             ///< by body slot
  std::uint64_t look_ = 0, first_look_ = 0;  ///< the latter: of this step
  std::vector<std::uint32_t> movers_;        ///< those that are awake
  std::vector<Pair> pairs_;
  std::vector<Sensed> sensed_;
  /// A pair of which one may pass the other, a sensor, within the step, with the centers at its start.
  struct Passing {
    Pair pair;
    double size;
    Vec3 centers[2];
  };
  std::vector<Passing> passing_;
  struct Thrown {
    std::uint32_t body;
    double reach;  ///< m
    bool is_hasty;
    double crossed = 0, bounce = 1;  ///< the gaps from the impact to here, m; one and its restitution
    std::optional<Vec3> stop{};      ///< the velocity of what does not give way there: all in a row may get it
  };
  std::vector<Thrown> thrown_;
  std::vector<Pair> passed_, near_thrown_;  ///< the former: do not meet by their velocities at the begin of the step
  std::vector<contact::Touch> found_;
  std::vector<contact::TouchOfPart> of_parts_;
  std::vector<contact::Seam> seams_;
  std::vector<contact::TouchOfPart> around_;  ///< of a body with all obstacles, at a look
  std::pair<std::uint64_t, std::uint32_t> looked_around_{};
  std::vector<std::uint32_t> hasty_;
  struct Listed {
    Pair pair;
    Meeting meeting;
    double apart = 0;  ///< they do not touch before, s
  };
  std::vector<Listed> listed_;         ///< of an island
  std::vector<std::uint8_t> is_here_;  ///< by body slot, in the island; zeros before and after
};

}  // namespace iota::step
