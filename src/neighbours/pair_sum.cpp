// SPDX-License-Identifier: Apache-2.0
#include "neighbours/pair_sum.h"

#include <algorithm>
#include <cmath>

namespace iota::neighbours {

namespace {

// A tenth of the cut-off: a longer list costs at every step what a shorter one costs when it is made.
constexpr double skin = 0.1;
constexpr std::size_t block = 512;  // pairs; a law's arrays of one block stay in the nearest cache
constexpr std::size_t many = 4096;  // particles, from which on threads pay

}  // namespace

void PairSum::update(const laws::ParticleArrays& p, const std::vector<std::uint32_t>& family, double cutoff) {
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
  list_.build(p, radius, family);
  built_at_x_ = p.x, built_at_y_ = p.y, built_at_z_ = p.z;
  built_radius_ = radius;
  ++builds_;
}

PairSum::Bad PairSum::add_forces(laws::ParticleArrays& p, const std::vector<std::uint32_t>& family,
                                 const laws::PairLaw& law, const double* parameters, double cutoff, double t,
                                 const Parallel& parallel) {
  update(p, family, cutoff);
  Task task{p, law, {}, cutoff, t};
  for (std::size_t k = 0; k < task.parameters.size(); ++k) task.parameters[k] = parameters + k;
  const std::size_t n = list_.row_count(), count = n < many ? 1 : parts_.size();
  parallel.for_each(count, 1, [&](std::size_t k) {
    Part& part = parts_[k];
    if (k > 0)
      for (auto* const f : {&part.fx, &part.fy, &part.fz}) f->assign(n, 0.0);
    double *const fx = k > 0 ? part.fx.data() : p.fx.data(), *const fy = k > 0 ? part.fy.data() : p.fy.data(),
                  *const fz = k > 0 ? part.fz.data() : p.fz.data();
    sum(part, task, k * n / count, (k + 1) * n / count, fx, fy, fz);
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

void PairSum::sum(Part& b, const Task& task, std::size_t first, std::size_t last, double* fx, double* fy,
                  double* fz) const {
  for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r, &b.v, &b.m_p, &b.m_q, &b.force, &b.drag}) a->resize(2 * block);
  b.i.resize(2 * block), b.j.resize(2 * block);
  b.bad = {};
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
      for (std::size_t k = start; k < stop; ++k) {  // no branch: what is too far is overwritten by the next
        const std::uint32_t j = row[k];
        const double dx = x[j] - xi, dy = y[j] - yi, dz = z[j] - zi, r2 = dx * dx + dy * dy + dz * dz;
        b.i[count] = static_cast<std::uint32_t>(i), b.j[count] = j;
        b.dx[count] = dx, b.dy[count] = dy, b.dz[count] = dz, b.r[count] = r2;
        count += r2 < cutoff2;
      }
      if (count < block) continue;
      evaluate(b, task, block, fx, fy, fz);
      count -= block;  // fewer than a block: they move to the front
      for (auto* const a : {&b.dx, &b.dy, &b.dz, &b.r}) std::copy_n(a->data() + block, count, a->data());
      for (auto* const a : {&b.i, &b.j}) std::copy_n(a->data() + block, count, a->data());
    }
  }
  evaluate(b, task, count, fx, fy, fz);
}

void PairSum::evaluate(Part& b, const Task& task, std::size_t count, double* fx, double* fy, double* fz) {
  const laws::ParticleArrays& p = task.particles;
  for (std::size_t k = 0; k < count; ++k) b.r[k] = std::sqrt(b.r[k]);
  if (task.law.has_damping())
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = b.i[k], j = b.j[k];
      b.v[k] = (b.dx[k] * (p.vx[j] - p.vx[i]) + b.dy[k] * (p.vy[j] - p.vy[i]) + b.dz[k] * (p.vz[j] - p.vz[i])) / b.r[k];
    }
  if (task.law.depends_on_mass())
    for (std::size_t k = 0; k < count; ++k) b.m_p[k] = p.m[b.i[k]], b.m_q[k] = p.m[b.j[k]];
  task.law.evaluate({count, b.r.data(), b.v.data(), b.m_p.data(), b.m_q.data(), task.t, task.parameters.data(), true,
                     b.force.data(), b.drag.data()});
  for (std::size_t k = 0; k < count; ++k) b.force[k] /= b.r[k];

  const bool has_drag = task.law.has_drag();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = b.i[k], j = b.j[k];
    double x = b.force[k] * b.dx[k], y = b.force[k] * b.dy[k], z = b.force[k] * b.dz[k];
    if (has_drag) {
      const double c = b.drag[k];
      x -= c * (p.vx[j] - p.vx[i]), y -= c * (p.vy[j] - p.vy[i]), z -= c * (p.vz[j] - p.vz[i]);
    }
    if (!std::isfinite(x + y + z)) [[unlikely]] {
      if (b.bad.count++ == 0) b.bad.i = i, b.bad.j = j;
      continue;
    }
    fx[i] -= x, fy[i] -= y, fz[i] -= z;
    fx[j] += x, fy[j] += y, fz[j] += z;
  }
}

double PairSum::energy(const laws::ParticleArrays& p, const std::vector<std::uint32_t>& family,
                       const laws::PairLaw& law, const double* parameters, double cutoff, double t) {
  if (!law.has_energy()) return 0;
  update(p, family, cutoff);
  double sum = 0;
  for (std::size_t i = 0; i < list_.row_count(); ++i)
    for (std::size_t k = 0; k < list_.row_size(i); ++k) {
      const std::uint32_t j = list_.row(i)[k];
      const double dx = p.x[j] - p.x[i], dy = p.y[j] - p.y[i], dz = p.z[j] - p.z[i], r2 = dx * dx + dy * dy + dz * dz;
      if (r2 < cutoff * cutoff) sum += law.elastic({std::sqrt(r2), 0, t, p.m[i], p.m[j]}, parameters).energy;
    }
  return sum;
}

}  // namespace iota::neighbours
