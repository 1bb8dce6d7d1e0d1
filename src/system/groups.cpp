// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

GroupId System::create_group(std::string_view name) {
  return implementation_->execute(edit::CreateGroup{std::string(name)});
}

void System::add(GroupId group, ParticleId particle) {
  implementation_->execute(edit::SetMember{group, particle, true});
}

void System::remove(GroupId group, ParticleId particle) {
  implementation_->execute(edit::SetMember{group, particle, false});
}

void System::destroy(GroupId id) { implementation_->execute(edit::Destroy<GroupId>{id}); }

bool System::contains(GroupId id) const { return implementation_->model.groups.contains(id); }

bool System::contains(GroupId group, ParticleId particle) const {
  const std::uint32_t bit = 1u << implementation_->slot(group);
  return implementation_->model.particles[implementation_->slot(particle)].groups & bit;
}

std::string System::name(GroupId id) const {
  return implementation_->model.groups[implementation_->slot(id)].name.data();
}

std::vector<GroupId> System::groups() const { return implementation_->model.groups.ids(); }

std::vector<ParticleId> System::particles(GroupId group) const {
  const std::uint32_t bit = 1u << implementation_->slot(group);
  std::vector<ParticleId> list;
  implementation_->model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    if (p.groups & bit) list.push_back(implementation_->model.particles.id(slot));
  });
  return list;
}

}  // namespace iota
