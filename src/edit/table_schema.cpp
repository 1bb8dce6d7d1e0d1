// SPDX-License-Identifier: Apache-2.0
#include "edit/table_schema.h"

#include "base/archive.h"
#include "edit/letter_i_schema.h"
#include "ingredient/tables.h"

namespace iota {

// A field that is missing here is lost between versions; padding is.
IOTA_FIELDS(Material, friction, touches, restitution, rolling, surface_velocity, static_friction, spinning)
IOTA_FIELDS(AttributeKey, life, radius, color)
IOTA_FIELDS(ContactParty, body, group)
IOTA_FIELDS(BreakLimits, force, torque)
IOTA_FIELDS(Compliance, linear, angular, time)
IOTA_FIELDS(CoordinateOptions, lower, upper, motor_speed, motor_max, servo, servo_time, friction, stiffness, damping,
            rest, friction_coefficient)
IOTA_FIELDS(shape::Data, kind, sizes, key)
IOTA_FIELDS(model::ListHead, first)
IOTA_FIELDS(model::Particle, body, ring, next_in_body, previous_in_body, next_in_ring, previous_in_ring, uses, groups,
            attributes, basis_index, inactive, part, mass)
IOTA_FIELDS(model::AffineParticle, weights, multiplier)
IOTA_FIELDS(model::Ring, first, last, count, nailed, is_instant, position, velocity, acceleration)
IOTA_FIELDS(model::RigidRow, length, multiplier)
IOTA_FIELDS(model::Body, kind, rank, row_count, kind_before, first, last, count, articulate, next_in_articulate,
            previous_in_articulate, first_inertia, first_solid, basis_needs, basis, first_row, orientation)
IOTA_FIELDS(model::InertiaPair, body, next, p, q, inertia)
IOTA_FIELDS(model::Solid, points, body, next, shape, half, center, principal)
IOTA_FIELDS(model::Obstacle, position, orientation)
IOTA_FIELDS(model::Stand, reach, places)
IOTA_FIELDS(model::Twin, particle, next, part, mass)
IOTA_FIELDS(model::Articulate, first, last, count, version, velocity_dirty, to_wake, slow_time, standing_steps,
            standing_gap, unsolved_steps, owed_work)
IOTA_FIELDS(model::Group, name)
IOTA_FIELDS(model::Attributes, particle, emitter, age, lifetime, radius, color, oriented, orientation, spin, torque,
            moment, damping, preferred, stiffness, alignment_damping)
IOTA_FIELDS(ingredient::Grip, body, count, points, weights, target, client, hold, frequency, max_acceleration, force)
IOTA_FIELDS(ingredient::Push, force, before)
IOTA_FIELDS(ingredient::Torque, torque, before)
IOTA_FIELDS(ingredient::SurfaceData, shape, function)
IOTA_FIELDS(ingredient::CurveData, kind, closed, first, count, rounding)
IOTA_FIELDS(ingredient::CoupledTerm, coupling, joint, next, next_at_joint, ratio, coordinate)
IOTA_FIELDS(ingredient::Constraint::Bits, bits)
IOTA_FIELDS(ingredient::Constraint, kind, active, broken, owned, in_world, alignment, lock, aligned, line_side, carries,
            told, is_part, particles, next, previous, fixed, scale, cosines, length, curve, first_term, coupled,
            surfaces, nearest, options, coordinate, breaks, compliance, multipliers, efforts, gap, is_new, is_hauled,
            way, rate)
IOTA_FIELDS(ingredient::Emitter, source, active, rate, position, velocity, orientation, velocity_spread, lifetime,
            lifetime_spread, mass, damping, max_count, key_count, keys, seed, draws, due, alive, born)
IOTA_FIELDS(ingredient::IgnoredPair, a, b)
IOTA_FIELDS(ingredient::Contact, p, q, next, previous, part, feature, other_part, other_feature, form, turns,
            slips_turn, is_of_sweeps, is_off, continues, points, point_count, of_p, roll_rows, weights, center, place,
            normal, first, second, axis, bends, radius, friction, restitution, ball, drift, rolling, carried, roller,
            roll_first, roll_second, torque, pivot, static_friction, spin_rows, spinning, spinner, spin_second, twist,
            depth, push, drag, energy, duration, impulse, time, approach, found_in)
IOTA_FIELDS(ingredient::PairForce, law, group, other, active, shifted, cutoff, parameters)
IOTA_FIELDS(ingredient::Closing, p, q, next, previous, distance, duration, elapsed, multiplier)
IOTA_FIELDS(ingredient::Law, kind, number, parameter_count, uses, function, standard, parameters, name, text)
IOTA_FIELDS(ingredient::RodSpin, momentum, angle, drawn)
IOTA_FIELDS(ingredient::Nail, position, position_before, multiplier)
IOTA_FIELDS(ingredient::CosmeticBond, p, q, next, previous)
IOTA_FIELDS(ingredient::AngleSpring, particles, next, previous, stiffness, damping, rest, lengths)
IOTA_FIELDS(ingredient::Track, from, velocity_from, to, velocity_to, h, energy_from, energy_to, dissipated,
            external_work, begin, length, points, leader, is_pinned)
IOTA_FIELDS(ingredient::Bond, p, q, next, previous, law, active, implicit, muted, broken, parameters, break_force,
            held_force, script)
IOTA_FIELDS(ingredient::Field, kind, number, group, parameter_count, active, replaces_gravity, function, parameters,
            names, name, text)

}  // namespace iota

namespace iota::edit {

const Schema& own_schema() {
  static const Schema own = [] {
    Schema schema;
    SchemaWriter writer(schema);
    model::Model empty;
    empty.archive(writer);
    return schema;
  }();
  return own;
}

const std::string& own_schema_text() {
  static const std::string text = own_schema().text();
  return text;
}

std::vector<std::byte> in_own_schema(std::string_view schema, std::span<const std::byte> tables) {
  std::vector<std::byte> standard;
  Writer writer(standard);
  model::Model empty;
  empty.archive(writer);
  return translate(Schema::from_text(schema), tables, own_schema(), standard);
}

std::string_view schema_of_letter_i() { return letter_i_schema; }

}  // namespace iota::edit
