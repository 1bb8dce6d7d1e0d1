// SPDX-License-Identifier: Apache-2.0
#include "neighbors/pair_sum.h"

#include "laws/force_limit.h"

#include <iota/vec3.h>

#include <algorithm>
#include <cmath>

namespace iota::neighbors {

namespace {

// A tenth of the cut-off. With a larger skin every step is slower, with a smaller one the list is rebuilt more often.
constexpr double skin = 0.1;
constexpr std::size_t block = 512;  // pairs; a law's arrays for one block fit in the first-level cache
constexpr std::size_t many = 4096;  // particles, from which on threads are faster

IOTA_WIDER void take_roots(std::size_t count, double* r) {
  for (std::size_t k = 0; k < count; ++k) r[k] = std::sqrt(r[k]);
}
IOTA_WIDER void divide(std::size_t count, double* values, const double* by) {
  for (std::size_t k = 0; k < count; ++k) values[k] /= by[k];
}

}  // namespace

void PairSum::update(const laws::ParticleArrays& p, const Choice& choice, double cutoff) {
  const std::size_t n = p.size();
  const double radius = cutoff * (1 + skin), allowed = cutoff * skin / 2;
  if (built_at_x_.size() == n && built_radius_ == radius) {
    bool near = true;
    for (std::size_t i = 0; i < n; ++i) {
      const double dx = p.x[i] - built_at_x_[i], dy = p.y[i] - built_at_y_[i], dz = p.z[i] - built_at_z_[i];
      near &= dx * dx + dy * dy + dz * dz <= allowed * allowed;
    }
    if (near) return;
  }
  list_.build(p, radius, choice.family, choice.sides);
  built_at_x_ = p.x, built_at_y_ = p.y, built_at_z_ = p.z;
  built_radius_ = radius;
  ++builds_;
}

PairSum::Task PairSum::make_task(const laws::ParticleArrays& p, const laws::PairLaw& law, const double* parameters,
                                 Cutoff cutoff, double t) {
  Task task{p, law, {}, cutoff.at, t, cutoff.shifted, {}};
  for (std::size_t k = 0; k < task.parameters.size(); ++k) task.parameters[k] = parameters + k;
  if (cutoff.shifted) task.at_cutoff = law.elastic({.r = cutoff.at, .t = t}, parameters);
  return task;
}

template <class Work>
std::size_t PairSum::in_parts(const Parallel& parallel, Work work) {
  const std::size_t n = list_.row_count(), count = n < many ? 1 : parts_.size();
  parallel.for_each(count, 1, [&](std::size_t k) { work(parts_[k], k * n / count, (k + 1) * n / count); });
  return count;
}

PairSum::Bad PairSum::add_forces(laws::ParticleArrays& p, const Choice& choice, const laws::PairLaw& law,
                                 const double* parameters, Cutoff cutoff, double t, const Parallel& parallel) {
  update(p, choice, cutoff.at);
  const Task task = make_task(p, law, parameters, cutoff, t);
  const std::size_t n = list_.row_count();
  const std::size_t count = in_parts(parallel, [&](Part& part, std::size_t first, std::size_t last) {
    const auto sums_in = [](auto& of) {
      return Sums{of.fx.data(), of.fy.data(), of.fz.data(), of.tx.data(), of.ty.data(), of.tz.data()};
    };
    const bool has_own = &part != parts_.data();
    if (has_own) {
      for (auto* const f : {&part.fx, &part.fy, &part.fz}) f->assign(n, 0.0);
      if (law.depends_on_normals())
        for (auto* const t : {&part.tx, &part.ty, &part.tz}) t->assign(n, 0.0);
    }
    const Sums sums = has_own ? sums_in(part) : sums_in(p);
    part.bad = {};
    gather<true>(part, task, first, last, [&](std::size_t pairs) { add_block(part, task, pairs, sums); });
  });
  Bad bad;
  for (std::size_t k = 0; k < count; ++k) {
    const Part& part = parts_[k];
    if (part.bad.count > 0 && bad.count == 0) bad.i = part.bad.i, bad.j = part.bad.j;
    bad.count += part.bad.count;
    if (k == 0) continue;
    for (std::size_t i = 0; i < n; ++i) p.fx[i] += part.fx[i];
    for (std::size_t i = 0; i < n; ++i) p.fy[i] += part.fy[i];
    for (std::size_t i = 0; i < n; ++i) p.fz[i] += part.fz[i];
    if (!law.depends_on_normals()) continue;
    for (std::size_t i = 0; i < n; ++i) p.tx[i] += part.tx[i];
    for (std::size_t i = 0; i < n; ++i) p.ty[i] += part.ty[i];
    for (std::size_t i = 0; i < n; ++i) p.tz[i] += part.tz[i];
  }
  return bad;
}

double PairSum::energy(const laws::ParticleArrays& p, const Choice& choice, const laws::PairLaw& law,
                       const double* parameters, Cutoff cutoff, double t, const Parallel& parallel) {
  if (!law.has_energy()) return 0;
  update(p, choice, cutoff.at);
  const Task task = make_task(p, law, parameters, cutoff, t);
  const std::size_t count = in_parts(parallel, [&](Part& part, std::size_t first, std::size_t last) {
    part.energy = {};
    const auto add = [&](std::size_t pairs) { add_energies(part, task, pairs); };
    law.depends_on_mass() || law.depends_on_normals() ? gather<true>(part, task, first, last, add)
                                                      : gather<false>(part, task, first, last, add);
  });
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k)
    for (const double energy : parts_[k].energy) sum += energy;
  return sum;
}

template <bool WithPartners, class Take>
void PairSum::gather(Part& b, const Task& task, std::size_t first, std::size_t last, Take take) const {
  for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r, &b.v, &b.m_p, &b.m_q, &b.force, &b.drag}) a->resize(2 * block);
  if (task.law.depends_on_normals())
    for (auto* const three : {&b.cosines, &b.slopes})
      for (auto& a : *three) a.resize(2 * block);
  b.i.resize(2 * block), b.j.resize(2 * block);
  const double cutoff2 = task.cutoff * task.cutoff;
  const double *const x = task.particles.x.data(), *const y = task.particles.y.data(),
                      *const z = task.particles.z.data();
  std::size_t count = 0;
  for (std::size_t i = first; i < last; ++i) {
    const std::uint32_t* const row = list_.row(i);
    const std::size_t size = list_.row_size(i);
    const double xi = x[i], yi = y[i], zi = z[i];
    for (std::size_t start = 0; start < size; start += block) {
      const std::size_t stop = std::min(size, start + block);
      for (std::size_t k = start; k < stop; ++k) {  // no branch: the next pair overwrites one that is too far
        const std::uint32_t j = row[k];
        const double dx = x[j] - xi, dy = y[j] - yi, dz = z[j] - zi, r2 = dx * dx + dy * dy + dz * dz;
        if constexpr (WithPartners) {
          b.i[count] = static_cast<std::uint32_t>(i), b.j[count] = j;
          b.dx[count] = dx, b.dy[count] = dy, b.dz[count] = dz;
        }
        b.r[count] = r2;
        count += r2 < cutoff2;
      }
      if (count < block) continue;
      take(block);
      count -= block;  // the rest, less than a block, moves to the front
      for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r}) std::copy_n(a->data() + block, count, a->data());
      for (auto* const a : {&b.i, &b.j}) std::copy_n(a->data() + block, count, a->data());
    }
  }
  take(count);
}

/// The inputs of a law, without the rates; the caller sets the arrays for results.
laws::PairBatch PairSum::prepare(Part& b, const Task& task, std::size_t count) {
  const laws::ParticleArrays& p = task.particles;
  take_roots(count, b.r.data());
  if (task.law.depends_on_mass())
    for (std::size_t k = 0; k < count; ++k) b.m_p[k] = p.m[b.i[k]], b.m_q[k] = p.m[b.j[k]];
  if (task.law.depends_on_normals())
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = b.i[k], j = b.j[k];
      b.cosines[0][k] = (p.nx[i] * b.dx[k] + p.ny[i] * b.dy[k] + p.nz[i] * b.dz[k]) / b.r[k];
      b.cosines[1][k] = (p.nx[j] * b.dx[k] + p.ny[j] * b.dy[k] + p.nz[j] * b.dz[k]) / b.r[k];
      b.cosines[2][k] = p.nx[i] * p.nx[j] + p.ny[i] * p.ny[j] + p.nz[i] * p.nz[j];
    }
  return {.count = count,
          .r = b.r.data(),
          .v = b.v.data(),
          .m_p = b.m_p.data(),
          .m_q = b.m_q.data(),
          .cos_p = b.cosines[0].data(),
          .cos_q = b.cosines[1].data(),
          .cos_pq = b.cosines[2].data(),
          .t = task.t,
          .parameters = task.parameters.data(),
          .same_parameters = true};
}

void PairSum::add_energies(Part& b, const Task& task, std::size_t count) {
  constexpr std::size_t lanes = std::tuple_size_v<decltype(b.energy)>;
  laws::PairBatch batch = prepare(b, task, count);
  double* const energy = batch.energy = b.force.data();
  task.law.energies(batch);
  if (task.shifted)
    for (std::size_t k = 0; k < count; ++k)
      energy[k] -= task.at_cutoff.energy + (b.r[k] - task.cutoff) * task.at_cutoff.slope;
  std::fill(energy + count, energy + (count + lanes - 1) / lanes * lanes, 0.0);
  const auto add = [&](auto value) {
    auto sum = b.energy;
    for (std::size_t k = 0; k < count; k += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) sum[lane] += value(energy[k + lane]);
    return sum;
  };
  auto sum = add([](double e) { return e; });
  if (!std::isfinite(sum[0] + sum[1] + sum[2] + sum[3])) [[unlikely]]
    sum = add([](double e) { return std::isfinite(e) ? e : 0; });
  b.energy = sum;
}

void PairSum::add_block(Part& b, const Task& task, std::size_t count, const Sums& sums) {
  const laws::ParticleArrays& p = task.particles;
  laws::PairBatch batch = prepare(b, task, count);
  if (task.law.has_damping())
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = b.i[k], j = b.j[k];
      b.v[k] = (b.dx[k] * (p.vx[j] - p.vx[i]) + b.dy[k] * (p.vy[j] - p.vy[i]) + b.dz[k] * (p.vz[j] - p.vz[i])) / b.r[k];
    }
  batch.force = b.force.data(), batch.drag = b.drag.data();
  batch.slopes = {b.slopes[0].data(), b.slopes[1].data(), b.slopes[2].data()};
  task.law.evaluate(batch);
  if (task.shifted)
    for (std::size_t k = 0; k < count; ++k) b.force[k] += task.at_cutoff.slope;  // f = -U'
  divide(count, b.force.data(), b.r.data());
  if (task.law.depends_on_normals()) return add_turning(b, task, count, sums);

  double *const fx = sums.fx, *const fy = sums.fy, *const fz = sums.fz;
  const bool has_drag = task.law.has_drag();
  for (std::size_t k = 0; k < count;) {  // by rows: the force on the first particle is summed in a register
    const std::uint32_t i = b.i[k];
    double sx = 0, sy = 0, sz = 0;
    for (; k < count && b.i[k] == i; ++k) {
      const std::uint32_t j = b.j[k];
      double x = b.force[k] * b.dx[k], y = b.force[k] * b.dy[k], z = b.force[k] * b.dz[k];
      if (has_drag) {
        const double c = b.drag[k];
        x -= c * (p.vx[j] - p.vx[i]), y -= c * (p.vy[j] - p.vy[i]), z -= c * (p.vz[j] - p.vz[i]);
      }
      if (!laws::is_force(x, y, z)) [[unlikely]] {
        if (b.bad.count++ == 0) b.bad.i = i, b.bad.j = j;
        continue;
      }
      sx += x, sy += y, sz += z;
      fx[j] += x, fy[j] += y, fz[j] += z;
    }
    fx[i] -= sx, fy[i] -= sy, fz[i] -= sz;
  }
}

// With the line u = d / r, a = n_p u, b = n_q u and c = n_p n_q, the energy U(r, a, b, c) pulls at q by
//   -dU/dx_q = -U_r u - (U_a (n_p - a u) + U_b (n_q - b u)) / r
// and turns p by -n_p x (U_a u + U_c n_q), q by -n_q x (U_b u + U_c n_p). These add up to no moment.
void PairSum::add_turning(Part& part, const Task& task, std::size_t count, const Sums& sums) {
  const laws::ParticleArrays& p = task.particles;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = part.i[k], j = part.j[k];
    const Vec3 d{part.dx[k], part.dy[k], part.dz[k]}, u = (1 / part.r[k]) * d;
    const Vec3 n_p{p.nx[i], p.ny[i], p.nz[i]}, n_q{p.nx[j], p.ny[j], p.nz[j]};
    const double a = part.cosines[0][k], b = part.cosines[1][k];
    const double U_a = part.slopes[0][k], U_b = part.slopes[1][k], U_c = part.slopes[2][k];
    Vec3 force = part.force[k] * d - (1 / part.r[k]) * (U_a * (n_p - a * u) + U_b * (n_q - b * u));
    if (task.law.has_drag()) force -= part.drag[k] * Vec3{p.vx[j] - p.vx[i], p.vy[j] - p.vy[i], p.vz[j] - p.vz[i]};
    const Vec3 on_p = -cross(n_p, U_a * u + U_c * n_q), on_q = -cross(n_q, U_b * u + U_c * n_p);
    if (!laws::is_force(force) || !laws::is_force(on_p) || !laws::is_force(on_q)) [[unlikely]] {
      if (part.bad.count++ == 0) part.bad.i = i, part.bad.j = j;
      continue;
    }
    sums.fx[i] -= force.x, sums.fy[i] -= force.y, sums.fz[i] -= force.z;
    sums.fx[j] += force.x, sums.fy[j] += force.y, sums.fz[j] += force.z;
    sums.tx[i] += on_p.x, sums.ty[i] += on_p.y, sums.tz[i] += on_p.z;
    sums.tx[j] += on_q.x, sums.ty[j] += on_q.y, sums.tz[j] += on_q.z;
  }
}

}  // namespace iota::neighbors
