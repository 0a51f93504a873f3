/** Lines over a slice: crosshair, region, cutters, seed, and the drawing under way. */
import { cutOutline, regionOutline, type Outline, type Point } from "./outlines";
import type { Orientation } from "./orientation";
import type { Window } from "./picture";
import type { Scene } from "./state";

const CROSSHAIR = "#5cb8d1";
const REGION = "#7fe08a";
const CUT = "#ff6f61";
const SEED = "#ffd23f";
const DRAWN = "#ffffff";
/** How far from a slice a seed is still shown, mm. */
const SEED_MM = 6;

export class Marks {
  constructor(
    private readonly canvas: CanvasRenderingContext2D,
    private readonly plane: Orientation,
    private readonly window: Window,
    private readonly size: readonly [number, number],
  ) {}

  draw(scene: Scene): void {
    const { edits, look, tool } = scene;
    const { plane, window } = this;
    const region = regionOutline(edits, plane, window.level);
    if (region) this.outline(region.outline, REGION, region.within ? [] : [5, 5]);
    for (const cut of edits.cuts_mm) {
      const outline = cutOutline(cut, plane, window.level);
      if (outline) this.outline(outline, CUT, [], 2.5);
    }
    const seed = edits.seed_mm;
    if (seed && Math.abs(seed[plane.through] - window.level) < SEED_MM)
      this.dot([seed[plane.across], seed[plane.along]], SEED);
    this.cross([look.crosshair[plane.across], look.crosshair[plane.along]]);
    if (tool.plane !== plane || !tool.corners.length) return;
    const corners = [...tool.corners, ...(tool.pointer ? [tool.pointer] : [])];
    const points = corners.map((corner): Point => [corner[plane.across], corner[plane.along]]);
    const [from, to] = [points[0], points[points.length - 1]];
    const drawn: readonly Point[] = tool.name === "box" ? [from, [to[0], from[1]], to, [from[0], to[1]]] : points;
    this.outline({ kind: "path", points: drawn, closed: tool.name === "box" }, DRAWN, [4, 3]);
    for (const corner of tool.corners) this.dot([corner[plane.across], corner[plane.along]], DRAWN, 3);
  }

  /** Pixels of a place in the plane, mm. */
  pixel(point: Point): [number, number] {
    const { middle, scale } = this.window;
    return [
      this.size[0] / 2 + (point[0] - middle[0]) / scale,
      this.size[1] / 2 + (this.plane.down * (point[1] - middle[1])) / scale,
    ];
  }

  private outline(outline: Outline, colour: string, dashes: number[], thickness = 1.5): void {
    const { canvas } = this;
    canvas.beginPath();
    if (outline.kind === "circle") {
      const [x, y] = this.pixel(outline.middle);
      canvas.arc(x, y, outline.radius / this.window.scale, 0, 2 * Math.PI);
    } else {
      outline.points.forEach((point, place) => {
        const [x, y] = this.pixel(point);
        if (place) canvas.lineTo(x, y);
        else canvas.moveTo(x, y);
      });
      if (outline.closed) canvas.closePath();
    }
    this.stroke(colour, dashes, thickness);
  }

  private cross(point: Point): void {
    const { canvas } = this;
    const [x, y] = this.pixel(point).map((value) => Math.round(value) + 0.5);
    const gap = 8 * devicePixelRatio;
    canvas.beginPath();
    for (const [from, to] of [
      [0, x - gap],
      [x + gap, this.size[0]],
    ]) {
      canvas.moveTo(from, y);
      canvas.lineTo(to, y);
    }
    for (const [from, to] of [
      [0, y - gap],
      [y + gap, this.size[1]],
    ]) {
      canvas.moveTo(x, from);
      canvas.lineTo(x, to);
    }
    canvas.globalAlpha = 0.65;
    this.stroke(CROSSHAIR, [], 1);
    canvas.globalAlpha = 1;
  }

  private dot(point: Point, colour: string, radius = 5): void {
    const { canvas } = this;
    const [x, y] = this.pixel(point);
    canvas.beginPath();
    canvas.arc(x, y, radius * devicePixelRatio, 0, 2 * Math.PI);
    canvas.fillStyle = colour;
    canvas.fill();
    this.stroke("#000000", [], 1);
  }

  private stroke(colour: string, dashes: number[], thickness: number): void {
    const { canvas } = this;
    canvas.setLineDash(dashes.map((length) => length * devicePixelRatio));
    canvas.lineWidth = thickness * devicePixelRatio;
    canvas.strokeStyle = colour;
    canvas.stroke();
  }
}
