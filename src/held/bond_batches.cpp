// SPDX-License-Identifier: Apache-2.0
#include "held/bond_batches.h"

#include <algorithm>
#include <cmath>

namespace iota::held {

namespace {

/// Laws with a finite force at any distance, which need no check.
bool is_finite_everywhere(const ingredient::Law& law) {
  return law.kind == ingredient::LawKind::listed &&
         (law.number == ingredient::spring_law || law.number == ingredient::drag_law ||
          law.number == laws::find_pair_law("dashpot") || law.number == laws::find_pair_law("tether") ||
          law.number == laws::find_pair_law("soft_repulsion"));
}

void put(double* out, std::size_t row, const Vec3& v) {
  out[3 * row] = v.x, out[3 * row + 1] = v.y, out[3 * row + 2] = v.z;
}

}  // namespace

void BondBatches::update(const model::Model& model) {
  if (seen_revision == model.bonds_revision) return;
  seen_revision = model.bonds_revision;
  held.clear(), watched.clear();
  std::vector<std::uint32_t> index_of_held(model.laws.slot_count(), model::none), index_of_watched = index_of_held;
  const auto put = [&](std::vector<BondBatch>& batches, std::uint32_t& index, std::uint32_t slot, std::uint32_t law) {
    if (index == model::none) {
      index = static_cast<std::uint32_t>(batches.size());
      batches.emplace_back().law = law;
    }
    batches[index].bonds.push_back(slot);
    batches[index].ids.push_back(model.bonds.id(slot));
  };
  model.bonds.for_each([&](std::uint32_t slot, const ingredient::Bond& bond) {
    if (!bond.acts()) return;
    if (bond.law == ingredient::scripted_law) return;
    if (!bond.implicit)
      put(held, index_of_held[bond.law], slot, bond.law);
    else if (!is_finite_everywhere(model.laws[bond.law]))
      put(watched, index_of_watched[bond.law], slot, bond.law);
  });
  const auto by_law = [](const BondBatch& a, const BondBatch& b) { return a.law < b.law; };
  std::sort(held.begin(), held.end(), by_law);
  std::sort(watched.begin(), watched.end(), by_law);
}

void BondBatch::load(const model::Model& model, double ahead) {
  const std::size_t n = bonds.size();
  for (auto* const column : {&r, &v, &m_p, &m_q, &force, &drag}) column->resize(n);
  direction.resize(n), rate.resize(n);
  const std::uint32_t count = model.laws[law].parameter_count;
  for (std::uint32_t k = 0; k < count; ++k) parameters[k].resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const ingredient::Bond& bond = model.bonds[bonds[i]];
    const model::Particle &p = model.particles[bond.p], &q = model.particles[bond.q];
    const model::Ring &from = model.rings[p.ring], &to = model.rings[q.ring];
    const Vec3 rate_now = to.velocity - from.velocity;
    const Vec3 d = to.position - from.position + ahead * rate_now;
    rate[i] = rate_now + ahead * (to.acceleration - from.acceleration);
    r[i] = norm(d);
    direction[i] = (1 / (r[i] + 1e-300)) * d;
    v[i] = dot(direction[i], rate[i]);
    m_p[i] = p.mass, m_q[i] = q.mass;
    for (std::uint32_t k = 0; k < count; ++k) parameters[k][i] = bond.parameters[k];
  }
}

laws::PairBatch BondBatch::loaded(double time) {
  for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = parameters[k].data();
  return {.count = bonds.size(),
          .r = r.data(),
          .v = v.data(),
          .m_p = m_p.data(),
          .m_q = m_q.data(),
          .t = time,
          .parameters = columns.data()};
}

void BondBatch::load_rows(const model::Model& model, double ahead) {
  const std::size_t n = bonds.size(), count = model.laws[law].parameter_count;
  for (auto* const rows : {&position_p, &position_q, &velocity_p, &velocity_q, &force_rows}) rows->resize(3 * n);
  parameter_rows.resize(n * count);
  for (std::size_t i = 0; i < n; ++i) {
    const ingredient::Bond& bond = model.bonds[bonds[i]];
    const model::Ring &p = model.rings[model.particles[bond.p].ring], &q = model.rings[model.particles[bond.q].ring];
    put(position_p.data(), i, p.position + ahead * p.velocity);
    put(position_q.data(), i, q.position + ahead * q.velocity);
    put(velocity_p.data(), i, p.velocity + ahead * p.acceleration);
    put(velocity_q.data(), i, q.velocity + ahead * q.acceleration);
    for (std::size_t k = 0; k < count; ++k) parameter_rows[i * count + k] = bond.parameters[k];
  }
}

double BondBatch::energy(const model::Model& model) {
  const laws::PairLaw& compiled = model.compiled(law);
  if (!compiled.has_energy()) return 0;
  load(model, 0);
  laws::PairBatch numbers = loaded(model.time);
  numbers.energy = force.data();
  compiled.energies(numbers);
  double sum = 0;
  for (const double one : force)
    if (std::isfinite(one)) sum += one;
  return sum;
}

}  // namespace iota::held
