// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_readings.h"

#include "base/sort_unique.h"
#include "ingredient/joint_forms.h"
#include "ingredient/model.h"
#include "ingredient/row_loads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace iota::ingredient {

using namespace joint;

namespace {

/// visit(row, places): the row of a coordinate at the present places; an angle is unwrapped near the last one.
template <class Visit>
void with_placed_coordinate(const Model& model, std::uint32_t slot, JointCoordinate which, Visit visit) {
  const Constraint& c = model.constraints[slot];
  const JointPlaces places(model, c);
  with_coordinate({c, model.geometry(slot), places.arms}, which, [&](auto row) {
    set_target(row, c.coordinate[static_cast<std::size_t>(which)], 0);
    visit(std::as_const(row), places);
  });
}

}  // namespace

void refresh_coordinates(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  for (const JointCoordinate which : joint_coordinates) {
    if (!has_coordinate(c.kind, which)) continue;
    double value = 0;
    with_placed_coordinate(model, slot, which, [&](const auto& row, const JointPlaces& places) {
      row.value(places.position.data(), 1, &value);
    });
    c.coordinate[static_cast<std::size_t>(which)] = value;
  }
}

namespace {

/// Angles of one sum of coordinates that may be counted anew.
struct TurnsOfSum {
  struct Angle {
    double* value = nullptr;
    double ratio = 0;
  };
  std::vector<Angle> angles;
  double off = 0, size = 0;  ///< the sum minus what it should be, and what counts as little of it

  void add(double ratio, double value, double scale) {
    off += ratio * value, size = std::max(size, std::abs(ratio) * scale);
  }
  /// Turns one angle, or two as far as they need it. Not at all where that does not meet the sum.
  void meet() {
    constexpr double met = 1e-6, turn = 2 * std::numbers::pi;
    constexpr int most_turns = 64;
    if (!(std::abs(off) > met * size)) return;
    for (int of_second = 0; of_second <= most_turns; ++of_second)
      for (Angle& first : angles) {
        for (const Angle& second : angles) {
          if ((&second == &first) != (of_second == 0)) continue;
          for (const int m : {of_second, -of_second}) {
            const double rest = off + m * turn * second.ratio, n = std::round(-rest / (turn * first.ratio));
            if (!(std::abs(rest + n * turn * first.ratio) <= met * size)) continue;
            *first.value += n * turn, *second.value += m * turn;
            return;
          }
        }
      }
  }
};

/// The place of a particle on its path: from the last one only the nearest along the path is found.
void find_on_path(Model& model, std::uint32_t slot) {
  constexpr double on_path = 1e-6;
  constexpr int parts = 32;
  double& place = model.constraints[slot].coordinate[static_cast<std::size_t>(JointCoordinate::slide)];
  const double last = place, part = model.constraints[slot].length / parts;
  double best = last, least = calc_violation(model, slot).relative;
  for (int k = 1; k <= parts && least > on_path; ++k)
    for (const int way : {1, -1}) {
      place = last + way * k * part;
      refresh_coordinates(model, slot);
      const double off = calc_violation(model, slot).relative;
      if (off < least) least = off, best = place;
    }
  place = best;
}

}  // namespace

void count_turns(Model& model, std::span<const std::uint32_t> joints) {
  std::vector<std::uint32_t> open(joints.begin(), joints.end()), couplings;
  const auto is_angle = [](JointCoordinate which) { return which != JointCoordinate::slide; };
  const auto value_of = [&](std::uint32_t joint, JointCoordinate which) -> double& {
    return model.constraints[joint].coordinate[static_cast<std::size_t>(which)];
  };
  const auto scale_of = [&](std::uint32_t joint, JointCoordinate which) {
    const auto& scale = model.constraints[joint].scale;
    return is_angle(which) ? 1 : std::max(scale[0], scale[1]);
  };
  for (const std::uint32_t slot : joints) {
    const Constraint& c = model.constraints[slot];
    if (c.kind == ConstraintKind::path) find_on_path(model, slot);
    for_each_coupling_of(model, c, [&](std::uint32_t coupling) { couplings.push_back(coupling); });
    if (!info(c.kind).screw || c.length == 0) continue;
    TurnsOfSum sum{.angles = {{&value_of(slot, JointCoordinate::angle), c.length}}};
    sum.add(c.length, value_of(slot, JointCoordinate::angle), 1);
    sum.add(-1, value_of(slot, JointCoordinate::slide), scale_of(slot, JointCoordinate::slide));
    sum.meet();
    std::erase(open, slot);  // its slide tells its turns
  }
  sort_unique(couplings);
  for (const std::uint32_t coupling : couplings) {
    if (info(model.constraints[coupling].kind).sign != 0) continue;  // a tackle, of lengths
    TurnsOfSum sum{.angles = {}, .off = -model.constraints[coupling].length};
    for_each_term(model, model.constraints[coupling], [&](const CoupledTerm& term) {
      sum.add(term.ratio, value_of(term.joint, term.coordinate), scale_of(term.joint, term.coordinate));
      if (is_angle(term.coordinate) && std::erase(open, term.joint) > 0)  // once counted, it stays so
        sum.angles.push_back({&value_of(term.joint, term.coordinate), term.ratio});
    });
    sum.meet();
  }
}

namespace {

/// The forces of a constraint on all its places in the last step.
std::array<Vec3, place_count> forces_at(const LastStep& step, std::uint32_t slot, const JointPlaces& places) {
  const Model& model = step.model;
  const Constraint& c = model.constraints[slot];
  std::array<Vec3, place_count> forces{};
  if (!is_in_force(model, c)) return forces;
  const std::array<Vec3, place_count> start = places.calc_start(step, c);
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    Row loaded = row;
    double multipliers[Row::rows];
    if (use.role == Role::hold)
      load_hold(loaded, model, c, use, multipliers);
    else
      multipliers[0] = c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1];
    for_each_row_force(loaded, multipliers, step.stage.midpoint, start.data(), places.position.data(),
                       [&](std::uint32_t place, const Vec3& force) { forces[place] += force; });
  };
  build_rows({c, model.geometry(slot), places.arms}, sink);
  return forces;
}

/// The forces of couplings on all places of a joint in the last step: of those for which `counts(coupling)`.
template <class Counts>
std::array<Vec3, place_count> coupled_forces_at(const LastStep& step, std::uint32_t slot, const JointPlaces& places,
                                                Counts counts) {
  const Model& model = step.model;
  const Constraint& c = model.constraints[slot];
  const std::array<Vec3, place_count> start = places.calc_start(step, c);
  std::array<Vec3, place_count> forces{};
  for (std::uint32_t t = c.coupled; t != none; t = model.coupled_terms[t].next_at_joint) {
    const CoupledTerm& term = model.coupled_terms[t];
    const Constraint& coupling = model.constraints[term.coupling];
    if (!counts(term.coupling) || !is_in_force(model, coupling)) continue;
    const double multiplier = term.ratio * coupling.multipliers[0];
    with_coordinate({c, model.geometry(slot), places.arms}, term.coordinate, [&](auto row) {
      set_target(row, c.coordinate[static_cast<std::size_t>(term.coordinate)], 0);
      for_each_row_force(row, &multiplier, step.stage.midpoint, start.data(), places.position.data(),
                         [&](std::uint32_t place, const Vec3& force) { forces[place] += force; });
    });
  }
  return forces;
}

}  // namespace

Vec3 calc_force_at(const LastStep& step, std::uint32_t slot, int place) {
  const JointPlaces places(step.model, step.model.constraints[slot]);
  Vec3 force = forces_at(step, slot, places)[static_cast<std::size_t>(place)];
  if (step.model.constraints[slot].coupled != none)
    force += coupled_forces_at(step, slot, places, [](std::uint32_t) { return true; })[static_cast<std::size_t>(place)];
  return force;
}

Reaction calc_reaction(const Model& model, std::uint32_t slot) {
  const Constraint& c = model.constraints[slot];
  const bool is_coupling = c.first_term != none;
  const std::uint32_t joint = is_coupling ? model.coupled_terms[c.first_term].joint : slot;
  const auto& particles = model.constraints[joint].particles;
  const auto first = std::find_if(particles.begin(), particles.end(), [](std::uint32_t p) { return p != none; });
  const LastStep step(model, first == particles.end() ? none : *first);
  const JointPlaces places(model, model.constraints[joint]);
  const std::array<Vec3, place_count> forces =
      is_coupling ? coupled_forces_at(step, joint, places, [&](std::uint32_t coupling) { return coupling == slot; })
                  : forces_at(step, slot, places);
  Reaction reaction;
  reaction.position = places.position[a_origin];
  for (int place = a_origin; place < b_origin; ++place) {
    reaction.force += forces[place];
    reaction.torque += cross(places.position[place] - reaction.position, forces[place]);
  }
  // A rope that runs several times between its first two points pulls there with as many strands.
  if (c.kind == ConstraintKind::tackle) reaction.force *= 1 / model.coupled_terms[c.first_term].ratio;
  return reaction;
}

namespace {

/// visit(row, law, value): the rows of a constraint, except a coupling, at the present places of its particles. A length that
/// is to run in the next step is as at this part of its way.
template <class Visit>
void for_each_held_value(const Model& model, std::uint32_t slot, double fraction, Visit visit) {
  const Constraint& c = model.constraints[slot];
  const JointPlaces places(model, c);
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    if (use.role != Role::hold) return;
    Row loaded = row;
    double multipliers[Row::rows], g[Row::rows];
    load_hold(loaded, model, c, use, multipliers);
    move_target(loaded, c.way);
    loaded.value(places.position.data(), fraction, g);
    for (int r = 0; r < Row::rows; ++r) visit(loaded, law_of_hold(c, use, loaded, r), g[r]);
  };
  build_rows({c, model.geometry(slot), places.arms}, sink);
}

}  // namespace

Violation calc_violation(const Model& model, std::uint32_t slot) {
  return with_form(model.constraints[slot].kind, [&]<class F>() {
    Violation worst;
    if constexpr (requires { F::calc_violation(model, model.constraints[slot]); })
      worst = F::calc_violation(model, model.constraints[slot]);
    else
      for_each_held_value(model, slot, 1, [&](const auto& row, const solver::RowLaw& law, double value) {
        const double off = law.violation(value);
        worst.absolute = std::max(worst.absolute, off);
        worst.relative = std::max(worst.relative, off / row.reference_length());
      });
    return worst;
  });
}

double friction_of_line(const Constraint& c) {
  return info(c.kind).may_rub() && PinForm::rubs(c) ? c.multipliers[2] : 0;
}

double calc_energy_of_holds(const Model& model, std::uint32_t slot) {
  double energy = 0;
  for_each_held_value(model, slot, 0,
                      [&](const auto&, const solver::RowLaw& law, double value) { energy += law.energy(value); });
  return energy;
}

std::pair<double, double> calc_coordinate(const Model& model, std::uint32_t slot, JointCoordinate which) {
  std::pair<double, double> found{0, 0};
  with_placed_coordinate(model, slot, which, [&]<class Row>(const Row& row, const JointPlaces& places) {
    row.value(places.position.data(), 1, &found.first);
    const solver::Gradients<Row> gradients(row, places.position.data(), 1);
    for (int i = 0; i < row.node_count(); ++i) {
      Vec3 direction;
      gradients.of_node(i, &direction);
      found.second += dot(direction, places.velocity[row.nodes[i]]);
    }
  });
  return found;
}

bool has_coordinate_row(const Model& model, std::uint32_t slot, JointCoordinate which) {
  const JointPlaces places(model, model.constraints[slot]);
  return with_coordinate({model.constraints[slot], model.geometry(slot), places.arms}, which, [](const auto&) {});
}

void start_rows(Model& model, std::uint32_t slot) {
  with_form(model.constraints[slot].kind, [&]<class F>() { F::start(model, slot); });
}

}  // namespace iota::ingredient
