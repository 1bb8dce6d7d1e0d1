// SPDX-License-Identifier: Apache-2.0
#include "solver/spin.h"

#include "solver/row_masses.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

/// visit(part): each part that contains one of the nodes.
template <class Visit>
void for_each_once(std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> part_of, Visit visit) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto is_seen = [&](std::uint32_t node) { return part_of[node] == part_of[nodes[i]]; };
    if (std::none_of(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(i), is_seen)) visit(part_of[nodes[i]]);
  }
}

/// Contacts neither hold bodies nor connect them here: each gets its own loss back, which is that of its turn in the step, whatever
/// pushes it. As parts of one piece a rolling ball lost 40 % of its speed in 2 s, a spinning one as much, and a light body paid
/// with its motion for the spin of a heavy one.
template <class C>
constexpr bool is_joint = !std::is_same_v<C, DistanceConstraint> && !is_of_contact<C>;

/// The pseudoinverse of an inertia. For points on a line it is zero along the line.
Mat3 pseudoinverse(const Mat3& inertia) {
  const SymmetricEigen eigen = symmetric_eigen(inertia);
  Mat3 inverse;
  for (int k = 0; k < 3; ++k) {
    const Vec3 column = solve_semidefinite(eigen, {double(k == 0), double(k == 1), double(k == 2)}, 1e-12);
    inverse.m[0][k] = column.x, inverse.m[1][k] = column.y, inverse.m[2][k] = column.z;
  }
  return inverse;
}

}  // namespace

void Spin::begin(const Problem& problem) {
  if (acting_version_ != problem.acting_version()) forget();
  acting_version_ = problem.acting_version();
}

// The parts are found once for a structure and the rows that act. What holds them is updated in each step, since nails move.
void Spin::find_parts(const Problem& problem, Connection connection, const Holds& all, Parts& all_parts) {
  auto& [parts, connected, nail] = all_parts;
  const bool is_new = connected.of.size() != problem.size();
  if (is_new) parts.resize(find_pieces(problem, connection, connected, room_for_pieces_, Nails::apart));
  const bool skips_contacts = connection == Connection::joints && problem.has_used<ContactConstraint>();
  const bool is_alone = parts.size() == 1 && !skips_contacts;
  // A walk over all rows is not needed where all hangs on a nail that has not moved.
  const std::optional<Vec3> pivot =
      is_alone || skips_contacts || problem.items_of<AffineConstraint>().size() != 1 ? std::nullopt : all.pivot();
  if (is_new || !pivot || nail != pivot) {
    for (Part& part : parts) part.holds = {}, part.touches = false;
    if (is_alone)
      parts.front().holds = all;
    else if (!all.are_none())
      add_holds(problem, connection, connected, [&](std::uint32_t part) -> Holds& { return parts[part].holds; });
  }
  nail = pivot;
  if (skips_contacts) {
    const auto& contacts = problem.pool_of<ContactConstraint>();
    for (std::size_t i = 0; i < contacts.items.size(); ++i)
      if (contacts.acts(i))
        for (const std::uint32_t node : contacts.nodes_of(contacts.items[i])) all_parts.of(node).touches = true;
  }
  for (Part& part : parts) part.is_kept = part.holds.are_none() || part.holds.pivot(), part.axle = {};
}

// After find_parts. In gravity only upright axles: about others it changes the angular momentum. Nothing that moves is an axle.
void Spin::find_axles(const Problem& problem, Noticed by, Parts& all_parts) {
  constexpr double upright = 1e-9;
  constexpr std::uint32_t none = Pieces::none;
  auto& [parts, connected, nail] = all_parts;
  const auto may_have_one = [&](std::uint32_t k) { return !parts[k].is_kept && !connected.is_nail(k); };
  std::uint32_t count = 0;
  for (std::uint32_t k = 0; k < parts.size(); ++k) count += may_have_one(k);
  if (count == 0) return;
  hung_of_part_.assign(parts.size(), none), count = 0;
  for (std::uint32_t k = 0; k < parts.size(); ++k)
    if (may_have_one(k)) hung_of_part_[k] = count++;
  bool moves = false;
  problem.for_each_acting([&](const auto& pool, std::size_t i) {
    moves = moves || (!pool.items[i].is_internal() && pool.items[i].is_moving());
  });
  if (moves) return;
  hung_of_node_.resize(problem.size());
  for (std::uint32_t i = 0; i < problem.size(); ++i) hung_of_node_[i] = hung_of_part_[connected.of[i]];
  if (connected.are_nails.empty())
    for (const AffineConstraint& c : problem.items_of<AffineConstraint>())
      if (c.is_nail()) hung_of_node_[c.nodes[0]] = none;
  noticed_.assign(count, {.length = 0});
  const auto for_each_hung = [&](auto visit) {
    for (std::uint32_t i = 0; i < problem.size(); ++i)
      if (hung_of_node_[i] != none) visit(problem.position[i], hung_of_node_[i]);
  };
  for_each_hung([&](const Vec3& place, std::uint32_t k) { noticed_[k].center = place; });  // one of them
  for_each_hung([&](const Vec3& place, std::uint32_t k) {
    noticed_[k].length = std::max(noticed_[k].length, norm(place - noticed_[k].center));
  });
  for (RigidModes& noticed : noticed_)
    if (noticed.length == 0) noticed.length = 1;
  add_noticed_modes(problem, hung_of_node_, noticed_, by);
  for (std::uint32_t k = 0; k < parts.size(); ++k) {
    if (hung_of_part_[k] == none) continue;
    const std::optional<Axle> axle = noticed_[hung_of_part_[k]].axle();
    if (!axle || norm(cross(axle->direction, problem.gravity)) > upright * norm(problem.gravity)) continue;
    parts[k].axle = axle, parts[k].is_kept = true;
  }
}

/// Two to four points, each at a fixed distance from each other, and nothing else that holds or turns them.
void Spin::find_rigid_pieces(const Problem& problem) {
  constexpr std::uint32_t most_nodes = 4;
  bool may_be = false;
  for (Part& part : pieces_.parts) part.is_rigid = part.holds.are_none(), may_be = may_be || part.is_rigid;
  if (!may_be) return;
  counts_.assign(pieces_.parts.size(), {});
  for (const std::uint32_t part : pieces_.connected.of) ++counts_[part].nodes;
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    const std::uint32_t part = pieces_.connected.of[pool.nodes_of(pool.items[i]).front()];
    if constexpr (std::is_same_v<C, DistanceConstraint>)
      ++counts_[part].rods;
    else if constexpr (!is_of_contact<C>)
      pieces_.parts[part].is_rigid = false;
  });
  const auto drop = [&](const auto& forces) {
    for (const auto& f : forces) pieces_.of(f.arm.nodes[0]).is_rigid = false;
  };
  drop(problem.items_of<GyroscopicForce>());
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    const auto [n, rods] = counts_[k];
    Part& part = pieces_.parts[k];
    part.is_rigid = part.is_rigid && n >= 2 && n <= most_nodes && 2 * rods == n * (n - 1);
  }
}

/// Whether the rows may leave a single body one or two motions. Pieces of one member do not count: they get back everything.
bool Spin::find_members(const Problem& problem) {
  constexpr std::uint32_t most_nodes = 4, fewest_rows = 4;
  std::size_t rows_of_joints = 0;
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>&, std::size_t) {
    if constexpr (is_joint<C>) rows_of_joints += C::rows;
  });
  if (rows_of_joints < fewest_rows) return false;
  auto& members = members_.parts;
  const std::vector<std::uint32_t>& member_of = members_.connected.of;
  if (member_of.size() != problem.size()) {
    members.resize(find_pieces(problem, Connection::lengths, members_.connected, room_for_pieces_));
    piece_of_.assign(members.size(), Pieces::none);
    nodes_of_.assign(members.size(), 0), rows_of_.assign(members.size(), 0);
    for (std::uint32_t i = 0; i < problem.size(); ++i) {
      const std::uint32_t own = pieces_.connected.of[i];
      std::uint32_t &piece = piece_of_[member_of[i]], &nodes = nodes_of_[member_of[i]];
      if (piece == Pieces::none || pieces_.connected.is_nail(piece))
        piece = own;
      else if (piece != own && !pieces_.connected.is_nail(own))
        nodes = most_nodes;  // what hangs on one nail is not one body
      ++nodes;
    }
    problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
      if constexpr (is_joint<C>)
        for_each_once(pool.nodes_of(pool.items[i]), member_of,
                      [&](std::uint32_t member) { rows_of_[member] += C::rows; });
    });
    may_turn_.resize(members.size());
    for (std::size_t k = 0; k < members.size(); ++k)
      may_turn_[k] = nodes_of_[k] <= most_nodes && rows_of_[k] >= fewest_rows;
  }
  bool any = false;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const bool gets_all = members.size() == pieces_.parts.size() && pieces_.parts[piece_of_[k]].is_free();
    members[k].is_kept = may_turn_[k] && !gets_all;
    any = any || members[k].is_kept;
  }
  return any;
}

// Rows with a law count while they are equations. A row that depends on others adds nothing.
void Spin::find_supports(const Problem& problem) {
  constexpr double independent = 1e-12;  // of the square of a norm
  supports_.resize(members_.parts.size());
  for (std::size_t k = 0; k < supports_.size(); ++k) {
    supports_[k].count = 0;
    if (members_.parts[k].is_due) supports_[k].by_inertia = pseudoinverse(members_.parts[k].inertia);
  }
  const auto product = [&](std::uint32_t member, const Wrench& a, const Wrench& b) {
    return (1 / members_.parts[member].mass) * dot(a.force, b.force) +
           dot(a.torque, supports_[member].by_inertia * b.torque);
  };
  const auto is_open = [&](std::uint32_t member) {
    return members_.parts[member].is_due && supports_[member].count < 6;
  };
  const auto add = [&](std::uint32_t member, Wrench wrench) {
    Support& support = supports_[member];
    if (!is_open(member)) return;
    const double size = product(member, wrench, wrench);
    for (int pass = 0; pass < 2; ++pass)  // the second removes round-off
      for (int k = 0; k < support.count; ++k) {
        const double share = product(member, support.wrenches[k], wrench);
        wrench.force -= share * support.wrenches[k].force, wrench.torque -= share * support.wrenches[k].torque;
      }
    const double rest = product(member, wrench, wrench);
    if (!(rest > independent * size)) return;
    const double scale = 1 / std::sqrt(rest);
    support.wrenches[support.count++] = {scale * wrench.force, scale * wrench.torque};
  };
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (is_joint<C>)
      for (std::size_t item = 0; item < pool.items.size(); ++item) {
        const auto nodes = pool.nodes_of(pool.items[item]);
        if (std::none_of(nodes.begin(), nodes.end(), [&](auto i) { return is_open(members_.connected.of[i]); }))
          continue;
        const Gradients<C> gradients(pool.items[item], problem.position.data(), 1);
        for_each_once(nodes, members_.connected.of, [&](std::uint32_t member) {
          if (!is_open(member)) return;
          Wrench wrenches[C::rows];
          for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (members_.connected.of[nodes[i]] != member) continue;
            Vec3 rows[C::rows];
            gradients.of_node(static_cast<int>(i), rows);
            const Vec3 arm = problem.position[nodes[i]] - members_.parts[member].center;
            for (int r = 0; r < C::rows; ++r) wrenches[r].force += rows[r], wrenches[r].torque += cross(arm, rows[r]);
          }
          for (int r = 0; r < C::rows; ++r) {
            const auto is_equation = [&] {
              if (!pool.has_laws()) return true;
              const RowLaw& law = pool.law(item)[r];
              return !law.is_off() && !law.is_compliant() && pool.is_equation(item, r);
            };
            if (is_equation()) add(member, wrenches[r]);
          }
        });
      }
  });
}

/// Whether forces connect or damp pieces. Pieces on a spring to the world are not a cluster: it may be as stiff as a nail.
bool Spin::find_clusters(const Problem& problem, const Holds& all) {
  if (!problem.has_used_springs()) return false;
  find_parts(problem, Connection::rows_and_forces, all, clusters_);
  find_axles(problem, Noticed::by_all_rows, clusters_);
  const auto drop_held = [&](const auto& forces) {
    for (const auto& f : forces)
      if (!f.arm.is_internal()) clusters_.of(f.arm.nodes[0]).is_kept = false;
  };
  drop_held(problem.items_of<SpringForce>()), drop_held(problem.items_of<RadialForce>());
  return true;
}

/// Whether contacts connect pieces.
bool Spin::find_touching(const Problem& problem, const Holds& all) {
  if (std::none_of(pieces_.parts.begin(), pieces_.parts.end(), [](const Part& piece) { return piece.touches; }))
    return false;
  find_parts(problem, Connection::rows, all, touching_);
  find_axles(problem, Noticed::by_all_rows, touching_);
  return touching_.parts.size() < pieces_.parts.size();
}

/// Adds what each of the finer parts was given to what the coarser one around it has lost.
void Spin::add_given(const Parts& finer, Parts& coarser) {
  std::uint32_t seen = 0;  // parts are numbered by their lowest nodes
  for (std::uint32_t i = 0; i < finer.connected.of.size(); ++i)
    if (finer.connected.of[i] == seen) coarser.of(i).lost += finer.parts[seen++].given;
}

/// Finds the clusters, and keeps the momenta of those that nothing else than a single point at rest holds.
void Spin::find_free_clusters(const Problem& problem, const Holds& all, Parts& clusters) {
  find_parts(problem, Connection::rows_and_forces, all, clusters);
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      if (!f.arm.is_internal()) clusters.of(f.arm.nodes[0]).is_kept = false;
  });
}

// The end-point rule gives sum m x1 x (v1 - v0) = h moment, that is L1 - L0 = h moment + h sum m v1 x v0. The moment of what its
// solution leaves unbalanced is small, and the same in each step: by it a free body at 20 rad/s gained 1e-11 of its speed a step.
bool Spin::find_losses(const Problem& problem, std::span<const Vec3> displacement, const NodeVectors& unbalanced,
                       double h, Supported supported, Parts& parts) {
  constexpr double round_off = 1e-13;
  const auto start_velocity = [&](std::uint32_t i) { return problem.velocity[i] - (1 / h) * displacement[i]; };
  for (Part& part : parts.parts) static_cast<Sums&>(part) = {}, part.given = part.lost_momentum = {};
  const auto add = [&](Sums& sums, double mass, std::uint32_t i, const Vec3& start) {
    const Vec3& v = problem.velocity[i];
    sums.mass += mass;
    sums.center += mass * problem.position[i];
    sums.momentum += mass * v, sums.wanted_momentum += mass * start;
  };
  const auto add_loss = [&](Sums& sums, double mass, std::uint32_t i, const Vec3& start) {
    const Vec3& v = problem.velocity[i];
    sums.lost += (mass * h) * cross(v, start), sums.kinetic += mass * dot(v, v);
    sums.lost += h * cross(problem.position[i], unbalanced[i]), sums.unbalanced += h * unbalanced[i];
  };
  for (std::uint32_t i = 0; i < problem.size();) {
    const std::uint32_t index = parts.connected.of[i];
    Part& part = parts.parts[index];
    Sums sums = part;  // in registers while the part stays the same
    const auto for_each_of_part = [&](auto visit) {
      do visit(i, problem.mass[i], start_velocity(i));
      while (++i < problem.size() && parts.connected.of[i] == index);
    };
    if (!part.is_kept)
      for_each_of_part([](std::uint32_t, double, const Vec3&) {});
    else if (part.holds.count > 0)  // the point that holds it is its center
      for_each_of_part([&](std::uint32_t node, double mass, const Vec3& start) {
        sums.mass += mass, add_loss(sums, mass, node, start);
      });
    else
      for_each_of_part([&](std::uint32_t node, double mass, const Vec3& start) {
        add(sums, mass, node, start), add_loss(sums, mass, node, start);
      });
    static_cast<Sums&>(part) = sums;
  }
  for (const auto& c : problem.mass_couplings) {
    Part& part = parts.of(c.a);
    const Vec3 start_a = start_velocity(c.a), start_b = start_velocity(c.b);
    add(part, c.mass, c.a, start_a), add(part, c.mass, c.b, start_b);
    part.lost += (c.mass * h) * (cross(problem.velocity[c.a], start_b) + cross(problem.velocity[c.b], start_a));
  }
  const auto start = [&](std::uint32_t i) { return problem.position[i] - h * problem.velocity[i]; };
  const ForceStage stage{.h = h};
  for (const GyroscopicForce& f :
       problem.items_of<GyroscopicForce>()) {  // its moment should be minus the change of the spin
    const Vec3 e1 = f.arm.value(problem.position.data()), e0 = start(f.arm.nodes[1]) - start(f.arm.nodes[0]);
    parts.of(f.arm.nodes[0]).lost += cross(e1, h * f.force(e0, e1, stage)) + f.spin * (e1 - e0);
  }
  const auto add_moments = [&](const auto& forces) {  // which should be zero
    for (const auto& f : forces) {
      const std::uint32_t part = parts.connected.of_all(std::span(f.arm.nodes).first(f.arm.count));
      if (!f.may_act_across() || part == Pieces::none) continue;
      const Vec3 e1 = f.arm.value(problem.position.data()), e0 = e1 - h * f.arm.rate(problem.velocity.data());
      parts.parts[part].lost += cross(e1, h * f.force_across(e0, e1, stage));
    }
  };
  add_moments(problem.items_of<SpringForce>()), add_moments(problem.items_of<RadialForce>());
  for (Part& part : parts.parts) {
    part.is_due = part.is_kept && part.mass > 0;
    if (!part.is_due) continue;
    if (const auto point = part.fixed_point()) {
      part.center = *point;
      part.lost -= cross(part.center, part.unbalanced);
    } else {
      part.center *= 1 / part.mass;
      part.lost_of_center = (h / part.mass) * cross(part.momentum, part.wanted_momentum);
      part.lost -= part.lost_of_center + cross(part.center, part.unbalanced);
    }
  }
  add_losses_of_fields(problem, displacement, h, supported, parts);
  bool any = false;
  for (Part& part : parts.parts) {
    if (!part.is_due) continue;
    if (const auto axis = part.only_about(problem.gravity))
      part.lost = (dot(part.lost, *axis) / dot(*axis, *axis)) * *axis;
    part.is_due = norm(part.lost) > round_off * h * part.kinetic;
    any = any || part.is_due;
  }
  return any;
}

// Only of parts that have lost something.
void Spin::find_motions(const Problem& problem, Parts& parts) {
  for (Part& part : parts.parts) part.kinetic = 0, part.angular = {}, part.inertia = {};
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    Part& part = parts.of(a);
    if (!part.is_due) return;
    const Vec3 ra = problem.position[a] - part.center, rb = problem.position[b] - part.center, v = part.velocity();
    const Vec3 va = problem.velocity[a] - v, vb = problem.velocity[b] - v;
    part.kinetic += 0.5 * mass * dot(va, vb);
    part.angular += mass * cross(ra, vb);
    part.inertia += coupled_inertia(mass, ra, rb);
  });
}

// The motions after `give_back`.
void Spin::find_velocities(const Problem& problem, Parts& parts) {
  for (Part& part : parts.parts) part.chord = part.velocity(), part.momentum = {};
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    parts.of(a).momentum += mass * problem.velocity[b];
  });
  find_motions(problem, parts);
}

// A part on a single point in gravity turns only about the direction of gravity, which changes the other components.
Vec3 Spin::turning(const Part& part, const Vec3& angular, const Vec3& gravity) {
  const std::optional<Vec3> axis = part.only_about(gravity);
  if (!axis) return solve_semidefinite(part.inertia, angular, 1e-12);
  const double inertia = dot(*axis, part.inertia * *axis);
  return inertia > 0 ? (dot(angular, *axis) / inertia) * *axis : Vec3{};
}

bool Spin::give_back(Problem& problem, std::span<const Vec3> displacement, const NodeVectors& unbalanced, double h,
                     const Holds& all, double most_gain) {
  begin(problem);
  find_parts(problem, Connection::joints, all, pieces_);
  find_axles(problem, Noticed::by_joints, pieces_);
  find_rigid_pieces(problem);
  const bool are_pieces_due = find_losses(problem, displacement, unbalanced, h, Supported::no, pieces_);
  const bool are_touching_due =
      find_touching(problem, all) && find_losses(problem, displacement, unbalanced, h, Supported::no, touching_);
  const bool are_clusters_due =
      find_clusters(problem, all) && find_losses(problem, displacement, unbalanced, h, Supported::no, clusters_);
  are_members_due_ =
      find_members(problem) && find_losses(problem, displacement, unbalanced, h, Supported::yes, members_);
  are_wheels_due_ = wheels_.find_losses(problem, displacement, h);
  if (are_members_due_) most_gain -= turn_members(problem, most_gain);
  if (are_wheels_due_)
    most_gain -= wheels_.turn(
        problem, most_gain,
        [&](auto points) {  // not yet done as a member
          return !are_members_due_ ||
                 std::none_of(points.begin(), points.end(), [&](std::uint32_t i) { return members_.of(i).is_due; });
        },
        [&](auto points, const Vec3& given) {
          Part& piece = pieces_.of(points.front());
          piece.lost += given, piece.given += given;
        });
  if (are_pieces_due) most_gain -= turn_parts(problem, most_gain, pieces_);
  // Bodies that collide change the motions of their centers of mass, too, and so lose more together.
  if (are_touching_due) {
    add_given(pieces_, touching_);
    most_gain -= turn_parts(problem, most_gain, touching_);
  }
  if (are_clusters_due) {
    add_given(pieces_, clusters_);
    if (are_touching_due) add_given(touching_, clusters_);
    (void)turn_parts(problem, most_gain, clusters_);
  }
  return are_pieces_due || are_touching_due || are_clusters_due || are_members_due_ || are_wheels_due_;
}

/// Gives each member the angular impulse that it has lost, without moving its supports. A free piece would be pushed by this:
/// all of it is pushed back. Returns the kinetic energy that this adds, J.
double Spin::turn_members(Problem& problem, double most_gain) {
  find_motions(problem, members_);
  find_supports(problem);
  double first = 0, second = 0;
  for (std::size_t k = 0; k < members_.parts.size(); ++k) {
    Part& part = members_.parts[k];
    // A member that hangs on a point swings: see turn_parts.
    part.is_due = part.is_due && supports_[k].count >= 4;
    if (!part.is_due) continue;
    const bool is_on_fixed_axle = !pieces_.parts[piece_of_[k]].is_free() && problem.gravity == Vec3{};
    Wrench impulse{-part.lost_momentum, is_on_fixed_axle ? -part.lost - part.lost_of_center : -part.lost};
    const Vec3 turn = supports_[k].by_inertia * impulse.torque;
    for (int i = 0; i < supports_[k].count; ++i) {
      const Wrench& support = supports_[k].wrenches[i];
      const double share = dot(support.torque, turn);
      impulse.force -= share * support.force, impulse.torque -= share * support.torque;
    }
    part.velocity_change = (1 / part.mass) * impulse.force;
    part.turn = supports_[k].by_inertia * impulse.torque;
    first += dot(part.velocity_change, part.momentum) + dot(part.turn, part.angular);
    second += 0.5 * (dot(part.velocity_change, impulse.force) + dot(part.turn, part.inertia * part.turn));
  }
  for (Part& piece : pieces_.parts) piece.velocity_change = {};
  for (std::size_t k = 0; k < members_.parts.size(); ++k) {
    const Part& part = members_.parts[k];
    Part& piece = pieces_.parts[piece_of_[k]];
    if (part.is_due && piece.is_kept && piece.holds.count == 0)
      piece.velocity_change -= (part.mass / piece.mass) * part.velocity_change;
  }
  for (const Part& piece : pieces_.parts) {
    first += dot(piece.velocity_change, piece.momentum);
    second -= 0.5 * piece.mass * dot(piece.velocity_change, piece.velocity_change);
  }
  const double share = largest_share(first, second, most_gain);
  for (std::size_t k = 0; k < members_.parts.size(); ++k) {
    const Part& part = members_.parts[k];
    if (!part.is_due) continue;
    Part& piece = pieces_.parts[piece_of_[k]];
    const Vec3 push = (share * part.mass) * part.velocity_change;
    const Vec3 given = share * (part.inertia * part.turn) + cross(part.center - piece.center, push);
    piece.lost += given, piece.given += given;
  }
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    const Part& part = members_.of(i);
    problem.velocity[i] += share * pieces_.of(i).velocity_change;
    if (part.is_due)
      problem.velocity[i] += share * (part.velocity_change + cross(part.turn, problem.position[i] - part.center));
  }
  return share * (first + share * second);
}

/// Returns the kinetic energy that this adds, J.
double Spin::turn_parts(Problem& problem, double most_gain, Parts& parts) {
  find_motions(problem, parts);
  // A part that swings on a nail keeps its motion, with the fall along the chord of the step: its reactions depend on it.
  const auto gives = [&](const Part& part) { return part.holds.count == 0 || problem.gravity == Vec3{}; };
  double first = 0, second = 0, rest = 0;
  for (Part& part : parts.parts) {
    if (!part.is_due) continue;
    part.turn = turning(part, -part.lost, problem.gravity);
    first += dot(part.turn, part.angular), second += 0.5 * dot(part.turn, part.inertia * part.turn);
    part.velocity_change = turning(part, part.angular, problem.gravity);  // the rigid motion that is there
    if (gives(part)) rest += part.kinetic - 0.5 * dot(part.velocity_change, part.angular);
  }
  constexpr double little = 1e-9;  // a straight chain that begins to turn needs just all of the rest
  const double share = largest_share(first, second, most_gain + (1 + little) * rest);
  const double gain = share * (first + share * second), excess = gain - most_gain;
  const double factor = excess > 0 ? std::sqrt(std::max(0.0, 1 - excess / std::max(rest, 1e-300))) : 1;
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    const Part& part = parts.of(i);
    if (!part.is_due) continue;
    const Vec3 place = problem.position[i] - part.center;
    const Vec3 shared = part.velocity() + cross(part.velocity_change, place);
    const double kept = part.is_rigid ? 0 : gives(part) ? factor : 1;
    problem.velocity[i] = shared + kept * (problem.velocity[i] - shared) + share * cross(part.turn, place);
  }
  for (Part& part : parts.parts)
    if (part.is_due) part.given += share * (part.inertia * part.turn);
  return std::min(gain, most_gain);
}

// Adds up mass, center, momentum and angular momentum of each piece. The angular momentum includes the spins of rods,
// and is about the pivot or, without one, the origin. Pieces that nothing or one point at rest holds are due.
void Spin::add_momenta(const Problem& problem, Parts& parts) {
  for (Part& piece : parts.parts) {
    piece.is_due = piece.is_kept;
    piece.mass = 0;
    piece.center = piece.momentum = piece.angular = {};
  }
  const auto about = [](const Part& piece) { return piece.holds.pivot().value_or(Vec3{}); };
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    Part& piece = parts.of(a);
    piece.mass += mass;
    piece.center += mass * problem.position[a];
    piece.momentum += mass * problem.velocity[a];
    piece.angular += mass * cross(problem.position[a] - about(piece), problem.velocity[b]);
  });
  for (const GyroscopicForce& f : problem.items_of<GyroscopicForce>())
    parts.of(f.arm.nodes[0]).angular += f.spin * f.arm.value(problem.position.data());
}

/// Drag between points turns what it connects: it also acts across their line.
void Spin::drop_turned(const Problem& problem, Parts& clusters) {
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      if (!f.keeps_angular_momentum()) clusters.of(f.arm.nodes[0]).is_kept = false;
  });
}

void Spin::note(const Problem& problem, const Holds& all, Connection connection) {
  begin(problem);
  if (std::exchange(noted_connection_, connection) != connection) noted_.connected.of.clear();
  if (connection == Connection::rows_and_forces)
    find_free_clusters(problem, all, noted_), drop_turned(problem, noted_);
  else
    find_parts(problem, connection, all, noted_);
  add_momenta(problem, noted_);
  for (Part& part : noted_.parts) part.wanted_momentum = part.momentum, part.wanted_angular = part.angular;
}

void Spin::expect(const Problem& problem, std::span<const Vec3> places, double h) {
  const auto add = [&](std::uint32_t i, const Vec3& impulse) {
    Part& part = noted_.of(i);
    part.wanted_momentum += impulse;
    part.wanted_angular += cross(places[i] - part.holds.pivot().value_or(Vec3{}), impulse);
  };
  for_each_mass(problem, [&](double mass, std::uint32_t i, std::uint32_t) { add(i, (h * mass) * problem.gravity); });
  for (std::uint32_t i = 0; i < problem.force.size(); ++i) add(i, h * problem.force[i]);
}

double Spin::restore(Problem& problem) {
  constexpr int passes = 2;  // the second removes the round-off of the first
  constexpr double most_gains[passes] = {
      100, 1e-9};  // of the kinetic energy: points almost in one place would spin extremely
  constexpr double tolerance = 1e-9, round_off = 1e-12;
  Parts& parts = noted_;
  double most_lost = 0;
  for (const double most_gain : most_gains) {
    add_momenta(problem, parts);
    for (Part& piece : parts.parts) {
      piece.is_due = piece.is_due && piece.mass > 0;
      if (!piece.is_due) continue;
      piece.lost = piece.wanted_angular - piece.angular;
      if (const auto pivot = piece.holds.pivot()) {
        piece.center = *pivot, piece.velocity_change = {};
      } else {
        const Vec3 push = piece.wanted_momentum - piece.momentum;
        piece.center *= 1 / piece.mass;
        piece.lost -= cross(piece.center, push), piece.velocity_change = (1 / piece.mass) * push;
      }
    }
    find_motions(problem, parts);
    most_lost = 0;
    for (Part& piece : parts.parts) {
      if (!piece.is_due) continue;
      piece.turn = solve_semidefinite(piece.inertia, piece.lost, 1e-12);
      const double first = dot(piece.turn, piece.angular), second = 0.5 * dot(piece.turn, piece.inertia * piece.turn);
      piece.turn *= largest_share(first, second, most_gain * piece.kinetic);
      const double remains = norm(piece.lost - piece.inertia * piece.turn);
      // A piece that does not turn has angular momentum by the round-off of its momentum alone.
      const double terms =
          norm(piece.center) * norm(piece.wanted_momentum) + std::sqrt(2 * piece.kinetic * piece.inertia.trace());
      if (remains > std::max(tolerance * norm(piece.wanted_angular), round_off * terms))
        most_lost = std::max(most_lost, remains);
    }
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const Part& piece = parts.of(i);
      if (piece.is_due)
        problem.velocity[i] += piece.velocity_change + cross(piece.turn, problem.position[i] - piece.center);
    }
  }
  return most_lost;
}

}  // namespace iota::solver
