// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <array>
#include <vector>

namespace iota::held {

/// Bonds of one law in the order of their slots, and arrays for their numbers. Nothing here is saved.
struct BondBatch {
  std::uint32_t law = 0;
  std::vector<std::uint32_t> bonds;
  std::vector<BondId> ids;
  std::vector<double> r, v, m_p, m_q, force, drag;
  std::vector<Vec3> direction, rate;                                                               // from p to q
  std::array<std::vector<double>, laws::max_parameters> parameters;                                // one array each
  std::array<const double*, laws::max_parameters> columns{};                                       // where those begin
  std::vector<double> position_p, position_q, velocity_p, velocity_q, parameter_rows, force_rows;  // of functions

  /// Loads the numbers of all its bonds, with positions extrapolated by `ahead` seconds.
  void load(const model::Model&, double ahead);
  void load_rows(const model::Model&, double ahead);
  /// The numbers from `load`, at a time, without arrays for results.
  laws::PairBatch loaded(double time);
  /// The energy of all its bonds at present, J; only for laws with a derivative. Overwrites the arrays.
  double energy(const model::Model&);
};

/// The bonds that are evaluated once a step and held, and the implicit ones that must be checked; by law.
struct BondBatches {
  void update(const model::Model&);
  void forget() { seen_revision = ~0ull; }

  std::vector<BondBatch> held, watched;
  std::uint64_t seen_revision = ~0ull;
};

}  // namespace iota::held
