/** The orientation cube: how the surface lies in the patient, each side a button to look from. */
import { Quaternion, Vector3 } from "three";

import { fill, svg } from "../dom";
import { DIRECTIONS } from "./directions";

interface Side {
  readonly normal: readonly [number, number, number];
  readonly up: readonly [number, number, number];
  readonly letter: string;
  readonly axis: string;
  readonly view: string;
}

const SIDES: readonly Side[] = [
  { normal: [0, -1, 0], up: [0, 0, 1], letter: "A", axis: "−y", view: "AP" },
  { normal: [0, 1, 0], up: [0, 0, 1], letter: "P", axis: "+y", view: "PA" },
  { normal: [1, 0, 0], up: [0, 0, 1], letter: "L", axis: "+x", view: "LL" },
  { normal: [-1, 0, 0], up: [0, 0, 1], letter: "R", axis: "−x", view: "RL" },
  { normal: [0, 0, 1], up: [0, 1, 0], letter: "S", axis: "+z", view: "SUP" },
  { normal: [0, 0, -1], up: [0, -1, 0], letter: "I", axis: "−z", view: "INF" },
];

const HALF = 17;

export class OrientationCube {
  readonly element = svg("svg", { class: "cube", viewBox: "-32 -32 64 64", "aria-hidden": "true" });
  private space: string;
  private readonly turn = new Quaternion();

  /** `look` is told the standard view of the side that was clicked. */
  constructor(space: string, look: (view: string) => void) {
    this.space = space;
    this.element.addEventListener("click", (event) => {
      const view = (event.target as Element).closest("[data-view]")?.getAttribute("data-view");
      if (view) look(view);
    });
  }

  setSpace(space: string): void {
    this.space = space;
    this.draw();
  }

  turnTo(turn: Quaternion): void {
    if (this.element.childElementCount && turn.equals(this.turn)) return;
    this.turn.copy(turn);
    this.draw();
  }

  private draw(): void {
    const { turn } = this;
    const seen = turn.clone().invert();
    const drawn = SIDES.flatMap((side) => {
      const normal = new Vector3(...side.normal).applyQuaternion(seen);
      return normal.z > 0.02 ? [this.side(side, normal, seen)] : [];
    });
    fill(this.element, ...drawn);
  }

  private side(side: Side, normal: Vector3, seen: Quaternion): SVGGElement {
    const up = new Vector3(...side.up).applyQuaternion(seen);
    const right = new Vector3().crossVectors(up, normal);
    const corner = (across: number, along: number): string =>
      `${HALF * (normal.x + across * right.x + along * up.x)},${-HALF * (normal.y + across * right.y + along * up.y)}`;
    const matrix = [right.x, -right.y, -up.x, up.y, HALF * normal.x, -HALF * normal.y].join(" ");
    const words = this.space === "LPS" ? side.letter : side.axis;
    const from = DIRECTIONS.find((each) => each.name === side.view)?.seenFrom ?? "";
    return svg(
      "g",
      { "data-view": side.view, class: "cube-side" },
      svg("title", {}, this.space === "LPS" ? `Look from ${from}` : `Look along ${side.axis}`),
      svg("polygon", { points: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)].join(" ") }),
      svg(
        "text",
        { transform: `matrix(${matrix})`, "text-anchor": "middle", dy: "0.36em", "font-size": words.length > 1 ? 15 : 20 },
        words,
      ),
    );
  }
}
