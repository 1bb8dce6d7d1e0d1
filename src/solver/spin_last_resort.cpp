// SPDX-License-Identifier: Apache-2.0
// The motion of what no attempt has solved: see Integrator::coast.
#include "solver/row_masses.h"
#include "solver/spin.h"

namespace iota::solver {

double Spin::move_rigidly(Problem& problem, double h, const Holds& all) {
  constexpr double kept = 0.5;  // of the motion that is not rigid
  begin(problem);
  find_free_clusters(problem, all, clusters_);
  std::vector<Part>& clusters = clusters_.parts;
  const std::span<const std::uint32_t> cluster_of = clusters_.connected.of;
  for (Part& cluster : clusters) {
    cluster.mass = 0, cluster.center = cluster.momentum = cluster.lost = {};
    cluster.is_due = cluster.is_kept;
  }
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    Part& cluster = clusters_.of(a);
    cluster.mass += mass;
    cluster.center += mass * problem.position[a], cluster.momentum += mass * problem.velocity[b];
  });
  turning_bodies_.assign(clusters.size(), {});
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    Part& cluster = clusters[k];
    cluster.is_due = cluster.is_due && cluster.mass > 0;
    if (!cluster.is_due) continue;
    const Vec3 center = (1 / cluster.mass) * cluster.center;
    cluster.center = cluster.holds.pivot().value_or(center);
    turning_bodies_[k].moment = cluster.mass * (center - cluster.center);
  }
  find_motions(problem, clusters_);
  for (const GyroscopicForce& f : problem.items_of<GyroscopicForce>())
    turning_bodies_[cluster_of[f.arm.nodes[0]]].spin += f.spin * f.arm.value(problem.position.data());
  for (std::uint32_t i = 0; i < problem.force.size(); ++i) {
    Part& cluster = clusters_.of(i);
    cluster.lost += problem.force[i];
    turning_bodies_[cluster_of[i]].torque += cross(problem.position[i] - cluster.center, problem.force[i]);
  }
  std::vector<Turned> turned(clusters.size());
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    Part& cluster = clusters[k];
    if (!cluster.is_due) continue;
    TurningBody& body = turning_bodies_[k];
    body.inertia = cluster.inertia, body.angular_momentum = cluster.angular + body.spin;
    turned[k] = turn_rigidly(body, problem.gravity, h);
    cluster.turn = solve_semidefinite(cluster.inertia, cluster.angular, 1e-12);
    cluster.velocity_change = cluster.velocity();
    cluster.momentum += h * (cluster.mass * problem.gravity + cluster.lost);
  }
  double work = 0;
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    const Part& cluster = clusters_.of(i);
    Vec3 &x = problem.position[i], &v = problem.velocity[i];
    if (!cluster.is_due) {
      v *= kept;
      continue;
    }
    const Turned& motion = turned[cluster_of[i]];
    const Vec3 place = x - cluster.center, own = v - cluster.velocity_change - cross(cluster.turn, place);
    const Vec3 arm = rotate(motion.turn, place), before = x;
    x = cluster.center + (0.5 * h) * (cluster.velocity_change + cluster.velocity()) + arm;
    v = cluster.velocity() + cross(motion.turning, arm) + kept * rotate(motion.turn, own);
    if (!problem.force.empty()) work += dot(problem.force[i], x - before);
  }
  // The round-off of places times an extreme turning: points that are almost in one place would get momentum by it.
  std::vector<Vec3> momenta(clusters.size());
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    momenta[cluster_of[a]] += mass * problem.velocity[b];
  });
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    const Part& cluster = clusters_.of(i);
    if (cluster.is_due && cluster.holds.count == 0)
      problem.velocity[i] += (1 / cluster.mass) * (cluster.momentum - momenta[cluster_of[i]]);
  }
  return work;
}

}  // namespace iota::solver
