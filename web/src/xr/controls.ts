// SPDX-License-Identifier: Apache-2.0
// The script's controls as rows of the wrist panel. A slider has two buttons, a choice goes to its next option; texts are only shown.

import type { Choice, Command, Entry } from "../commands/command.ts";
import { WidgetKind, type WidgetEntity } from "../protocol/generated.ts";

/** Presses that take a slider from one end to the other. */
const sliderPresses = 20;
const inRow = 3;
const signs = { minus: "M6 12h12", plus: "M6 12h12M12 6v12" };

type Change = (widget: WidgetEntity, value: number) => void;

/** `change` is called with what a press sets a control to. */
export function controlRows(widgets: readonly WidgetEntity[], change: Change): Entry[][] {
  const rows: Entry[][] = [];
  let open: Entry[] | null = null;
  for (const widget of widgets) {
    if (widget.kind === WidgetKind.button || widget.kind === WidgetKind.checkbox) {
      if (open === null || open.length === inRow) rows.push((open = []));
      open.push(makeButton(widget, change));
      continue;
    }
    open = null;
    if (widget.kind === WidgetKind.slider) rows.push(makeSlider(widget, change));
    else if (widget.kind === WidgetKind.choice) rows.push(makeChoice(widget, change));
    else rows.push([makeReading(`name ${widget.label}`, () => `${widget.label}: ${widget.text}`)]);
  }
  return rows;
}

function makeButton(widget: WidgetEntity, change: Change): Command {
  const isCheck = widget.kind === WidgetKind.checkbox;
  const isOn = isCheck && widget.value !== 0;
  return {
    name: `control ${widget.label}`,
    title: () => widget.label,
    enabled: () => widget.enabled,
    active: () => isOn,
    run: () => change(widget, isCheck && !isOn ? 1 : 0),
  };
}

function makeSlider(widget: WidgetEntity, change: Change): Entry[] {
  const { label, unit, value, minimum, maximum, step, enabled } = widget;
  const pace = (maximum - minimum) / sliderPresses;
  const by = step > 0 ? Math.max(step, step * Math.round(pace / step)) : pace;
  const press = (name: string, sign: string, way: 1 | -1): Command => ({
    name: `${name} ${label}`,
    title: () => `${name} ${label}`,
    sign: () => sign,
    narrow: true,
    enabled: () => enabled,
    run: () => change(widget, Math.min(Math.max(value + way * by, minimum), maximum)),
  });
  const shown = `${Number(value.toPrecision(3))}${unit === "" ? "" : ` ${unit}`}`;
  return [makeReading(`name ${label}`, () => `${label}: ${shown}`), press("less", signs.minus, -1), press("more", signs.plus, 1)];
}

function makeChoice(widget: WidgetEntity, change: Change): Entry[] {
  const { label, options, value, enabled } = widget;
  return [
    makeReading(`name ${label}`, () => label),
    {
      name: `control ${label}`,
      title: () => options[value] ?? "",
      enabled: () => enabled,
      run: () => change(widget, (value + 1) % Math.max(options.length, 1)),
    },
  ];
}

export function makeReading(name: string, value: () => string): Choice {
  return { name, title: value, options: [], unit: "", wide: true, value, choose: () => {} };
}
