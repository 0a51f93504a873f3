/** Where the value of a clicked point comes from: typed in, or read off a map to practise on. */
import type { SurfaceCase } from "../surfacecase";
import { Choice, NumberField } from "../widgets/panel";
import type { Aim } from "./live";

export interface Truth {
  readonly name: string;
  readonly unit: string;
  readonly values: Float32Array;
}

export class ValueSource {
  readonly choice: Choice;
  readonly typed: NumberField;
  readonly noise: NumberField;
  readonly cycle: NumberField;
  private example: Truth | null = null;

  /** `changed` is called when values are of another map from now on. */
  constructor(
    private readonly surface: SurfaceCase,
    changed: () => void,
  ) {
    this.typed = new NumberField("Value", () => undefined, { value: 0 });
    this.noise = new NumberField("Noise of a value", changed, { min: 0, unit: " " });
    this.noise.input.placeholder = "unknown";
    this.cycle = new NumberField("Cycle length", changed, { unit: "ms", min: 0 });
    this.cycle.input.placeholder = "none";
    this.choice = new Choice("A click takes", () => {
      this.settle();
      changed();
    });
    this.offer();
    const first = surface.fields.find((field) => field.signal >= 0);
    if (first) this.choice.value = `field:${first.name}`;
    this.settle();
  }

  /** Offers an example of the planned kind of map too. */
  setExample(example: Truth | null): void {
    const chosen = this.choice.value;
    this.example = example;
    this.offer();
    this.choice.value = chosen === "example" && !example ? "typed" : chosen;
    this.settle();
  }

  /** The map that values are read off, if they are. */
  get truth(): Truth | null {
    const chosen = this.choice.value;
    if (chosen === "example") return this.example;
    if (!chosen.startsWith("field:")) return null;
    return this.surface.fields.find((field) => `field:${field.name}` === chosen) ?? null;
  }

  /** What a sample at a place of a face is; NaN if it is not known there. */
  valueAt(corners: readonly number[], weights: readonly number[]): number {
    const { truth } = this;
    if (!truth) return this.typed.value;
    const value = weights.reduce((sum, weight, place) => sum + weight * truth.values[corners[place]], 0);
    const noise = Number.isFinite(this.noise.value) ? this.noise.value : 0;
    return value + noise * normal();
  }

  aim(target: number): Aim {
    const { truth } = this;
    const cycle = this.cycle.value;
    return {
      name: truth?.name ?? "value",
      unit: truth?.unit ?? "",
      target_nrmse: target,
      noise: Number.isFinite(this.noise.value) ? this.noise.value : null,
      cycle_length_ms: cycle > 0 ? cycle : null,
    };
  }

  private offer(): void {
    const fields = this.surface.fields.map((field) => [`field:${field.name}`, `the value of ${field.title || field.name}`] as const);
    const example = this.example ? [["example", "the value of the plan’s example"] as const] : [];
    const chosen = this.choice.value || "typed";
    this.choice.setOptions([["typed", "the value typed below"], ...fields, ...example], chosen);
  }

  private settle(): void {
    this.typed.element.hidden = this.truth !== null;
    const unit = this.noise.element.querySelector(".unit");
    if (unit) unit.textContent = this.truth?.unit ?? "";
  }
}

/** Error of a map relative to the deviation of the true one, over the area where both are known. */
export function trueError(surface: SurfaceCase, truth: Float32Array, map: Float32Array, cycle: number | null): number {
  let area = 0;
  let mean = 0;
  const known = (i: number): boolean => Number.isFinite(truth[i]) && Number.isFinite(map[i]);
  for (let i = 0; i < truth.length; i += 1) {
    if (!known(i)) continue;
    area += surface.areas[i];
    mean += surface.areas[i] * truth[i];
  }
  if (!area || cycle !== null) return NaN;
  mean /= area;
  let wrong = 0;
  let spread = 0;
  for (let i = 0; i < truth.length; i += 1) {
    if (!known(i)) continue;
    wrong += surface.areas[i] * (map[i] - truth[i]) ** 2;
    spread += surface.areas[i] * (truth[i] - mean) ** 2;
  }
  return spread > 0 ? Math.sqrt(wrong / spread) : NaN;
}

/** A number from the standard normal distribution. */
function normal(): number {
  return Math.sqrt(-2 * Math.log(1 - Math.random())) * Math.cos(2 * Math.PI * Math.random());
}
