/** A stage: one canvas with one or more linked pictures side by side, one camera for all.
 *
 * Only pictures that changed are drawn anew. Where drawing takes long, pictures that move are drawn
 * coarsely, and finely once they rest.
 */
import { Vector3, Vector4, WebGLRenderer } from "three";

import { h, onceAFrame } from "../dom";
import { OrientationCube } from "./cube";
import { direction } from "./directions";
import { takeInHand } from "./hands";
import { Orbit, type Outlook } from "./orbit";
import { Pane } from "./pane";
import { pick, type Picked } from "./picking";

/** A stage rests when nothing has moved for so long after its last picture was drawn. */
const REST_MS = 150;
/** Drawing that takes longer is done coarsely while something moves. */
const SLOW_MS = 25;
const COARSE = 0.5;

export interface PickedInPane extends Picked {
  readonly pane: Pane;
  /** Keys held while clicking. */
  readonly shiftKey: boolean;
  /** When it was clicked, in milliseconds of `performance.now()`. */
  readonly time: number;
}

export interface Cut {
  /** 0, 1, 2 for x, y, z; what lies beyond `at` mm on that axis is cut away. */
  readonly axis: 0 | 1 | 2;
  readonly at: number;
  readonly flipped: boolean;
}

interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

export class Stage {
  readonly element = h("div", { class: "stage" });
  readonly canvas: HTMLCanvasElement;
  readonly orbit = new Orbit();
  readonly panes: Pane[] = [];
  /** Called with the place clicked on a surface. */
  picked: ((place: PickedInPane) => void) | null = null;
  /** Called with the place under the pointer, or null. */
  hovered: ((place: PickedInPane | null, x: number, y: number) => void) | null = null;
  /** Called after each drawing. */
  drawn: (() => void) | null = null;
  /** Draws all pictures with the next frame. */
  readonly draw = (): void => {
    for (const pane of this.panes) pane.stale = true;
    this.drawSoon();
  };
  private readonly renderer: WebGLRenderer;
  private readonly cube: OrientationCube;
  private readonly captions = h("div", { class: "pane-captions" });
  private readonly observer: ResizeObserver;
  private cut: Cut | null = null;
  /** Pixels of the page. */
  private size = { width: 0, height: 0 };
  private slow = false;
  private coarse = false;
  private restless = false;
  private resting = 0;
  private readonly drawSoon = onceAFrame(() => {
    if (this.panes.some((pane) => pane.stale)) this.drawNow();
  });

  /** `label` says to screen readers what the picture is. `space` is "LPS" or "unknown". */
  constructor(host: HTMLElement, label: string, space = "unknown") {
    const hand = h("div", {
      class: "stage-hand",
      tabindex: 0,
      role: "application",
      "aria-label": `${label}. Arrow keys turn it, plus and minus zoom, R resets.`,
    });
    this.renderer = new WebGLRenderer({ antialias: false, alpha: true, preserveDrawingBuffer: true, powerPreference: "high-performance" });
    this.renderer.autoClear = false;
    this.renderer.localClippingEnabled = true;
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("aria-hidden", "true");
    this.cube = new OrientationCube(space, (name) => this.look(name));
    hand.append(this.canvas);
    this.element.append(hand, this.captions, this.cube.element);
    host.append(this.element);
    takeInHand(hand, this.orbit, {
      moved: () => {
        this.moving();
        this.draw();
      },
      clicked: (x, y, event) => {
        const place = this.picked && this.placeAt(x, y, event);
        if (place) this.picked?.(place);
      },
      hovered: (at) => this.hovered?.(at && this.placeAt(at.x, at.y), at?.x ?? 0, at?.y ?? 0),
    });
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.element);
    this.orbit.look(direction("AP"));
    this.moving();
  }

  /** To be told before each step of what moves: a slider, a hand, samples. Nothing is drawn yet. */
  moving(): void {
    this.resolve(this.slow);
    window.clearTimeout(this.resting);
    this.restless = true;
  }

  /** Adds a picture to the right of the others. */
  addPane(caption = ""): Pane {
    const pane = new Pane(this.drawSoon);
    pane.setCaption(caption);
    this.panes.push(pane);
    this.captions.append(pane.caption);
    this.resize();
    return pane;
  }

  /** Puts the pictures into this order. */
  arrange(panes: readonly Pane[]): void {
    this.panes.splice(0, this.panes.length, ...panes);
    this.captions.replaceChildren(...panes.map((pane) => pane.caption));
    this.resize();
  }

  removePane(pane: Pane): void {
    this.panes.splice(this.panes.indexOf(pane), 1);
    pane.dispose();
    this.resize();
  }

  /** Sets what the axes are called: anatomical letters only where the file says they are LPS. */
  setSpace(space: string): void {
    this.cube.setSpace(space);
    this.draw();
  }

  /** Shows all of a surface. */
  fit(positions: Float32Array): void {
    this.orbit.fit(positions);
    this.draw();
  }

  /** Looks from a standard direction ("AP", "LAO 45", …). */
  look(name: string): void {
    this.orbit.look(direction(name));
    this.draw();
  }

  setCut(cut: Cut | null): void {
    this.cut = cut;
    this.draw();
  }

  get outlook(): Outlook {
    return this.orbit.outlook;
  }

  set outlook(outlook: Outlook) {
    this.orbit.outlook = outlook;
    this.draw();
  }

  /** Draws what is stale at once; with the next frame it is drawn anyway. */
  drawNow(): void {
    const { renderer } = this;
    const { height } = this.size;
    const plane = this.plane();
    renderer.setScissorTest(true);
    this.boxes().forEach((box, place) => {
      const pane = this.panes[place];
      if (!pane.stale) return;
      const bottom = height - box.top - box.height;
      renderer.setViewport(box.left, bottom, box.width, box.height);
      renderer.setScissor(box.left, bottom, box.width, box.height);
      renderer.clear();
      pane.cutBy(plane, renderer.getPixelRatio());
      renderer.render(pane.scene, this.orbit.placed(box.width, box.height));
      pane.stale = false;
    });
    this.cube.turnTo(this.orbit.turn);
    this.drawn?.();
    if (this.restless) requestAnimationFrame(() => this.restSoon());
  }

  /** Waits until the picture last drawn is there. */
  finish(): void {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Waits until the pixels are there and returns a sum over them, for tests and timing. */
  pixels(): { sum: number; width: number; height: number } {
    this.drawFinely();
    const gl = this.renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    let sum = 0;
    for (let i = 0; i < bytes.length; i += 1) sum = (Math.imul(sum, 31) + bytes[i]) | 0;
    return { sum, width, height };
  }

  /** The picture on a plain ground, for saving. */
  snapshot(ground: string): HTMLCanvasElement {
    this.drawFinely();
    const copy = h("canvas", { width: this.canvas.width, height: this.canvas.height });
    const pen = copy.getContext("2d") as CanvasRenderingContext2D;
    pen.fillStyle = ground;
    pen.fillRect(0, 0, copy.width, copy.height);
    pen.drawImage(this.canvas, 0, 0);
    return copy;
  }

  /** Where a place of the surface lies on the stage, pixels of the page; null if not in a pane. */
  project(position: readonly [number, number, number], pane = 0): { x: number; y: number } | null {
    const box = this.boxes()[pane];
    if (!box) return null;
    const at = new Vector3(...position).project(this.orbit.placed(box.width, box.height));
    return { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height };
  }

  /** The captions and where they stand, pixels of the page. */
  captionPlaces(): { text: string; x: number; y: number }[] {
    return this.boxes().map((box, place) => ({
      text: this.panes[place].caption.textContent ?? "",
      x: box.left + 12,
      y: box.top + 22,
    }));
  }

  dispose(): void {
    window.clearTimeout(this.resting);
    this.observer.disconnect();
    for (const pane of [...this.panes]) this.removePane(pane);
    this.renderer.dispose();
    this.element.remove();
  }

  /** Places of the pictures on the stage, pixels of the page. */
  private boxes(): Box[] {
    const { width, height } = this.size;
    const count = Math.max(this.panes.length, 1);
    const beside = width >= height;
    return this.panes.map((_, place) =>
      beside
        ? { left: (width * place) / count, top: 0, width: width / count, height }
        : { left: 0, top: (height * place) / count, width, height: height / count },
    );
  }

  private resize(): void {
    this.size = { width: this.element.clientWidth, height: this.element.clientHeight };
    const { width, height } = this.size;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.pixelRatio());
    this.renderer.setSize(width, height);
    const boxes = this.boxes();
    this.panes.forEach((pane, place) => {
      const box = boxes[place];
      pane.caption.style.left = `${box.left}px`;
      pane.caption.style.top = `${box.top}px`;
      pane.caption.style.width = `${box.width}px`;
      pane.stale = true;
    });
    this.drawNow();
  }

  /** Pixels of the canvas to one of the page. */
  private pixelRatio(): number {
    return Math.min(devicePixelRatio, 2) * (this.coarse ? COARSE : 1);
  }

  private resolve(coarse: boolean): void {
    if (coarse === this.coarse) return;
    this.coarse = coarse;
    this.renderer.setPixelRatio(this.pixelRatio());
    for (const pane of this.panes) pane.stale = true;
  }

  private drawFinely(): void {
    this.resolve(false);
    for (const pane of this.panes) pane.stale = true;
    this.drawNow();
  }

  private restSoon(): void {
    window.clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.rest(), REST_MS);
  }

  /** Draws finely what was drawn coarsely, and learns how long drawing takes here. */
  private rest(): void {
    if (!this.element.isConnected || !this.size.width) return;
    this.restless = false;
    const begun = performance.now();
    this.drawFinely();
    this.finish();
    this.slow = performance.now() - begun > SLOW_MS;
  }

  private plane(): Vector4 {
    if (!this.cut) return new Vector4(0, 0, 0, 1);
    const sign = this.cut.flipped ? -1 : 1;
    const normal = [0, 0, 0];
    normal[this.cut.axis] = sign;
    return new Vector4(normal[0], normal[1], normal[2], sign * this.cut.at);
  }

  private placeAt(x: number, y: number, event?: PointerEvent): PickedInPane | null {
    const boxes = this.boxes();
    const place = boxes.findIndex(
      (box) => x >= box.left && x < box.left + box.width && y >= box.top && y < box.top + box.height,
    );
    if (place < 0) return null;
    const box = boxes[place];
    const pane = this.panes[place];
    const plane = this.plane();
    const found = pick(
      pane.positions,
      pane.faces,
      this.orbit.placed(box.width, box.height),
      { x: (2 * (x - box.left)) / box.width - 1, y: 1 - (2 * (y - box.top)) / box.height },
      (px, py, pz) => plane.x * px + plane.y * py + plane.z * pz <= plane.w,
    );
    return found && { ...found, pane, shiftKey: event?.shiftKey ?? false, time: event?.timeStamp ?? performance.now() };
  }
}
