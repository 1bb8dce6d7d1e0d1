// SPDX-License-Identifier: Apache-2.0
#include <iota/shapes.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace iota {

Mesh height_field(std::span<const double> heights, std::size_t along, std::size_t across, double size_x,
                  double size_z) {
  if (along < 2 || across < 2 || heights.size() / along != across || heights.size() % along != 0)
    throw std::invalid_argument("height_field: heights must be 2 rows of 2 columns or more, not " +
                                std::to_string(along) + " rows of " + std::to_string(across) + " columns");
  for (const double size : {size_x, size_z})
    if (!(std::isfinite(size) && size > 0))
      throw std::invalid_argument("height_field: the size must be two positive lengths, not " + std::to_string(size) +
                                  " m");
  Mesh mesh;
  mesh.vertices.reserve(heights.size());
  for (std::size_t i = 0; i < along; ++i)
    for (std::size_t k = 0; k < across; ++k) {
      const double height = heights[across * i + k];
      if (!std::isfinite(height))
        throw std::invalid_argument("height_field: the height in row " + std::to_string(i) + ", column " +
                                    std::to_string(k) + " is not finite");
      mesh.vertices.push_back({size_x * (static_cast<double>(i) / static_cast<double>(along - 1) - 0.5), height,
                               size_z * (static_cast<double>(k) / static_cast<double>(across - 1) - 0.5)});
    }
  mesh.triangles.reserve(2 * (along - 1) * (across - 1));
  for (std::size_t i = 0; i + 1 < along; ++i)
    for (std::size_t k = 0; k + 1 < across; ++k) {
      const auto here = static_cast<std::uint32_t>(across * i + k), next = static_cast<std::uint32_t>(here + across);
      mesh.triangles.push_back({here, here + 1, next});
      mesh.triangles.push_back({here + 1, next + 1, next});
    }
  return mesh;
}

}  // namespace iota
