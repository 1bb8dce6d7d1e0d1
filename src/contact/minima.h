// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::contact {

/// A place on a curve, as a share of it, and the distance of this place from something.
struct Minimum {
  double share, distance;
};

/// The minimum of a function of one variable between two bounds, by a golden section.
double golden_section(const auto& distance, double low, double high, int steps) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = high - golden * (high - low), b = low + golden * (high - low), at_a = distance(a), at_b = distance(b);
  for (int step = 0; step < steps; ++step) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a, a = high - golden * (high - low), at_a = distance(a);
    } else {
      low = a, a = b, at_a = at_b, b = low + golden * (high - low), at_b = distance(b);
    }
  }
  return at_a < at_b ? a : b;
}

/// How a curve is searched.
struct CurveSearch {
  int samples;
  bool is_closed;
  double limit;  ///< of the distance, m
  double level;  ///< of what changes by less around a closed curve all places are as near, and none is a minimum, m
  int steps = 44;
};

/// The nearest minima of a distance along a curve: at most `Most`. Returns how many there are.
template <int Most>
int find_minima(const auto& distance, const CurveSearch& search, Minimum (&minima)[Most]) {
  constexpr int most_samples = 128;
  constexpr double none = std::numeric_limits<double>::infinity();
  double sampled[most_samples + 1];
  const int count = search.samples, last = search.is_closed ? count - 1 : count;
  for (int k = 0; k <= last; ++k) sampled[k] = distance(static_cast<double>(k) / count);
  const auto [least, most] = std::minmax_element(sampled, sampled + last + 1);
  if (search.is_closed && *most - *least < search.level) return 0;
  int found = 0;
  for (int k = 0; k <= last; ++k) {
    const double before = k > 0 ? sampled[k - 1] : search.is_closed ? sampled[last] : none;
    const double after = k < last ? sampled[k + 1] : search.is_closed ? sampled[0] : none;
    if (!(sampled[k] < before && sampled[k] <= after)) continue;
    double low = (k - 1.0) / count, high = (k + 1.0) / count;
    if (!search.is_closed) low = std::max(low, 0.0), high = std::min(high, 1.0);
    const double share = golden_section(distance, low, high, search.steps), apart = distance(share);
    if (!(apart <= search.limit)) continue;
    if (found < Most) {
      minima[found++] = {share, apart};
      continue;
    }
    Minimum& farthest = *std::max_element(minima, minima + Most,
                                          [](const Minimum& a, const Minimum& b) { return a.distance < b.distance; });
    if (apart < farthest.distance) farthest = {share, apart};
  }
  return found;
}

}  // namespace iota::contact
