// SPDX-License-Identifier: Apache-2.0
//
// The chain in Jolt as npm ships it (WebAssembly, single precision), under Node.js: its own loop, since Python cannot call it.
//   node bench/peers/jolt_chain.mjs LINKS HZ SUBSTEPS SECONDS CAP      prints one row as JSON; see chain.py for what it means
import initJolt from "jolt-physics";

const LENGTH = 0.1, MASS = 0.1, RADIUS = 0.005, GRAVITY = 9.81;
const AXIAL = (MASS * RADIUS ** 2) / 2, TRANSVERSE = (MASS * (3 * RADIUS ** 2 + LENGTH ** 2)) / 12;
const [links, hz, substeps, seconds, cap] = process.argv.slice(2).map(Number);

const Jolt = await initJolt();
const settings = new Jolt.JoltSettings();
settings.mMaxWorkerThreads = 0;
settings.mMaxBodies = links + 16;
settings.mObjectLayerPairFilter = new Jolt.ObjectLayerPairFilterTable(1); // nothing collides
const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
settings.mBroadPhaseLayerInterface = layers;
settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, settings.mObjectLayerPairFilter, 1);
const world = new Jolt.JoltInterface(settings);
const physics = world.GetPhysicsSystem(), bodyInterface = physics.GetBodyInterface();
physics.SetGravity(new Jolt.Vec3(0, -GRAVITY, 0));

function addBody(x, moves) {
  const motion = moves ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static;
  const creation = new Jolt.BodyCreationSettings(
    new Jolt.SphereShape(RADIUS), new Jolt.RVec3(x, 0, 0), new Jolt.Quat(0, 0, 0, 1), motion, 0);
  creation.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
  creation.mMassPropertiesOverride.mMass = MASS;
  creation.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(new Jolt.Vec3(AXIAL, TRANSVERSE, TRANSVERSE));
  creation.mLinearDamping = creation.mAngularDamping = 0;
  creation.mAllowSleeping = false;
  const body = bodyInterface.CreateBody(creation);
  bodyInterface.AddBody(body.GetID(), moves ? Jolt.EActivation_Activate : Jolt.EActivation_DontActivate);
  return body;
}

const bodies = [];
let before = addBody(0, false);
for (let i = 0; i < links; ++i) {
  const body = addBody((i + 0.5) * LENGTH, true);
  bodies.push(body);
  const joint = new Jolt.PointConstraintSettings();
  joint.mSpace = Jolt.EConstraintSpace_WorldSpace;
  joint.mPoint1 = joint.mPoint2 = new Jolt.RVec3(i * LENGTH, 0, 0);
  physics.AddConstraint(joint.Create(before, body));
  before = body;
}

function observe() {
  let gap = 0, twice = 0, potential = 0, end = [0, 0, 0];
  for (const body of bodies) {
    const p = body.GetPosition(), q = body.GetRotation(), v = body.GetLinearVelocity(), w = body.GetAngularVelocity();
    const [x, y, z, r] = [q.GetX(), q.GetY(), q.GetZ(), q.GetW()];
    const axis = [1 - 2 * (y * y + z * z), 2 * (x * y + r * z), 2 * (x * z - r * y)];
    const centre = [p.GetX(), p.GetY(), p.GetZ()], spin = [w.GetX(), w.GetY(), w.GetZ()];
    gap = Math.max(gap, Math.hypot(...centre.map((c, k) => c - axis[k] * LENGTH / 2 - end[k])));
    end = centre.map((c, k) => c + (axis[k] * LENGTH) / 2);
    const along = spin[0] * axis[0] + spin[1] * axis[1] + spin[2] * axis[2];
    const across = spin[0] ** 2 + spin[1] ** 2 + spin[2] ** 2 - along ** 2;
    twice += MASS * (v.GetX() ** 2 + v.GetY() ** 2 + v.GetZ() ** 2) + TRANSVERSE * across + AXIAL * along ** 2;
    potential += MASS * GRAVITY * centre[1];
  }
  return { gap, kinetic: twice / 2, potential };
}

const row = {
  engine: "jolt", setting: substeps > 1 ? `sub${substeps}` : "default", links, hz, steps: 0,
  observed_every: Math.max(1, Math.floor(links / (64 * substeps))), blew_up: "", note: "WebAssembly",
};
const available = (MASS * GRAVITY * LENGTH * links ** 2) / 2, total = Math.round(seconds * hz);
const began = performance.now();
const first = observe(), start = first.kinetic + first.potential;
let spent = 0, highest = start, last = start, largest = 0, worst = 0;
while (row.steps < total && performance.now() - began < 1000 * cap) {
  const count = Math.min(row.observed_every, total - row.steps);
  const cpu = process.cpuUsage();
  for (let i = 0; i < count; ++i) world.Step(1 / hz, substeps);
  const used = process.cpuUsage(cpu);
  spent += used.user + used.system;
  row.steps += count;
  const { gap, kinetic, potential } = observe(), when = `${(row.steps / hz).toFixed(2)} s`;
  if (!Number.isFinite(gap + kinetic + potential)) {
    row.blew_up ||= `not a number at ${when}`;
    break;
  }
  last = kinetic + potential;
  highest = Math.max(highest, last), largest = Math.max(largest, kinetic), worst = Math.max(worst, gap);
  if (gap > LENGTH) row.blew_up ||= `gap over a link at ${when}`;
  if (kinetic > 1.5 * available) row.blew_up ||= `energy at ${when}`;
}
row.simulated_s = row.steps / hz;
row.us_per_link_step = spent / (row.steps * links);
row.worst_gap_m = worst;
row.kinetic_over_available = largest / available;
row.energy_end = largest > 0 ? (last - start) / largest : null;
row.energy_gain = largest > 0 ? (highest - start) / largest : null;
console.log(JSON.stringify(row));
process.exit(0);
