/** The controls of Explore. */
import { PALETTE_LABELS } from "../colour/palettes";
import type { ColourScale, PaletteName } from "../colour/scale";
import { h } from "../dom";
import type { Cut } from "../scene/stage";
import type { SurfaceCase } from "../surfacecase";
import { button, Choice, Facts, NumberField, section, Slider, Toggle } from "../widgets/panel";
import { figures } from "../words";
import { PICTURES, type ExploreState, type Picture } from "./state";

/** What the controls ask for. */
export interface Wishes {
  count(count: number): void;
  share(share: number): void;
  change(part: Partial<ExploreState>): void;
  scale(part: Partial<ColourScale>): void;
  resetScale(): void;
  savePicture(): void;
  saveVertices(): void;
  saveSpectrum(): void;
}

const PICTURE_LABELS: Record<Picture, string> = {
  original: "Original",
  harmonics: "k harmonics",
  points: "k points",
};
/** Shares of the power one goes to at once; the first two are the paper's. */
const SHARES = [0.85, 0.9, 0.95, 0.99] as const;
const AXES = ["x", "y", "z"] as const;

export class Panel {
  readonly element = h("aside", { class: "side", "aria-label": "Controls", tabindex: 0 });
  readonly facts = new Facts();
  readonly slider: Slider;
  private readonly number: NumberField;
  private readonly field: Choice;
  private readonly rebuild: Choice;
  private readonly colour: Choice;
  private readonly pictures: Record<Picture, Toggle>;
  private readonly single: Toggle;
  private readonly palette: Choice;
  private readonly low: NumberField;
  private readonly high: NumberField;
  private readonly bands: NumberField;
  private readonly lines: Toggle;
  private readonly edges: Toggle;
  private readonly cutAxis: Choice;
  private readonly cutPlace: Slider;
  private readonly flip: Toggle;
  private readonly fieldNote = h("p", { class: "note" });
  private readonly colours: HTMLElement;
  private readonly remarks = h("details", { class: "remarks" });

  constructor(
    private readonly surface: SurfaceCase,
    private readonly state: ExploreState,
    private readonly wishes: Wishes,
  ) {
    const { nModes } = surface;
    this.slider = new Slider("Number of harmonics k", (value) => wishes.count(value), {
      min: 1,
      max: nModes,
      value: state.count,
    });
    this.number = new NumberField("Exactly", (value) => wishes.count(value), { min: 1, max: nModes, step: 1, value: state.count });
    this.single = new Toggle("Harmonic k alone", state.single, (single) => wishes.change({ single }), "Show one harmonic instead of the sum of the first k");
    this.field = new Choice("Map", (field) => wishes.change({ field }));
    this.rebuild = new Choice("Rebuild", (value) => wishes.change({ rebuild: value as ExploreState["rebuild"] }));
    this.colour = new Choice("Colours show", (value) => wishes.change({ colour: value as ExploreState["colour"] }));
    this.pictures = Object.fromEntries(
      PICTURES.map((picture) => [picture, new Toggle(PICTURE_LABELS[picture], state.pictures.includes(picture), () => this.choosePictures(picture))]),
    ) as Record<Picture, Toggle>;
    this.palette = new Choice("Palette", (value) => wishes.scale({ palette: value as PaletteName }));
    this.low = new NumberField("From", (low) => wishes.scale({ low }));
    this.high = new NumberField("To", (high) => wishes.scale({ high }));
    this.bands = new NumberField("Bands", (bands) => wishes.scale({ bands: Math.round(bands) }), { min: 0, max: 64, step: 1 });
    this.lines = new Toggle("Contours", false, (lines) => wishes.scale({ lines }), "Isochrones of activation times");
    this.edges = new Toggle("Edges", state.edges, (edges) => wishes.change({ edges }));
    this.cutAxis = new Choice("Cut across", () => this.cut());
    this.cutPlace = new Slider("Cut at", () => this.cut(), { min: -1, max: 1, value: 0, step: 0.5, words: (value) => `${figures(value)} mm` });
    this.flip = new Toggle("Other side", false, () => this.cut());
    this.colours = this.colourSection();
    this.element.append(this.harmonicSection(), this.mapSection(), this.colours, this.lookSection(), this.savingSection());
    this.refresh();
  }

  /** Brings all controls up to date with the state. */
  refresh(): void {
    const { state, surface } = this;
    const map = surface.fields.find((field) => field.name === state.field);
    this.setCount(state.count);
    this.single.on = state.single;
    for (const picture of PICTURES) this.pictures[picture].on = state.pictures.includes(picture);
    this.field.setOptions(
      [["", "None (bare surface)"], ...surface.fields.map((field) => [field.name, field.title] as const)],
      state.field,
    );
    this.rebuild.setOptions([["both", "Shape and map"], ["shape", "Shape only"], ["map", "Map only"]], state.rebuild);
    this.colour.setOptions([["map", "the rebuilt map"], ["error", "its error"]], state.colour);
    if (!map) this.colour.setOptions([["map", "nothing"], ["error", "error of the shape"]], state.colour);
    this.rebuild.element.hidden = !map || map.signal < 0;
    this.fieldNote.textContent = map?.fault ? `This map ${map.fault}: it cannot be rebuilt.` : "";
    this.fieldNote.hidden = !map?.fault;
    this.edges.on = state.edges;
    this.refreshScale(map ? state.scales[map.name] : null, map?.unit ?? "");
    this.refreshCut();
  }

  setCount(count: number): void {
    this.slider.value = count;
    this.number.value = count;
  }

  private refreshScale(scale: ColourScale | null, unit: string): void {
    this.colours.hidden = !scale;
    if (!scale) return;
    this.palette.setOptions(Object.entries(PALETTE_LABELS), scale.palette);
    this.low.value = scale.low;
    this.high.value = scale.high;
    this.bands.value = scale.bands;
    this.lines.on = scale.lines;
    for (const field of [this.low, this.high]) field.setUnit(unit);
  }

  private refreshCut(): void {
    const { cut } = this.state;
    const lps = this.surface.space === "LPS";
    const names = lps ? ["left–right (x)", "front–back (y)", "low–high (z)"] : AXES.map((axis) => `${axis} axis of the file`);
    this.cutAxis.setOptions([["", "nothing"], ...names.map((name, axis) => [String(axis), name] as const)], cut ? String(cut.axis) : "");
    this.cutPlace.element.hidden = this.flip.element.hidden = !cut;
    if (!cut) return;
    const [low, high] = extent(this.surface.positions, cut.axis);
    this.cutPlace.setRange(Math.floor(low), Math.ceil(high));
    this.cutPlace.value = cut.at;
    this.flip.on = cut.flipped;
  }

  private cut(): void {
    const chosen = this.cutAxis.value;
    const axis = Number(chosen) as Cut["axis"];
    const before = this.state.cut;
    const [low, high] = extent(this.surface.positions, axis);
    const at = before?.axis === axis ? this.cutPlace.value : Math.round(low + high) / 2;
    this.wishes.change({ cut: chosen === "" ? null : { axis, at, flipped: this.flip.on } });
  }

  private choosePictures(toggled: Picture): void {
    const pictures = PICTURES.filter((picture) => this.pictures[picture].on);
    if (!pictures.length) this.pictures[toggled].on = true;
    this.wishes.change({ pictures: pictures.length ? pictures : [toggled] });
  }

  private harmonicSection(): HTMLElement {
    return section(
      "Harmonics",
      this.slider.element,
      h("div", { class: "pair" }, this.number.element, this.single.element),
      h(
        "div",
        { class: "buttons", role: "group", "aria-label": "Harmonics that hold a share of the power" },
        h("span", { class: "note" }, "k to hold"),
        ...SHARES.map((share) =>
          button(`${100 * share} %`, () => this.wishes.share(share), { kind: "small", title: `As many harmonics as hold ${100 * share} % of the power` }),
        ),
      ),
      this.facts.element,
    );
  }

  private mapSection(): HTMLElement {
    const side = h(
      "div",
      { class: "buttons", role: "group", "aria-label": "Pictures side by side" },
      ...PICTURES.map((picture) => this.pictures[picture].element),
    );
    return section("Shown", side, this.field.element, this.fieldNote, this.rebuild.element, this.colour.element);
  }

  private colourSection(): HTMLElement {
    return section(
      "Colours",
      this.palette.element,
      h("div", { class: "pair" }, this.low.element, this.high.element),
      h("div", { class: "pair" }, this.bands.element, this.lines.element, button("Reset", () => this.wishes.resetScale(), { kind: "small" })),
    );
  }

  private lookSection(): HTMLElement {
    return section("Look", h("div", { class: "buttons" }, this.edges.element, this.flip.element), this.cutAxis.element, this.cutPlace.element);
  }

  private savingSection(): HTMLElement {
    const { remarks, surface, wishes } = this;
    remarks.append(h("summary", {}, `Notes on this surface (${surface.remarks.length})`), h("ul", {}, ...surface.remarks.map((each) => h("li", {}, each))));
    remarks.hidden = !surface.remarks.length;
    const size = `${surface.nVertices.toLocaleString("en")} vertices, ${surface.nModes} harmonics, ${figures(surface.areaMm2 / 100)} cm²`;
    return section(
      "Save",
      h(
        "div",
        { class: "buttons" },
        button("Picture (PNG)", () => wishes.savePicture(), { kind: "small" }),
        button("Vertices (CSV)", () => wishes.saveVertices(), { kind: "small" }),
        button("Spectrum (CSV)", () => wishes.saveSpectrum(), { kind: "small" }),
      ),
      h("p", { class: "note" }, size),
      remarks,
    );
  }
}

function extent(positions: Float32Array, axis: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (let i = axis; i < positions.length; i += 3) {
    low = Math.min(low, positions[i]);
    high = Math.max(high, positions[i]);
  }
  return [low, high];
}
