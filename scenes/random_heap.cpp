// SPDX-License-Identifier: Apache-2.0
#include "scenes/random_heap.h"

#include "scenes/dice.h"

#include <iota/system.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace iota::scenes {

namespace {

class Heap {
 public:
  explicit Heap(std::uint64_t seed) : dice_{seed * 0x9e3779b97f4a7c15} {
    size_ = std::pow(10, dice_.uniform(-2, 1));
    dt_ = 1 / std::pow(10, dice_.uniform(1.5, 2.4));
    const std::uint32_t mode = dice_.below(30);
    system_.set_mode(mode == 0   ? IntegrationMode::accurate  // the slowest one
                     : mode <= 6 ? IntegrationMode::robust
                     : mode <= 9 ? IntegrationMode::plausible
                                 : IntegrationMode::energy_keeping);
    if (dice_.below(5) == 0) system_.set_gravity({});
    StepBudget budget = system_.budget();
    const double budgets[] = {budget.contacts, budget.contacts, 1, 3e4, 0};
    budget.contacts = budgets[dice_.below(5)];
    system_.set_budget(budget);
    if (dice_.below(2) == 0) system_.set_rest({.after = 0.3, .speed = 0.01 * size_});
    material_ = {.friction = dice_.uniform(0, 1)};
    if (dice_.below(2) == 0) material_.restitution = dice_.uniform(0, 1);
    if (dice_.below(4) == 0) material_.rolling = dice_.uniform(0, 0.1);
    system_.set_usual_material(material_);
    const Shape floor =
        dice_.below(2) == 0 ? Shape{HalfSpace{{0, 1, 0}}} : Shape{Box{{8 * size_, 0.2 * size_, 8 * size_}}};
    for (const Shape& shape : {floor, Shape{Box{{2 * size_, size_, 0.1 * size_}}}})
      system_.bodies().set_material(system_.bodies().create_obstacle(shape), material_);
    const std::uint32_t count = 3 + dice_.below(7);
    for (std::uint32_t i = 0; i < count; ++i)
      add({size_ * dice_.uniform(-0.6, 0.6), size_ * (1 + 0.9 * i), size_ * dice_.uniform(-0.6, 0.6)});
  }

  System& system() { return system_; }
  double size() const { return size_; }
  double dt() const { return dt_; }

  /// Whether it was not refused.
  bool edit() {
    const std::vector<BodyId> bodies = system_.bodies().ids();
    if (bodies.empty()) return add(size_ * Vec3{0, 2, 0}), true;
    try {
      edit(bodies[dice_.below(static_cast<std::uint32_t>(bodies.size()))], bodies);
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  }
  /// That of all bodies if they moved by a hundredth of their size in a step, or were lifted by it, as a coin that rolls on
  /// its rim in long steps is, J.
  double least_energy() const {
    double mass = 0;
    for (const BodyId body : system_.bodies().ids()) mass += system_.bodies().mass(body);
    return mass * (0.5 * std::pow(0.01 * size_ / dt_, 2) + 0.01 * size_ * norm(system_.gravity()));
  }
  std::vector<std::pair<BodyId, Vec3>> places() const {
    std::vector<std::pair<BodyId, Vec3>> all;
    for (const BodyId body : system_.bodies().ids()) all.push_back({body, system_.bodies().center_of_mass(body)});
    return all;
  }
  /// A body that goes further from these places than the fastest throw and twice the speed that `kinetic`, J, would give
  /// it alone: a turn that an edit sets moves what hangs far away fast. None: null.
  BodyId find_shot(const std::vector<std::pair<BodyId, Vec3>>& before, double kinetic) const {
    constexpr double far = 1000;  // sizes in a step
    for (const auto& [body, place] : before) {
      if (!system_.bodies().contains(body)) continue;
      const double fastest = std::sqrt(2 * kinetic / system_.bodies().mass(body));
      if (!(norm(system_.bodies().center_of_mass(body) - place) < far * size_ + 2 * fastest * dt_)) return body;
    }
    return {};
  }
  bool chance(std::uint32_t in) { return dice_.below(in) == 0; }

 private:
  Quaternion turn() {
    if (dice_.below(2) == 0) return {};
    const Vec3 v = dice_.point(1);
    const double w = dice_.uniform(-1, 1), length = std::sqrt(dot(v, v) + w * w) + 1e-9;
    return {v.x / length, v.y / length, v.z / length, std::sqrt(std::max(0.0, 1 - dot(v, v) / (length * length)))};
  }
  void add(const Vec3& position) {
    const double a = size_ * dice_.uniform(0.2, 0.8);
    if (dice_.below(8) == 0) return add_rod(position, a);
    const Shape shapes[] = {Sphere{a / 2},
                            Box{{a, 0.8 * a, 0.6 * a}},
                            Box{{a, a, a}},
                            Box{{a, 0.05 * a, a}},
                            Capsule{0.3 * a, 0.8 * a},
                            Cylinder{0.4 * a, 0.7 * a},
                            Cylinder{0.03 * a, a},
                            Cone{0.4 * a, 0.8 * a},
                            Ellipsoid{{a, 0.7 * a, 0.5 * a}},
                            Torus{0.35 * a, 0.12 * a}};
    (void)system_.bodies().create(
        shapes[dice_.below(std::size(shapes))],
        {.density = std::pow(10, dice_.uniform(2, 4)), .position = position, .orientation = turn()});
  }
  void add_rod(const Vec3& position, double length) {
    const BodyId rod = system_.bodies().create(BodyOptions{});
    (void)system_.particles().create(rod, position, 1);
    (void)system_.particles().create(rod, position + Vec3{length, 0, 0}, 1);
  }
  ParticleId corner_of(BodyId body) {
    const std::vector<ParticleId> all = system_.bodies().particles(body);
    if (all.empty()) throw std::invalid_argument("it has no particle");
    return all[dice_.below(static_cast<std::uint32_t>(all.size()))];
  }
  void edit(BodyId body, const std::vector<BodyId>& all) {
    Bodies bodies = system_.bodies();
    const BodyId other = all[dice_.below(static_cast<std::uint32_t>(all.size()))];
    const std::vector<ContactPoint> contacts = bodies.contacts(body);
    switch (dice_.below(18)) {
      case 0: return all.size() > 3 ? bodies.destroy(body) : void();
      case 1:
        return all.size() < 12 ? add(size_ * Vec3{dice_.uniform(-0.5, 0.5), 4, dice_.uniform(-0.5, 0.5)}) : void();
      case 2:
        if (!contacts.empty() && !bodies.is_obstacle(contacts[0].other))
          (void)system_.edits().combine(body, contacts[0].other);
        return;
      case 3:
        if (const std::vector<BodyId> parts = bodies.parts(body); parts.size() > 1)
          (void)system_.edits().separate(body, parts[1]);
        return;
      case 4: return bodies.set_kind(body, BodyKind::static_);
      case 5: return bodies.set_kind(body, BodyKind::scripted);
      case 6:
      case 7: return bodies.set_kind(body, BodyKind::dynamic);
      case 8: return bodies.set_kind(body, BodyKind::inactive);
      case 9: return system_.restore(system_.snapshot());
      case 10: return bodies.set_velocity(body, dice_.point(3 * size_));
      case 11: return bodies.set_velocity(body, dice_.point(std::pow(10, dice_.uniform(0, 2.5)) * size_));
      case 12: return bodies.set_angular_velocity(body, dice_.point(std::pow(10, dice_.uniform(0, 2.5))));
      case 13: return bodies.set_material(body, dice_.below(2) == 0 ? std::optional<Material>() : material_);
      case 14: return (void)system_.edits().combine(corner_of(body), corner_of(other));
      case 15: {
        const ParticleId p = corner_of(body), q = corner_of(other);
        return (void)system_.edits().separate(p, q);
      }
      case 16:
        return (void)system_.joints().create(
            DistanceSpec{.kind = dice_.below(2) == 0 ? ConstraintKind::rod : ConstraintKind::rope,
                         .p = corner_of(body),
                         .q = corner_of(other)});
      default: return bodies.set_pose(body, bodies.center_of_mass(body) + dice_.point(0.3 * size_), turn());
    }
  }

  Dice dice_;
  System system_;
  Material material_;
  double size_ = 1, dt_ = 0.01;
};

std::string text_of(const auto&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

}  // namespace

std::optional<std::string> play_heap(std::uint64_t seed, HeapTally& tally) {
  constexpr int steps = 120;
  constexpr double most_solved = 0.02, most_in_sweeps = 0.2;  // of the energy of the heap, from nothing in a step
  Heap heap(seed);
  System& system = heap.system();
  bool was_unsolved = false;
  ++tally.heaps;
  for (int i = 0; i < steps; ++i, ++tally.steps) {
    bool is_edited = false;
    while (heap.chance(3)) {
      is_edited = true, ++tally.edits;
      tally.refused += !heap.edit();
    }
    if (const std::vector<std::string> faults = system.validate(); !faults.empty())
      return text_of("before step ", i, " ", faults.front());
    const Energy before = system.energy();
    const auto places = heap.places();
    const StepReport report = system.step(heap.dt());
    // Two bodies that have fallen far apart may have held a third one between them, which comes back when one is destroyed.
    const bool may_come_back = was_unsolved && is_edited;
    if (!may_come_back && heap.find_shot(places, before.kinetic) != BodyId{})
      return text_of("step ", i, " shoots a body away");
    was_unsolved = report.unconverged > 0;
    tally.unsolved += report.unconverged, tally.approximate += report.approximate;
    if (!std::isfinite(report.energy.total())) return text_of("step ", i, " has no finite energy");
    // Overlaps that are eased out lift bodies, which is in the account of edits: without giving them speed.
    const double risen = report.energy.potential - before.potential;
    const double gained = report.energy.kinetic - before.kinetic - std::max(0.0, -risen) -
                          std::max(0.0, report.energy.external_work - before.external_work) -
                          std::max(0.0, report.energy.edits - before.edits - std::max(0.0, risen));
    const double share = gained / (std::max(report.energy.kinetic, before.kinetic) + heap.least_energy());
    if (!is_edited && report.unconverged == 0 && share > (report.approximate > 0 ? most_in_sweeps : most_solved))
      return text_of("step ", i, " makes a kinetic energy of ", report.energy.kinetic, " J of ", before.kinetic, " J");
    if (!is_edited && share > 0) {
      double& most = report.unconverged > 0   ? tally.gained_unsolved
                     : report.approximate > 0 ? tally.gained_in_sweeps
                                              : tally.gained;
      most = std::max(most, share);
    }
  }
  const Snapshot saved = system.snapshot();
  System copy;
  copy.restore(saved);
  for (int i = 0; i < 10; ++i) (void)system.step(heap.dt()), (void)copy.step(heap.dt());
  if (system.state_hash() != copy.state_hash()) return "a restored copy goes on in another way";
  return std::nullopt;
}

}  // namespace iota::scenes
