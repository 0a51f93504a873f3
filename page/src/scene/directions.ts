/** Directions a cardiac surface is looked at from: LPS axes, x to the left, y to the back, z up. */

export interface Direction {
  readonly name: string;
  /** What points to the right and upwards in the picture. */
  readonly right: readonly [number, number, number];
  readonly up: readonly [number, number, number];
  /** Where the viewer stands, in words. */
  readonly seenFrom: string;
}

const oblique = (name: string, degrees: number, seenFrom: string): Direction => {
  const angle = (degrees * Math.PI) / 180;
  return { name, right: [Math.cos(angle), Math.sin(angle), 0], up: [0, 0, 1], seenFrom };
};

/** The standard views, as in the report (auricle.report.views). */
export const DIRECTIONS: readonly Direction[] = [
  { name: "AP", right: [1, 0, 0], up: [0, 0, 1], seenFrom: "the front" },
  { name: "PA", right: [-1, 0, 0], up: [0, 0, 1], seenFrom: "the back" },
  oblique("LAO 45", 45, "the front, 45° to the patient's left"),
  oblique("RAO 30", -30, "the front, 30° to the patient's right"),
  { name: "LL", right: [0, 1, 0], up: [0, 0, 1], seenFrom: "the patient's left" },
  { name: "RL", right: [0, -1, 0], up: [0, 0, 1], seenFrom: "the patient's right" },
  { name: "SUP", right: [1, 0, 0], up: [0, 1, 0], seenFrom: "above" },
  { name: "INF", right: [1, 0, 0], up: [0, -1, 0], seenFrom: "below" },
];

export function direction(name: string): Direction {
  const found = DIRECTIONS.find((each) => each.name === name);
  if (!found) throw new Error(`no view is called ${name}`);
  return found;
}
