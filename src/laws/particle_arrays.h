// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace iota::laws {

/// Many particles as plain arrays, one for each component, so that loops over them are vectorized.
struct ParticleArrays {
  std::vector<double> x, y, z, vx, vy, vz, m;  ///< m, m/s, kg
  std::vector<double> fx, fy, fz;              ///< N
  std::vector<double> nx, ny, nz;              ///< unit normals, of oriented particles; or empty
  std::vector<double> tx, ty, tz;              ///< beside normals: N m

  std::size_t size() const { return x.size(); }
  void resize(std::size_t n) {
    for (auto* const a : {&x, &y, &z, &vx, &vy, &vz, &m, &fx, &fy, &fz}) a->resize(n);
  }
  void resize_with_normals(std::size_t n) {
    resize(n);
    for (auto* const a : {&nx, &ny, &nz, &tx, &ty, &tz}) a->resize(n);
  }
};

}  // namespace iota::laws
