// SPDX-License-Identifier: Apache-2.0
// The script's controls and plots, at the right edge; absent if the script has none.

import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import { Role, WidgetKind, type PlotEntity, type WidgetEntity } from "../protocol/generated.ts";
import { byId, make, makeSign } from "./dom.ts";
import { drawPlot } from "./plot.ts";
import { signOf } from "./signs.ts";

type PanelPage = Pick<Page, "world" | "session" | "viewer">;

/** A shown control. */
interface Shown {
  readonly element: HTMLElement;
  /** The values of its record whose change needs another element. */
  readonly face: string;
  show(widget: WidgetEntity): void;
}

interface ShownPlot {
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly legend: HTMLElement;
}

/** In narrower windows the panel would cover much of the world: it is folded there, and opens at a touch. */
const roomy = "(min-width: 900px)";
/** Share of the window's height. */
const lowest = 0.3;

export class Panel implements FramePart {
  private readonly page_: PanelPage;
  private readonly root_ = make("details", "panel");
  private readonly list_ = make("div", "controls");
  private readonly shown_ = new Map<number, Shown>();
  private readonly plots_ = new Map<number, ShownPlot>();
  private widgetsSeen_ = 0;
  private plotsSeen_ = 0;
  private refusal_ = "";

  constructor(page: PanelPage) {
    this.page_ = page;
    this.root_.id = "panel";
    const room = matchMedia(roomy);
    this.root_.open = room.matches;
    room.addEventListener("change", () => {
      this.root_.open = room.matches;
    });
    this.root_.hidden = true;
    this.root_.setAttribute("aria-label", "Controls of the world");
    this.root_.append(make("summary", "", "Controls"), this.list_);
    this.root_.addEventListener("toggle", () => {
      this.plotsSeen_ = -1;
    });
    document.body.append(this.root_);
    this.keepAbove_(byId("foot", HTMLElement));
  }

  /** Ends above the bar and the figures beside it, however high these are. */
  private keepAbove_(foot: HTMLElement): void {
    const fit = () => this.root_.style.setProperty("--foot", `${Math.ceil(innerHeight - foot.getBoundingClientRect().top)}px`);
    new ResizeObserver(fit).observe(foot);
    // A view is framed beside the panel, and under one that is low.
    new ResizeObserver(() => {
      const { left, height } = this.root_.getBoundingClientRect();
      this.page_.viewer.margins.right = height > lowest * innerHeight ? innerWidth - left + 12 : 0;
      this.page_.viewer.invalidate();
    }).observe(this.root_);
    window.addEventListener("resize", fit);
    fit();
  }

  draw(): void {
    const { widget, plot } = this.page_.world.entities;
    const refusal = this.page_.session.refusal(Role.actor);
    if (widget.version !== this.widgetsSeen_ || refusal !== this.refusal_) {
      this.widgetsSeen_ = widget.version;
      this.refusal_ = refusal;
      this.showWidgets_(widget.of(this.page_.session.clientId));
    }
    if (plot.version !== this.plotsSeen_) {
      this.plotsSeen_ = plot.version;
      this.showPlots_(plot.all());
    }
    this.root_.hidden = this.shown_.size + plot.size === 0;
  }

  private showWidgets_(widgets: readonly WidgetEntity[]): void {
    const known = new Set(widgets.map(({ id }) => id.slot));
    for (const [slot, { element }] of this.shown_) {
      if (known.has(slot)) continue;
      element.remove();
      this.shown_.delete(slot);
    }
    let before: Element | null = null;
    for (const widget of widgets) {
      const element = this.showWidget_(widget);
      const place: Element | null = before === null ? this.list_.firstElementChild : before.nextElementSibling;
      if (place !== element) this.list_.insertBefore(element, place);
      before = element;
    }
  }

  private showWidget_(widget: WidgetEntity): HTMLElement {
    const { slot, generation } = widget.id;
    const title = this.refusal_ || widget.help;
    const face = JSON.stringify([generation, widget.kind, widget.label, title, widget.options]);
    let shown = this.shown_.get(slot);
    if (shown?.face !== face) {
      shown?.element.remove();
      shown = { face, ...this.make_(widget) };
      if (title !== "") shown.element.title = title;
      this.shown_.set(slot, shown);
    }
    shown.show(this.refusal_ === "" ? widget : { ...widget, enabled: false });
    return shown.element;
  }

  private make_(widget: WidgetEntity): Omit<Shown, "face"> {
    const send = (value: number, text = "") => {
      this.page_.session.send({ type: "change", widget: widget.id, value, text });
    };
    switch (widget.kind) {
      case WidgetKind.button: return makePress(widget, send);
      case WidgetKind.slider: return makeSlider(widget, send);
      case WidgetKind.checkbox: return makeCheck(widget, send);
      case WidgetKind.choice: return makeChoice(widget, send);
      default: return makeText(widget, send);
    }
  }

  private showPlots_(plots: readonly PlotEntity[]): void {
    const known = new Set(plots.map(({ id }) => id.slot));
    for (const [slot, { element }] of this.plots_) {
      if (known.has(slot)) continue;
      element.remove();
      this.plots_.delete(slot);
    }
    for (const plot of plots) {
      let shown = this.plots_.get(plot.id.slot);
      if (shown === undefined) {
        shown = makePlot(plot);
        this.plots_.set(plot.id.slot, shown);
        this.list_.append(shown.element);
      }
      if (this.root_.open) drawPlot(shown.canvas, shown.legend, plot);
    }
  }
}

type Send = (value: number, text?: string) => void;

/** A label of more characters is a question: its control is below it, as wide as the panel. */
const longestName = 28;

function isQuestion({ label }: WidgetEntity): boolean {
  return label.length > longestName;
}

function labeled(widget: WidgetEntity, ...parts: readonly HTMLElement[]): HTMLElement {
  const label = make("label", isQuestion(widget) ? "control question" : "control");
  label.append(make("span", "name", widget.label), ...parts);
  return label;
}

function makePress(widget: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const button = make("button", "press", widget.label);
  button.type = "button";
  button.addEventListener("click", () => send(1));
  return { element: button, show: ({ enabled }) => {
    button.disabled = !enabled;
  } };
}

/** The least number of digits that distinguishes the slider's values. */
export function written(value: number, span: number): string {
  const digits = span > 0 ? Math.min(Math.max(3 - Math.floor(Math.log10(span)), 0), 100) : 3;
  return String(Number(value.toFixed(digits)));
}

function makeSlider(widget: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const input = make("input");
  input.type = "range";
  // Not <output>, which the label would name instead of the slider.
  const value = make("span", "value");
  let shown = widget;
  const write = (now: number) => {
    value.textContent = `${written(now, shown.maximum - shown.minimum)}${shown.unit === "" ? "" : ` ${shown.unit}`}`;
    input.setAttribute("aria-valuetext", value.textContent);
  };
  input.addEventListener("input", () => {
    write(input.valueAsNumber);
    send(input.valueAsNumber);
  });
  const element = labeled(widget, value, input);
  element.classList.add("slider");
  return { element, show: (now) => {
    shown = now;
    input.min = String(now.minimum);
    input.max = String(now.maximum);
    input.step = now.step > 0 ? String(now.step) : "any";
    input.disabled = !now.enabled;
    // A control that the user is changing is not updated.
    if (input.matches(":active")) return;
    input.value = String(now.value);
    write(now.value);
  } };
}

function makeCheck(widget: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const input = make("input");
  input.type = "checkbox";
  input.addEventListener("change", () => send(input.checked ? 1 : 0));
  return { element: labeled(widget, input), show: ({ value, enabled }) => {
    input.checked = value !== 0;
    input.disabled = !enabled;
  } };
}

/** More options are a list. */
const mostSigns = 6;

function makeChoice(widget: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const { options } = widget;
  if (options.length <= mostSigns && options.every((option) => signOf(option) !== undefined)) return makeSigns(widget, send);
  const select = make("select");
  widget.options.forEach((option, index) => select.append(new Option(option, String(index))));
  select.addEventListener("change", () => send(select.selectedIndex));
  return { element: labeled(widget, select), show: ({ value, enabled }) => {
    select.selectedIndex = value;
    select.disabled = !enabled;
  } };
}

/** A choice of what has signs: all are seen, and one press takes one. */
function makeSigns({ id, label, options }: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const element = make("fieldset", "control signs");
  const row = make("div", "row");
  const inputs = options.map((option, index) => {
    const input = make("input");
    input.type = "radio";
    input.name = `choice ${id.slot}`;
    input.addEventListener("change", () => send(index));
    const choice = make("label");
    choice.append(input, makeSign(signOf(option)!), make("span", "", option));
    row.append(choice);
    return input;
  });
  element.append(make("legend", "", label), row);
  return { element, show: ({ value, enabled }) => {
    element.disabled = !enabled;
    for (const [index, input] of inputs.entries()) input.checked = index === value;
  } };
}

/** A line; for a question, whose answer may be long, some lines. */
function makeText(widget: WidgetEntity, send: Send): Omit<Shown, "face"> {
  const input = make(isQuestion(widget) ? "textarea" : "input");
  if (input instanceof HTMLInputElement) input.type = "text";
  else input.rows = 3;
  input.maxLength = 1000;
  input.addEventListener("change", () => send(0, input.value));
  return { element: labeled(widget, input), show: ({ text, enabled }) => {
    input.disabled = !enabled;
    if (document.activeElement !== input) input.value = text;
  } };
}

function makePlot({ label, unit }: PlotEntity): ShownPlot {
  const element = make("figure", "plot");
  const caption = make("figcaption", "", unit === "" ? label : `${label}, ${unit}`);
  const canvas = make("canvas");
  const legend = make("div", "legend");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `Plot of ${label}`);
  element.append(caption, canvas, legend);
  return { element, canvas, legend };
}
