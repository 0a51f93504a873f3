/** How values become colours: a palette, limits, bands. */

export type PaletteName = "viridis" | "cividis" | "classic" | "cyclic" | "diverging" | "distance";

export interface ColourScale {
  readonly palette: PaletteName;
  /** Values of the two ends; `high` may lie below `low` to turn the palette round. */
  readonly low: number;
  readonly high: number;
  /** Number of bands; 0 for continuous colours. */
  readonly bands: number;
  /** Lines between the bands. */
  readonly lines: boolean;
}

/** Grey of places without a value, 0 to 255. */
export const UNKNOWN: readonly [number, number, number] = [150, 150, 150];

/** Round numbers at most `count` steps apart that hold [low, high]: 1, 2, 2.5 or 5 times a power of ten. */
export function roundSteps(low: number, high: number, count: number): number[] {
  if (!(high > low)) return [low - 0.5, low + 0.5];
  const raw = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = ([1, 2, 2.5, 5, 10].find((each) => each * decade >= raw * (1 - 1e-9)) ?? 10) * decade;
  const first = Math.floor(low / step + 1e-9);
  const last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** A scale with round limits that hold the middle 98 % of the values. */
export function scaleOf(values: Float32Array, palette: PaletteName, bands = 10): ColourScale {
  const known = values.filter((value) => Number.isFinite(value)).sort();
  if (!known.length) return { palette, low: 0, high: 1, bands, lines: false };
  const at = (share: number): number => known[Math.round(share * (known.length - 1))];
  const steps = roundSteps(at(0.01), at(0.99), bands);
  return { palette, low: steps[0], high: steps[steps.length - 1], bands: steps.length - 1, lines: false };
}

/** Boundaries of the bands, from low to high. */
export function boundaries(scale: ColourScale): number[] {
  const count = scale.bands || 10;
  return Array.from({ length: count + 1 }, (_, i) => scale.low + ((scale.high - scale.low) * i) / count);
}
