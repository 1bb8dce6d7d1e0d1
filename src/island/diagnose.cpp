// SPDX-License-Identifier: Apache-2.0
// Describes the results of the singular value decomposition of an island's constraints.
#include "base/text.h"
#include "island/island.h"

#include <iota/reports.h>

#include <algorithm>
#include <cmath>

namespace iota::island {

using model::Model;

namespace {

constexpr std::size_t most_rows = 600;
constexpr double nearly = 1e-3;  // singular values below it are reported

/// "a, b and 3 more", each once, in order of weight.
std::string enumerate(std::vector<std::pair<double, std::string>> parts) {
  constexpr std::size_t shown = 6;
  double largest = 0;
  for (const auto& part : parts) largest = std::max(largest, part.first);
  for (auto& part : parts) part.first = std::round(10 * part.first / largest);  // equal ones stay in order
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [weight, name] : parts)
    if (weight > 0 && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  if (names.size() > shown) {
    const std::size_t left = names.size() - shown;
    names.resize(shown);
    names.push_back(text(left, " more"));
  }
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

std::string times(std::size_t n) { return n == 1 ? "once" : n == 2 ? "twice" : text(n, " times"); }

}  // namespace

std::string Island::name_of_row(const Model& model, const solver::RowName& row) const {
  std::string name;
  for_each_ingredient([&](const auto& i) {
    if (const solver::ItemKey key = problem_.key_of(row.pool, row.item); key.owner == i.owner)
      name = i.name_of_row(model, key);
  });
  return name;
}

Diagnosis Island::diagnose(const Model& model) const {
  Diagnosis out;
  const std::size_t rows = solver::count_rows_that_hold(problem_);
  if (rows > most_rows)
    throw std::invalid_argument(
        text("diagnose: ", rows, " rows are too many for a dense decomposition, which takes ", most_rows, " at most"));
  const solver::ConstraintSpectrum spectrum = solver::calc_spectrum(problem_);
  const auto& s = spectrum.svd.s;
  out.unknowns = static_cast<std::uint32_t>(spectrum.unknowns);
  out.rows = static_cast<std::uint32_t>(rows), out.rank = static_cast<std::uint32_t>(spectrum.rank);
  out.redundancy = out.rows - out.rank, out.degrees_of_freedom = out.unknowns - out.rank;
  out.singular_values.assign(s.begin(), s.begin() + std::min<std::ptrdiff_t>(out.rows, out.unknowns));
  if (out.rank > 0) out.condition = s.front() / s[out.rank - 1];
  out.kkt_condition = spectrum.kkt_condition();

  if (out.redundancy > 0) {
    out.findings.push_back(
        text(out.rows, " rows have rank ", out.rank, ": the same is said ", times(out.redundancy),
             " too often. How forces share there is arbitrary, and rows that disagree cannot be met."));
    const solver::Dense repeated = spectrum.repeated_rows();
    for (std::size_t k = 0; k < repeated.rows; ++k) {
      std::vector<std::pair<double, std::string>> parts;
      for (std::size_t i = 0; i < rows; ++i)
        if (repeated(k, i) != 0) parts.push_back({std::abs(repeated(k, i)), name_of_row(model, spectrum.names[i])});
      out.findings.push_back("One of these follows from the others: " + enumerate(std::move(parts)) + ".");
    }
  }
  for (std::size_t i = 0; i < spectrum.rank; ++i) {
    if (s[i] > nearly * s.front()) continue;
    std::vector<std::pair<double, std::string>> parts, points;
    for (std::size_t row = 0; row < rows; ++row)
      parts.push_back({std::abs(spectrum.svd.u(row, i)), name_of_row(model, spectrum.names[row])});
    for (std::size_t node = 0; node < problem_.size(); ++node) {
      const Vec3 v{spectrum.svd.v(3 * node, i), spectrum.svd.v(3 * node + 1, i), spectrum.svd.v(3 * node + 2, i)};
      points.push_back({norm(v), ingredient::name_of_ring(model, nodes_.rings[node])});
    }
    out.findings.push_back(text("Nearly singular (", s[i] / s.front(), "): ", enumerate(std::move(parts)),
                                " nearly repeat each other, and hardly resist a motion of ",
                                enumerate(std::move(points)), "."));
  }
  return out;
}

}  // namespace iota::island
