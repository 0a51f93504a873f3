/** The view: three linked planes, the tools, thresholds, and what comes out. */
import type { App } from "../app";
import { fill, h } from "../dom";
import type { MountedView } from "../registry";
import { Controls } from "./controls";
import { editsKey, editsOf, History, type Edits } from "./edits";
import { HistogramFigure, type Level } from "./histogram";
import { Lattice, type Vec3 } from "./lattice";
import { ORIENTATIONS } from "./orientation";
import { regionBox } from "./outlines";
import type { Overlay } from "./picture";
import { SlicePlane } from "./plane";
import { savePlanes } from "./saving";
import type { Look, Scene } from "./state";
import { Tool, TOOLS } from "./tools";
import { Trials, type Trial } from "./trials";
import { colourOf } from "./verdict";

/** As the server describes the CT. */
export interface VolumeInfo {
  readonly name: string;
  readonly shape: Vec3;
  readonly spacing_mm: Vec3;
  readonly shown_shape: Vec3;
  readonly shown_step_mm: number;
  readonly shown_origin_mm: Vec3;
  readonly orientation_known: boolean;
  readonly remarks: readonly string[];
  readonly sketch_step_mm: number;
  readonly preview_step_mm: number;
  /** Whether an atrium of this CT has been accepted. */
  readonly accepted: boolean;
}

/** Half the sides of the box about the seed whose histogram is shown where no region is, mm. */
const AROUND: Vec3 = [75, 60, 65];

export function mountSegment(root: HTMLElement, app: App): MountedView {
  const view = new SegmentView(root, app);
  void view.begin();
  return view;
}

class SegmentView implements MountedView {
  readonly keys = [
    ...TOOLS.map((tool) => [tool.key, `${tool.label}: ${tool.about}`] as const),
    ["← → ↑ ↓", "move the cross by 1 mm (with Shift: 10 mm), when a slice is focused"],
    ["PgUp PgDn", "next slice; the wheel does the same"],
    ["Enter", "use the tool at the cross"],
    ["+ − 0", "closer, farther, whole; Ctrl and the wheel do the same"],
    ["Shift and drag", "grey levels; Alt and drag moves the pictures"],
    ["Esc, Backspace", "give a drawing up, take its last corner back"],
    ["Ctrl Z, Ctrl Y", "undo, redo"],
  ] as const;
  private readonly history = new History(() => this.edited());
  private trials: Trials;
  private readonly tool = new Tool();
  private readonly controls: Controls;
  private readonly histogram = new HistogramFigure();
  private readonly look: Look = { crosshair: [0, 0, 0], middle: [0, 0, 0], zoom: 1, level: 200, width: 900 };
  private planes: SlicePlane[] = [];
  private volume: Lattice<Int16Array> | null = null;
  private opened: VolumeInfo | null = null;
  private following = true;
  /** Key of the preview last read out. */
  private said: string | undefined;
  private beginning: Promise<void> | null = null;

  constructor(
    private readonly root: HTMLElement,
    private readonly app: App,
  ) {
    this.trials = new Trials(app, () => this.tried());
    this.controls = new Controls(app, {
      history: this.history,
      tool: this.tool,
      look: this.look,
      redraw: () => this.redraw(),
      goTo: (place) => this.goTo(place),
      zoom: (factor) => this.zoom(factor, this.look.crosshair),
      whole: () => this.whole(),
      accept: () => void this.accept(),
      savePicture: () => savePlanes(this.planes, this.words()),
    });
    root.addEventListener("keydown", (event) => this.shortcut(event));
    app.onChange(() => this.reopened());
  }

  begin(): Promise<void> {
    this.beginning ??= this.load().finally(() => (this.beginning = null));
    return this.beginning;
  }

  shown(): void {
    this.redraw();
  }

  saved(): unknown {
    return { edits: this.history.now, look: this.look };
  }

  restore(state: unknown): void {
    const { edits, look } = (state ?? {}) as { edits?: unknown; look?: Partial<Look> };
    this.history.set(editsOf(edits));
    const place = (each: unknown): each is Vec3 => Array.isArray(each) && each.length === 3 && each.every(Number.isFinite);
    if (place(look?.crosshair) && place(look.middle)) Object.assign(this.look, { crosshair: look.crosshair, middle: look.middle });
    for (const name of ["zoom", "level", "width"] as const)
      if (Number.isFinite(look?.[name])) this.look[name] = look?.[name] as number;
    this.following = false;
    this.redraw();
  }

  /** Another CT has been opened in place of this one. */
  private reopened(): void {
    const info = this.app.session["volume"] as VolumeInfo | undefined;
    if (!info || !this.opened || sameVolume(info, this.opened)) return;
    void this.begin();
  }

  private async load(): Promise<void> {
    fill(this.root, h("p", { class: "welcome" }, "Reading slices …"));
    await this.app.attempt(async () => {
      const info = this.app.session["volume"] as VolumeInfo;
      this.startAfresh();
      const answer = await this.app.request("/api/segment/voxels");
      const voxels = new Int16Array(await answer.arrayBuffer());
      this.opened = info;
      this.volume = new Lattice(voxels, info.shown_shape, info.shown_origin_mm, info.shown_step_mm);
      this.build(info);
      this.whole();
      this.edited();
    });
  }

  /** Nothing chosen or found for one CT is carried to the next. */
  private startAfresh(): void {
    this.trials.close();
    this.trials = new Trials(this.app, () => this.tried());
    this.history.reset();
    this.histogram.reset();
    this.following = true;
  }

  private build(info: VolumeInfo): void {
    const middle = ([0, 1, 2] as const).map(
      (axis) => info.shown_origin_mm[axis] + ((info.shown_shape[axis] - 1) * info.shown_step_mm) / 2,
    );
    this.look.crosshair = middle as unknown as Vec3;
    this.controls.describe(info);
    this.planes = ORIENTATIONS.map((plane) => new SlicePlane(plane, () => this.scene(), this));
    fill(
      this.root,
      h("div", { class: "segment" },
        h("div", { class: "slices" }, ...this.planes.map((plane) => plane.element), this.histogram.element),
        h("aside", { class: "side", "aria-label": "Segmentation" }, this.controls.element),
      ),
    );
  }

  private scene(): Scene {
    const { volume, look, tool } = this;
    if (!volume) throw new Error("no slices yet");
    const shown = this.shownTrial();
    const edits = this.history.now;
    const found = shown?.document.thresholds_hu;
    const low = edits.lower_hu ?? found?.lower;
    const high = edits.upper_hu ?? found?.upper;
    return {
      volume,
      look,
      edits,
      tool,
      tinted: this.controls.tints && low !== undefined ? [low, high ?? Infinity] : null,
      overlay: this.overlay(shown),
      oriented: this.opened?.orientation_known ?? false,
    };
  }

  /** The preview of the edits as they are, else the latest sketch. */
  private shownTrial(): Trial | null {
    return this.trials.preview(this.history.now) ?? this.trials.sketch;
  }

  private overlay(shown: Trial | null): Overlay | null {
    if (!shown?.mask || !this.controls.overlays) return null;
    return { mask: shown.mask, colour: colourOf(shown.document) };
  }

  private edited(): void {
    if (!this.volume) return;
    this.trials.wish(this.history.now);
    this.redraw();
  }

  private tried(): void {
    const shown = this.shownTrial();
    const seed = shown?.document.seed;
    if (seed && this.following) {
      this.following = false;
      this.look.crosshair = seed.position_mm;
      this.look.middle = seed.position_mm;
      if (this.volume) this.look.zoom = Math.max((Math.max(...this.volume.shape) * this.volume.step) / 170, 1);
    }
    const { key, sketch, verdict, volume_ml } = shown?.document ?? {};
    if (sketch === false && key !== this.said) {
      this.said = key;
      this.app.announce(verdict === "refused" ? "No atrium was found" : `${volume_ml?.toFixed(1)} ml, verdict ${verdict}`);
    }
    this.redraw();
  }

  private redraw(): void {
    const { volume } = this;
    if (!volume) return;
    for (const plane of this.planes) plane.refresh();
    const shown = this.shownTrial();
    const current = shown?.edits === editsKey(this.history.now);
    this.controls.show(shown, current, this.trials);
    this.histogram.show(volume, this.box(shown), levels(this.history.now, shown));
  }

  /** Where the histogram is taken: the region, or around the seed, or everything. */
  private box(shown: Trial | null): readonly [Vec3, Vec3] {
    const region = regionBox(this.history.now);
    if (region) return region;
    const { volume } = this;
    const seed = shown?.document.seed?.position_mm ?? this.history.now.seed_mm;
    const end = (side: -1 | 1): Vec3 =>
      [0, 1, 2].map((axis) =>
        seed ? seed[axis] + side * AROUND[axis] : side < 0 ? (volume?.first(axis) ?? 0) : (volume?.last(axis) ?? 0),
      ) as unknown as Vec3;
    return [end(-1), end(1)];
  }

  private async accept(): Promise<void> {
    const trial = this.trials.preview(this.history.now);
    if (!trial) return;
    const done = await this.app.work<{ volume_ml: number }>("Drawing the surface", "/api/segment/accept", {
      key: trial.document.key,
    });
    if (!done) return;
    this.controls.accepted();
    await this.app.attempt(() => this.app.refreshSession());
    this.app.toast(`Accepted: a closed surface of ${done.volume_ml.toFixed(1)} ml is open in Explore and Plan`, "good");
    this.app.show("explore");
  }

  /** What the slices show, for a picture of them. */
  private words(): string {
    const { volume_ml, sketch } = this.shownTrial()?.document ?? {};
    const found = volume_ml === undefined ? "" : `Left atrium, ${volume_ml.toFixed(1)} ml (${sketch ? "sketch" : "preview"}). `;
    return `${found}For research use only.`;
  }

  // What hands and keys on the planes do.

  goTo(place: Vec3): void {
    this.look.middle = place;
    this.lookAt(place);
  }

  lookAt(place: Vec3): void {
    const { volume } = this;
    if (!volume) return;
    this.look.crosshair = [0, 1, 2].map((axis) =>
      Math.min(Math.max(place[axis], volume.first(axis)), volume.last(axis)),
    ) as unknown as Vec3;
    this.redraw();
  }

  press(place: Vec3, plane: (typeof ORIENTATIONS)[number], near: (one: Vec3, other: Vec3) => boolean): void {
    this.following = false;
    if (this.tool.name === "look") this.lookAt(place);
    else this.drawn(this.tool.press(place, plane, near, this.history.now));
  }

  release(place: Vec3, near: (one: Vec3, other: Vec3) => boolean): void {
    this.drawn(this.tool.release(place, near, this.history.now));
  }

  hover(place: Vec3, plane: (typeof ORIENTATIONS)[number]): void {
    if (!this.tool.drawing || this.tool.plane !== plane) return;
    this.tool.pointer = place;
    for (const each of this.planes) if (each.plane === plane) each.refresh();
  }

  greys(across: number, down: number): void {
    this.controls.setGreys(this.look.level - 2 * down, Math.max(this.look.width + 3 * across, 20));
  }

  zoom(factor: number, about: Vec3): void {
    const zoom = Math.min(Math.max(this.look.zoom * factor, 1), 20);
    const share = 1 - this.look.zoom / zoom;
    this.look.middle = this.look.middle.map((value, axis) => value + share * (about[axis] - value)) as unknown as Vec3;
    this.look.zoom = zoom;
    this.redraw();
  }

  move(by: Vec3): void {
    this.look.middle = this.look.middle.map((value, axis) => value + by[axis]) as unknown as Vec3;
    this.redraw();
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === "+" || event.key === "=") this.zoom(1.25, this.look.crosshair);
    else if (event.key === "-") this.zoom(0.8, this.look.crosshair);
    else if (event.key === "0") this.whole();
    else if (event.key === "Escape" && this.tool.drawing) this.tool.abandon();
    else if (event.key === "Backspace" && this.tool.drawing) this.tool.back();
    else return false;
    this.redraw();
    return true;
  }

  private shortcut(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (target.matches("input:not([type=range]), select, textarea")) return;
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key === "z" && !event.shiftKey) this.history.undo();
      else if (key === "y" || key === "z") this.history.redo();
      else return;
      event.preventDefault();
      return;
    }
    const tool = TOOLS.find((each) => each.key.toLowerCase() === key);
    if (tool && !event.altKey) this.controls.choose(tool.name);
  }

  private drawn(change: Partial<Edits> | null): void {
    if (change) this.history.set(change);
    this.redraw();
  }

  private whole(): void {
    const { volume } = this;
    if (!volume) return;
    this.look.zoom = 1;
    this.look.middle = [0, 1, 2].map((axis) => (volume.first(axis) + volume.last(axis)) / 2) as unknown as Vec3;
    this.redraw();
  }
}

function sameVolume(one: VolumeInfo, other: VolumeInfo): boolean {
  const key = (info: VolumeInfo): string => JSON.stringify([info.name, info.shown_shape, info.shown_origin_mm, info.shown_step_mm]);
  return key(one) === key(other);
}

function levels(edits: Edits, shown: Trial | null): Level[] {
  const found = shown?.document.thresholds_hu;
  const lower = edits.lower_hu ?? found?.lower;
  const upper = edits.upper_hu ?? found?.upper;
  return [
    ...(found ? [{ hu: found.wall, words: "wall", kind: "measured" } as const] : []),
    ...(lower === undefined ? [] : [{ hu: lower, words: "surface", kind: "threshold" } as const]),
    ...(found ? [{ hu: found.blood, words: "blood", kind: "measured" } as const] : []),
    ...(upper === undefined ? [] : [{ hu: upper, words: "upper", kind: "threshold" } as const]),
  ];
}
