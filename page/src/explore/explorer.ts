/** Explore at work: from the state to pictures, numbers and charts. */
import type { App } from "../app";
import { ColourBar } from "../colour/bar";
import { roundSteps, scaleOf, type ColourScale } from "../colour/scale";
import { h } from "../dom";
import type { Pane } from "../scene/pane";
import { Stage } from "../scene/stage";
import type { Field, Signal, SurfaceCase } from "../surfacecase";
import { percent, withUnit } from "../words";
import { ViewBar } from "../widgets/viewbar";
import { Charts } from "./charts";
import { levelOf, valuesAt, fewestPoints, type Level } from "./levels";
import { showHarmonic, showNumbers } from "./numbers";
import { Panel } from "./panel";
import { deviations, Rebuilt, rootMeanSquare } from "./rebuild";
import { savePicture, saveSpectrum, saveVertices } from "./saving";
import { checkedState, defaultScale, initialState, type ExploreState, type Picture, type SavedExplore } from "./state";

const ABOUT = "Shape and map rebuilt from the k coarsest waves, and from k points";

export class Explorer {
  readonly stage: Stage;
  state: ExploreState;
  private readonly panel: Panel;
  private readonly charts: Charts;
  private readonly bar = new ColourBar();
  private readonly secondBar = new ColourBar();
  private readonly readout = h("div", { class: "readout", "aria-hidden": "true", hidden: true });
  private readonly panes = new Map<Picture, Pane>();
  private readonly rebuilt: (Rebuilt | null)[];
  private level: Level | null = null;
  private errorScale: ColourScale | null = null;
  private shown: Float32Array | null = null;

  constructor(
    readonly root: HTMLElement,
    private readonly app: App,
    readonly surface: SurfaceCase,
  ) {
    this.state = initialState(surface, root.clientWidth);
    this.rebuilt = surface.signals.map(() => null);
    const host = h("div", { class: "stage-host" });
    this.charts = new Charts((count) => this.setCount(count));
    this.panel = new Panel(surface, this.state, {
      count: (count) => this.setCount(count),
      share: (share) => this.goToShare(share),
      change: (part) => this.change(part),
      scale: (part) => this.changeScale(part),
      resetScale: () => this.changeScale(null),
      savePicture: () => savePicture(this.stage, surface, [surface.name, "For research use only."], [this.bar.element, this.secondBar.element].filter((bar) => !bar.hidden)),
      saveVertices: () => this.saveVertices(),
      saveSpectrum: () => saveSpectrum(surface),
    });
    const views = new ViewBar(surface.space, ABOUT, (name) => this.stage.look(name), () => {
      this.stage.orbit.reset();
      this.stage.draw();
    });
    const stages = h("div", { class: "stages" }, this.bar.element, host, this.secondBar.element);
    root.replaceChildren(h("div", { class: "explore" }, h("div", { class: "explore-main" }, views.element, stages, this.charts.element), this.panel.element));
    this.stage = new Stage(host, "The surface", surface.space);
    host.append(this.readout);
    this.stage.hovered = (place, x, y) => this.hover(place && { pane: place.pane, vertex: place.vertex, x, y });
    this.stage.fit(surface.positions);
    this.showPictures();
    this.showCharts();
  }

  /** Goes to the first `count` harmonics, and to `count` points. */
  setCount(count: number): void {
    const next = Math.min(Math.max(Math.round(count), 1), this.surface.nModes);
    this.state.count = next;
    this.panel.setCount(next);
    this.stage.moving();
    this.update();
  }

  /** Goes to as many harmonics as hold a share of the power of the map, or of the bare shape. */
  private goToShare(share: number): void {
    const signal = this.map ?? this.surface.signals[0];
    const place = signal.share.findIndex((each) => each >= share);
    if (place >= 0) this.setCount(place + 1);
    else this.app.toast(`${this.surface.nModes} harmonics hold ${percent(signal.share[this.surface.nModes - 1])} of the power of ${signal.title}`);
  }

  saved(): SavedExplore {
    return { ...this.state, outlook: this.stage.outlook };
  }

  restore(saved: unknown): void {
    const { outlook, ...state } = checkedState(saved, this.surface);
    Object.assign(this.state, state);
    this.stage.outlook = outlook;
    this.showPictures();
    this.showCharts();
  }

  dispose(): void {
    this.stage.dispose();
  }

  private get field(): Field | null {
    return this.surface.fields.find((field) => field.name === this.state.field) ?? null;
  }

  private get map(): Signal | null {
    const { field } = this;
    return field && field.signal >= 0 ? this.surface.signals[field.signal] : null;
  }

  private change(part: Partial<ExploreState>): void {
    const field = this.state.field;
    Object.assign(this.state, part);
    if ("cut" in part) this.stage.moving();
    this.stage.setCut(this.state.cut);
    if (part.pictures) this.showPictures();
    else this.update();
    if (this.state.field !== field) this.showCharts();
    this.panel.refresh();
  }

  private changeScale(part: Partial<ColourScale> | null): void {
    const { field } = this;
    if (!field) return;
    const scale = this.scale(field);
    const next = part ? { ...scale, ...part } : defaultScale(field);
    if (next.low === next.high) this.app.toast("the two ends of a colour scale differ", "bad");
    else this.state.scales[field.name] = next;
    this.update();
    this.panel.refresh();
  }

  private scale(field: Field): ColourScale {
    return (this.state.scales[field.name] ??= defaultScale(field));
  }

  /** Puts up the pictures the state names, in order. */
  private showPictures(): void {
    const { pictures } = this.state;
    for (const picture of pictures) if (!this.panes.has(picture)) this.addPicture(picture);
    for (const [picture, pane] of this.panes) {
      if (pictures.includes(picture)) continue;
      this.stage.removePane(pane);
      this.panes.delete(picture);
    }
    this.stage.arrange(pictures.map((picture) => this.panes.get(picture) as Pane));
    this.stage.setCut(this.state.cut);
    this.update();
    this.panel.refresh();
  }

  private addPicture(picture: Picture): void {
    const pane = this.stage.addPane();
    this.panes.set(picture, pane);
    if (picture !== "points") pane.setSurface(this.surface.positions, this.surface.faces);
    else {
      pane.setFlat(true);
      this.level = null;
    }
  }

  private showCharts(): void {
    this.charts.show(this.surface, this.map ?? this.surface.signals[0]);
    this.charts.mark(this.state.count);
    this.panel.refresh();
  }

  /** Everything that depends on the count, the map and the colours; drawn before it returns. */
  private update(): void {
    const { field, state } = this;
    const scale = field && this.scale(field);
    if (!scale || state.colour === "map") this.errorScale = null;
    this.original(field, scale);
    const measured = state.single ? this.oneHarmonic() : this.firstHarmonics(field, scale);
    this.points(field, scale);
    if (state.single) showHarmonic(this.panel.facts, this.surface, this.map, state.count);
    else showNumbers(this.panel.facts, this.surface, this.map, state.count, measured);
    this.charts.mark(state.count);
    const grey = field?.values.some((value) => !Number.isFinite(value)) ? "not sampled" : "";
    this.bar.show(this.mapIsSeen() ? scale : null, field?.title ?? "", field?.unit ?? "", grey);
    for (const pane of this.panes.values()) pane.setEdges(state.edges || pane === this.panes.get("points"));
    this.root.dataset["count"] = String(state.count);
    this.stage.drawNow();
  }

  /** Whether any picture shows the map itself. */
  private mapIsSeen(): boolean {
    const { state } = this;
    return state.pictures.some((each) => each !== "harmonics") || (!state.single && state.colour === "map");
  }

  private original(field: Field | null, scale: ColourScale | null): void {
    const pane = this.panes.get("original");
    pane?.setCaption("Original");
    pane?.setValues(field?.values ?? null, scale);
  }

  private points(field: Field | null, scale: ColourScale | null): void {
    const pane = this.panes.get("points");
    if (!pane) return;
    const { surface } = this;
    const count = Math.max(this.state.count, fewestPoints(surface));
    if (!this.level || this.level.positions.length !== 3 * count) {
      this.level = levelOf(surface, count);
      if (this.level) pane.setSurface(this.level.positions, this.level.faces);
    }
    pane.setCaption(count === 1 ? "1 point" : `${count} points (simplified)`);
    const values = field && this.level ? valuesAt(this.level, surface, field.values) : null;
    pane.setValues(values, scale);
  }

  /** The first harmonics in their picture; the errors of shape and map. */
  private firstHarmonics(field: Field | null, scale: ColourScale | null): { shape: number; map: number } {
    const { state, surface, map } = this;
    const shape = this.rebuiltOf(0);
    const shapeError = deviations(shape.values, surface.positions, 3);
    const withMap = map && field ? this.rebuiltOf(field.signal) : null;
    const mapError = withMap && field ? deviations(withMap.values, field.values, 1) : null;
    const measured = {
      shape: rootMeanSquare(shapeError, surface.areas),
      map: mapError ? rootMeanSquare(mapError, surface.areas) : NaN,
    };
    const pane = this.panes.get("harmonics");
    if (!pane) return measured;
    const moved = !map || state.rebuild !== "map";
    pane.movePositions(moved ? shape.values : surface.positions);
    pane.setCaption(state.count === 1 ? "1 harmonic" : `${state.count} harmonics`);
    if (state.colour === "error") this.colourByError(pane, mapError ?? shapeError, field && mapError ? field.unit : "mm", mapError ? "error of the map" : "error of the shape");
    else {
      // What harmonics say where nothing was sampled is made up: it stays grey.
      const rebuiltMap =
        withMap && field && state.rebuild !== "shape"
          ? field.values.map((known, i) => (Number.isFinite(known) ? withMap.values[i] : NaN))
          : field?.values;
      this.secondBar.show(null, "", "");
      pane.setValues((this.shown = rebuiltMap ?? null), scale);
    }
    return measured;
  }

  private colourByError(pane: Pane, error: Float32Array, unit: string, title: string): void {
    // The limits stay while the slider moves, so that errors can be compared.
    this.errorScale ??= { ...scaleOf(error, "distance", 8), low: 0 };
    pane.setValues((this.shown = error), this.errorScale);
    this.secondBar.show(this.errorScale, title, unit);
  }

  private oneHarmonic(): { shape: number; map: number } {
    const { state, surface } = this;
    const mode = state.count - 1;
    const row = surface.modes.subarray(mode * surface.nVertices, (mode + 1) * surface.nVertices);
    const values = Float32Array.from(row, (value) => value * surface.modeScales[mode]);
    const most = values.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0);
    const end = roundSteps(0, most, 5).at(-1) ?? most;
    const scale: ColourScale = { palette: "diverging", low: -end, high: end, bands: 0, lines: false };
    const pane = this.panes.get("harmonics");
    pane?.movePositions(surface.positions);
    pane?.setValues((this.shown = values), scale);
    pane?.setCaption(`Harmonic ${state.count} alone`);
    this.secondBar.show(pane ? scale : null, `harmonic ${state.count}`, "1/mm");
    return { shape: NaN, map: NaN };
  }

  private rebuiltOf(signal: number): Rebuilt {
    const rebuilt = (this.rebuilt[signal] ??= new Rebuilt(this.surface, this.surface.signals[signal]));
    rebuilt.goTo(this.state.count);
    return rebuilt;
  }

  private hover(at: { pane: Pane; vertex: number; x: number; y: number } | null): void {
    const { field } = this;
    this.readout.hidden = !at;
    if (!at) return;
    const harmonics = at.pane === this.panes.get("harmonics");
    const points = at.pane === this.panes.get("points");
    const position = Array.from(at.pane.positions.subarray(3 * at.vertex, 3 * at.vertex + 3), (value) => value.toFixed(1));
    const values = harmonics ? this.shown : points && field && this.level ? valuesAt(this.level, this.surface, field.values) : field?.values;
    const unit = !harmonics || (this.state.colour === "map" && !this.state.single) ? (field?.unit ?? "") : "";
    const value = values?.[at.vertex];
    const words = value === undefined ? "" : Number.isFinite(value) ? withUnit(value, unit) : "not sampled";
    this.readout.textContent = [words, `${position.join(", ")} mm`].filter(Boolean).join("  ·  ");
    this.readout.style.left = `${Math.min(at.x + 14, this.stage.element.clientWidth - 190)}px`;
    this.readout.style.top = `${Math.max(at.y - 30, 4)}px`;
  }

  private saveVertices(): void {
    const { field, surface, map } = this;
    const shape = Float32Array.from(this.rebuiltOf(0).values);
    const rebuilt = map && field ? this.rebuiltOf(field.signal).values : null;
    saveVertices(surface, this.state.count, shape, field && { ...field, rebuilt });
  }
}
