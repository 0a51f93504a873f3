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
  const { kept, gone } = collapses;
  const places = surface.positions.slice();
  // Of several places of one vertex the last counts.
  for (let step = 0, from = 0; step < steps; step += 1, from += 3) {
    const to = 3 * kept[step];
    places[to] = collapses.places[from];
    places[to + 1] = collapses.places[from + 1];
    places[to + 2] = collapses.places[from + 2];
  }
  const standsFor = new Int32Array(nVertices);
  for (let i = 0; i < nVertices; i += 1) standsFor[i] = i;
  for (let step = steps - 1; step >= 0; step -= 1) standsFor[gone[step]] = standsFor[kept[step]];
  return compacted(surface, places, standsFor);
}

function compacted({ faces }: SurfaceCase, places: Float32Array, standsFor: Int32Array): Level {
  const number = new Int32Array(standsFor.length);
  const positions = new Float32Array(places.length);
  let count = 0;
  for (let i = 0; i < standsFor.length; i += 1) {
    if (standsFor[i] !== i) continue;
    number[i] = count;
    for (let axis = 0; axis < 3; axis += 1) positions[3 * count + axis] = places[3 * i + axis];
    count += 1;
  }
  const standIn = new Int32Array(standsFor.length);
  for (let i = 0; i < standIn.length; i += 1) standIn[i] = number[standsFor[i]];
  const left = new Uint32Array(faces.length);
  let corners = 0;
  for (let face = 0; face < faces.length; face += 3) {
    const a = standIn[faces[face]];
    const b = standIn[faces[face + 1]];
    const c = standIn[faces[face + 2]];
    if (a === b || b === c || c === a) continue;
    left[corners] = a;
    left[corners + 1] = b;
    left[corners + 2] = c;
    corners += 3;
  }
  return { positions: positions.slice(0, 3 * count), faces: left.slice(0, corners), standIn };
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
  const means = new Float32Array(n);
  for (let i = 0; i < n; i += 1) means[i] = known[i] > 0 && 2 * known[i] >= all[i] ? sum[i] / known[i] : NaN;
  return means;
}
