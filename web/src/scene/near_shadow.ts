// SPDX-License-Identifier: Apache-2.0
// A second, finer picture of the key light's shadow where the camera is near a part of a wide scene: in that of the whole scene what is small
// there has a blot for a shadow, or none. three.js has one picture for each light, so it belongs to a light that gives none.

import { DirectionalLight, ShaderChunk, Vector3, type Camera, type Sphere } from "three";

/** The intensity of its shadow, by which the shader knows this light. */
const mark = 2;

/** The shader asks for a light's shadow here. */
const before = "directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ]";
const uses = `
#if UNROLLED_LOOP_INDEX == 0 && NUM_DIR_LIGHT_SHADOWS > 1
  vec2 nearEdge = smoothstep( vec2( 0.5 ), vec2( 0.45 ), abs( vDirectionalShadowCoord[ 1 ].xy - 0.5 ) );
  float near = nearEdge.x * nearEdge.y * step( 1.5, directionalLightShadows[ 1 ].shadowIntensity );
  if ( near > 0.0 && receiveShadow ) {
    DirectionalLightShadow nearShadow = directionalLightShadows[ 1 ];
    float fine = getShadow( directionalShadowMap[ 1 ], nearShadow.shadowMapSize, 1.0, nearShadow.shadowBias, nearShadow.shadowRadius, vDirectionalShadowCoord[ 1 ] );
    float coarse = near < 1.0 ? getShadow( directionalShadowMap[ 0 ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity,
      directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ 0 ] ) : 1.0;
    directLight.color *= mix( coarse, fine, near );
  } else
#endif
`;

/** The text of three.js for lights, in which the first light's shadow has a finer picture where there is one. */
export function withNearShadow(text: string): string {
  return text.includes(uses) ? text : text.replace(before, `${uses}${before}`);
}

export class NearShadow {
  /** Has to be the directional light after the key light in the scene. */
  readonly light = new DirectionalLight("#000000", 0);
  /** Middle and half the width of what it covers, m. */
  readonly center = new Vector3();
  reach = 0;

  private readonly eye_ = new Vector3();
  private readonly ahead_ = new Vector3();
  private readonly across_ = new Vector3();
  private readonly up_ = new Vector3();

  constructor() {
    ShaderChunk.lights_fragment_begin = withNearShadow(ShaderChunk.lights_fragment_begin);
    const { shadow } = this.light;
    this.light.castShadow = true;
    shadow.mapSize.set(2048, 2048);
    shadow.radius = 4;
    shadow.intensity = mark;
  }

  /** Covers what the camera sees from itself to its pivot, `distance` away, and beyond. */
  follow(camera: Camera, distance: number, toLight: Vector3, lit: Sphere): void {
    const eye = camera.getWorldPosition(this.eye_);
    const ahead = camera.getWorldDirection(this.ahead_);
    // Between the size of what is near and that of all, in steps, so that edges move seldom while the camera does.
    const reach = 2 ** (Math.round(2 * Math.log2(0.7 * Math.sqrt(distance * lit.radius))) / 2);
    const height = eye.y + distance * ahead.y;
    ahead.multiplyScalar(Math.max(distance, 0.8 * reach)).add(eye).y = height;
    this.aim(ahead, reach, toLight, lit);
  }

  /** Covers a ball about a place as seen along the key light, which is at `toLight` from all that is lit. */
  aim(center: Vector3, reach: number, toLight: Vector3, lit: Sphere): void {
    const { light, light: { shadow, shadow: { camera } }, across_: across, up_: up } = this;
    const pixel = (2 * reach) / shadow.mapSize.x;
    this.reach = reach;
    // By whole pixels, so that edges do not flicker while the camera moves.
    across.set(0, 1, 0).cross(toLight).normalize();
    up.crossVectors(toLight, across).normalize();
    this.center.copy(center);
    for (const axis of [across, up]) {
      const along = center.dot(axis);
      this.center.addScaledVector(axis, Math.round(along / pixel) * pixel - along);
    }
    // From above all that is lit to below it.
    const height = up.copy(toLight).normalize().dot(lit.center) - this.center.dot(up);
    light.target.position.copy(this.center);
    light.position.copy(this.center).addScaledVector(up, height + 1.02 * lit.radius);
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0;
    camera.far = 2.04 * lit.radius;
    camera.updateProjectionMatrix();
    shadow.bias = (-0.0013 * reach) / camera.far;
    shadow.normalBias = 0.002 * reach;
  }
}
