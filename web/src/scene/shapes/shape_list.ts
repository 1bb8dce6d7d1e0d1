// SPDX-License-Identifier: Apache-2.0
// Every shape, by name. A new shape needs a file here and a line below (and a header in src/shape of the engine).

import { box } from "./box.ts";
import { capsule } from "./capsule.ts";
import { cone } from "./cone.ts";
import { cylinder } from "./cylinder.ts";
import { ellipsoid } from "./ellipsoid.ts";
import { halfSpace } from "./half_space.ts";
import type { Kind } from "./kind.ts";
import { mesh } from "./mesh.ts";
import { sphere } from "./sphere.ts";
import { torus } from "./torus.ts";

export const shapeList: readonly Kind[] = [sphere, box, cylinder, capsule, torus, mesh, ellipsoid, halfSpace, cone];

const byName = new Map(shapeList.map((kind) => [kind.name, kind]));

/** Throws an Error that lists the shapes for an unknown name. */
export function shapeKind(name: string): Kind {
  const kind = byName.get(name);
  if (kind === undefined) throw new Error(`unknown shape ${JSON.stringify(name)}; known: ${[...byName.keys()].join(", ")}`);
  return kind;
}
