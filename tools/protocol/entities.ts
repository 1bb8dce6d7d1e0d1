// SPDX-License-Identifier: Apache-2.0
/** The kind that a message names; undefined where this page does not know it: its records are then to be left out. */
export function entityKindOf(name: string): EntityKind | undefined {
  return entityKindsByName.get(name);
}

/** The entities of one kind whose records `records` are. */
export function decodeEntities<K extends EntityKind>(kind: K, records: Uint8Array): EntityRecords[K][] {
  const entities: EntityRecords[K][] = [];
  reader.startRecords(records);
  while (reader.left() > 0) entities.push(entityCodecs[kind].read());
  reader.finish();
  return entities;
}

/** The records of entities of one kind. */
export function encodeEntities<K extends EntityKind>(kind: K, entities: readonly EntityRecords[K][]): Uint8Array {
  writer.startRecords();
  for (const entity of entities) entityCodecs[kind].write(entity);
  return new Uint8Array(writer.finish());
}
