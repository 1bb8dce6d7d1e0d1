// SPDX-License-Identifier: Apache-2.0
// Joints are known, and not drawn: the bodies that they connect show where they are.

import type { JointEntity } from "../../protocol/generated.ts";
import { EntityRecords } from "./entity.ts";

export class JointView extends EntityRecords<JointEntity> {}
