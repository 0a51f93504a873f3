/** What a click, a drag or Enter does on a slice: each tool ends in other edits. */
import { NO_EDITS, type Edits } from "./edits";
import type { Vec3 } from "./lattice";
import { hundredth, rounded, withAxis, type Orientation } from "./orientation";

export type ToolName = "look" | "seed" | "polygon" | "box" | "ball" | "wall";

export const TOOLS: readonly { readonly name: ToolName; readonly label: string; readonly key: string; readonly about: string }[] = [
  { name: "look", label: "Look", key: "L", about: "Click or drag: the three planes meet there." },
  { name: "seed", label: "Seed", key: "S", about: "Click into the blood of the left atrium." },
  { name: "polygon", label: "Outline", key: "P", about: "Click corners around the atrium on one slice; click the first again, or press Enter on it, to close." },
  { name: "box", label: "Box", key: "B", about: "Drag a box around the atrium." },
  { name: "ball", label: "Ball cut", key: "O", about: "Click: blood within the ball is not followed." },
  { name: "wall", label: "Wall cut", key: "W", about: "Drag a line across a leak: a round wall stands on it, upright on the slice." },
];

/** Corners this near, in pixels of the picture, are the same. */
export const SAME_PX = 9;

/** A drawing under way on one plane. */
export class Tool {
  name: ToolName = "look";
  plane: Orientation | null = null;
  corners: Vec3[] = [];
  /** Where the pointer is, for the line to it. */
  pointer: Vec3 | null = null;
  ballRadius = 8;

  choose(name: ToolName): void {
    this.name = name;
    this.abandon();
  }

  abandon(): void {
    this.plane = null;
    this.corners = [];
    this.pointer = null;
  }

  get drawing(): boolean {
    return this.corners.length > 0;
  }

  /** Takes back the last corner. */
  back(): void {
    this.corners.pop();
    if (!this.corners.length) this.abandon();
  }

  /**
   * A click, the beginning of a drag, or Enter at a place.
   * `near` tells whether two places are the same within a few pixels.
   */
  press(place: Vec3, plane: Orientation, near: (one: Vec3, other: Vec3) => boolean, edits: Edits): Partial<Edits> | null {
    const here = rounded(place);
    if (this.plane && this.plane !== plane) this.abandon();
    if (this.name === "seed") return { seed_mm: here };
    if (this.name === "ball") return { cuts_mm: [...edits.cuts_mm, [...here, this.ballRadius]] };
    if (this.name === "polygon") return this.corner(here, plane, near);
    if (this.name === "box" || this.name === "wall") {
      if (this.drawing && !near(this.corners[0], here)) return this.release(here, near, edits);
      this.plane = plane;
      this.corners = [here];
    }
    return null;
  }

  /** The end of a drag. */
  release(place: Vec3, near: (one: Vec3, other: Vec3) => boolean, edits: Edits): Partial<Edits> | null {
    const [from, plane] = [this.corners[0], this.plane];
    if (!from || !plane || this.name === "polygon" || near(from, place)) return null;
    this.abandon();
    return this.name === "box" ? boxOf(from, place, plane, edits) : wallOf(from, place, plane, edits);
  }

  private corner(here: Vec3, plane: Orientation, near: (one: Vec3, other: Vec3) => boolean): Partial<Edits> | null {
    const level = this.corners[0]?.[plane.through] ?? here[plane.through];
    const onSlice = withAxis(here, plane.through, level);
    if (this.corners.length > 2 && near(this.corners[0], onSlice)) {
      const region_mm = this.corners;
      this.abandon();
      return { region_mm };
    }
    this.plane = plane;
    if (!this.corners.some((corner) => near(corner, onSlice))) this.corners.push(onSlice);
    return null;
  }
}

/** The box over a rectangle, as deep to either side of the slice as the edits say. */
function boxOf(from: Vec3, to: Vec3, plane: Orientation, edits: Edits): Partial<Edits> | null {
  const depth = edits.region_depth_mm || NO_EDITS.region_depth_mm;
  const level = from[plane.through];
  const low: [number, number, number] = [0, 0, 0];
  const high: [number, number, number] = [0, 0, 0];
  for (const axis of [0, 1, 2]) {
    low[axis] = axis === plane.through ? level - depth : Math.min(from[axis], to[axis]);
    high[axis] = axis === plane.through ? level + depth : Math.max(from[axis], to[axis]);
    if (high[axis] - low[axis] < 5) return null;
  }
  return { region_mm: [rounded(low), rounded(high)] };
}

/** The disc that stands upright on the slice, over a line. */
function wallOf(from: Vec3, to: Vec3, plane: Orientation, edits: Edits): Partial<Edits> | null {
  const across = to[plane.across] - from[plane.across];
  const along = to[plane.along] - from[plane.along];
  const length = Math.hypot(across, along);
  if (length < 2) return null;
  const cut = [0, 0, 0, 0, 0, 0, hundredth(length / 2)];
  for (const axis of [0, 1, 2]) cut[axis] = hundredth((from[axis] + to[axis]) / 2);
  cut[3 + plane.across] = Math.round((along / length) * 1e4) / 1e4;
  cut[3 + plane.along] = Math.round((-across / length) * 1e4) / 1e4;
  return { cuts_mm: [...edits.cuts_mm, cut] };
}
