/** Where seeds, regions and cutters meet a slice: curves in the two axes of its plane, mm. */
import type { Edits } from "./edits";
import type { Vec3 } from "./lattice";
import type { Orientation } from "./orientation";

export type Point = readonly [across: number, along: number];

export type Outline =
  | { readonly kind: "circle"; readonly middle: Point; readonly radius: number }
  | { readonly kind: "path"; readonly points: readonly Point[]; readonly closed: boolean };

/** A cutter on the slice at `level`; null where it does not meet it. */
export function cutOutline(cut: readonly number[], plane: Orientation, level: number): Outline | null {
  const middle: Point = [cut[plane.across], cut[plane.along]];
  const height = level - cut[plane.through];
  if (cut.length === 4) {
    const square = cut[3] ** 2 - height ** 2;
    return square > 0 ? { kind: "circle", middle, radius: Math.sqrt(square) } : null;
  }
  return discOutline(middle, height, cut, plane);
}

function discOutline(middle: Point, height: number, cut: readonly number[], plane: Orientation): Outline | null {
  const length = Math.hypot(cut[3], cut[4], cut[5]);
  const normal = [cut[3] / length, cut[4] / length, cut[5] / length];
  const [u, v, w] = [normal[plane.across], normal[plane.along], normal[plane.through]];
  const steep = Math.hypot(u, v);
  const radius = cut[6];
  if (steep < 1e-3) return Math.abs(height) <= 1 ? { kind: "circle", middle, radius } : null;
  // The disc's steepest line rises by `steep` a mm and moves against the normal in the slice.
  const climb = height / steep;
  if (Math.abs(climb) >= radius) return null;
  const half = Math.sqrt(radius ** 2 - climb ** 2);
  const foot: Point = [middle[0] - (climb * w * u) / steep, middle[1] - (climb * w * v) / steep];
  const along: Point = [(-v / steep) * half, (u / steep) * half];
  const points: Point[] = [
    [foot[0] - along[0], foot[1] - along[1]],
    [foot[0] + along[0], foot[1] + along[1]],
  ];
  return { kind: "path", points, closed: false };
}

/** The axis a polygon was drawn across: the one along which its corners differ least. */
export function drawnAcross(corners: readonly Vec3[]): 0 | 1 | 2 {
  const spread = ([0, 1, 2] as const).map((axis) => {
    const values = corners.map((corner) => corner[axis]);
    return Math.max(...values) - Math.min(...values);
  });
  return spread.indexOf(Math.min(...spread)) as 0 | 1 | 2;
}

/** Opposite corners of the box around a region. */
export function regionBox(edits: Pick<Edits, "region_mm" | "region_depth_mm">): [Vec3, Vec3] | null {
  const corners = edits.region_mm;
  if (corners.length < 2) return null;
  const end = (pick: (...values: number[]) => number): [number, number, number] => [
    pick(...corners.map((corner) => corner[0])),
    pick(...corners.map((corner) => corner[1])),
    pick(...corners.map((corner) => corner[2])),
  ];
  const [low, high] = [end(Math.min), end(Math.max)];
  if (corners.length > 2) {
    const axis = drawnAcross(corners);
    low[axis] -= edits.region_depth_mm;
    high[axis] += edits.region_depth_mm;
  }
  return [low, high];
}

/** The region on a slice, and whether the slice lies within it. */
export function regionOutline(
  edits: Pick<Edits, "region_mm" | "region_depth_mm">,
  plane: Orientation,
  level: number,
): { readonly outline: Outline; readonly within: boolean } | null {
  const box = regionBox(edits);
  if (!box) return null;
  const [low, high] = box;
  const within = level >= low[plane.through] && level <= high[plane.through];
  const corners = edits.region_mm;
  const points: Point[] =
    corners.length > 2 && drawnAcross(corners) === plane.through
      ? corners.map((corner) => [corner[plane.across], corner[plane.along]])
      : [
          [low[plane.across], low[plane.along]],
          [high[plane.across], low[plane.along]],
          [high[plane.across], high[plane.along]],
          [low[plane.across], high[plane.along]],
        ];
  return { outline: { kind: "path", points, closed: true }, within };
}
