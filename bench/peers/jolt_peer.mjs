// SPDX-License-Identifier: Apache-2.0
//
// Jolt as npm ships it (WebAssembly, single precision), under Node.js: its own loop, since Python cannot call it.
//   node bench/peers/jolt_peer.mjs JOB      reads run.py's job, prints one row as JSON; judge.py tells what it means
import { readFileSync } from "node:fs";
import initJolt from "jolt-physics";

const { scene, hz, substeps, seconds, cap, available, gravity, longest_gap, row } = JSON.parse(readFileSync(process.argv[2], "utf8"));

const Jolt = await initJolt();
const settings = new Jolt.JoltSettings();
settings.mMaxWorkerThreads = 0;
settings.mMaxBodies = scene.mass.length + 16;
settings.mObjectLayerPairFilter = new Jolt.ObjectLayerPairFilterTable(1); // nothing collides
const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
settings.mBroadPhaseLayerInterface = layers;
settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, settings.mObjectLayerPairFilter, 1);
const world = new Jolt.JoltInterface(settings);
const physics = world.GetPhysicsSystem(), bodyInterface = physics.GetBodyInterface();
physics.SetGravity(new Jolt.Vec3(0, -gravity, 0));

function addBody(center, turn, mass, inertia) {
  const motion = mass ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static;
  const creation = new Jolt.BodyCreationSettings(
    new Jolt.SphereShape(0.005), new Jolt.RVec3(...center), new Jolt.Quat(...turn), motion, 0);
  if (mass) {
    creation.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
    creation.mMassPropertiesOverride.mMass = mass;
    creation.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(new Jolt.Vec3(...inertia));
  }
  creation.mLinearDamping = creation.mAngularDamping = 0;
  creation.mAllowSleeping = false;
  const body = bodyInterface.CreateBody(creation);
  bodyInterface.AddBody(body.GetID(), mass ? Jolt.EActivation_Activate : Jolt.EActivation_DontActivate);
  return body;
}

const ground = addBody([0, 0, 0], [0, 0, 0, 1], 0);
const bodies = scene.mass.map((mass, k) => addBody(scene.center[k], scene.turn[k], mass, scene.inertia[k]));
scene.joints.forEach(([first, second], k) => {
  const joint = new Jolt.PointConstraintSettings();
  joint.mSpace = Jolt.EConstraintSpace_WorldSpace;
  joint.mPoint1 = joint.mPoint2 = new Jolt.RVec3(...scene.joint_at[k]);
  physics.AddConstraint(joint.Create(first < 0 ? ground : bodies[first], bodies[second]));
});

/** `v` turned by the unit quaternion (x, y, z, w); `back`: by its inverse. */
function turned([x, y, z, w], v, back = false) {
  const s = back ? -1 : 1, [a, b, c] = [s * x, s * y, s * z];
  const t = [2 * (b * v[2] - c * v[1]), 2 * (c * v[0] - a * v[2]), 2 * (a * v[1] - b * v[0])];
  return [v[0] + w * t[0] + b * t[2] - c * t[1], v[1] + w * t[1] + c * t[0] - a * t[2], v[2] + w * t[2] + a * t[1] - b * t[0]];
}

function observe() {
  let twice = 0, potential = 0, gap = 0;
  const poses = bodies.map((body, k) => {
    const p = body.GetPosition(), q = body.GetRotation();
    const center = [p.GetX(), p.GetY(), p.GetZ()], turn = [q.GetX(), q.GetY(), q.GetZ(), q.GetW()];
    const v = body.GetLinearVelocity(), speed = v.GetX() ** 2 + v.GetY() ** 2 + v.GetZ() ** 2;
    const w = body.GetAngularVelocity(), spin = turned(turn, [w.GetX(), w.GetY(), w.GetZ()], true);
    twice += scene.mass[k] * speed + spin.reduce((sum, s, axis) => sum + scene.inertia[k][axis] * s * s, 0);
    potential += scene.mass[k] * gravity * center[1];
    return { center, turn };
  });
  const end = (body, anchor) =>
    body < 0 ? anchor : turned(poses[body].turn, anchor).map((value, axis) => value + poses[body].center[axis]);
  scene.joints.forEach(([first, second], k) => {
    const a = end(first, scene.anchors[0][k]), b = end(second, scene.anchors[1][k]);
    gap = Math.max(gap, Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
  });
  return { gap, kinetic: twice / 2, potential };
}

const total = Math.round(seconds * hz), began = performance.now();
const first = observe(), start = first.kinetic + first.potential;
let spent = 0, highest = start, last = start, largest = 0, worst = 0, every = 1;
while (row.steps < total && performance.now() - began < 1000 * cap) {
  const count = Math.min(every, total - row.steps);
  const cpu = process.cpuUsage();
  for (let i = 0; i < count; ++i) world.Step(1 / hz, substeps);
  const used = process.cpuUsage(cpu);
  const took = used.user + used.system;
  spent += took;
  row.steps += count;
  const { gap, kinetic, potential } = observe(), when = `${(row.steps / hz).toFixed(2)} s`;
  const all = process.cpuUsage(cpu);
  if (all.user + all.system > 2 * took) ++every;
  if (!Number.isFinite(gap + kinetic + potential)) {
    row.blew_up ||= `not a number at ${when}`;
    break;
  }
  last = kinetic + potential;
  highest = Math.max(highest, last), largest = Math.max(largest, kinetic), worst = Math.max(worst, gap);
  if (gap > longest_gap) row.blew_up ||= `gap over a link at ${when}`;
  if (kinetic > 1.5 * available) row.blew_up ||= `energy at ${when}`;
}
row.simulated_s = row.steps / hz;
row.us_per_link_step = spent / (row.steps * scene.mass.length);
row.worst_gap_m = worst;
row.kinetic_over_available = largest / available;
row.energy_end = largest > 0 ? (last - start) / largest : null;
row.energy_gain = largest > 0 ? (highest - start) / largest : null;
console.log(JSON.stringify(row));
process.exit(0);
