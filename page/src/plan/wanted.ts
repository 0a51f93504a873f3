/** What is to be mapped: the controls that say so, and the question for the server in its words. */
import { fill, h } from "../dom";
import { Choice, NumberField } from "../widgets/panel";

export interface Choices {
  readonly classes: readonly {
    readonly name: string;
    readonly title: string;
    readonly parameters: Readonly<{ [name: string]: number }>;
    readonly is_circular: boolean;
  }[];
  readonly fields: readonly { readonly name: string; readonly unit: string }[];
  readonly designs: readonly { readonly name: string; readonly title: string }[];
  readonly catheters: readonly string[];
  readonly n_modes: number;
}

export interface SavedWanted {
  readonly kind: string;
  readonly parameters: { [name: string]: number };
  readonly bandwidth: number;
}

const CATHETERS: { [name: string]: string } = {
  grid: "grid, 4 × 4",
  star: "star, 5 × 4",
  loop: "loop, 20",
  row: "row, 4",
};
const ENDINGS: readonly (readonly [ending: string, unit: string])[] = [
  ["_mm_per_ms", "mm/ms"],
  ["_mm", "mm"],
  ["_ms", "ms"],
];

/** `width_mm` as "Width" and "mm". */
export function named(parameter: string): [words: string, unit: string] {
  const [ending, unit] = ENDINGS.find(([each]) => parameter.endsWith(each)) ?? ["", ""];
  const plain = parameter.slice(0, parameter.length - ending.length).replaceAll("_", " ");
  return [plain.charAt(0).toUpperCase() + plain.slice(1), unit];
}

export class Wanted {
  readonly element: HTMLElement;
  private readonly kind: Choice;
  private readonly parameters = h("div", { class: "parameters" });
  private fields = new Map<string, NumberField>();
  private bandwidth = 100;
  private readonly noise: NumberField;
  private readonly acquisition: Choice;
  private readonly design: Choice;
  private readonly catheter: Choice;
  private readonly count: NumberField;

  constructor(private readonly choices: Choices) {
    const { classes, fields, designs, catheters } = choices;
    this.kind = new Choice("Kind of map", () => this.showParameters());
    this.kind.setOptions(
      [
        ...classes.map((each) => [`class:${each.name}`, capital(each.title)] as const),
        ...fields.map((each) => [`field:${each.name}`, `A map like ${each.name}`] as const),
        ["bandwidth", "A number of harmonics"],
      ],
      "class:activation",
    );
    this.noise = new NumberField("Noise of a point", () => undefined, { unit: "% of the map’s deviation", min: 0, max: 1000, value: 5 });
    this.acquisition = new Choice("Points are taken", () => undefined);
    this.acquisition.setOptions([["planned", "where the plan says"], ["unplanned", "wherever the catheter is"]], "planned");
    this.design = new Choice("Placed", () => undefined);
    this.design.setOptions(designs.map((each) => [each.name, each.title] as const), "farthest");
    this.catheter = new Choice("Catheter", () => undefined);
    this.catheter.setOptions([["", "one point at a time"], ...catheters.map((each) => [each, CATHETERS[each] ?? each] as const)], "");
    this.count = new NumberField("Only so many", () => undefined, { unit: "points", min: 1, step: 1 });
    this.count.input.placeholder = "as needed";
    const more = h("details", { class: "more" }, h("summary", {}, "How they are taken"), this.acquisition.element, this.catheter.element, this.design.element, this.count.element);
    this.element = h("div", { class: "wanted" }, this.kind.element, this.parameters, this.noise.element, more);
    this.showParameters();
  }

  /** Parameters for POST /api/plan, but the target. */
  get question(): { [name: string]: unknown } {
    const [kind, name] = this.kind.value.split(/:(.*)/s);
    const count = this.count.value;
    const parameters = this.entered();
    const cycle = parameters["cycle_length_ms"];
    return {
      ...(kind === "class" ? { map_class: name, parameters } : {}),
      ...(kind === "field" ? { field: name, ...(cycle > 0 ? { cycle_length_ms: cycle } : {}) } : {}),
      ...(kind === "bandwidth" ? { bandwidth: parameters["harmonics"] } : {}),
      noise_ratio: this.noise.value / 100,
      acquisition: this.acquisition.value,
      design: this.design.value,
      catheter: this.catheter.value || null,
      n_samples: Number.isFinite(count) ? count : null,
    };
  }

  get saved(): SavedWanted {
    return { kind: this.kind.value, parameters: this.entered(), bandwidth: this.bandwidth };
  }

  restore(saved: SavedWanted): void {
    if (![...this.kind.input.options].some((option) => option.value === saved.kind)) return;
    this.kind.value = saved.kind;
    this.showParameters();
    for (const [name, value] of Object.entries(saved.parameters ?? {})) {
      const field = this.fields.get(name);
      if (field && Number.isFinite(value)) field.value = value;
    }
  }

  private entered(): { [name: string]: number } {
    return Object.fromEntries([...this.fields].map(([name, field]) => [name, field.value]));
  }

  private showParameters(): void {
    const [kind, name] = this.kind.value.split(/:(.*)/s);
    const { n_modes } = this.choices;
    const defaults: Readonly<{ [name: string]: number }> =
      kind === "class"
        ? (this.choices.classes.find((each) => each.name === name)?.parameters ?? {})
        : kind === "bandwidth"
          ? { harmonics: Math.min(this.bandwidth, n_modes) }
          : { cycle_length_ms: 0 };
    this.fields = new Map(
      Object.entries(defaults).map(([key, value]) => {
        const [words, unit] = named(key);
        const field = new NumberField(words, () => undefined, { unit, min: 0, value, ...(key === "harmonics" ? { min: 2, max: n_modes, step: 1 } : {}) });
        if (kind === "field") field.input.title = "0 if the times do not wrap round";
        return [key, field];
      }),
    );
    fill(this.parameters, ...[...this.fields.values()].map((field) => field.element));
  }
}

function capital(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1);
}
