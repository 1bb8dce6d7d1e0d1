// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outlines.h"
#include "ingredient/contact_readings.h"
#include "step/contacts.h"

#include <iota/reports.h>

#include <map>
#include <utility>
#include <vector>

namespace iota::step {

/// Finds the touches that begin and end in a step, and tells them to the watches whose filters they pass. Costs nothing
/// without a watch. Two bodies touch from a step in which their contacts carry a load until they are further apart than
/// a ten-thousandth of the smaller one: what rests opens and closes by round-off, which is no end. A sensor and what is
/// in it touch without a load.
class ContactWatches {
 public:
  /// Returns its number. Touches of now have begun already.
  std::uint32_t add(const model::Model&, contact::Outlines&, const ContactFilter&);
  void remove(std::uint32_t watch);

  /// After a restore other bodies touch: no report tells of that.
  void begin_step(const model::Model&, contact::Outlines&);
  /// After the solution and before edits, which end contacts.
  void end_step(const model::Model&, contact::Outlines&, const std::vector<Sensed>&, StepReport&);

 private:
  using Pair = std::pair<BodyId, BodyId>;  ///< the first one has the lower slot
  struct Touching {
    Pair pair;
    std::uint64_t number = 0;  ///< of the touch; an edit may give it another pair
    BodyId body, other;
    Vec3 position, normal;
  };
  struct Change {
    Touching touching;
    bool began;
    double impulse = 0, speed = 0;
  };
  /// A contact that has touched, or whose gap is small; or a pair with a sensor.
  struct Near {
    Pair pair;
    std::uint32_t slot;  ///< of the contact
    const Sensed* sensed = nullptr;
    bool has_touched;
  };
  struct Told {
    std::uint64_t number;  ///< of the touch
    bool is_turned;        ///< the filter's first body is the other one
  };
  struct Watch {
    std::uint32_t number;
    ContactFilter filter;
    std::vector<Told> told;        ///< begins whose ends are to be told; numbers rise
    std::map<Pair, double> times;  ///< of begins that were told, s, with a cooldown
  };

  void look_anew(const model::Model&, contact::Outlines&);
  void list_near(const model::Model&, const contact::Outlines&, bool also_asleep, const std::vector<Sensed>& = {});
  void follow_edits(const model::Model&);
  void compare(const model::Model&, double h);
  Change begin(const model::Model&, std::size_t first, std::size_t last, double h);
  static void place(const model::Model&, const Near&, Touching&);
  static void tell(const model::Model&, Watch&, const Change&, StepReport&);
  static bool passes(const model::Model&, Watch&, const Change&);

  std::vector<Watch> watches_;
  std::uint32_t last_watch_ = 0;
  std::uint64_t last_touch_ = 0, restores_ = 0;
  std::vector<Touching> touching_;  ///< sorted by pairs
  bool knows_sensed_ = true;        ///< otherwise what is in a sensor was there before
  // Scratch of one step, kept for its capacity.
  std::vector<Near> near_;
  std::vector<Touching> still_;
  std::vector<Change> changes_;
};

}  // namespace iota::step
