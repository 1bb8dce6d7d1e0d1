// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/touch.h"

#include <span>
#include <vector>

namespace iota::contact {

/// Whether two touches are points of one rim that lies on one plane.
bool are_on_one_rim(const Touch&, const Touch&);

/// Appends touches of points of a rim beside its load. A fine grid on the rim names them: they hold by friction while the load stays
/// between them, and the one that carries stays when the load goes past it.
class PointsOfRim {
 public:
  /// touches: those of its fixed points, with others; one: of them.
  PointsOfRim(std::span<const Touch> touches, const Touch& one, std::vector<Touch>& added)
      : touches_(touches), one_(one), added_(added) {}

  /// The two beside a load, if it is not well within the fixed points. load: where the rim carries it, from its middle.
  void add_beside(const Vec3& load);
  /// One that has carried, if the feature is one of this rim.
  void add_again(std::uint32_t feature);

 private:
  void add(std::uint32_t place);

  std::span<const Touch> touches_;
  const Touch& one_;
  std::vector<Touch>& added_;
};

}  // namespace iota::contact
