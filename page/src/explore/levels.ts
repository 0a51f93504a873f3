/** The surface simplified to k points: the collapses of the sequence, replayed. */
import type { SurfaceCase } from "../surfacecase";

export interface Level {
  readonly positions: Float32Array;
  readonly faces: Uint32Array;
  /** Of each vertex of the full surface, the vertex of the level that stands for it. */
  readonly standIn: Int32Array;
}

/** Fewest points there is a level of. */
export function fewestPoints(surface: SurfaceCase): number {
  return surface.nVertices - (surface.collapses?.kept.length ?? 0);
}

/** The surface with `count` points. */
export function levelOf(surface: SurfaceCase, count: number): Level | null {
  const { collapses, nVertices } = surface;
  if (!collapses || count < fewestPoints(surface)) return null;
  const steps = Math.max(nVertices - count, 0);
  const places = surface.positions.slice();
  // Of several places of one vertex the last counts.
  for (let step = 0; step < steps; step += 1)
    for (let axis = 0; axis < 3; axis += 1)
      places[3 * collapses.kept[step] + axis] = collapses.places[3 * step + axis];
  const standsFor = Int32Array.from({ length: nVertices }, (_, i) => i);
  for (let step = steps - 1; step >= 0; step -= 1)
    standsFor[collapses.gone[step]] = standsFor[collapses.kept[step]];
  return compacted(surface, places, standsFor);
}

function compacted(surface: SurfaceCase, places: Float32Array, standsFor: Int32Array): Level {
  const number = new Int32Array(standsFor.length).fill(-1);
  const positions: number[] = [];
  for (let i = 0; i < standsFor.length; i += 1) {
    if (standsFor[i] !== i) continue;
    number[i] = positions.length / 3;
    positions.push(places[3 * i], places[3 * i + 1], places[3 * i + 2]);
  }
  const standIn = standsFor.map((vertex) => number[vertex]);
  const faces: number[] = [];
  for (let face = 0; face < surface.faces.length; face += 3) {
    const a = standIn[surface.faces[face]];
    const b = standIn[surface.faces[face + 1]];
    const c = standIn[surface.faces[face + 2]];
    if (a !== b && b !== c && c !== a) faces.push(a, b, c);
  }
  return { positions: Float32Array.from(positions), faces: Uint32Array.from(faces), standIn };
}

/** A map at the points of a level: the mean over the area each stands for; NaN if mostly unsampled. */
export function valuesAt(level: Level, surface: SurfaceCase, values: Float32Array): Float32Array {
  const n = level.positions.length / 3;
  const sum = new Float64Array(n);
  const known = new Float64Array(n);
  const all = new Float64Array(n);
  for (let i = 0; i < values.length; i += 1) {
    const to = level.standIn[i];
    all[to] += surface.areas[i];
    if (!Number.isFinite(values[i])) continue;
    sum[to] += surface.areas[i] * values[i];
    known[to] += surface.areas[i];
  }
  return Float32Array.from(sum, (total, i) => (known[i] > 0 && 2 * known[i] >= all[i] ? total / known[i] : NaN));
}
