/** Which place of a surface lies under the pointer. */
import { Vector3, type Camera } from "three";

export interface Picked {
  /** Face, its corner nearest to the place, and the place's weights in the three corners. */
  readonly face: number;
  readonly vertex: number;
  readonly weights: readonly [number, number, number];
  /** The place, mm. */
  readonly position: readonly [number, number, number];
}

/** The foremost place of a surface at (x, y), in the camera's coordinates from -1 to 1. */
export function pick(
  positions: Float32Array,
  faces: Uint32Array,
  camera: Camera,
  at: { x: number; y: number },
  visible: (x: number, y: number, z: number) => boolean = () => true,
): Picked | null {
  const flat = projected(positions, camera);
  let best: Picked | null = null;
  let nearest = Infinity;
  for (let face = 0; face < faces.length / 3; face += 1) {
    const corners = [faces[3 * face], faces[3 * face + 1], faces[3 * face + 2]] as const;
    const weights = weightsAt(flat, corners, at);
    if (!weights) continue;
    const depth = mixed(flat, corners, weights, 2);
    if (depth >= nearest) continue;
    const position = [0, 1, 2].map((axis) => mixed(positions, corners, weights, axis));
    if (!visible(position[0], position[1], position[2])) continue;
    nearest = depth;
    const vertex = corners[weights.indexOf(Math.max(...weights))];
    best = { face, vertex, weights, position: position as [number, number, number] };
  }
  return best;
}

function projected(positions: Float32Array, camera: Camera): Float32Array {
  const flat = new Float32Array(positions.length);
  const at = new Vector3();
  for (let i = 0; i < positions.length; i += 3)
    at.fromArray(positions, i).project(camera).toArray(flat, i);
  return flat;
}

function weightsAt(
  flat: Float32Array,
  [a, b, c]: readonly [number, number, number],
  at: { x: number; y: number },
): [number, number, number] | null {
  const ax = flat[3 * a] - at.x;
  const ay = flat[3 * a + 1] - at.y;
  const bx = flat[3 * b] - at.x;
  const by = flat[3 * b + 1] - at.y;
  const cx = flat[3 * c] - at.x;
  const cy = flat[3 * c + 1] - at.y;
  const u = bx * cy - by * cx;
  const v = cx * ay - cy * ax;
  const w = ax * by - ay * bx;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return null;
  const sum = u + v + w;
  return sum === 0 ? null : [u / sum, v / sum, w / sum];
}

function mixed(
  of: Float32Array,
  corners: readonly [number, number, number],
  weights: readonly [number, number, number],
  axis: number,
): number {
  return (
    weights[0] * of[3 * corners[0] + axis] +
    weights[1] * of[3 * corners[1] + axis] +
    weights[2] * of[3 * corners[2] + axis]
  );
}
