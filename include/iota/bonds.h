// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>
#include <iota/ids.h>
#include <iota/reports.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <string_view>
#include <utility>
#include <vector>

namespace iota {

/// Forces between two particles. Several bonds may share a law.
class Bonds : public View {
 public:
  explicit Bonds(Core& core) : View(core) {}

  BondId create(ParticleId p, ParticleId q, BondLaw law);
  void destroy(BondId);
  bool contains(BondId) const;
  std::vector<BondId> ids() const;  ///< in order of slots

  std::pair<ParticleId, ParticleId> ends(BondId) const;
  bool is_active(BondId) const;
  void set_active(BondId, bool);  ///< true repairs a broken one
  /// On the first particle, N (the second gets the opposite): of an implicit bond at the present state, of a held one
  /// or a very stiff spring in the last step.
  Vec3 force(BondId) const;
  void set_break_force(BondId, double newtons);  ///< beyond it the bond is switched off at the end of a step
  double break_force(BondId) const;              ///< N; infinite: never
  bool is_broken(BondId) const;
  LawId law(BondId) const;
  bool is_implicit(BondId) const;
  std::vector<LawParameter> parameters(BondId) const;  ///< of its law, with its own values
  void set_parameter(BondId, std::string_view name, double value);
};

/// Lines that are drawn between two particles of one body, without force. Destroying them can split the body, see
/// destroy.
class CosmeticBonds : public View {
 public:
  explicit CosmeticBonds(Core& core) : View(core) {}

  CosmeticBondId create(ParticleId p, ParticleId q);
  /// If that disconnects the body's cosmetic bonds, it splits the body (thesis, 5.1.1): the piece with the bond's first
  /// end stays this body, the other one is new. Particles connected to neither end go with the nearer piece; a solid
  /// and its attachments are one piece. Velocities, and so momenta, do not change.
  RestructureReport destroy(CosmeticBondId);
  bool contains(CosmeticBondId) const;
  std::vector<CosmeticBondId> ids() const;  ///< in order of slots
  std::pair<ParticleId, ParticleId> ends(CosmeticBondId) const;
};

}  // namespace iota
