/** Pieces of the side panel, all reachable by keyboard and named for screen readers. */
import { fill, freshId, h } from "../dom";

/** A titled group of controls. */
export function section(title: string, ...children: (Node | string)[]): HTMLElement {
  const id = freshId("section");
  return h("section", { class: "section", "aria-labelledby": id }, h("h2", { id }, title), ...children);
}

export function button(
  label: string,
  pressed: () => void,
  options: { title?: string; kind?: "primary" | "plain" | "small" } = {},
): HTMLButtonElement {
  return h(
    "button",
    { type: "button", class: options.kind ?? "plain", title: options.title, onclick: () => pressed() },
    label,
  );
}

/** A button that stays down. */
export class Toggle {
  readonly element: HTMLButtonElement;

  constructor(label: string, on: boolean, changed: (on: boolean) => void, title = "") {
    this.element = button(
      label,
      () => {
        this.on = !this.on;
        changed(this.on);
      },
      { kind: "small", title },
    );
    this.on = on;
  }

  get on(): boolean {
    return this.element.getAttribute("aria-pressed") === "true";
  }

  set on(on: boolean) {
    this.element.setAttribute("aria-pressed", String(on));
  }
}

/** A labelled list to choose one of. */
export class Choice {
  readonly element: HTMLElement;
  readonly input: HTMLSelectElement;

  constructor(label: string, changed: (value: string) => void) {
    const id = freshId("choice");
    this.input = h("select", { id, onchange: () => changed(this.input.value) });
    this.element = h("div", { class: "row" }, h("label", { for: id }, label), this.input);
  }

  setOptions(options: readonly (readonly [value: string, words: string])[], chosen: string): void {
    fill(
      this.input,
      ...options.map(([value, words]) => h("option", { value, selected: value === chosen }, words)),
    );
  }

  get value(): string {
    return this.input.value;
  }

  set value(value: string) {
    this.input.value = value;
  }
}

/** A labelled number with its unit. */
export class NumberField {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;
  private readonly unit = h("span", { class: "unit" });

  constructor(
    label: string,
    changed: (value: number) => void,
    options: { unit?: string; min?: number; max?: number; step?: number | "any"; value?: number } = {},
  ) {
    const id = freshId("number");
    const { unit = "", min, max, step = "any", value } = options;
    this.input = h("input", { id, type: "number", min, max, step, value, inputmode: "decimal" });
    this.input.addEventListener("change", () => {
      if (Number.isFinite(this.input.valueAsNumber) && this.input.checkValidity())
        changed(this.input.valueAsNumber);
    });
    this.element = h(
      "div",
      { class: "row" },
      h("label", { for: id }, label),
      h("span", { class: "with-unit" }, this.input, this.unit),
    );
    this.setUnit(unit);
  }

  setUnit(unit: string): void {
    this.unit.textContent = unit;
    this.unit.hidden = !unit;
  }

  get value(): number {
    return this.input.valueAsNumber;
  }

  set value(value: number) {
    this.input.value = String(value);
  }
}

/** A labelled slider; `changed` is called while it moves, at most once a frame. */
export class Slider {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;
  private readonly output = h("output", {});

  constructor(
    label: string,
    changed: (value: number) => void,
    options: { min: number; max: number; step?: number; value: number; words?: (value: number) => string },
  ) {
    const id = freshId("slider");
    const { min, max, step = 1, value, words = String } = options;
    this.words = words;
    this.input = h("input", { id, type: "range", min, max, step, value });
    this.output.setAttribute("for", id);
    let waiting = false;
    this.input.addEventListener("input", () => {
      this.say();
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        changed(this.value);
      });
    });
    this.element = h("div", { class: "slider" }, h("label", { for: id }, label), this.output, this.input);
    this.say();
  }

  private readonly words: (value: number) => string;

  get value(): number {
    return this.input.valueAsNumber;
  }

  set value(value: number) {
    this.input.value = String(value);
    this.say();
  }

  setRange(min: number, max: number): void {
    this.input.min = String(min);
    this.input.max = String(max);
    this.say();
  }

  private say(): void {
    const words = this.words(this.value);
    this.output.textContent = words;
    this.input.setAttribute("aria-valuetext", words);
  }
}

/** Named numbers one above the other: `facts.set("RMS", "0.41 mm")`. */
export class Facts {
  readonly element = h("dl", { class: "facts" });
  private readonly places = new Map<string, HTMLElement>();
  private shown = "";

  /** Shows these and no others; what stays the same is left alone, so little is drawn anew. */
  show(entries: readonly (readonly [name: string, value: string, key: string])[]): void {
    const keys = entries.map(([, , key]) => key).join(" ");
    if (keys !== this.shown) this.clear();
    this.shown = keys;
    entries.forEach(([name, value, key], at) => {
      const row = this.element.children[at] ?? this.element.appendChild(h("div", {}, h("dt", {}), h("dd", { "data-fact": key })));
      const [label, number] = row.children;
      if (label.textContent !== name) label.textContent = name;
      if (number.textContent !== value) number.textContent = value;
    });
  }

  set(name: string, value: string, key = ""): void {
    let place = this.places.get(name);
    if (!place) {
      place = h("dd", { "data-fact": key || name });
      this.places.set(name, place);
      this.element.append(h("div", {}, h("dt", {}, name), place));
    }
    place.textContent = value;
  }

  clear(): void {
    this.places.clear();
    fill(this.element);
  }
}
