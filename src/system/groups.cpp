// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

GroupId Groups::create(std::string_view name) { return core_.execute(edit::CreateGroup{std::string(name)}); }

void Groups::add(GroupId group, ParticleId particle) { core_.execute(edit::SetMember{group, particle, true}); }

void Groups::remove(GroupId group, ParticleId particle) { core_.execute(edit::SetMember{group, particle, false}); }

void Groups::destroy(GroupId id) { core_.execute(edit::Destroy<GroupId>{id}); }

bool Groups::contains(GroupId id) const { return core_.model.groups.contains(id); }

bool Groups::contains(GroupId group, ParticleId particle) const {
  const std::uint32_t bit = 1u << core_.slot(group);
  return core_.model.particles[core_.slot(particle)].groups & bit;
}

std::string Groups::name(GroupId id) const { return core_.model.groups[core_.slot(id)].name.data(); }

std::vector<GroupId> Groups::ids() const { return core_.model.groups.ids(); }

std::vector<ParticleId> Groups::particles(GroupId group) const {
  const std::uint32_t bit = 1u << core_.slot(group);
  std::vector<ParticleId> list;
  core_.model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    if (p.groups & bit) list.push_back(core_.model.particles.id(slot));
  });
  return list;
}

}  // namespace iota
