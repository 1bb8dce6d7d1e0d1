// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/surface.h"
#include "solver/constraints/arms.h"

namespace iota::solver {

/// Two surfaces, each fixed in a body or in the world, touch, or, with a one-sided multiplier, do not overlap.
///   constraint  g = signed distance along the common normal n   (m): positive apart, negative overlapping
/// gradient +-n at the two nearest points, as points of the bodies (envelope theorem: the motion of these points
/// does not matter); no Hessian: Newton's method does not need this second-order part. The nearest points p on A and q =
/// p + g n on B solve phi_A(p) = 0, phi_B(q) = 0, grad phi_A || -grad phi_B, by Newton's method from those of the last
/// `track`: unlike the least distance, this stays regular while the surfaces touch. A surface with sharp edges, which
/// have no normals, is replaced by another surface of constant phi, farther out by its skin and rounded; the gap is
/// then measured to that and the skin added, which is exact for convex shapes. Arms: 0: d = origin of B - origin of A;
/// 1 ... 3: axes of A; 4 ... 6: axes of B (orthonormal). The multiplier is the normal force, N, positive if it pulls
/// the bodies together: a one-sided pair has upper = 0.
struct SurfacePairConstraint : ArmConstraint<SurfacePairConstraint, 1, 7> {
  static constexpr bool has_curvature = false;

  const shape::Surface *surface_a = nullptr, *surface_b = nullptr;
  Vec3 nearest;  ///< p at the last `track`, in A's frame
  double reference = 1;

  double reference_length() const { return reference; }
  /// Searches the nearest points without a guess.
  void start(const Vec3* x, double fraction);
  void track(const Vec3* x, double fraction);

  void calc_value(const Vec3* e, double fraction, double* g) const;
  void calc_gradient(const Vec3* e, Vec3 (*d)[7]) const;
  /// As that of PlaceConstraint, by the place and the turn of B in A's frame.
  void mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const;
  /// The second derivative of g along the velocities v of the nodes at x, m/s^2: accelerations need it.
  double bend(const Vec3* x, const Vec3* v) const;

 private:
  struct Nearest {
    Vec3 p, q, normal;     // of A, in A's frame
    double gap;            // between the surfaces, without skins
    Vec3 place, gradient;  // of q and of phi_B, in B's frame
  };
  /// The derivatives of the gap by the place t and the turn R of B in A's frame. Those by the arms are sums over them.
  struct ByRelative {
    double by_place[3], by_turn[3][3];
  };
  Nearest find(const Vec3* e, const Vec3& near) const;
  ByRelative by_relative(const Vec3* e, double* gap) const;
  static void by_arms(const Vec3* e, const ByRelative& by, Vec3* d);
  bool is_nowhere() const { return !surface_a->failure().empty() || !surface_b->failure().empty(); }
};

}  // namespace iota::solver
