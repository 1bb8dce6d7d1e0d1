// SPDX-License-Identifier: Apache-2.0
#include "contact/apart.h"

#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace iota::contact {

namespace {

/// A gap is larger than the limit by so much of the sizes: the axes that are looked at otherwise find the same with other round-off.
constexpr double surely = 1e-6;

/// All points within a radius of a box, in its frame.
struct RoundedBox {
  std::array<Vec3, 3> axes;
  std::array<double, 3> half;
  double radius;

  RoundedBox(const Box& box, const Quaternion& turn)
      : axes{rotate(turn, {1, 0, 0}), rotate(turn, {0, 1, 0}), rotate(turn, {0, 0, 1})},
        half{0.5 * box.size.x - box.rounding, 0.5 * box.size.y - box.rounding, 0.5 * box.size.z - box.rounding},
        radius(box.rounding) {}
  double extent() const { return half[0] + half[1] + half[2] + radius; }
};

bool is_ball_apart(const RoundedBox& box, const Vec3& way, double radius, double within) {
  const double limit = within + radius + box.radius + surely * (box.extent() + radius);
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beyond = std::max(0.0, std::abs(dot(box.axes[k], way)) - box.half[k]);
    square += beyond * beyond;
  }
  return square > limit * limit;
}

bool are_boxes_apart(const RoundedBox& a, const RoundedBox& b, const Vec3& way, double within) {
  const double limit = within + a.radius + b.radius + surely * (a.extent() + b.extent());
  double across[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) across[i][k] = std::abs(dot(a.axes[i], b.axes[k]));
  for (std::size_t i = 0; i < 3; ++i) {
    const double of_a = a.half[i] + b.half[0] * across[i][0] + b.half[1] * across[i][1] + b.half[2] * across[i][2];
    const double of_b = b.half[i] + a.half[0] * across[0][i] + a.half[1] * across[1][i] + a.half[2] * across[2][i];
    if (std::abs(dot(a.axes[i], way)) - of_a > limit || std::abs(dot(b.axes[i], way)) - of_b > limit) return true;
  }
  return false;
}

}  // namespace

bool are_clearly_apart(const Solid& first, const Solid& second, double within) {
  const Shape &shape = first.form->shape, &other = second.form->shape;
  const auto *const box = std::get_if<Box>(&shape), *const other_box = std::get_if<Box>(&other);
  const auto *const ball = std::get_if<Sphere>(&shape), *const other_ball = std::get_if<Sphere>(&other);
  if (!(box || ball) || !(other_box || other_ball)) return false;
  const Vec3 way = second.position - first.position;
  if (ball && other_ball) {
    const double limit = (1 + surely) * (within + ball->radius + other_ball->radius);
    return dot(way, way) > limit * limit;
  }
  if (ball) return is_ball_apart({*other_box, second.turn}, way, ball->radius, within);
  if (other_ball) return is_ball_apart({*box, first.turn}, way, other_ball->radius, within);
  return are_boxes_apart({*box, first.turn}, {*other_box, second.turn}, way, within);
}

}  // namespace iota::contact
