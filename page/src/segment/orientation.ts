/** The three planes, hung as a radiologist hangs them. Axes: 0 left, 1 back, 2 head. */
import type { Vec3 } from "./lattice";

export interface Orientation {
  readonly name: "axial" | "coronal" | "sagittal";
  readonly title: string;
  /** Axis that runs to the right of the picture, and the one that runs up or down it. */
  readonly across: 0 | 1 | 2;
  readonly along: 0 | 1 | 2;
  /** 1 where the second axis grows downwards in the picture, -1 where upwards. */
  readonly down: 1 | -1;
  /** Axis one looks along. */
  readonly through: 0 | 1 | 2;
  /** Letters at the left, right, upper and lower edge. */
  readonly letters: readonly [string, string, string, string];
}

export const ORIENTATIONS: readonly Orientation[] = [
  { name: "axial", title: "Axial", across: 0, along: 1, down: 1, through: 2, letters: ["R", "L", "A", "P"] },
  { name: "coronal", title: "Coronal", across: 0, along: 2, down: -1, through: 1, letters: ["R", "L", "S", "I"] },
  { name: "sagittal", title: "Sagittal", across: 1, along: 2, down: -1, through: 0, letters: ["A", "P", "S", "I"] },
];

/** A place with one coordinate changed. */
export function withAxis(place: Vec3, axis: number, value: number): Vec3 {
  const changed: [number, number, number] = [...place];
  changed[axis] = value;
  return changed;
}

/** A place to a hundredth of a millimetre, so that what is written is what was used. */
export function rounded(place: Vec3): Vec3 {
  return [hundredth(place[0]), hundredth(place[1]), hundredth(place[2])];
}

export function hundredth(value: number): number {
  return Math.round(value * 100) / 100;
}

/** A number as people write it, with a real minus sign. */
export function signed(value: number, digits = 0): string {
  return value.toFixed(digits).replace("-", "−");
}
