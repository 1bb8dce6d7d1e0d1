// SPDX-License-Identifier: Apache-2.0
// Joints are not drawn: their bodies show their places.

import type { JointEntity } from "../../protocol/generated.ts";
import { EntityRecords } from "./entity.ts";

export class JointView extends EntityRecords<JointEntity> {}
