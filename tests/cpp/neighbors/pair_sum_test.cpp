// SPDX-License-Identifier: Apache-2.0
#include "neighbors/pair_sum.h"

#include "tests/cpp/neighbors/cloud.h"

#include <iota/vec3.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace iota::neighbors {
namespace {

const Parallel one(1), two(2);

TEST(PairSum, is_the_sum_over_all_pairs) {
  const laws::PairLaw listed(laws::find_pair_law("lennard_jones"));
  const laws::PairLaw written("energy = 4*e*((s/r)^12 - (s/r)^6); force = -c*v; drag = 0.1*m_p*m_q", {"e", "s", "c"});
  const double parameters[laws::max_parameters] = {1.2, 0.05, 0.3};
  for (const laws::PairLaw* const law : {&listed, &written}) {
    laws::ParticleArrays p = cloud(500, 0.5, 5), slow = p;
    PairSum sum;
    const auto bad = sum.add_forces(p, {}, *law, parameters, 0.25, 0, one);
    EXPECT_EQ(bad.count, 0u);
    double energy = 0, total = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t j = i + 1; j < p.size(); ++j) {
        const double r = std::sqrt(distance2(slow, i, j));
        if (!(r < 0.25)) continue;
        const Vec3 d{slow.x[j] - slow.x[i], slow.y[j] - slow.y[i], slow.z[j] - slow.z[i]};
        const Vec3 u{slow.vx[j] - slow.vx[i], slow.vy[j] - slow.vy[i], slow.vz[j] - slow.vz[i]};
        const laws::PairState s{r, dot(d, u) / r, 0, slow.m[i], slow.m[j]};
        const double f = law->damping(s, parameters).value - law->elastic(s, parameters).slope;
        const Vec3 on_j = (f / r) * d - law->drag(s, parameters) * u;
        slow.fx[j] += on_j.x, slow.fy[j] += on_j.y, slow.fz[j] += on_j.z;
        slow.fx[i] -= on_j.x, slow.fy[i] -= on_j.y, slow.fz[i] -= on_j.z;
        energy += law->elastic(s, parameters).energy;
      }
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(p.fx[i], slow.fx[i], 1e-11 * (1 + std::abs(slow.fx[i])));
      EXPECT_NEAR(p.fz[i], slow.fz[i], 1e-11 * (1 + std::abs(slow.fz[i])));
      total += std::abs(p.fx[i]);
    }
    EXPECT_GT(total, 1);
    EXPECT_NEAR(sum.energy(p, {}, *law, parameters, 0.25, 0, one), energy, 1e-9 * std::abs(energy));
  }
}

TEST(PairSum, of_normals_pushes_and_turns_by_the_slope_of_its_energy) {
  const laws::PairLaw law("energy = k*(1 - r/w)^2*(cos_p^2 + 0.5*cos_q^2 + cos_p*cos_q - 0.7*cos_pq + 0.3*cos_pq^2)",
                          {"k", "w"});
  ASSERT_TRUE(law.depends_on_normals());
  const double parameters[laws::max_parameters] = {3, 0.9}, cutoff = 0.9;
  laws::ParticleArrays p = cloud(40, 0.5, 11);
  p.resize_with_normals(40);
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 n{normal(random), normal(random), normal(random)};
    p.nx[i] = n.x / norm(n), p.ny[i] = n.y / norm(n), p.nz[i] = n.z / norm(n);
  }
  PairSum sum;
  EXPECT_EQ(sum.add_forces(p, {}, law, parameters, cutoff, 0, one).count, 0u);
  const auto energy = [&] { return PairSum().energy(p, {}, law, parameters, cutoff, 0, one); };
  constexpr double step = 1e-5;
  Vec3 force, moment;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto slope_at = [&](double& x) {
      const double before = x;
      x = before + step;
      const double above = energy();
      x = before - step;
      const double below = energy();
      x = before;
      return (above - below) / (2 * step);
    };
    EXPECT_NEAR(p.fx[i], -slope_at(p.x[i]), 1e-6);
    EXPECT_NEAR(p.fy[i], -slope_at(p.y[i]), 1e-6);
    EXPECT_NEAR(p.fz[i], -slope_at(p.z[i]), 1e-6);
    // A turn about z moves the normal by (-ny, nx, 0): the torque is the slope along that, against the energy.
    const Vec3 n{p.nx[i], p.ny[i], p.nz[i]};
    const Vec3 slope{slope_at(p.nx[i]), slope_at(p.ny[i]), slope_at(p.nz[i])};
    const Vec3 torque = -cross(n, slope);
    EXPECT_NEAR(p.tx[i], torque.x, 1e-6);
    EXPECT_NEAR(p.ty[i], torque.y, 1e-6);
    EXPECT_NEAR(p.tz[i], torque.z, 1e-6);
    const Vec3 f{p.fx[i], p.fy[i], p.fz[i]};
    force += f;
    moment += cross(Vec3{p.x[i], p.y[i], p.z[i]}, f) + Vec3{p.tx[i], p.ty[i], p.tz[i]};
  }
  EXPECT_LT(norm(force), 1e-12);
  EXPECT_LT(norm(moment), 1e-12);
}

TEST(PairSum, of_normals_has_the_same_bits_by_any_number_of_threads) {
  const laws::PairLaw law("energy = (1 - r/0.3)^2*(cos_p^2 + cos_q^2 - cos_pq)", {});
  laws::ParticleArrays p = cloud(6000, 1.4, 6);
  p.resize_with_normals(6000);
  std::fill(p.nz.begin(), p.nz.end(), 1.0);
  laws::ParticleArrays q = p;
  (void)PairSum().add_forces(p, {}, law, nullptr, 0.3, 0, one);
  (void)PairSum().add_forces(q, {}, law, nullptr, 0.3, 0, two);
  EXPECT_EQ(p.fx, q.fx);
  EXPECT_EQ(p.tx, q.tx);
}

TEST(PairSum, has_an_energy_with_the_same_bits_too) {
  const laws::PairLaw law(laws::find_pair_law("lennard_jones"));
  const double parameters[laws::max_parameters] = {1, 0.1};
  laws::ParticleArrays p = cloud(6000, 1.4, 6);
  PairSum kept;
  for (int step = 0; step < 10; ++step) {
    EXPECT_EQ(kept.energy(p, {}, law, parameters, 0.25, 0, one),
              PairSum().energy(p, {}, law, parameters, 0.25, 0, Parallel(3)));
    for (std::size_t i = 0; i < p.size(); ++i) p.x[i] += 0.002 * p.vx[i], p.y[i] += 0.002 * p.vy[i];
  }
  p.x[7] = p.x[8], p.y[7] = p.y[8], p.z[7] = p.z[8];
  EXPECT_TRUE(std::isfinite(kept.energy(p, {}, law, parameters, 0.25, 0, one))) << "what is infinite is left out";
}

TEST(PairSum, has_the_same_bits_whenever_its_list_was_made_and_by_how_many_threads) {
  const laws::PairLaw law(laws::find_pair_law("soft_repulsion"));
  const double parameters[laws::max_parameters] = {100, 0.3};
  laws::ParticleArrays p = cloud(6000, 1.4, 6);
  PairSum kept;
  for (int step = 0; step < 40; ++step) {
    PairSum fresh;
    laws::ParticleArrays q = p;
    (void)kept.add_forces(p, {}, law, parameters, 0.3, 0, one);
    (void)fresh.add_forces(q, {}, law, parameters, 0.3, 0, two);
    ASSERT_EQ(p.fx, q.fx);
    ASSERT_EQ(p.fz, q.fz);
    for (std::size_t i = 0; i < p.size(); ++i) {
      p.x[i] += 0.002 * p.vx[i], p.y[i] += 0.002 * p.vy[i], p.z[i] += 0.002 * p.vz[i];
      p.fx[i] = p.fy[i] = p.fz[i] = 0;
    }
  }
  EXPECT_LT(kept.build_count(), 20u);
  EXPECT_GT(kept.build_count(), 2u);
}

TEST(PairSum, passes_over_pairs_without_a_finite_force_and_counts_them) {
  const laws::PairLaw law(laws::find_pair_law("lennard_jones"));
  const double parameters[laws::max_parameters] = {1, 0.1};
  laws::ParticleArrays p = cloud(50, 0.5, 7);
  p.x[9] = p.x[4], p.y[9] = p.y[4], p.z[9] = p.z[4];
  PairSum sum;
  const auto bad = sum.add_forces(p, {}, law, parameters, 0.3, 0, one);
  EXPECT_EQ(bad.count, 1u);
  EXPECT_EQ(bad.i, 4u);
  EXPECT_EQ(bad.j, 9u);
  for (const double f : p.fx) EXPECT_TRUE(std::isfinite(f));
}

}  // namespace
}  // namespace iota::neighbors
