// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "laws/pair_law.h"
#include "laws/particle_arrays.h"
#include "neighbors/pair_list.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::neighbors {

/// A law among all pairs nearer than a cut-off. The list of pairs reaches a skin further and is rebuilt when a particle
/// has moved half of that. Pairs beyond the cut-off are skipped, rows are sorted, and many particles are summed in four
/// parts for any number of threads, so the bits do not depend on the time of the list or on the threads.
class PairSum {
 public:
  /// Selects pairs: see PairList::build.
  struct Choice {
    std::span<const std::uint32_t> family{};
    std::span<const std::uint8_t> sides{};
  };
  /// shifted: a constant and a linear term are subtracted from the energy, so that it and the force are zero at the
  /// cut-off. For laws that have an energy and do not depend on masses.
  struct Cutoff {
    Cutoff(double at, bool shifted = false) : at(at), shifted(shifted) {}  // NOLINT(google-explicit-constructor)
    double at;                                                             ///< m
    bool shifted;
  };

  /// Adds the forces to particles.fx, fy, fz, and the torques of a law of normals to particles.tx, ty, tz. Pairs whose force is not finite add nothing; returns their number and
  /// the first of them.
  struct Bad {
    std::size_t count = 0;
    std::uint32_t i = 0, j = 0;
  };
  Bad add_forces(laws::ParticleArrays& particles, const Choice&, const laws::PairLaw& law, const double* parameters,
                 Cutoff cutoff, double t, const Parallel& parallel);

  /// Energy of all pairs within the cut-off, J; 0 for laws without one. A pair whose energy is not finite adds nothing.
  double energy(const laws::ParticleArrays& particles, const Choice&, const laws::PairLaw& law,
                const double* parameters, Cutoff cutoff, double t, const Parallel& parallel);

  std::size_t build_count() const { return builds_; }  ///< for reports

 private:
  /// The arrays in which the forces and torques of a part are summed.
  struct Sums {
    double *fx, *fy, *fz, *tx, *ty, *tz;
  };
  /// A range of rows, with room for a block of pairs and, but for the first part, for sums of its own.
  struct Part {
    std::vector<std::uint32_t> i, j;
    std::vector<double> dx, dy, dz, r, v, m_p, m_q, force, drag;
    std::array<std::vector<double>, 3> cosines, slopes;  ///< of p with the line, of q with the line, of both
    std::vector<double> fx, fy, fz, tx, ty, tz;
    std::array<double, 4> energy;  // used in turn, so that additions do not wait for each other
    Bad bad;
  };
  struct Task {
    const laws::ParticleArrays& particles;
    const laws::PairLaw& law;
    std::array<const double*, laws::max_parameters> parameters;
    double cutoff, t;
    bool shifted;
    laws::Elastic at_cutoff;  ///< subtracted if shifted
  };
  static Task make_task(const laws::ParticleArrays&, const laws::PairLaw&, const double* parameters, Cutoff, double t);
  void update(const laws::ParticleArrays& particles, const Choice&, double cutoff);
  /// Calls work(part, first row, last row) for each part; returns the number of parts.
  template <class Work>
  std::size_t in_parts(const Parallel& parallel, Work work);
  /// Gathers the pairs of these rows that are within the cut-off, and calls `take(count)` for each block of them. For
  /// the energy of most laws distances are sufficient.
  template <bool WithPartners, class Take>
  void gather(Part&, const Task&, std::size_t first, std::size_t last, Take take) const;
  static laws::PairBatch prepare(Part&, const Task&, std::size_t count);
  static void add_block(Part&, const Task&, std::size_t count, const Sums&);
  /// Adds the effects of the normals of the block's pairs: forces across the lines, and torques.
  static void add_turning(Part&, const Task&, std::size_t count, const Sums&);
  static void add_energies(Part&, const Task&, std::size_t count);

  PairList list_;
  std::vector<double> built_at_x_, built_at_y_, built_at_z_;
  double built_radius_ = 0;
  std::size_t builds_ = 0;
  std::array<Part, 4> parts_;
};

}  // namespace iota::neighbors
