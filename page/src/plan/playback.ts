/** A study played back in the order its points were taken; when was it enough? */
import type { App } from "../app";
import { Plot } from "../charts/plot";
import { fill, h } from "../dom";
import { button, Choice, section, Slider, Toggle } from "../widgets/panel";
import { percent } from "../words";
import type { Live } from "./live";

export interface RecordingInfo {
  readonly name: string;
  readonly unit: string;
  readonly n_samples: number;
  readonly cycle_length_ms: number | null;
}

interface Review {
  readonly steps: readonly { readonly n_samples: number; readonly predicted_nrmse: number | null; readonly enough: boolean }[];
  readonly enough_from: number | null;
}

const STEPS = 40;

export class Playback {
  readonly element: HTMLElement;
  readonly plot = new Plot();
  private readonly recording: Choice;
  private readonly slider: Slider;
  private readonly playing: Toggle;
  private readonly answer = h("p", { class: "note", "aria-live": "polite", "data-fact": "enough-from" });
  private readonly rows: HTMLElement;

  /** `load` is told the number of the recording to begin with. */
  constructor(
    private readonly app: App,
    private readonly live: Live,
    recordings: readonly RecordingInfo[],
    load: (recording: number) => void,
  ) {
    this.recording = new Choice("Recorded", () => undefined);
    this.recording.setOptions(
      recordings.map((each, place) => [String(place), `${each.name}, ${each.n_samples} points`] as const),
      "0",
    );
    this.slider = new Slider("Points taken", (count) => void this.live.goTo(count), { min: 0, max: 1, value: 0 });
    this.playing = new Toggle("Play", false, (on) => on && void this.run(), "Take the points one after another, as they were taken");
    const begin = button("Load", () => load(Number(this.recording.value)), { title: "Begin with none of its points taken" });
    this.rows = h(
      "div",
      { class: "playback-rows" },
      this.slider.element,
      h("div", { class: "buttons" }, this.playing.element, button("When was it enough?", () => void this.review(), { kind: "small", title: "Judge the study after 5, … and all of its points" })),
    );
    const recorded = recordings.length ? [this.recording.element, h("div", { class: "buttons" }, begin)] : [];
    this.element = section("Play back", ...recorded, this.rows, this.answer);
    this.plot.element.classList.add("history");
    this.update();
  }

  /** Follows the state of the live map. */
  update(): void {
    const { state } = this.live;
    const all = state ? state.n_taken + state.n_ahead : 0;
    this.rows.hidden = all === 0;
    this.element.hidden = all === 0 && !this.recording.input.options.length;
    this.slider.setRange(0, Math.max(all, 1));
    if (document.activeElement !== this.slider.input || this.playing.on) this.slider.value = state?.n_taken ?? 0;
    this.chart(all, state?.target_nrmse ?? 0.1);
  }

  /** Forgets the answer: the samples are other ones. */
  reset(): void {
    this.playing.on = false;
    fill(this.answer);
  }

  private async run(): Promise<void> {
    for (;;) {
      const { state } = this.live;
      if (!this.playing.on || !state?.n_ahead) break;
      const step = Math.max(1, Math.round((state.n_taken + state.n_ahead) / STEPS));
      const before = state.n_taken;
      await this.live.goTo(before + step);
      await new Promise((resolve) => setTimeout(resolve, 60));
      if (this.live.state?.n_taken === before) break;
    }
    this.playing.on = false;
  }

  private async review(): Promise<void> {
    const found = await this.app.work<Review>("Judging the study", "/api/live/review", {});
    if (!found) return;
    for (const step of found.steps)
      if (step.predicted_nrmse !== null)
        this.live.history.set(step.n_samples, { n: step.n_samples, error: step.predicted_nrmse, enough: step.enough });
    const all = found.steps[found.steps.length - 1].n_samples;
    const words = found.enough_from === null
      ? `Not enough with all ${all} points.`
      : `Enough from ${found.enough_from} of ${all} points on.`;
    fill(this.answer, h("strong", {}, words), ` Judged after ${found.steps.map((each) => each.n_samples).join(", ")}.`);
    this.app.announce(words);
    this.update();
  }

  private chart(all: number, target: number): void {
    const records = [...this.live.history.values()].filter((each) => each.n > 0).sort((one, other) => one.n - other.n);
    const judged = records.filter((each) => each.enough !== null);
    this.plot.element.hidden = records.length < 2;
    if (records.length < 2) return;
    const most = Math.max(all, records[records.length - 1].n);
    const worst = Math.max(...records.map((each) => Math.min(each.error, 1.5)), 1.5 * target);
    const series = (name: string, each: typeof records, kind: "line" | "dots", look: number) => ({
      name,
      xs: each.map(({ n }) => n),
      ys: each.map(({ error }) => 100 * error),
      kind,
      look,
    });
    const enough = judged.filter((each) => each.enough);
    this.plot.show({
      title: "Predicted error as the samples came",
      x: { label: "samples", log: false, low: 0, high: most },
      y: { label: "error (%)", log: false, low: 0, high: 100 * worst },
      series: [
        series("predicted", records, "line", 1),
        ...(enough.length ? [series("enough", enough, "dots", 3)] : []),
        { name: `target ${percent(target)}`, xs: [0, most], ys: [100 * target, 100 * target], kind: "line", look: 2 },
      ],
      picked: (n) => void this.live.goTo(Math.round(n)),
    });
    this.plot.mark(this.live.state?.n_taken ?? 0);
  }
}
