/** Segmentations the server has tried: previews one after the other, results on demand. */
import { inWords, type App } from "../app";
import { editsKey, type Edits } from "./edits";
import { Lattice, type Vec3 } from "./lattice";

export interface Reason {
  readonly code: string;
  readonly cause: string;
  readonly remedy: string;
  readonly stops: boolean;
  readonly position_mm: Vec3 | null;
}

/** As the server describes a trial. */
export interface TrialDocument {
  readonly key: string;
  readonly preview: boolean;
  readonly verdict: "ok" | "check" | "refused";
  readonly reasons: readonly Reason[];
  readonly volume_ml?: number;
  readonly step_mm?: number;
  readonly mask_shape?: Vec3;
  readonly mask_origin_mm?: Vec3;
  readonly seed?: { readonly position_mm: Vec3; readonly given: boolean };
  readonly thresholds_hu?: {
    readonly blood: number;
    readonly wall: number;
    readonly noise: number;
    readonly lower: number;
    readonly upper: number;
  };
}

export interface Trial {
  readonly edits: string;
  readonly document: TrialDocument;
  readonly mask: Lattice<Uint8Array> | null;
}

const RESULTS_KEPT = 8;

export class Trials {
  /** The preview shown last, of these edits or of earlier ones. */
  preview: Trial | null = null;
  /** Whether a preview is under way. */
  busy = false;
  private readonly results = new Map<string, Trial>();
  private wished: Edits | null = null;
  private readonly last = new AbortController();

  constructor(
    private readonly app: App,
    private readonly changed: () => void,
  ) {}

  /** Hears of nothing any more: another CT is open. */
  close(): void {
    this.wished = null;
    this.last.abort();
  }

  /** The result of these edits, if it was found before. */
  result(edits: Edits): Trial | null {
    return this.results.get(editsKey(edits)) ?? null;
  }

  /** Wants a preview of these edits. While one is under way only the latest wish waits. */
  wish(edits: Edits): void {
    this.wished = edits;
    if (!this.busy) void this.run();
  }

  /** Finds the result; null if it was cancelled. */
  async segment(edits: Edits): Promise<Trial | null> {
    const document = await this.app.work<TrialDocument>("Segmenting", "/api/segment/result", { config: edits });
    if (!document) return null;
    const trial = await this.app.attempt(() => this.taken(edits, document));
    if (!trial) return null;
    this.results.set(trial.edits, trial);
    for (const key of this.results.keys()) if (this.results.size > RESULTS_KEPT) this.results.delete(key);
    this.changed();
    return trial;
  }

  private async run(): Promise<void> {
    this.busy = true;
    this.changed();
    let fault: unknown;
    while (this.wished) {
      const edits = this.wished;
      this.wished = null;
      if (this.preview?.edits === editsKey(edits)) continue;
      try {
        const { signal } = this.last;
        const document = await this.app.send<TrialDocument>("/api/segment/preview", { config: edits }, { signal });
        this.preview = await this.taken(edits, document);
        fault = undefined;
      } catch (caught) {
        fault = caught;
      }
      if (!this.last.signal.aborted) this.changed();
    }
    this.busy = false;
    if (this.last.signal.aborted) return;
    if (fault !== undefined) this.app.toast(inWords(fault), "bad");
    this.changed();
  }

  private async taken(edits: Edits, document: TrialDocument): Promise<Trial> {
    const { mask_shape, mask_origin_mm, step_mm } = document;
    let mask: Lattice<Uint8Array> | null = null;
    if (mask_shape && mask_origin_mm && step_mm) {
      const answer = await this.app.request(`/api/segment/mask/${document.key}`);
      const bytes = new Uint8Array(await answer.arrayBuffer());
      mask = new Lattice(bytes, mask_shape, mask_origin_mm, step_mm);
    }
    return { edits: editsKey(edits), document, mask };
  }
}
