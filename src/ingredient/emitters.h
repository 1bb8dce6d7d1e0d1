// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "shape/data.h"

#include <iota/attributes.h>

#include <array>

namespace iota::ingredient {

/// EmitterOptions as plain data, and its state.
struct Emitter {
  shape::Data source;
  std::uint32_t active = 1, padding = 0;
  double rate = 0;
  Vec3 position, velocity;
  Quaternion orientation;
  double velocity_spread = 0, lifetime = 1, lifetime_spread = 0, mass = 0, damping = 0;
  std::uint32_t max_count = 0, key_count = 0;
  std::array<AttributeKey, 8> keys{};
  std::uint64_t seed = 0, draws = 0;  ///< numbers drawn so far: the state of its random numbers
  double due = 0;                     ///< pending births, a fraction
  std::uint32_t alive = 0, padding2 = 0;
  std::uint64_t born = 0;
};

/// Sources of particles, which are born and die between steps.
class Emitters : public NoAnswers {
 public:
  struct Tables {
    SlotTable<Emitter, EmitterId> emitters;
    model::ChangedSlots changed_emitters;  ///< not saved

    const auto& table_of(EmitterId) const { return emitters; }
    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      emitters.archive(ar);
    }
  };
  static void forget_particle(Model&, std::uint32_t particle);
  static model::ChangedSlots* scene_log(Model&);
  static void describe(const SceneView&, SceneChanges&);
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void end_step(Model&, double h);
  static void tell(Model&, Outcome&);
  static double ball_radius(const Model&, std::uint32_t particle);

  /// Radius and color of an emitted particle, interpolated on its emitter's curve by age; of any other one its own.
  static ParticleAttributes look(const Model&, const model::Attributes&);

  /// Creates the particles that an emitter owes after a step of h seconds, and adds them to a list.
  static void bear(Model&, std::uint32_t emitter, double h, std::vector<ParticleId>& born);
};

}  // namespace iota::ingredient
