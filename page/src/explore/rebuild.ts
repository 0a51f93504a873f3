/** Maps rebuilt from their first k harmonics, step by step: only what a step adds is added. */
import type { Signal, SurfaceCase } from "../surfacecase";

export class Rebuilt {
  /** The map of the present number of harmonics, (n, c). */
  readonly values: Float64Array;
  /** How many harmonics are in it. */
  count = 0;

  constructor(
    private readonly surface: SurfaceCase,
    readonly signal: Signal,
  ) {
    this.values = new Float64Array(surface.nVertices * signal.nColumns);
    this.restart();
  }

  /** Goes to `count` harmonics by the shorter way: from what there is, or from nothing. */
  goTo(count: number): void {
    if (Math.abs(count - this.count) > count) this.restart();
    const sign = count > this.count ? 1 : -1;
    const [from, to] = sign > 0 ? [this.count, count] : [count, this.count];
    for (let mode = from; mode < to; mode += AT_ONCE) this.add(mode, Math.min(mode + AT_ONCE, to), sign);
    this.count = count;
  }

  private restart(): void {
    const { offset, nColumns } = this.signal;
    for (let i = 0; i < this.values.length; i += 1) this.values[i] = offset[i % nColumns];
    this.count = 0;
  }

  /** Adds the harmonics `from` to `to`, at most `AT_ONCE` of them; one that is lacking weighs nothing. */
  private add(from: number, to: number, sign: number): void {
    const { modes, modeScales, nVertices } = this.surface;
    const { coefficients, nColumns } = this.signal;
    const rows = Array.from({ length: AT_ONCE }, (_, i) => Math.min(from + i, to - 1) * nVertices).map((start) => modes.subarray(start, start + nVertices));
    for (let column = 0; column < nColumns; column += 1) {
      const weights = rows.map((_, i) => (from + i < to ? sign * modeScales[from + i] * coefficients[nColumns * (from + i) + column] : 0));
      addRows(this.values, column, nColumns, rows, weights);
    }
  }
}

/** Harmonics added in one go through the vertices: the sums are read and written once for all of them. */
const AT_ONCE = 4;

function addRows(to: Float64Array, first: number, stride: number, [a, b, c, d]: Int16Array[], [wa, wb, wc, wd]: number[]): void {
  for (let i = 0, at = first; i < a.length; i += 1, at += stride) to[at] += wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i];
}

/** Distance of each rebuilt value, or position, from the original; NaN where unsampled. */
export function deviations(
  rebuilt: Float64Array,
  original: ArrayLike<number>,
  nColumns: number,
): Float32Array {
  const found = new Float32Array(rebuilt.length / nColumns);
  for (let i = 0; i < found.length; i += 1) {
    let square = 0;
    for (let c = nColumns * i; c < nColumns * (i + 1); c += 1)
      square += (rebuilt[c] - original[c]) ** 2;
    found[i] = Math.sqrt(square);
  }
  return found;
}

/** Root of the area-weighted mean square, over the vertices that hold a value. */
export function rootMeanSquare(values: Float32Array, areas: Float64Array): number {
  let sum = 0;
  let area = 0;
  for (let i = 0; i < values.length; i += 1) {
    if (!Number.isFinite(values[i])) continue;
    sum += areas[i] * values[i] ** 2;
    area += areas[i];
  }
  return Math.sqrt(sum / area);
}
