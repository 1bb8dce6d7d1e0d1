// SPDX-License-Identifier: Apache-2.0
const ROTATION_STEP = Math.SQRT2 / 1023;

/** Unit quaternion (x y z w) of a packed rotation, written to out[offset .. offset + 3]. */
export function unpackRotation(packed: number, out: Float32Array, offset: number): void {
  const largest = packed >>> 30;
  let rest = 1;
  let shift = 20;
  for (let i = 0; i < 4; i++) {
    if (i === largest) continue;
    const value = ((packed >>> shift) & 1023) * ROTATION_STEP - Math.SQRT1_2;
    out[offset + i] = value;
    rest -= value * value;
    shift -= 10;
  }
  out[offset + largest] = Math.sqrt(Math.max(rest, 0));
}

/** Position (world, m) of row `i` of `poses.bodies`, written to out[offset .. offset + 2]. */
export function unpackPosition(
  poses: PosesBuffer,
  i: number,
  out: Float32Array,
  offset: number,
): void {
  const { bodies, boxMin, boxMax } = poses;
  const lowX = boxMin[0] as number;
  const lowY = boxMin[1] as number;
  const lowZ = boxMin[2] as number;
  out[offset] = lowX + ((bodies.x[i] as number) / 65535) * ((boxMax[0] as number) - lowX);
  out[offset + 1] = lowY + ((bodies.y[i] as number) / 65535) * ((boxMax[1] as number) - lowY);
  out[offset + 2] = lowZ + ((bodies.z[i] as number) / 65535) * ((boxMax[2] as number) - lowZ);
}

const scratchPosition = new Float32Array(3);
const scratchRotation = new Float32Array(4);

/**
 * Calls `set` for every body of the frame, near and far: slot, position (x y z, world, m), unit quaternion (x y z w).
 * The two arrays are reused by the next call: copy what has to stay.
 */
export function forEachPose(
  poses: PosesBuffer,
  set: (body: number, position: Float32Array, rotation: Float32Array) => void,
): void {
  const { bodies, farBodies } = poses;
  for (let i = 0; i < bodies.count; i++) {
    unpackPosition(poses, i, scratchPosition, 0);
    unpackRotation(bodies.rotation[i] as number, scratchRotation, 0);
    set(bodies.body[i] as number, scratchPosition, scratchRotation);
  }
  for (let i = 0; i < farBodies.count; i++) {
    for (let k = 0; k < 3; k++) scratchPosition[k] = farBodies.position[3 * i + k] as number;
    unpackRotation(farBodies.rotation[i] as number, scratchRotation, 0);
    set(farBodies.body[i] as number, scratchPosition, scratchRotation);
  }
}
