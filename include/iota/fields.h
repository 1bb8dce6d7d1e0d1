// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>
#include <iota/ids.h>
#include <iota/view.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iota {

/// Named sets of particles, which fields and pairwise forces act on; at most 32 at a time.
class Groups : public View {
 public:
  explicit Groups(Core& core) : View(core) {}

  GroupId create(std::string_view name);
  void destroy(GroupId);  ///< throws std::invalid_argument while a field or a pairwise force acts on it
  bool contains(GroupId) const;
  std::vector<GroupId> ids() const;
  std::string name(GroupId) const;

  void add(GroupId, ParticleId);
  void remove(GroupId, ParticleId);
  bool contains(GroupId, ParticleId) const;
  std::vector<ParticleId> particles(GroupId) const;
};

/// Forces on each single particle of a group, or on all; evaluated once a step and held.
class Fields : public View {
 public:
  explicit Fields(Core& core) : View(core) {}

  FieldId create(FieldBody body, const FieldOptions& options = {});
  void destroy(FieldId);
  bool contains(FieldId) const;
  std::vector<FieldId> ids() const;

  std::string name(FieldId) const;
  std::string_view kind(FieldId) const;  ///< "predefined", "expression" or "function"
  std::string text(FieldId) const;       ///< the predefined one or the expression that it was made of; empty for code
  std::optional<GroupId> group(FieldId) const;
  bool replaces_gravity(FieldId) const;
  bool is_active(FieldId) const;
  void set_active(FieldId, bool);
  std::vector<LawParameter> parameters(FieldId) const;
  void set_parameter(FieldId, std::string_view name, double value);
  std::size_t rehearse(FieldId, double dt);  ///< see Laws::rehearse; returns the number of particles
};

/// Forces between all pairs of particles of a group, or of all, that are nearer than a cut-off; evaluated once a step
/// and held. Not between points of one body.
class Pairs : public View {
 public:
  explicit Pairs(Core& core) : View(core) {}

  PairsId create(const SharedLaw& law, const PairsOptions& options = {});
  void destroy(PairsId);
  bool contains(PairsId) const;
  std::vector<PairsId> ids() const;

  LawId law(PairsId) const;
  double cutoff(PairsId) const;  ///< m
  std::optional<GroupId> group(PairsId) const;
  std::optional<GroupId> other(PairsId) const;
  bool is_shifted(PairsId) const;
  double energy(PairsId) const;  ///< of all pairs within the cut-off, now, J; a part of System::energy().potential
  bool is_active(PairsId) const;
  void set_active(PairsId, bool);
  std::vector<LawParameter> parameters(PairsId) const;
  void set_parameter(PairsId, std::string_view name, double value);
  std::size_t rehearse(PairsId, double dt);  ///< see Laws::rehearse; returns the number of particles
};

}  // namespace iota
