/** Plan and map at work: the plan, the samples, the pictures and the numbers. */
import type { App } from "../app";
import { unpacked } from "../bundle";
import { uploaded } from "../connection";
import { PALETTE_LABELS } from "../colour/palettes";
import type { PaletteName } from "../colour/scale";
import { fill, h } from "../dom";
import { savePicture } from "../explore/saving";
import type { Outlook } from "../scene/orbit";
import type { PickedInPane } from "../scene/stage";
import type { SurfaceCase } from "../surfacecase";
import { button, Choice, Facts, NumberField, section, Toggle } from "../widgets/panel";
import { ViewBar } from "../widgets/viewbar";
import { percent } from "../words";
import { Live } from "./live";
import { showOutcome, type PlanDocument } from "./outcome";
import { BESIDE, Pictures, type Beside } from "./pictures";
import { Playback, type RecordingInfo } from "./playback";
import { saveMap, savePlan, saveSamples } from "./saving";
import { askColumns, headings } from "./table";
import { trueError, ValueSource } from "./values";
import { VerdictBox } from "./verdict";
import { Wanted, type Choices, type SavedWanted } from "./wanted";

const PALETTES: readonly PaletteName[] = ["viridis", "cividis", "classic"];

const ABOUT = "The map the samples give, and how sure it is: click to take one";

interface Planned {
  readonly document: PlanDocument;
  readonly positions: Float32Array;
  readonly wavelengths: Float32Array | null;
}

interface SavedPlan {
  readonly wanted: SavedWanted;
  readonly target: number;
  readonly samples: readonly (readonly number[])[];
  readonly aim: { readonly name: string; readonly unit: string; readonly noise: number | null; readonly cycle: number | null };
  readonly beside: Beside;
  readonly palette: PaletteName;
  readonly outlook: Outlook;
}

export class Planner {
  readonly live: Live;
  readonly pictures: Pictures;
  /** Milliseconds from the last click to the pixels of the map being there. */
  lastClickMs = NaN;
  private plan: Planned | null = null;
  private readonly wanted: Wanted;
  private readonly target: NumberField;
  private readonly values: ValueSource;
  private readonly playback: Playback;
  private readonly verdict = new VerdictBox();
  private readonly outcome = h("div", { class: "outcome", "aria-live": "polite" });
  private readonly facts = new Facts();
  private readonly beside: Choice;
  private readonly palette: Choice;
  private readonly showPlan: Toggle;
  private readonly showNext: Toggle;
  private readonly undoButton = button("Undo", () => this.undo(), { title: "Ctrl Z" });
  private readonly redoButton = button("Redo", () => this.redo(), { title: "Ctrl Y" });
  private readonly planButtons = h("div", { class: "buttons", hidden: true });

  constructor(
    root: HTMLElement,
    private readonly app: App,
    private readonly surface: SurfaceCase,
    choices: Choices,
  ) {
    this.live = new Live(app, () => this.update());
    this.wanted = new Wanted(choices);
    this.target = new NumberField("Error to reach", () => void this.begin(), { unit: "% of the map’s deviation", min: 0.1, max: 99, value: 10 });
    this.values = new ValueSource(surface, () => void this.begin());
    const opened = app.session["case"] as { recordings?: RecordingInfo[] } | undefined;
    this.playback = new Playback(app, this.live, opened?.recordings ?? [], (recording) => void this.play(recording, opened?.recordings ?? []));
    this.beside = new Choice("Beside the map", () => this.update());
    this.beside.setOptions(BESIDE, root.clientWidth >= 760 ? "uncertainty" : "none");
    this.palette = new Choice("Colours", () => this.update());
    this.palette.setOptions(PALETTES.map((each) => [each, PALETTE_LABELS[each]] as const), "viridis");
    this.showPlan = new Toggle("Planned points", true, () => this.update());
    this.showNext = new Toggle("Next point", true, () => this.update(), "Where one more sample helps most");
    this.pictures = new Pictures(surface, (place) => void this.clicked(place));
    this.build(root);
    this.pictures.stage.fit(surface.positions);
    this.update();
  }

  undo(): void {
    void this.live.goTo((this.live.state?.n_taken ?? 0) - 1);
  }

  redo(): void {
    const { state } = this.live;
    if (state?.n_ahead) void this.live.goTo(state.n_taken + 1);
  }

  /** Takes a sample where it is proposed. */
  async takeNext(): Promise<void> {
    const { state } = this.live;
    if (state) await this.takeAt(state.next, [this.nearest(state.next), 0, 0], [1, 0, 0]);
  }

  async loadTable(file: File): Promise<void> {
    const columns = await askColumns(file, await headings(file));
    if (!columns) return;
    const query = new URLSearchParams(Object.entries(columns).filter(([, name]) => name));
    await this.app.attempt(async () => {
      const answer = await this.app.request(`/api/live/table?${query.toString()}`, uploaded(file));
      const told = (await answer.json()) as { n_ahead: number; n_left_out: number };
      this.fresh();
      await this.live.goTo(told.n_ahead);
      const left = told.n_left_out ? `, ${told.n_left_out} left out: off the surface, or without a value` : "";
      this.app.toast(`${told.n_ahead} samples from ${file.name}${left}`, "good");
    });
  }

  saved(): SavedPlan {
    const { state } = this.live;
    const positions = state?.positions ?? new Float32Array(0);
    return {
      wanted: this.wanted.saved,
      target: this.target.value,
      samples: Array.from(state?.values ?? [], (value, i) => [...positions.subarray(3 * i, 3 * i + 3), value]),
      aim: { name: state?.name ?? "value", unit: state?.unit ?? "", noise: state?.noise ?? null, cycle: state?.cycle_length_ms ?? null },
      beside: this.beside.value as Beside,
      palette: this.palette.value as PaletteName,
      outlook: this.pictures.stage.outlook,
    };
  }

  /** Goes back to a saved state; throws in words if it is none. */
  restore(saved: unknown): void {
    void this.restored(checked(saved));
  }

  private async restored(state: SavedPlan): Promise<void> {
    this.wanted.restore(state.wanted);
    this.target.value = state.target;
    this.beside.value = state.beside;
    this.palette.value = state.palette;
    this.pictures.stage.outlook = state.outlook;
    const { name, unit, noise, cycle } = state.aim;
    await this.live.begin({ name, unit, noise, cycle_length_ms: cycle, target_nrmse: state.target / 100 });
    if (state.samples.length)
      await this.live.takeAll(state.samples.map((each) => each.slice(0, 3)), state.samples.map((each) => each[3]));
  }

  dispose(): void {
    this.pictures.dispose();
  }

  private build(root: HTMLElement): void {
    const table = h("input", { type: "file", accept: ".csv,.txt,.tsv,text/csv", class: "unseen", tabindex: -1, "aria-label": "Table of samples" });
    table.addEventListener("change", () => {
      const file = table.files?.[0];
      table.value = "";
      if (file) void this.loadTable(file);
    });
    fill(
      this.planButtons,
      button("Take them", () => void this.takePlan(), { kind: "small", title: "Take a sample at every planned point" }),
      button("Points as CSV", () => this.plan && savePlan(this.surface, this.plan.positions), { kind: "small" }),
    );
    const panel = h(
      "aside",
      { class: "side", "aria-label": "Controls", tabindex: 0 },
      this.verdict.element,
      section(
        "Plan",
        this.target.element,
        this.wanted.element,
        h("div", { class: "buttons" }, button("Plan", () => void this.makePlan(), { kind: "primary" })),
        this.outcome,
        this.planButtons,
      ),
      section(
        "Samples",
        this.values.choice.element,
        this.values.typed.element,
        this.values.noise.element,
        this.values.cycle.element,
        h("div", { class: "buttons" }, button("Take next point", () => void this.takeNext(), { title: "Where one more sample helps most (key N)" }), this.undoButton, this.redoButton, button("Clear", () => void this.begin())),
        h("div", { class: "buttons" }, button("Load CSV …", () => table.click()), table),
        this.facts.element,
      ),
      this.playback.element,
      section(
        "Pictures",
        this.beside.element,
        this.palette.element,
        h("div", { class: "buttons" }, this.showPlan.element, this.showNext.element),
        h(
          "div",
          { class: "buttons" },
          button("Samples as CSV", () => this.live.state && saveSamples(this.surface, this.live.state), { kind: "small" }),
          button("Map as CSV", () => this.live.state && saveMap(this.surface, this.live.state, this.live.judgement), { kind: "small" }),
          button("Picture", () => savePicture(this.pictures.stage, this.surface, [this.surface.name, "For research use only."], [...this.pictures.element.querySelectorAll(".colour-bar:not([hidden])")]), { kind: "small" }),
        ),
      ),
    );
    const views = new ViewBar(this.surface.space, ABOUT, (name) => this.pictures.stage.look(name), () => {
      this.pictures.stage.orbit.reset();
      this.pictures.stage.draw();
    });
    root.replaceChildren(h("div", { class: "planning" }, h("div", { class: "plan-main" }, views.element, this.pictures.element, this.playback.plot.element), panel));
  }

  private update(): void {
    const { state, judgement } = this.live;
    const truth = this.values.truth;
    this.pictures.show(this.live, {
      beside: this.beside.value as Beside,
      palette: this.palette.value as PaletteName,
      truth,
      planned: this.plan && this.showPlan.on ? this.plan.positions : null,
      plannedWavelengths: this.plan?.wavelengths ?? null,
      showNext: this.showNext.on,
    });
    this.verdict.show(state, judgement);
    this.playback.update();
    this.undoButton.disabled = !state?.n_taken;
    this.redoButton.disabled = !state?.n_ahead;
    this.facts.clear();
    if (state?.next_nrmse) this.facts.set("With the next point", percent(state.next_nrmse), "next-error");
    if (state?.mean && truth) {
      const error = trueError(this.surface, truth.values, state.mean, state.cycle_length_ms);
      if (Number.isFinite(error)) this.facts.set("True error", percent(error), "true-error");
    }
    if (judgement?.bandwidth) this.facts.set("Bandwidth", `${judgement.bandwidth[0]} to ${judgement.bandwidth[1]} harmonics`, "bandwidth");
    if (judgement?.undersampled_share) this.facts.set("Too sparse", `${percent(judgement.undersampled_share)} of the area`, "sparse");
    if (state?.n_left_out) this.facts.set("Left out", `${state.n_left_out} samples`, "left-out");
  }

  private async clicked(place: PickedInPane): Promise<void> {
    const { faces } = this.surface;
    const corners = [0, 1, 2].map((corner) => faces[3 * place.face + corner]);
    await this.takeAt(place.position, corners, place.weights);
    await new Promise(requestAnimationFrame);
    this.pictures.stage.finish();
    this.lastClickMs = performance.now() - place.time;
  }

  private async takeAt(position: readonly number[], corners: readonly number[], weights: readonly number[]): Promise<void> {
    const value = this.values.valueAt(corners, weights);
    if (!Number.isFinite(value)) {
      this.app.toast("there is no value here: click where the map is known, or type a value", "bad");
      return;
    }
    if (this.live.state && !this.live.state.n_taken && !this.live.state.n_ahead) await this.begin();
    await this.live.add([...position], value);
    this.app.announce(`${this.live.state?.n_taken ?? 0} samples`);
  }

  /** Begins anew, without samples; what they will be of may have changed. */
  private async begin(): Promise<void> {
    const aim = this.values.aim(this.target.value / 100);
    const { state } = this.live;
    const kept = state?.n_taken && state.name === aim.name ? state : null;
    this.playback.reset();
    await this.live.begin(aim);
    if (kept && kept.target_nrmse !== aim.target_nrmse)
      await this.live.takeAll(triples(kept.positions), Array.from(kept.values));
  }

  private async play(recording: number, recordings: readonly RecordingInfo[]): Promise<void> {
    const cycle = recordings[recording]?.cycle_length_ms ?? null;
    this.fresh();
    await this.live.play(recording, { ...this.values.aim(this.target.value / 100), cycle_length_ms: cycle });
  }

  private fresh(): void {
    this.live.forget();
    this.playback.reset();
    this.values.choice.value = "typed";
  }

  private async makePlan(): Promise<void> {
    const question = { ...this.wanted.question, target_nrmse: this.target.value / 100, beside_samples: true };
    const document = await this.app.work<PlanDocument>("Planning", "/api/plan", question);
    if (!document) return;
    await this.app.attempt(async () => {
      const answer = await this.app.request("/api/plan/maps");
      const maps = unpacked(await answer.arrayBuffer());
      const example = maps.header["example"] as { name: string; unit: string } | null;
      this.plan = {
        document,
        positions: maps.array<Float32Array>("positions"),
        wavelengths: maps.has("wavelengths") ? maps.array<Float32Array>("wavelengths") : null,
      };
      this.values.setExample(example && { ...example, values: maps.array<Float32Array>("example") });
      showOutcome(this.outcome, document);
      this.planButtons.hidden = !this.plan.positions.length;
      this.update();
      this.app.announce(`${document.recommendation.n_samples ?? "no number of"} points`);
    });
  }

  /** Takes a sample at every planned point, after those taken. */
  private async takePlan(): Promise<void> {
    if (!this.plan) return;
    const { state } = this.live;
    const taken = state ? triples(state.positions) : [];
    const planned = triples(this.plan.positions);
    const values = planned.map((position) => this.values.valueAt([this.nearest(position), 0, 0], [1, 0, 0]));
    if (values.some((value) => !Number.isFinite(value))) {
      this.app.toast("the map has no value at some of the points: choose another, or type a value", "bad");
      return;
    }
    if (!taken.length) await this.begin();
    await this.live.takeAll([...taken, ...planned], [...(taken.length && state ? state.values : []), ...values]);
  }

  private nearest(position: readonly number[]): number {
    const { positions } = this.surface;
    let best = 0;
    let least = Infinity;
    for (let i = 0; i < positions.length; i += 3) {
      const away = (positions[i] - position[0]) ** 2 + (positions[i + 1] - position[1]) ** 2 + (positions[i + 2] - position[2]) ** 2;
      if (away < least) {
        least = away;
        best = i / 3;
      }
    }
    return best;
  }
}

function triples(positions: Float32Array): number[][] {
  return Array.from({ length: positions.length / 3 }, (_, i) => [...positions.subarray(3 * i, 3 * i + 3)]);
}

/** A saved state made sure of; throws in words. */
function checked(saved: unknown): SavedPlan {
  const state = saved as Partial<SavedPlan> | null;
  const finite = (value: unknown): boolean => typeof value === "number" && Number.isFinite(value);
  const whole =
    typeof state === "object" && state !== null &&
    Array.isArray(state.samples) && state.samples.every((each) => Array.isArray(each) && each.length === 4 && each.every(finite)) &&
    finite(state.target) && typeof state.aim?.name === "string" && typeof state.aim.unit === "string" &&
    BESIDE.some(([name]) => name === state.beside) && PALETTES.some((name) => name === state.palette) &&
    typeof state.wanted?.kind === "string" && !!state.outlook && [...state.outlook.turn, ...state.outlook.centre, state.outlook.halfHeight].every(finite);
  if (!whole) throw new Error("the saved state of Plan and map cannot be used: save it again");
  return state as SavedPlan;
}
