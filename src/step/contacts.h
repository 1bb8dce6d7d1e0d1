// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outlines.h"
#include "contact/touches.h"
#include "ingredient/model.h"

#include <vector>

namespace iota::step {

/// Finds the contacts of moving bodies with obstacles at the begin of a step. Both have a material; bodies that are hinged
/// to each other do not touch.
class ContactFinder {
 public:
  /// For a step of h seconds. Costs nothing while no obstacle has a material.
  void find(model::Model&, contact::Outlines&, double h);

 private:
  struct Obstacle {
    std::uint32_t body;
    geometry::Bounds box;
    bool is_half_space;
    Vec3 origin, normal;                 ///< of a half-space
    double distance(const Vec3&) const;  ///< m, at most
  };
  void list_obstacles(model::Model&, contact::Outlines&);
  void find_of(model::Model&, contact::Outlines&, std::uint32_t body, double h);

  contact::TouchFinder touches_;
  // Scratch, kept for its capacity.
  std::vector<Obstacle> obstacles_;
  std::vector<std::uint32_t> near_;
  std::vector<contact::Touch> found_;
  std::vector<ingredient::Contacts::Found> all_;
};

}  // namespace iota::step
