// SPDX-License-Identifier: Apache-2.0
// The tables of snapshots of letter I, of November 2026. Never changes.
#pragma once

#include <string_view>

namespace iota::edit {

inline constexpr std::string_view letter_i_schema = R"(schema 41 158
56 13
body u 4 0 1
ring u 4 4 1
next_in_body u 4 8 1
previous_in_body u 4 12 1
next_in_ring u 4 16 1
previous_in_ring u 4 20 1
uses u 4 24 1
groups u 4 28 1
attributes u 4 32 1
basis_index i 1 36 1
inactive u 1 37 1
part u 4 40 2
mass f 8 48 1
4 1
- u 4 0 1
88 8
first u 4 0 1
last u 4 4 1
count u 4 8 1
nailed u 2 12 1
is_instant u 2 14 1
position f 8 16 3
velocity f 8 40 3
acceleration f 8 64 3
104 17
kind u 1 0 1
rank u 1 1 1
row_count u 1 2 1
kind_before u 1 3 1
first u 4 4 1
last u 4 8 1
count u 4 12 1
articulate u 4 16 1
next_in_articulate u 4 20 1
previous_in_articulate u 4 24 1
first_inertia u 4 28 1
first_solid u 4 32 1
basis_needs u 4 36 1
basis u 4 40 4
first_row.length f 8 56 1
first_row.multiplier f 8 64 1
orientation f 8 72 4
152 9
points u 4 0 4
body u 4 16 1
next u 4 20 1
shape.kind u 4 24 1
shape.sizes f 8 32 4
shape.key u 8 64 1
half f 8 72 3
center f 8 96 3
principal f 8 120 4
24 4
particle u 4 0 1
next u 4 4 1
part u 4 8 2
mass f 8 16 1
56 10
first u 4 0 1
last u 4 4 1
count u 4 8 1
version u 4 12 1
velocity_dirty u 4 16 1
to_wake u 4 20 1
slow_time f 8 24 1
standing_steps u 8 32 1
standing_gap f 8 40 1
unsolved_steps u 8 48 1
32 1
name i 1 0 32
24 5
body u 4 0 1
next u 4 4 1
p u 4 8 1
q u 4 12 1
inertia f 8 16 1
192 15
particle u 4 0 1
emitter u 4 4 1
age f 8 8 1
lifetime f 8 16 1
radius f 8 24 1
color f 4 32 4
oriented u 4 48 1
orientation f 8 56 4
spin f 8 88 3
torque f 8 112 3
moment f 8 136 1
damping f 8 144 1
preferred f 8 152 3
stiffness f 8 176 1
alignment_damping f 8 184 1
56 2
weights f 8 0 4
multiplier f 8 32 3
8 1
- f 8 0 1
80 10
0.length f 8 0 1
0.multiplier f 8 8 1
1.length f 8 16 1
1.multiplier f 8 24 1
2.length f 8 32 1
2.multiplier f 8 40 1
3.length f 8 48 1
3.multiplier f 8 56 1
4.length f 8 64 1
4.multiplier f 8 72 1
56 2
position f 8 0 3
orientation f 8 24 4
32 4
friction f 8 0 1
touches u 8 8 1
restitution f 8 16 1
rolling f 8 24 1
1 1
- u 1 0 1
24 1
- f 8 0 3
16 2
0 u 4 0 2
1 u 4 8 2
4 1
- i 4 0 1
32 1
- i 1 0 32
8 1
- u 8 0 1
48 2
force f 8 0 3
before f 8 24 3
48 2
torque f 8 0 3
before f 8 24 3
24 3
momentum f 8 0 1
angle f 8 8 1
drawn f 8 16 1
56 8
p u 4 0 1
q u 4 4 1
next u 4 8 2
previous u 4 16 2
distance f 8 24 1
duration f 8 32 1
elapsed f 8 40 1
multiplier f 8 48 1
4 1
first u 4 0 1
72 3
position f 8 0 3
position_before f 8 24 3
multiplier f 8 48 3
1312 16
kind u 4 0 1
number u 4 4 1
parameter_count u 4 8 1
uses u 4 12 1
function u 8 16 1
standard f 8 24 8
parameters.0 i 1 88 24
parameters.1 i 1 112 24
parameters.2 i 1 136 24
parameters.3 i 1 160 24
parameters.4 i 1 184 24
parameters.5 i 1 208 24
parameters.6 i 1 232 24
parameters.7 i 1 256 24
name i 1 280 32
text i 1 312 1000
136 13
p u 4 0 1
q u 4 4 1
next u 4 8 2
previous u 4 16 2
law u 4 24 1
active u 1 28 1
implicit u 1 29 1
muted u 1 30 1
broken u 1 31 1
parameters f 8 32 8
break_force f 8 96 1
held_force f 8 104 3
script u 8 128 1
912 82
kind u 1 0 1
active u 1 1 1
broken u 1 2 1
owned u 1 3 1
in_world u 1 4 1
alignment u 1 5 1
lock u 1 6 1
aligned u 1 7 1
line_side u 1 8 1
carries.bits u 1 9 1
told.bits u 1 10 1
is_part u 1 11 1
particles u 4 12 8
next u 4 44 8
previous u 4 76 8
fixed.0 f 8 112 3
fixed.1 f 8 136 3
fixed.2 f 8 160 3
fixed.3 f 8 184 3
scale f 8 208 2
cosines f 8 224 2
length f 8 240 1
curve.kind u 1 248 1
curve.closed u 1 249 1
curve.first u 4 252 1
curve.count u 4 256 1
curve.rounding f 8 264 1
first_term u 4 272 1
coupled u 4 276 1
surfaces.0.shape.kind u 4 280 1
surfaces.0.shape.sizes f 8 288 4
surfaces.0.shape.key u 8 320 1
surfaces.0.function u 8 328 1
surfaces.1.shape.kind u 4 336 1
surfaces.1.shape.sizes f 8 344 4
surfaces.1.shape.key u 8 376 1
surfaces.1.function u 8 384 1
nearest f 8 392 3
options.0.lower f 8 416 1
options.0.upper f 8 424 1
options.0.motor_speed f 8 432 1
options.0.motor_max f 8 440 1
options.0.servo f 8 448 1
options.0.servo_time f 8 456 1
options.0.friction f 8 464 1
options.0.stiffness f 8 472 1
options.0.damping f 8 480 1
options.0.rest f 8 488 1
options.0.friction_coefficient f 8 496 1
options.1.lower f 8 504 1
options.1.upper f 8 512 1
options.1.motor_speed f 8 520 1
options.1.motor_max f 8 528 1
options.1.servo f 8 536 1
options.1.servo_time f 8 544 1
options.1.friction f 8 552 1
options.1.stiffness f 8 560 1
options.1.damping f 8 568 1
options.1.rest f 8 576 1
options.1.friction_coefficient f 8 584 1
options.2.lower f 8 592 1
options.2.upper f 8 600 1
options.2.motor_speed f 8 608 1
options.2.motor_max f 8 616 1
options.2.servo f 8 624 1
options.2.servo_time f 8 632 1
options.2.friction f 8 640 1
options.2.stiffness f 8 648 1
options.2.damping f 8 656 1
options.2.rest f 8 664 1
options.2.friction_coefficient f 8 672 1
coordinate f 8 680 3
breaks.force f 8 704 1
breaks.torque f 8 712 1
compliance.linear f 8 720 1
compliance.angular f 8 728 1
compliance.time f 8 736 1
multipliers f 8 744 8
efforts.0 f 8 808 4
efforts.1 f 8 840 4
efforts.2 f 8 872 4
gap f 8 904 1
32 6
coupling u 4 0 1
joint u 4 4 1
next u 4 8 1
next_at_joint u 4 12 1
ratio f 8 16 1
coordinate u 1 24 1
1448 22
kind u 4 0 1
number u 4 4 1
group u 4 8 1
parameter_count u 4 12 1
active u 1 16 1
replaces_gravity u 1 17 1
function u 8 24 1
parameters f 8 32 12
names.0 i 1 128 24
names.1 i 1 152 24
names.2 i 1 176 24
names.3 i 1 200 24
names.4 i 1 224 24
names.5 i 1 248 24
names.6 i 1 272 24
names.7 i 1 296 24
names.8 i 1 320 24
names.9 i 1 344 24
names.10 i 1 368 24
names.11 i 1 392 24
name i 1 416 32
text i 1 448 1000
88 7
law u 4 0 1
group u 4 4 1
other u 4 8 1
active u 1 12 1
shifted u 1 13 1
cutoff f 8 16 1
parameters f 8 24 8
488 44
source.kind u 4 0 1
source.sizes f 8 8 4
source.key u 8 40 1
active u 4 48 1
rate f 8 56 1
position f 8 64 3
velocity f 8 88 3
orientation f 8 112 4
velocity_spread f 8 144 1
lifetime f 8 152 1
lifetime_spread f 8 160 1
mass f 8 168 1
damping f 8 176 1
max_count u 4 184 1
key_count u 4 188 1
keys.0.life f 8 192 1
keys.0.radius f 8 200 1
keys.0.color f 4 208 4
keys.1.life f 8 224 1
keys.1.radius f 8 232 1
keys.1.color f 4 240 4
keys.2.life f 8 256 1
keys.2.radius f 8 264 1
keys.2.color f 4 272 4
keys.3.life f 8 288 1
keys.3.radius f 8 296 1
keys.3.color f 4 304 4
keys.4.life f 8 320 1
keys.4.radius f 8 328 1
keys.4.color f 4 336 4
keys.5.life f 8 352 1
keys.5.radius f 8 360 1
keys.5.color f 4 368 4
keys.6.life f 8 384 1
keys.6.radius f 8 392 1
keys.6.color f 4 400 4
keys.7.life f 8 416 1
keys.7.radius f 8 424 1
keys.7.color f 4 432 4
seed u 8 448 1
draws u 8 456 1
due f 8 464 1
alive u 4 472 1
born u 8 480 1
128 10
body u 4 0 1
count u 4 4 1
points u 4 8 4
weights f 8 24 4
target f 8 56 3
client u 4 80 1
hold u 4 84 1
frequency f 8 88 1
max_acceleration f 8 96 1
force f 8 104 3
64 1
- i 1 0 64
24 4
p u 4 0 1
q u 4 4 1
next u 4 8 2
previous u 4 16 2
80 7
particles u 4 0 3
next u 4 12 3
previous u 4 24 3
stiffness f 8 40 1
damping f 8 48 1
rest f 8 56 1
lengths f 8 64 2
816 48
p u 4 0 1
q u 4 4 1
next u 4 8 2
previous u 4 16 2
part u 4 24 1
feature u 4 28 1
other_part u 4 32 1
other_feature u 4 36 1
form u 1 40 1
turns u 1 41 1
slips_turn u 1 42 1
is_of_sweeps u 1 43 1
is_off u 1 44 1
continues u 1 45 1
points u 4 48 8
point_count u 4 80 1
of_p u 4 84 1
roll_rows u 4 88 1
weights.0 f 8 96 8
weights.1 f 8 160 8
weights.2 f 8 224 8
weights.3 f 8 288 8
weights.4 f 8 352 8
center f 8 416 3
place f 8 440 3
normal f 8 464 3
first f 8 488 3
second f 8 512 3
axis f 8 536 3
bends f 8 560 2
radius f 8 576 1
friction f 8 584 1
restitution f 8 592 1
ball f 8 600 1
rolling f 8 608 1
carried f 8 616 1
roller f 8 624 3
roll_first f 8 648 3
roll_second f 8 672 3
torque f 8 696 3
depth f 8 720 1
push f 8 728 1
drag f 8 736 3
energy f 8 760 1
duration f 8 768 1
impulse f 8 776 3
approach f 8 800 1
found_in u 8 808 1
32 4
a.body u 4 0 2
a.group u 4 8 2
b.body u 4 16 2
b.group u 4 24 2
144 12
from f 8 0 3
velocity_from f 8 24 3
to f 8 48 3
velocity_to f 8 72 3
h f 8 96 1
energy_from f 8 104 1
energy_to f 8 112 1
begin u 8 120 1
length u 4 128 1
points u 4 132 1
leader u 4 136 1
is_pinned u 4 140 1
particles.0 l 0
particles.1 l 1
particles.2 l 1
particles.3 v 1
rings.0 l 2
rings.1 l 1
rings.2 l 1
rings.3 v 1
bodies.0 l 3
bodies.1 l 1
bodies.2 l 1
bodies.3 v 1
solids.0 l 4
solids.1 l 1
solids.2 l 1
solids.3 v 1
twins.0 l 5
twins.1 l 1
twins.2 l 1
twins.3 v 1
articulates.0 l 6
articulates.1 l 1
articulates.2 l 1
articulates.3 v 1
groups.0 l 7
groups.1 l 1
groups.2 l 1
groups.3 v 1
inertia_pairs.0 l 8
inertia_pairs.1 l 1
inertia_pairs.2 l 1
inertia_pairs.3 v 1
attributes.0 l 9
attributes.1 l 1
attributes.2 l 1
attributes.3 v 1
ties.0 l 10
ties.1 l 1
fuses.0 l 11
fuses.1 l 1
first_twin.0 l 1
first_twin.1 l 1
more_rows.0 l 12
more_rows.1 l 1
body_damping.0 l 11
body_damping.1 l 1
obstacles.0 l 13
obstacles.1 l 1
radii.0 l 11
radii.1 l 1
usual_radius.0 v 11
materials.0 l 14
materials.1 l 1
usual_material.0 v 14
has_usual_material.0 v 15
corrections.0 l 16
structure_version.0 v 1
spark_changes.0 v 1
particle_survivors.0 l 17
body_survivors.0 l 17
meshes.0 m 15
gravity.0 v 16
mode.0 v 15
tolerance.0 v 11
budget_iterations.0 v 18
budget_seconds.0 v 11
budget_contacts.0 v 11
damping.0 v 11
solver.0 v 19
rest_after.0 v 11
rest_speed.0 v 11
time.0 v 11
last_dt.0 v 11
step.0 v 20
dissipated.0 v 11
lost.0 v 11
made.0 v 11
external_work.0 v 11
edit_energy.0 v 11
booked_energy.0 v 11
has_edits.0 v 20
held_energy.0 v 11
Pushes.0 l 21
Pushes.1 l 1
Pushes.2 l 22
Pushes.3 l 1
RodSpins.0 l 23
RodSpins.1 l 1
Closings.0 l 24
Closings.1 l 1
Closings.2 l 1
Closings.3 v 1
Closings.4 l 25
Closings.5 l 1
Nails.0 l 26
Nails.1 l 1
Laws.0 l 27
Laws.1 l 1
Laws.2 l 1
Laws.3 v 1
Bonds.0 l 28
Bonds.1 l 1
Bonds.2 l 1
Bonds.3 v 1
Bonds.4 l 25
Bonds.5 l 1
Joints.0 l 29
Joints.1 l 1
Joints.2 l 1
Joints.3 v 1
Joints.4 l 25
Joints.5 l 1
Joints.6 l 16
Joints.7 l 30
Joints.8 l 1
Joints.9 l 1
Joints.10 v 1
Fields.0 l 31
Fields.1 l 1
Fields.2 l 1
Fields.3 v 1
Pairs.0 l 32
Pairs.1 l 1
Pairs.2 l 1
Pairs.3 v 1
Emitters.0 l 33
Emitters.1 l 1
Emitters.2 l 1
Emitters.3 v 1
Grips.0 l 34
Grips.1 l 1
Grips.2 l 1
Grips.3 v 1
Names.0 l 35
Names.1 l 1
CosmeticBonds.0 l 36
CosmeticBonds.1 l 1
CosmeticBonds.2 l 1
CosmeticBonds.3 v 1
CosmeticBonds.4 l 25
CosmeticBonds.5 l 1
AngleSprings.0 l 37
AngleSprings.1 l 1
AngleSprings.2 l 1
AngleSprings.3 v 1
AngleSprings.4 l 25
AngleSprings.5 l 1
Contacts.0 l 38
Contacts.1 l 1
Contacts.2 l 1
Contacts.3 v 1
Contacts.4 l 25
Contacts.5 l 1
IgnoredContacts.0 l 39
Strides.0 l 1
Strides.1 l 1
Strides.2 l 40
Strides.3 l 1
)";

}  // namespace iota::edit
