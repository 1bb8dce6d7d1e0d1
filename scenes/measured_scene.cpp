// SPDX-License-Identifier: Apache-2.0
#include "scenes/measured_scene.h"

#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace iota::scenes {

MeasuredScene::MeasuredScene(std::uint64_t seed, IntegrationMode mode_, const MeasuredSceneOptions& options)
    : dice_{seed},
      length(std::pow(10, dice_.uniform(-3, 3))),
      mass(std::pow(10, dice_.uniform(-3, 3))),
      time(std::sqrt(length)),
      dt(time / dice_.uniform(60, 240)),
      mode(mode_),
      system({.gravity = options.gravity ? Vec3{0, -gravity, 0} : Vec3{}, .mode = mode_}),
      options_(options) {
  drift_ = dice_.point(length / time), turning_ = dice_.point(2 / time);
  switch (static_cast<Kind>(dice_.below(static_cast<std::uint32_t>(Kind::count)))) {
    case Kind::tree: add_tree(); break;
    case Kind::ring: add_ring(); break;
    case Kind::net: add_net(); break;
    case Kind::solids: add_solids(); break;
    case Kind::count: break;
  }
  if (options_.nailed && dice_.below(2) == 0) system.particles().nail(particles.front());
  if (options_.springs) add_springs();
}

void MeasuredScene::add_tree() {
  const std::uint32_t count = 2 + dice_.below(6);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t old = i == 0 ? 0 : any_particle(), first = particles.size();
    std::vector<Vec3> corners{i == 0 ? Vec3{} : place(old)};
    const std::uint32_t more = 1 + dice_.below(3);
    for (std::uint32_t k = 0; k < more; ++k) corners.push_back(corners.front() + length * any_direction());
    add_body(corners);
    if (i > 0) combine(old, first);
  }
}

void MeasuredScene::add_ring() {
  const std::uint32_t count = 3 + dice_.below(6);
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    corners.push_back(length * (Vec3{std::cos(angle), std::sin(angle), 0} + dice_.point(0.3)));
  }
  std::vector<std::size_t> firsts;
  for (std::uint32_t i = 0; i < count; ++i) {
    firsts.push_back(particles.size());
    std::vector<Vec3> own{corners[i], corners[(i + 1) % count]};
    const std::uint32_t more = dice_.below(3);
    for (std::uint32_t k = 0; k < more; ++k) own.push_back(own.front() + length * any_direction());
    add_body(own);
  }
  for (std::uint32_t i = 0; i < count; ++i) combine(firsts[i] + 1, firsts[(i + 1) % count]);
}

void MeasuredScene::add_net() {
  const std::size_t rows = 2 + dice_.below(4), columns = 2 + dice_.below(4);
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<Vec3> knots;
  std::vector<std::size_t> knot(rows * columns, none);  // one particle of each
  for (std::size_t k = 0; k < knot.size(); ++k)
    knots.push_back(length *
                    (Vec3{static_cast<double>(k % columns), 0, static_cast<double>(k / columns)} + dice_.point(0.2)));
  const auto link = [&](std::size_t a, std::size_t b) {
    const std::size_t first = particles.size();
    add_body({knots[a], knots[b]});
    for (const auto& [at, end] : {std::pair{a, first}, {b, first + 1}})
      if (knot[at] == none)
        knot[at] = end;
      else
        combine(knot[at], end);
  };
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t k = row * columns + column;
      if (column + 1 < columns) link(k, k + 1);
      if (row + 1 < rows) link(k, k + columns);
    }
}

void MeasuredScene::add_solids() {
  const std::uint32_t count = 2 + dice_.below(4);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t old = i == 0 ? 0 : any_particle(), first = particles.size();
    add_box(i == 0 ? Vec3{} : place(old));
    if (i > 0) combine(old, first);
  }
}

/// A body of point masses.
void MeasuredScene::add_body(const std::vector<Vec3>& corners) {
  const BodyId body = system.bodies().create();
  bodies.emplace_back();
  for (const Vec3& at : corners) {
    masses.push_back(mass * std::pow(10, dice_.uniform(-1, 1)));
    bodies.back().push_back(particles.size());
    particles.push_back(system.particles().create(body, at, masses.back(), any_velocity(at)));
  }
}

/// A box with a corner at `hinge`, its first particle. A sixth of its mass at the middle of each face has the same mass,
/// center and inertia (m/12 (b^2 + c^2) about an axis), so these points measure it.
void MeasuredScene::add_box(const Vec3& hinge) {
  const double own_mass = mass * std::pow(10, dice_.uniform(-1, 1));
  const auto edge = [&] { return length * std::pow(10, dice_.uniform(-1, 0)); };
  const Vec3 size{edge(), edge(), edge()};
  const Vec3 axis = any_direction();
  const double half_turn = dice_.uniform(0, 2);
  const Vec3 imaginary = (std::sin(half_turn) / norm(axis)) * axis;
  const Quaternion orientation{imaginary.x, imaginary.y, imaginary.z, std::cos(half_turn)};
  std::vector<Vec3> points{0.5 * size};
  for (const double side : {-0.5, 0.5})
    for (const Vec3& middle : {Vec3{size.x, 0, 0}, Vec3{0, size.y, 0}, Vec3{0, 0, size.z}})
      points.push_back(side * middle);
  const BodyId body = system.bodies().create(Box{.size = size}, {.mass = own_mass,
                                                                 .position = hinge - rotate(orientation, points[0]),
                                                                 .orientation = orientation,
                                                                 .velocity = any_velocity(hinge),
                                                                 .spin = dice_.point(3 / time),
                                                                 .attachments = points});
  const std::vector<ParticleId> all = system.bodies().particles(body);
  bodies.emplace_back();
  for (std::size_t k = 0; k < points.size(); ++k) {
    bodies.back().push_back(particles.size());
    particles.push_back(all[all.size() - points.size() + k]);
    masses.push_back(k == 0 ? 0 : own_mass / 6);
  }
}

void MeasuredScene::add_springs() {
  const std::uint32_t count = dice_.below(3);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::size_t p = any_particle(), q = any_particle();
    const double apart = norm(place(p) - place(q)), stiffness = mass * gravity / length * dice_.uniform(1, 20);
    if (!(apart > 0.3 * length)) continue;
    springs_.push_back({p, q, stiffness, apart});
    if (options_.swapped) std::swap(p, q);
    (void)system.bonds().create(particles[p], particles[q], SpringLaw{.stiffness = stiffness, .length = apart});
  }
}

Vec3 MeasuredScene::any_direction() {
  const Vec3 d = dice_.point(1);
  return (1 / (norm(d) + 1e-3)) * d + Vec3{0, 0, 0.1};
}

void MeasuredScene::combine(std::size_t p, std::size_t q) {
  if (options_.swapped) std::swap(p, q);
  (void)system.edits().combine(particles[p], particles[q]);
}

namespace {

/// of(p, q) for all pairs of a body's particles.
template <class Function>
std::vector<double> of_pairs(const std::vector<std::size_t>& body, Function of) {
  std::vector<double> values;
  for (std::size_t i = 0; i < body.size(); ++i)
    for (std::size_t k = i + 1; k < body.size(); ++k) values.push_back(of(body[i], body[k]));
  return values;
}

}  // namespace

std::vector<double> MeasuredScene::lengths(const std::vector<std::size_t>& body) const {
  return of_pairs(body, [&](std::size_t p, std::size_t q) { return norm(place(q) - place(p)); });
}

std::vector<double> MeasuredScene::stretch_rates(const std::vector<std::size_t>& body) const {
  return of_pairs(body, [&](std::size_t p, std::size_t q) {
    const Vec3 d = place(q) - place(p);
    return dot(d, velocity(q) - velocity(p)) / norm(d);
  });
}

double MeasuredScene::kinetic() const {
  double sum = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) sum += 0.5 * masses[i] * dot(velocity(i), velocity(i));
  return sum;
}

double MeasuredScene::potential() const {
  double sum = 0;
  for (std::size_t i = 0; options_.gravity && i < particles.size(); ++i) sum += masses[i] * gravity * place(i).y;
  for (const Spring& s : springs_) {
    const double stretch = norm(place(s.p) - place(s.q)) - s.length;
    sum += 0.5 * s.stiffness * stretch * stretch;
  }
  return sum;
}

double MeasuredScene::total_mass() const {
  double sum = 0;
  for (const double m : masses) sum += m;
  return sum;
}

Vec3 MeasuredScene::momentum() const {
  Vec3 sum;
  for (std::size_t i = 0; i < particles.size(); ++i) sum += masses[i] * velocity(i);
  return sum;
}

Vec3 MeasuredScene::angular_momentum() const {
  Vec3 sum;
  for (std::size_t i = 0; i < particles.size(); ++i) sum += masses[i] * cross(place(i), velocity(i));
  return sum;
}

double MeasuredScene::speed() const {
  double most = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) most = std::max(most, norm(velocity(i)));
  return most;
}

double MeasuredScene::extent() const {
  double most = length;
  for (std::size_t i = 0; i < particles.size(); ++i) most = std::max(most, norm(place(i)));
  return most;
}

}  // namespace iota::scenes
