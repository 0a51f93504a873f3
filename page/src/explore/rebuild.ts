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
    while (this.count < count) this.add(this.count++, 1);
    while (this.count > count) this.add(--this.count, -1);
  }

  private restart(): void {
    const { offset, nColumns } = this.signal;
    for (let i = 0; i < this.values.length; i += 1) this.values[i] = offset[i % nColumns];
    this.count = 0;
  }

  private add(mode: number, sign: number): void {
    const { modes, modeScales, nVertices } = this.surface;
    const { coefficients, nColumns } = this.signal;
    const row = modes.subarray(mode * nVertices, (mode + 1) * nVertices);
    const factor = sign * modeScales[mode];
    if (nColumns === 3)
      addVectors(this.values, row, [0, 1, 2].map((c) => factor * coefficients[3 * mode + c]));
    else addNumbers(this.values, row, factor * coefficients[mode]);
  }
}

function addNumbers(to: Float64Array, row: Int16Array, factor: number): void {
  for (let i = 0; i < row.length; i += 1) to[i] += factor * row[i];
}

function addVectors(to: Float64Array, row: Int16Array, [x, y, z]: number[]): void {
  for (let i = 0, at = 0; i < row.length; i += 1, at += 3) {
    const value = row[i];
    to[at] += x * value;
    to[at + 1] += y * value;
    to[at + 2] += z * value;
  }
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
