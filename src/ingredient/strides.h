// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace iota::ingredient {

/// The motion of a ring during a stride: a step of several steps' length, which was solved at its begin. Until its end the
/// ring moves from the state before to the state after it.
struct Track {
  Vec3 from, velocity_from, to, velocity_to;
  double h = 0;                                ///< length of one step, s
  double energy_from = 0, energy_to = 0;       ///< of all bodies of the island, J
  double dissipated = 0, external_work = 0;    ///< a ring's share of what was booked for the whole stride, J
  std::uint64_t begin = 0;                     ///< number of the step that solved it
  std::uint32_t length = 0;                    ///< steps; 0: there is no stride
  std::uint32_t points = 0;                    ///< rings of the island; 0: it was disturbed
  std::uint32_t leader = none, is_pinned = 0;  ///< first ring of the island; whether one of its rings is pinned

  bool is_active(std::uint64_t step) const { return step < begin + length; }
  friend bool are_of_one_stride(const Track& a, const Track& b) {
    return a.begin == b.begin && a.length == b.length && a.points == b.points && a.leader == b.leader;
  }
};

/// Booked for steps of a stride that were not taken, J.
struct Unused {
  double dissipated = 0, external_work = 0;

  double lost() const { return external_work - dissipated; }  ///< so much less was lost, as the balance stays
};

/// A command: how many steps the island of a body takes at once.
struct SetStride {
  static constexpr bool keeps_energy = true;
  BodyId body;
  std::uint32_t steps;
  bool whole;  ///< all bodies of its articulate
};

/// How often islands are solved: see Bodies::set_stride. The state of a body between two solutions is one of the model as
/// any other: contacts, scripts and pages read places and velocities of the present time. They are interpolated with the
/// acceleration constant, as the mid-point rule has it: the cubic through both states is then a parabola, and a link that
/// turns by a in the stride is too short by a^4/200 in between.
class Strides : public NoAnswers {
 public:
  static constexpr std::uint32_t longest = 16;                                        ///< steps
  static constexpr std::uint32_t frozen = std::numeric_limits<std::uint32_t>::max();  ///< longer than all
  /// Added to a stride that was set after an edit of the same articulate, which does not end it.
  static constexpr std::uint32_t newer = 0x100;
  struct Tables {
    SideTable<std::uint32_t> strides;            ///< of bodies; none: 1
    SideTable<Track> tracks;                     ///< of rings
    std::vector<std::uint32_t> changed_strides;  ///< bodies; not saved, since a restored system reads all
    std::vector<std::uint64_t> near_since;       ///< of bodies: the step in which they were near others; not saved

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      strides.archive(ar, structure.bodies.slot_count());
      tracks.archive(ar, structure.rings.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void forget_body(Model&, std::uint32_t body);
  static void ring_changed(Model&, std::uint32_t ring);

  using Commands = std::tuple<SetStride>;
  static void apply(Model&, const SetStride&);

  static bool any(const Model&);  ///< whether a body has a stride or is within one
  static std::uint32_t of(const Model&, std::uint32_t body);
  static void set(Model&, std::uint32_t body, std::uint32_t steps);
  /// An edit, a hand or a force has touched a body: its articulate is solved in every step from now on.
  static void disturb(Model&, std::uint32_t body);
  /// The same for all bodies that were edited since the last step, and those that hands hold.
  static void disturb_edited(Model&);
  static bool is_frozen(const Model&, std::uint32_t body);  ///< and not within a stride any more
  /// Whether a body is not solved in the next step, as it is within a stride or frozen.
  static bool skips(const Model&, std::uint32_t body);

  enum class Phase : std::uint8_t {
    none,    ///< no ring is within a stride
    within,  ///< all rings are within the same one, undisturbed
    broken   ///< something has come or gone, or was disturbed
  };
  /// for_each_ring(visit): of an island. h: length of a step, s.
  template <class ForEachRing>
  static Phase phase(const Model& model, double h, ForEachRing for_each_ring) {
    const Track* first = nullptr;
    std::uint32_t count = 0;
    bool any = false, all = true;
    for_each_ring([&](std::uint32_t ring) {
      const Track* const track = find(model, ring);
      if (count++ == 0) first = track;
      const bool is_active = track && is_within(model, *track);
      any = any || is_active;
      all = all && is_active && first && are_of_one_stride(*track, *first);
    });
    if (!any) return Phase::none;
    return all && first->points == count && first->h == h ? Phase::within : Phase::broken;
  }
  static const Track* find(const Model&, std::uint32_t ring);
  static bool is_within(const Model&, const Track&);
  /// The same for a ring of it in a step of h seconds; a step of another length ends a stride.
  static bool waits(const Model&, std::uint32_t body, std::uint32_t ring, double h);
  /// The length of a stride that could begin now, in steps: so that it ends at a step of its own beat, by which strides of equal lengths are
  /// spread over the steps, and no body turns too far. 1 for what touches something or will: strides of 8 steps took as
  /// long as 8 steps for dolls that fall on the ground, and ten times as long for heaps of them.
  static std::uint32_t length(const Model&, std::uint32_t stride, std::span<const std::uint32_t> bodies, double h);
  /// A body would come near another one in its stride.
  static void note_near(Model&, std::uint32_t body);
  /// Puts a ring where it is after `steps` steps of its track.
  static void show(Model&, std::uint32_t ring, std::uint32_t steps);
  /// Forces on a body that is not solved in this step have no effect.
  static void drop_forces(Model&, std::uint32_t body);
  /// Ends the strides of the bodies of an island here and now: their energy becomes a value between those at both ends.
  /// Returns what the accounts have too much.
  static Unused abandon(Model&, std::span<const std::uint32_t> bodies);
  /// Reduces the kinetic energy of bodies that have more energy than the limit, at the same momentum.
  static void limit_energy(Model&, std::span<const std::uint32_t> bodies, double limit, bool is_pinned);
};

}  // namespace iota::ingredient
