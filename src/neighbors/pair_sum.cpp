// SPDX-License-Identifier: Apache-2.0
#include "neighbors/pair_sum.h"

#include "laws/force_limit.h"

#include <algorithm>
#include <cmath>

namespace iota::neighbors {

namespace {

// A tenth of the cut-off. A larger skin makes every step slower, a smaller one rebuilds the list more often.
constexpr double skin = 0.1;
constexpr std::size_t block = 512;  // pairs; a law's arrays of one block stay in the nearest cache
constexpr std::size_t many = 4096;  // particles, from which on threads pay

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
    const bool has_own = &part != parts_.data();
    if (has_own)
      for (auto* const f : {&part.fx, &part.fy, &part.fz}) f->assign(n, 0.0);
    double *const fx = has_own ? part.fx.data() : p.fx.data(), *const fy = has_own ? part.fy.data() : p.fy.data(),
                  *const fz = has_own ? part.fz.data() : p.fz.data();
    part.bad = {};
    gather<true>(part, task, first, last, [&](std::size_t pairs) { add_block(part, task, pairs, fx, fy, fz); });
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
    law.depends_on_mass() ? gather<true>(part, task, first, last, add) : gather<false>(part, task, first, last, add);
  });
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k)
    for (const double energy : parts_[k].energy) sum += energy;
  return sum;
}

template <bool WithPartners, class Take>
void PairSum::gather(Part& b, const Task& task, std::size_t first, std::size_t last, Take take) const {
  for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r, &b.v, &b.m_p, &b.m_q, &b.force, &b.drag}) a->resize(2 * block);
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
      count -= block;  // fewer than a block: they move to the front
      for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r}) std::copy_n(a->data() + block, count, a->data());
      for (auto* const a : {&b.i, &b.j}) std::copy_n(a->data() + block, count, a->data());
    }
  }
  take(count);
}

/// The inputs of a law, without the rates; the caller sets where results go.
laws::PairBatch PairSum::prepare(Part& b, const Task& task, std::size_t count) {
  const laws::ParticleArrays& p = task.particles;
  take_roots(count, b.r.data());
  if (task.law.depends_on_mass())
    for (std::size_t k = 0; k < count; ++k) b.m_p[k] = p.m[b.i[k]], b.m_q[k] = p.m[b.j[k]];
  return {.count = count,
          .r = b.r.data(),
          .v = b.v.data(),
          .m_p = b.m_p.data(),
          .m_q = b.m_q.data(),
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

void PairSum::add_block(Part& b, const Task& task, std::size_t count, double* fx, double* fy, double* fz) {
  const laws::ParticleArrays& p = task.particles;
  laws::PairBatch batch = prepare(b, task, count);
  if (task.law.has_damping())
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = b.i[k], j = b.j[k];
      b.v[k] = (b.dx[k] * (p.vx[j] - p.vx[i]) + b.dy[k] * (p.vy[j] - p.vy[i]) + b.dz[k] * (p.vz[j] - p.vz[i])) / b.r[k];
    }
  batch.force = b.force.data(), batch.drag = b.drag.data();
  task.law.evaluate(batch);
  if (task.shifted)
    for (std::size_t k = 0; k < count; ++k) b.force[k] += task.at_cutoff.slope;  // f = -U'
  divide(count, b.force.data(), b.r.data());

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

}  // namespace iota::neighbors
