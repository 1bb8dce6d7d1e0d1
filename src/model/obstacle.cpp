// SPDX-License-Identifier: Apache-2.0
#include "model/obstacle.h"

namespace iota::model {

void make_obstacle(Structure& model, std::uint32_t body, const shape::Data& shape, const SolidPose& pose) {
  Solid solid;
  solid.body = body, solid.shape = shape;
  (void)append_solid(model, solid);
  move_obstacle(model, body, pose);
}

void move_obstacle(Structure& model, std::uint32_t body, const SolidPose& pose) {
  model.obstacles.make(body) = {pose.position, pose.orientation};
  model.note_body(body);
}

}  // namespace iota::model
