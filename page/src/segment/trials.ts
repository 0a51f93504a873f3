/** Segmentations the server has tried: a coarse sketch at once, then the preview, which is the result. */
import { inWords, pause, type App } from "../app";
import type { Stage } from "../connection";
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
  /** Whether it was found on a coarse lattice; else it is what Accept takes. */
  readonly sketch: boolean;
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

const PREVIEWS_KEPT = 8;
/** A preview is begun once the choices have rested for so long. */
const QUIET_MS = 250;

export class Trials {
  /** The sketch shown last, of these edits or of earlier ones. */
  sketch: Trial | null = null;
  /** Whether a sketch or a preview is under way. */
  busy = false;
  /** How far the preview is that is under way. */
  stage: Stage | null = null;
  private readonly previews = new Map<string, Trial>();
  private wished: Edits | null = null;
  private readonly last = new AbortController();
  /** What is being tried, and how to give its preview up. */
  private underWay = "";
  private stop = new AbortController();

  constructor(
    private readonly app: App,
    private readonly changed: () => void,
  ) {}

  /** Hears of nothing any more: another CT is open. */
  close(): void {
    this.wished = null;
    this.last.abort();
    this.stop.abort();
  }

  /** The preview of these edits, if it was found before. */
  preview(edits: Edits): Trial | null {
    return this.previews.get(editsKey(edits)) ?? null;
  }

  /** Wants these edits tried. While something is under way only the latest wish waits. */
  wish(edits: Edits): void {
    if (editsKey(edits) === this.underWay && !this.stop.signal.aborted) return;
    this.stop.abort();
    this.wished = this.preview(edits) ? null : edits;
    if (this.wished && !this.busy) void this.run();
  }

  private async run(): Promise<void> {
    this.busy = true;
    this.changed();
    while (this.wished) {
      const edits = this.wished;
      this.wished = null;
      this.stop = new AbortController();
      this.underWay = editsKey(edits);
      try {
        await this.sketched(edits);
        await this.previewed(edits, this.stop.signal);
      } catch (fault) {
        const given = fault instanceof DOMException && fault.name === "AbortError";
        if (!given && !this.wished) this.app.toast(inWords(fault), "bad");
      }
      this.stage = null;
      this.underWay = "";
    }
    this.busy = false;
    if (!this.last.signal.aborted) this.changed();
  }

  private async sketched(edits: Edits): Promise<void> {
    if (this.sketch?.edits === editsKey(edits)) return;
    const { signal } = this.last;
    const document = await this.app.send<TrialDocument>("/api/segment/sketch", { config: edits }, { signal });
    const sketch = await this.taken(edits, document);
    if (signal.aborted) return;
    this.sketch = sketch;
    this.changed();
  }

  private async previewed(edits: Edits, signal: AbortSignal): Promise<void> {
    await pause(QUIET_MS, signal);
    const document = await this.app.background<TrialDocument>("/api/segment/preview", { config: edits }, signal, (stage) => {
      this.stage = stage;
      this.changed();
    });
    const preview = await this.taken(edits, document);
    signal.throwIfAborted();
    this.previews.set(preview.edits, preview);
    for (const key of this.previews.keys()) if (this.previews.size > PREVIEWS_KEPT) this.previews.delete(key);
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
