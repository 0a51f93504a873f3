/** One of the three planes: its picture, its slider, and what hands and keys do on it. */
import { freshId, h, onceAFrame } from "../dom";
import { Marks } from "./marks";
import type { Vec3 } from "./lattice";
import { signed, withAxis, type Orientation } from "./orientation";
import { drawGreys, drawOverlay, type Window } from "./picture";
import type { Scene } from "./state";
import { SAME_PX } from "./tools";

/** What the planes ask of the view. */
export interface Hands {
  /** The three planes meet elsewhere. */
  lookAt(place: Vec3): void;
  /** The tool is used at a place; `near` tells same from different corners. */
  press(place: Vec3, plane: Orientation, near: (one: Vec3, other: Vec3) => boolean): void;
  release(place: Vec3, near: (one: Vec3, other: Vec3) => boolean): void;
  hover(place: Vec3, plane: Orientation): void;
  /** Grey levels by so many pixels across and down. */
  greys(across: number, down: number): void;
  /** Closer by a factor, about a place. */
  zoom(factor: number, about: Vec3): void;
  /** The pictures move by so many mm. */
  move(by: Vec3): void;
  /** Keys that mean the same on every plane; true if it was one. */
  key(event: KeyboardEvent): boolean;
}

const WHEEL_PX = 40;

export class SlicePlane {
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  private readonly slider: HTMLInputElement;
  private readonly where = h("output", {});
  private readonly draw = onceAFrame(() => this.paint());
  private dragging: "tool" | "greys" | "move" | null = null;
  private last: readonly [number, number] = [0, 0];
  private wheeled = 0;

  constructor(
    readonly plane: Orientation,
    private readonly scene: () => Scene,
    private readonly hands: Hands,
  ) {
    const { volume, oriented } = scene();
    const id = freshId("slice");
    this.canvas = h("canvas", {
      tabindex: 0,
      role: "application",
      "aria-label": `${plane.title} slice: arrow keys move the cross, Page Up and Down change the slice, Enter uses the tool`,
      "data-plane": plane.name,
    });
    const through = plane.through;
    this.slider = h("input", {
      id,
      type: "range",
      min: volume.first(through),
      max: volume.last(through),
      step: "any",
      "aria-label": `${plane.title} slice, mm`,
    });
    this.slider.addEventListener("input", () => this.lookThrough(this.slider.valueAsNumber));
    this.where.setAttribute("for", id);
    const letters = oriented
      ? plane.letters.map((letter, side) => h("span", { class: `letter letter-${side}`, "aria-hidden": "true" }, letter))
      : [];
    this.element = h(
      "figure",
      { class: "slice" },
      h("figcaption", {}, h("label", { for: id }, plane.title), this.where),
      h("div", { class: "slice-picture" }, this.canvas, ...letters),
      this.slider,
    );
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** The plane, where it lies and the value at the cross, in words. */
  get caption(): string {
    return `${this.plane.title}, ${this.where.textContent ?? ""}`;
  }

  /** Draws anew with the next frame. */
  refresh(): void {
    this.draw();
  }

  /** What the canvas shows now. */
  get window(): Window {
    const { look, volume } = this.scene();
    const { across, along, through } = this.plane;
    const longest = Math.max(...volume.shape) * volume.step;
    const shorter = Math.min(this.canvas.width, this.canvas.height) || 1;
    return {
      level: look.crosshair[through],
      middle: [look.middle[across], look.middle[along]],
      scale: longest / look.zoom / shorter,
    };
  }

  private paint(): void {
    const { canvas } = this;
    const box = canvas.getBoundingClientRect();
    const [width, height] = [box.width, box.height].map((side) => Math.round(side * devicePixelRatio));
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    if (!context) return;
    const scene = this.scene();
    const { window } = this;
    const { level, width: span } = scene.look;
    const pixels = context.createImageData(width, height);
    const greys = { black: level - span / 2, white: level + span / 2, tinted: scene.tinted };
    drawGreys(pixels, scene.volume, this.plane, window, greys);
    if (scene.overlay) drawOverlay(pixels, this.plane, window, scene.overlay);
    context.putImageData(pixels, 0, 0);
    new Marks(context, this.plane, window, [width, height]).draw(scene);
    this.tell(scene, window);
  }

  /** The numbers beside the picture, for people and for tests. */
  private tell(scene: Scene, window: Window): void {
    const hu = scene.volume.at(scene.look.crosshair);
    this.where.textContent = `${signed(window.level, 1)} mm, ${hu === undefined ? "–" : signed(hu)} HU`;
    this.slider.value = String(window.level);
    this.slider.setAttribute("aria-valuetext", `${signed(window.level, 1)} mm`);
    const { dataset } = this.canvas;
    dataset["middle"] = window.middle.join(",");
    dataset["scale"] = String(window.scale * devicePixelRatio);
    dataset["cross"] = scene.look.crosshair.join(",");
  }

  /** The place under a pointer. */
  private place(event: MouseEvent): Vec3 {
    const { window, canvas, plane } = this;
    const box = canvas.getBoundingClientRect();
    const x = (event.clientX - box.left) * devicePixelRatio - canvas.width / 2;
    const y = (event.clientY - box.top) * devicePixelRatio - canvas.height / 2;
    const across = window.middle[0] + x * window.scale;
    const along = window.middle[1] + plane.down * y * window.scale;
    const level = withAxis([0, 0, 0], plane.through, window.level);
    return withAxis(withAxis(level, plane.across, across), plane.along, along);
  }

  private readonly near = (one: Vec3, other: Vec3): boolean => {
    const reach = SAME_PX * devicePixelRatio * this.window.scale;
    const { across, along } = this.plane;
    return Math.hypot(one[across] - other[across], one[along] - other[along]) < reach;
  };

  private lookThrough(level: number): void {
    const { look, volume } = this.scene();
    const { through } = this.plane;
    const kept = Math.min(Math.max(level, volume.first(through)), volume.last(through));
    this.hands.lookAt(withAxis(look.crosshair, through, kept));
  }

  private listen(): void {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => this.pressed(event));
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    canvas.addEventListener("pointerup", (event) => this.released(event));
    canvas.addEventListener("pointercancel", () => (this.dragging = null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  private pressed(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.last = [event.clientX, event.clientY];
    if (event.button === 1 || (event.button === 0 && event.altKey)) this.dragging = "move";
    else if (event.button === 2 || event.shiftKey) this.dragging = "greys";
    else this.dragging = "tool";
    if (this.dragging === "tool") this.hands.press(this.place(event), this.plane, this.near);
  }

  private moved(event: PointerEvent): void {
    const [across, down] = [event.clientX - this.last[0], event.clientY - this.last[1]];
    this.last = [event.clientX, event.clientY];
    if (this.dragging === "greys") this.hands.greys(across, down);
    else if (this.dragging === "move") {
      const scale = this.window.scale * devicePixelRatio;
      const by = withAxis([0, 0, 0], this.plane.across, -across * scale);
      this.hands.move(withAxis(by, this.plane.along, -this.plane.down * down * scale));
    } else if (this.dragging === "tool" && this.scene().tool.name === "look") this.hands.lookAt(this.place(event));
    else this.hands.hover(this.place(event), this.plane);
  }

  private released(event: PointerEvent): void {
    if (this.dragging === "tool") this.hands.release(this.place(event), this.near);
    this.dragging = null;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    if (event.ctrlKey || event.metaKey) {
      this.hands.zoom(Math.exp(-event.deltaY / 400), this.place(event));
      return;
    }
    this.wheeled += event.deltaMode ? event.deltaY * WHEEL_PX : event.deltaY;
    const steps = Math.trunc(this.wheeled / WHEEL_PX);
    this.wheeled -= steps * WHEEL_PX;
    if (steps) this.step(steps);
  }

  /** Goes on by whole slices. */
  private step(steps: number): void {
    const { volume } = this.scene();
    this.lookThrough(this.window.level + steps * volume.step);
  }

  private key(event: KeyboardEvent): void {
    const { look } = this.scene();
    const pace = event.shiftKey ? 10 : 1;
    const moves: Record<string, readonly [axis: number, by: number]> = {
      ArrowLeft: [this.plane.across, -pace],
      ArrowRight: [this.plane.across, pace],
      ArrowUp: [this.plane.along, -pace * this.plane.down],
      ArrowDown: [this.plane.along, pace * this.plane.down],
    };
    const move = moves[event.key];
    if (move) this.hands.lookAt(withAxis(look.crosshair, move[0], look.crosshair[move[0]] + move[1]));
    else if (event.key === "PageUp") this.step(event.shiftKey ? 5 : 1);
    else if (event.key === "PageDown") this.step(event.shiftKey ? -5 : -1);
    else if (event.key === "Enter") this.hands.press(look.crosshair, this.plane, this.near);
    else if (!this.hands.key(event)) return;
    event.preventDefault();
  }
}
