// SPDX-License-Identifier: Apache-2.0
// The one list of entity kinds: a kind of protocol/entities is one file beside this one and one line here.

import type { Vector3 } from "three";
import type { EntityKind, EntityRecords } from "../../protocol/generated.ts";
import type { ArrowEntity, AxesEntity, CustomEntity, LightEntity, PlotEntity, PointCloudEntity, ShapeSetEntity, SoundEntity, StageEntity, TextureEntity, TraceEntity, ViewpointEntity } from "../../protocol/generated.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import type { CustomView, Marks } from "./custom.ts";
import { BodyView } from "./body.ts";
import type { EntityView } from "./entity.ts";
import { FrameView } from "./frame.ts";
import { LabelView } from "./label.ts";
import { Later } from "./later.ts";
import { LineView } from "./line.ts";
import { MarkerView } from "./marker.ts";
import { Memberships } from "./membership.ts";
import { NailView } from "./nail.ts";
import { ParticleSetView } from "./particle_set.ts";
import { PaintView } from "./paint.ts";
import { StrutView } from "./strut.ts";
import { SurfaceView } from "./surface.ts";
import { Visuals } from "./visual.ts";
import { TieView } from "./tie.ts";
import type { TraceView } from "./trace.ts";
import { TubeView } from "./tube.ts";
import { WatchedRecords, Widgets } from "./widget.ts";

/** The data and functions of the page for views. */
export interface EntityHost {
  readonly poses: PoseBuffer;
  /** Place of the viewer, world, m; kept up to date. */
  readonly eye: Vector3;
  readonly marks: Marks;
  /** A body was destroyed; called before its slot can be used again. */
  bodyGone(body: number): void;
  /** Something cannot be drawn: `title` says what, `text` why. */
  warn(title: string, text: string): void;
  /** Something looks different without a message of the server. */
  changed(): void;
}

/** A view for each kind of the schema: if one is missing, this file does not compile. */
export type EntityViews = { readonly [K in EntityKind]: EntityView<EntityRecords[K]> };

/** In the order of their frames: bodies are interpolated before things on them are drawn. */
export function makeEntityViews({ poses, eye, marks, bodyGone, warn, changed }: EntityHost) {
  const visual = new Visuals(warn);
  const body = new BodyView(poses, visual, bodyGone);
  const canHold = (slot: number) => body.canHold(slot);
  const surface = new SurfaceView(poses, canHold, (slot) => body.isFixed(slot));
  const tube = new TubeView(poses, canHold);
  body.covers.push(surface, tube);
  return {
    frame: new FrameView(poses),
    visual,
    body,
    membership: new Memberships(),
    tie: new TieView(poses, visual),
    nail: new NailView(poses),
    particleSet: new ParticleSetView(),
    label: new LabelView(poses, eye),
    line: new LineView(poses),
    arrow: new Later<ArrowEntity>(() => import("./arrow.ts").then(({ ArrowView }) => new ArrowView(poses)), changed),
    axes: new Later<AxesEntity>(() => import("./axes.ts").then(({ AxesView }) => new AxesView(poses)), changed),
    trace: new Later<TraceEntity, TraceView>(() => import("./trace.ts").then(({ TraceView }) => new TraceView(poses)), changed),
    pointCloud: new Later<PointCloudEntity>(() => import("./point_cloud.ts").then(({ PointCloudView }) => new PointCloudView(poses)), changed),
    marker: new MarkerView(poses, warn),
    widget: new Widgets(),
    plot: new WatchedRecords<PlotEntity>(),
    surface,
    paint: new PaintView(body),
    shapeSet: new Later<ShapeSetEntity>(() => import("./shape_set.ts").then(({ ShapeSetView }) => new ShapeSetView(poses, warn)), changed),
    strut: new StrutView(poses, warn),
    tube,
    viewpoint: new WatchedRecords<ViewpointEntity>(),
    stage: new WatchedRecords<StageEntity>(),
    light: new Later<LightEntity>(() => import("./light.ts").then(({ LightView }) => new LightView(poses, () => body.size)), changed),
    sound: new WatchedRecords<SoundEntity>(),
    custom: new Later<CustomEntity, CustomView>(() => import("./custom.ts").then((custom) => {
      const view = new custom.CustomView(poses, marks, canHold, warn, changed);
      body.covers.push(view);
      return view;
    }), changed),
    texture: new Later<TextureEntity>(() => import("./texture.ts").then(({ TextureView }) => new TextureView(changed, warn)), changed),
  } satisfies EntityViews;
}

export type Entities = ReturnType<typeof makeEntityViews>;
