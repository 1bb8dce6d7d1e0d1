// SPDX-License-Identifier: Apache-2.0
// Nails are known, and not drawn.

import type { NailEntity } from "../../protocol/generated.ts";
import { EntityRecords } from "./entity.ts";

export class NailView extends EntityRecords<NailEntity> {}
