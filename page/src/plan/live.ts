/** The live map as the server keeps it: requests one after the other, judgements beside them. */
import type { App } from "../app";
import { unpacked } from "../bundle";
import { posted } from "../connection";

export interface Aim {
  readonly name: string;
  readonly unit: string;
  readonly target_nrmse: number;
  readonly noise: number | null;
  readonly cycle_length_ms: number | null;
}

export interface LiveState extends Aim {
  readonly n_taken: number;
  readonly n_ahead: number;
  readonly n_left_out: number;
  readonly knows_nothing: boolean;
  readonly predicted_nrmse: number | null;
  /** Where the next sample helps most, mm. */
  readonly next: readonly [number, number, number];
  readonly next_nrmse: number | null;
  /** Of the samples taken: (N, 3) mm, values, distances off the surface in mm. */
  readonly positions: Float32Array;
  readonly values: Float64Array;
  readonly distances: Float32Array;
  /** Map and deviation at each vertex; null while nothing is known. */
  readonly mean: Float32Array | null;
  readonly std: Float32Array | null;
}

export interface Judgement {
  readonly n_taken: number;
  readonly enough: boolean;
  readonly reasons: readonly string[];
  readonly predicted_nrmse: number | null;
  readonly undersampled_share: number | null;
  readonly bandwidth: readonly [number, number] | null;
  /** Finest wavelength the samples support at each vertex, mm. */
  readonly wavelengths: Float32Array | null;
}

/** What was predicted after so many samples; judged or not. */
export interface Record {
  readonly n: number;
  readonly error: number;
  readonly enough: boolean | null;
}

const QUIET_MS = 120;

export class Live {
  state: LiveState | null = null;
  judgement: Judgement | null = null;
  /** By number of samples. */
  readonly history = new Map<number, Record>();
  private line: Promise<unknown> = Promise.resolve();
  private judging = false;
  private again = false;
  private timer = 0;
  private generation = 0;
  private waiting = 0;

  /** `changed` is called whenever the state or the judgement is another. */
  constructor(
    private readonly app: App,
    private readonly changed: () => void,
  ) {}

  /** Whether nothing is under way or about to be. */
  get quiet(): boolean {
    return !this.waiting && !this.judging && !this.timer;
  }

  /** Asks for the state as it is. */
  refresh(): Promise<void> {
    return this.ask("/api/live", {});
  }

  begin(aim: Aim): Promise<void> {
    this.forget();
    return this.ask("/api/live", posted(aim));
  }

  add(position: readonly number[], value: number): Promise<void> {
    return this.ask("/api/live/add", posted({ position, value }));
  }

  /** Takes these samples in place of all others. */
  takeAll(positions: readonly (readonly number[])[], values: readonly number[]): Promise<void> {
    this.forget();
    return this.ask("/api/live/samples", posted({ positions, values }));
  }

  goTo(count: number): Promise<void> {
    return this.ask("/api/live/go-to", posted({ n_taken: count }));
  }

  play(recording: number, aim: Aim): Promise<void> {
    this.forget();
    return this.ask("/api/live/play", posted({ ...aim, recording, wraps: aim.cycle_length_ms !== null }));
  }

  /** Drops what was predicted before: the samples are other ones now. */
  forget(): void {
    this.generation += 1;
    this.history.clear();
    this.judgement = null;
  }

  /** Sends a request after all those before it; the state follows. Faults are told to the user. */
  private ask(path: string, options: RequestInit): Promise<void> {
    this.waiting += 1;
    const next = this.line.then(() =>
      this.app.attempt(async () => {
        const answer = await this.app.request(path, options);
        this.take(await answer.arrayBuffer());
      }),
    );
    this.line = next.then(() => {
      this.waiting -= 1;
    });
    return next.then(() => undefined);
  }

  private take(bytes: ArrayBuffer): void {
    const bundle = unpacked(bytes);
    const optional = (name: string): Float32Array | null => (bundle.has(name) ? bundle.array<Float32Array>(name) : null);
    const state: LiveState = {
      ...(bundle.header as unknown as LiveState),
      positions: bundle.array<Float32Array>("positions"),
      values: bundle.array<Float64Array>("values"),
      distances: bundle.array<Float32Array>("distances"),
      mean: optional("mean"),
      std: optional("std"),
    };
    this.state = state;
    const before = this.history.get(state.n_taken);
    if (state.predicted_nrmse !== null && (before?.enough ?? null) === null)
      this.history.set(state.n_taken, { n: state.n_taken, error: state.predicted_nrmse, enough: null });
    this.changed();
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.judge(), QUIET_MS);
  }

  /** Asks whether the samples are enough; if they change meanwhile, once more. */
  private async judge(): Promise<void> {
    this.timer = 0;
    if (this.judging) {
      this.again = true;
      return;
    }
    this.judging = true;
    const { generation } = this;
    await this.app.attempt(async () => {
      const answer = await this.app.request("/api/live/judge", posted({}));
      const bundle = unpacked(await answer.arrayBuffer());
      if (generation !== this.generation) return;
      const found: Judgement = {
        ...(bundle.header as unknown as Judgement),
        wavelengths: bundle.has("wavelengths") ? bundle.array<Float32Array>("wavelengths") : null,
      };
      this.judgement = found;
      if (found.predicted_nrmse !== null)
        this.history.set(found.n_taken, { n: found.n_taken, error: found.predicted_nrmse, enough: found.enough });
      if (bundle.header["refitted"]) void this.refresh();
      this.changed();
    });
    this.judging = false;
    if (this.again) {
      this.again = false;
      void this.judge();
    }
  }
}
