/** The panel beside the planes. */
import type { App } from "../app";
import { fill, h, saveFile } from "../dom";
import { button, Facts, NumberField, section, Slider, Toggle } from "../widgets/panel";
import { commandOf, NO_EDITS, type Edits, type History } from "./edits";
import type { Vec3 } from "./lattice";
import { signed } from "./orientation";
import type { VolumeInfo } from "./segment";
import type { Look } from "./state";
import { TOOLS, type Tool, type ToolName } from "./tools";
import type { Trial, Trials } from "./trials";
import { VerdictPanel } from "./verdict";

export interface Actions {
  readonly history: History;
  readonly tool: Tool;
  readonly look: Look;
  redraw(): void;
  goTo(place: Vec3): void;
  zoom(factor: number): void;
  whole(): void;
  accept(): void;
  savePicture(): void;
}

const FILES = [
  ["mask.nrrd", "application/octet-stream"],
  ["surface.vtp", "application/octet-stream"],
  ["result.json", "application/json"],
] as const;

export class Controls {
  readonly element: HTMLElement;
  private readonly tools = new Map<ToolName, HTMLButtonElement>();
  private readonly about = h("p", { class: "note" });
  private readonly seed: HTMLElement;
  private readonly region: HTMLElement;
  private readonly cuts = h("ul", { class: "cuts" });
  private readonly lower: Threshold;
  private readonly upper: Threshold;
  private readonly level: Slider;
  private readonly width: Slider;
  private readonly stub: NumberField;
  private readonly depth: NumberField;
  private readonly radius: NumberField;
  private readonly verdict: VerdictPanel;
  private readonly facts = new Facts();
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private readonly acceptButton: HTMLButtonElement;
  private readonly command = h("code", { class: "command", tabindex: 0 });
  private readonly files: HTMLButtonElement[];
  private readonly overlay = new Toggle("Atrium", true, () => this.actions.redraw(), "Show the atrium over the slices");
  private readonly tint = new Toggle("Thresholds", false, () => this.actions.redraw(), "Tint what lies between the thresholds");
  private shownTrial: Trial | null = null;
  private listed: Edits["cuts_mm"] | null = null;

  constructor(
    private readonly app: App,
    private readonly actions: Actions,
  ) {
    const { history, look } = actions;
    this.lower = new Threshold("Surface at", history, "lower_hu", () => this.tintOn());
    this.upper = new Threshold("Brighter is not blood", history, "upper_hu", () => this.tintOn());
    this.level = new Slider("Level", (hu) => this.setGreys(hu, look.width), { min: -500, max: 1500, step: 10, value: look.level, words: (hu) => `${hu} HU` });
    this.width = new Slider("Width", (hu) => this.setGreys(look.level, hu), { min: 20, max: 3000, step: 10, value: look.width, words: (hu) => `${hu} HU` });
    this.stub = new NumberField("Vein stubs", (mm) => history.set({ vein_stub_mm: mm }), { unit: "mm", min: 0, max: 100, step: 1, value: NO_EDITS.vein_stub_mm });
    this.depth = new NumberField("Depth of region", (mm) => history.set({ region_depth_mm: mm }), { unit: "mm", min: 5, max: 200, step: 5, value: NO_EDITS.region_depth_mm });
    this.radius = new NumberField("Radius of balls", (mm) => (actions.tool.ballRadius = mm), { unit: "mm", min: 1, max: 60, step: 1, value: actions.tool.ballRadius });
    this.seed = h("span", { "data-fact": "seed" });
    this.region = h("span", { "data-fact": "region" });
    this.verdict = new VerdictPanel((place) => actions.goTo(place), () => this.enable());
    this.undo = button("Undo", () => history.undo(), { title: "Ctrl Z" });
    this.redo = button("Redo", () => history.redo(), { title: "Ctrl Y" });
    this.acceptButton = button("Accept", () => actions.accept(), { kind: "primary", title: "Draw the surface of the preview and open it" });
    this.files = FILES.map(([name, type]) => button(name, () => void this.save(name, type), { kind: "small", title: `Save ${name} of the accepted atrium` }));
    this.element = this.laidOut();
    this.choose("look");
  }

  /** Whether the thresholds are tinted, and the atrium shown, in the slices. */
  get tints(): boolean {
    return this.tint.on;
  }

  get overlays(): boolean {
    return this.overlay.on;
  }

  describe(info: VolumeInfo): void {
    for (const file of this.files) file.disabled = !info.accepted;
    const size = info.shape.join(" × ");
    this.facts.clear();
    this.facts.set("CT", info.name, "name");
    this.facts.set("Voxels", `${size} of ${info.spacing_mm.map((mm) => +mm.toFixed(3)).join(" × ")} mm`, "voxels");
    this.facts.set("Slices drawn at", `${info.shown_step_mm.toFixed(2)} mm`, "drawn");
    this.facts.set("Axes", info.orientation_known ? "LPS" : "unknown: give a seed", "axes");
    info.remarks.forEach((remark, place) => this.facts.set(place ? `Note ${place + 1}` : "Note", remark));
  }

  choose(name: ToolName): void {
    this.actions.tool.choose(name);
    this.depth.element.hidden = name !== "polygon" && name !== "box";
    this.radius.element.hidden = name !== "ball";
    for (const [tool, each] of this.tools) each.setAttribute("aria-pressed", String(tool === name));
    this.about.textContent = TOOLS.find((tool) => tool.name === name)?.about ?? "";
    this.actions.redraw();
  }

  setGreys(level: number, width: number): void {
    const { look } = this.actions;
    look.level = Math.round(level);
    look.width = Math.round(width);
    this.level.value = look.level;
    this.width.value = look.width;
    this.actions.redraw();
  }

  accepted(): void {
    for (const file of this.files) file.disabled = false;
  }

  /** Shows the edits and the trial; `current` tells whether it is of these very edits. */
  show(trial: Trial | null, current: boolean, trials: Trials): void {
    const { history } = this.actions;
    const edits = history.now;
    this.shownTrial = current ? trial : null;
    this.verdict.show(trial?.document ?? null, kindOf(trial, current, trials));
    const found = trial?.document.thresholds_hu;
    this.lower.show(edits.lower_hu, found?.lower);
    this.upper.show(edits.upper_hu, found?.upper);
    this.stub.value = edits.vein_stub_mm;
    this.depth.value = edits.region_depth_mm;
    const place = edits.seed_mm ?? trial?.document.seed?.position_mm;
    this.seed.textContent = place ? `${place.map((mm) => signed(mm, 1)).join(", ")} mm${edits.seed_mm ? "" : ", found"}` : "not found yet";
    this.region.textContent = regionWords(edits);
    this.listCuts(edits);
    this.command.textContent = commandOf(edits);
    this.undo.disabled = !history.canUndo;
    this.redo.disabled = !history.canRedo;
    this.enable();
  }

  private enable(): void {
    const document = this.shownTrial?.document;
    const usable = document !== undefined && !document.sketch && document.verdict !== "refused";
    this.acceptButton.disabled = !usable || !this.verdict.cleared;
  }

  private listCuts(edits: Edits): void {
    if (edits.cuts_mm === this.listed) return;
    this.listed = edits.cuts_mm;
    const remove = (place: number): void => this.actions.history.set({ cuts_mm: edits.cuts_mm.filter((_, each) => each !== place) });
    fill(
      this.cuts,
      ...edits.cuts_mm.map((cut, place) => {
        const what = cut.length === 4 ? "Ball" : "Wall";
        const words = `${what} of ${cut[cut.length - 1].toFixed(1)} mm radius`;
        return h(
          "li",
          {},
          button(words, () => this.actions.goTo([cut[0], cut[1], cut[2]]), { kind: "small", title: "Go there" }),
          h("button", { type: "button", class: "small", "aria-label": `Remove ${words}`, onclick: () => remove(place) }, "×"),
        );
      }),
    );
  }

  private tintOn(): void {
    this.tint.on = true;
    this.actions.redraw();
  }

  private async save(name: string, type: string): Promise<void> {
    await this.app.attempt(async () => {
      const answer = await this.app.request(`/api/segment/file/${name}`);
      saveFile(name, await answer.arrayBuffer(), type);
    });
  }

  private laidOut(): HTMLElement {
    const { history } = this.actions;
    for (const { name, label, key, about } of TOOLS) {
      const pressed = button(label, () => this.choose(name), { kind: "small", title: `${about} (${key})` });
      pressed.setAttribute("aria-pressed", "false");
      this.tools.set(name, pressed);
    }
    return h(
      "div",
      {},
      section(
        "Left atrium",
        this.verdict.element,
        h("div", { class: "buttons" }, this.acceptButton, this.undo, this.redo),
      ),
      section("Thresholds", this.lower.element, this.upper.element),
      section(
        "Tools",
        h("div", { class: "buttons", role: "group", "aria-label": "Tools" }, ...this.tools.values()),
        this.about,
        line("Seed", this.seed, button("Find it", () => history.set({ seed_mm: null }), { kind: "small" })),
        line("Region", this.region, button("None", () => history.set({ region_mm: [] }), { kind: "small" })),
        this.depth.element,
        this.radius.element,
        this.cuts,
        this.stub.element,
      ),
      section(
        "Picture",
        this.level.element,
        this.width.element,
        h(
          "div",
          { class: "buttons" },
          this.overlay.element,
          this.tint.element,
          button("+", () => this.actions.zoom(1.25), { kind: "small", title: "Closer" }),
          button("−", () => this.actions.zoom(0.8), { kind: "small", title: "Farther" }),
          button("Whole", () => this.actions.whole(), { kind: "small" }),
          button("Picture (PNG)", () => this.actions.savePicture(), { kind: "small", title: "Save the three planes as they are" }),
        ),
      ),
      section(
        "Files",
        this.facts.element,
        h("div", { class: "buttons" }, ...this.files),
        h("p", { class: "note" }, "Files of the accepted atrium. The same on the command line:"),
        this.command,
      ),
    );
  }
}

/** A threshold in HU: from the histogram until one moves it. */
class Threshold {
  readonly element: HTMLElement;
  private readonly slider: Slider;
  private readonly automatic: HTMLButtonElement;

  constructor(
    label: string,
    private readonly history: History,
    private readonly name: "lower_hu" | "upper_hu",
    moved: () => void,
  ) {
    this.slider = new Slider(
      label,
      (hu) => {
        moved();
        history.pass({ [name]: hu });
      },
      { min: 0, max: 1500, step: 1, value: 0, words: (hu) => `${hu} HU` },
    );
    this.slider.input.addEventListener("change", () => history.set({ [name]: this.slider.value }, name));
    this.slider.input.dataset["threshold"] = name;
    this.automatic = button("From the histogram", () => history.set({ [name]: null }), { kind: "small" });
    this.element = h("div", { class: "threshold" }, this.slider.element, this.automatic);
  }

  show(given: number | null, found: number | undefined): void {
    const value = given ?? found;
    if (value !== undefined && document.activeElement !== this.slider.input) this.slider.value = Math.round(value);
    else if (given === null && found !== undefined) this.slider.value = Math.round(found);
    this.automatic.disabled = this.history.now[this.name] === null;
  }
}

function line(label: string, value: HTMLElement, action: HTMLElement): HTMLElement {
  return h("div", { class: "line" }, h("span", { class: "line-label" }, label), value, action);
}

function kindOf(trial: Trial | null, current: boolean, { busy, stage }: Trials): string {
  if (!trial) return busy ? "looking …" : "";
  const { sketch, step_mm } = trial.document;
  const what = `${sketch ? "sketch" : "preview"}${step_mm ? ` at ${step_mm} mm` : ""}`;
  if (!current) return `${what}, being updated …`;
  if (!sketch || !busy) return what;
  return stage ? `${what}, preview: ${stage.stage} …` : `${what}, preview follows …`;
}

function regionWords(edits: Edits): string {
  const n = edits.region_mm.length;
  if (!n) return "around the seed";
  return n === 2 ? "box" : `outline of ${n} corners`;
}
