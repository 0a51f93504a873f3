/** The page as a whole: what is open, the way to the server, words to the user, the theme. */
import { fromBase64, readBundle } from "./bundle";
import { Connection, RequestError, posted, type SessionInfo, type Stage as WorkStage } from "./connection";
import { SurfaceCase } from "./surfacecase";

export type Tone = "info" | "good" | "bad";

export interface App {
  /** "served" by auricle on this machine, or "exported" as a file that carries its data. */
  readonly mode: "served" | "exported";
  /** What the server has open; of an exported page, what the file says. */
  readonly session: SessionInfo;
  /** The surface open now, if any. */
  readonly surface: SurfaceCase | null;
  /** Asks for a path below /api with the session's secret; JSON comes back. Throws in words. */
  api<T = unknown>(path: string, options?: RequestInit): Promise<T>;
  /** Sends a value as JSON (POST); JSON comes back. */
  send<T = unknown>(path: string, value: unknown, options?: RequestInit): Promise<T>;
  /** The same for an answer that is not JSON. */
  request(path: string, options?: RequestInit): Promise<Response>;
  /** Sends a value to long work and waits for its result behind a bar with a button to cancel;
   * undefined comes back if it was cancelled or failed, which the user has been told. */
  work<T = unknown>(title: string, path: string, value: unknown): Promise<T | undefined>;
  /** The same with the options of the request given (see `posted` and `uploaded`). */
  workWith<T = unknown>(title: string, path: string, options: RequestInit): Promise<T | undefined>;
  /** Sends a value to long work that no one waits for at a bar: it gives way to any other work and
   * begins anew after it. Throws in words, and an AbortError once `signal` is aborted. */
  background<T = unknown>(path: string, value: unknown, signal: AbortSignal, heard: (stage: WorkStage) => void): Promise<T>;
  /** Fetches the surface anew from GET /api/case and tells `onSurface`. */
  openSurface(): Promise<void>;
  /** Calls now, if a surface is open, and whenever another one is. Returns how to stop. */
  onSurface(heard: (surface: SurfaceCase) => void): () => void;
  /** Asks the server anew what is open (GET /api/page) and offers the views that fit; opens the
   * surface anew where there is one. */
  refreshSession(): Promise<void>;
  /** Calls whenever the session or the theme has changed. Returns how to stop. */
  onChange(heard: () => void): () => void;
  /** Shows a view by its id. */
  show(view: string): void;
  /** A message at the edge of the page, read aloud too. */
  toast(words: string, tone?: Tone): void;
  /** Words for screen readers only. */
  announce(words: string): void;
  /** Runs work and shows what it throws as a message; undefined comes back then. */
  attempt<T>(work: () => Promise<T>): Promise<T | undefined>;
  readonly theme: "light" | "dark";
}

export interface Frame {
  toast(words: string, tone: Tone): void;
  announce(words: string): void;
  show(view: string): void;
  /** Shows that something is being worked on, until `end`. */
  working(title: string, cancel: () => void): { stage(stage: WorkStage): void; end(): void };
}

export class PageApp implements App {
  readonly connection = new Connection();
  mode: "served" | "exported" = "served";
  session: SessionInfo = { views: [], name: "" };
  surface: SurfaceCase | null = null;
  frame: Frame | null = null;
  private surfaceListeners = new Set<(surface: SurfaceCase) => void>();
  private changeListeners = new Set<() => void>();
  private chosenTheme: "light" | "dark" | null = null;
  private working = 0;
  private giveWay: AbortController | null = null;

  constructor() {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.changed());
  }

  /** Opens what the page carries, or asks the server. */
  async begin(): Promise<void> {
    const carried = document.getElementById("case")?.textContent?.trim();
    if (carried) {
      this.mode = "exported";
      const surface = new SurfaceCase(await readBundle(fromBase64(carried)));
      this.session = { views: ["explore"], name: surface.name };
      this.take(surface);
      return;
    }
    await this.connection.begin();
    await this.refreshSession();
  }

  get theme(): "light" | "dark" {
    return this.chosenTheme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  }

  setTheme(theme: "light" | "dark"): void {
    this.chosenTheme = theme;
    document.documentElement.dataset["theme"] = theme;
    this.changed();
  }

  api<T = unknown>(path: string, options: RequestInit = {}): Promise<T> {
    return this.connection.json<T>(path, options);
  }

  send<T = unknown>(path: string, value: unknown, options: RequestInit = {}): Promise<T> {
    return this.connection.send<T>(path, value, options);
  }

  request(path: string, options: RequestInit = {}): Promise<Response> {
    return this.connection.request(path, options);
  }

  work<T = unknown>(title: string, path: string, value: unknown): Promise<T | undefined> {
    return this.workWith<T>(title, path, posted(value));
  }

  workWith<T = unknown>(title: string, path: string, options: RequestInit): Promise<T | undefined> {
    return this.attempt(async () => {
      const stop = new AbortController();
      const told = this.frame?.working(title, () => stop.abort());
      this.working += 1;
      this.giveWay?.abort();
      try {
        const run = (): Promise<T> => this.connection.work<T>(path, { ...options, signal: stop.signal }, (stage) => told?.stage(stage));
        return await whenFree(run, stop.signal);
      } finally {
        this.working -= 1;
        told?.end();
      }
    });
  }

  async background<T = unknown>(path: string, value: unknown, signal: AbortSignal, heard: (stage: WorkStage) => void): Promise<T> {
    for (;;) {
      while (this.working) await pause(BUSY_MS, signal);
      const way = (this.giveWay = new AbortController());
      const options = posted(value, { signal: AbortSignal.any([signal, way.signal]) });
      try {
        return await whenFree(() => this.connection.work<T>(path, options, heard), signal);
      } catch (fault) {
        if (signal.aborted || !way.signal.aborted) throw fault;
      } finally {
        if (this.giveWay === way) this.giveWay = null;
      }
    }
  }

  async openSurface(): Promise<void> {
    const answer = await this.connection.request("/api/case");
    this.take(new SurfaceCase(await readBundle(new Uint8Array(await answer.arrayBuffer()))));
  }

  async refreshSession(): Promise<void> {
    this.session = await this.connection.json<SessionInfo>("/api/page");
    if (this.session.views.includes("explore")) await this.openSurface();
    else this.surface = null;
    this.changed();
  }

  onSurface(heard: (surface: SurfaceCase) => void): () => void {
    this.surfaceListeners.add(heard);
    if (this.surface) heard(this.surface);
    return () => this.surfaceListeners.delete(heard);
  }

  onChange(heard: () => void): () => void {
    this.changeListeners.add(heard);
    return () => this.changeListeners.delete(heard);
  }

  show(view: string): void {
    this.frame?.show(view);
  }

  toast(words: string, tone: Tone = "info"): void {
    this.frame?.toast(words, tone);
  }

  announce(words: string): void {
    this.frame?.announce(words);
  }

  async attempt<T>(work: () => Promise<T>): Promise<T | undefined> {
    try {
      return await work();
    } catch (fault) {
      if (fault instanceof DOMException && fault.name === "AbortError") return undefined;
      this.toast(inWords(fault), "bad");
      return undefined;
    }
  }

  private take(surface: SurfaceCase): void {
    this.surface = surface;
    this.changed();
    for (const heard of this.surfaceListeners) heard(surface);
  }

  private changed(): void {
    for (const heard of this.changeListeners) heard();
  }
}

const BUSY_MS = 200;

/** Waits; throws an AbortError if given up meanwhile. */
export function pause(ms: number, signal: AbortSignal): Promise<void> {
  signal.throwIfAborted();
  return new Promise((done, failed) => {
    const timer = setTimeout(done, ms);
    signal.addEventListener("abort", () => (clearTimeout(timer), failed(signal.reason)), { once: true });
  });
}

/** Tries again while the server ends what was cancelled before. */
async function whenFree<T>(run: () => Promise<T>, signal: AbortSignal): Promise<T> {
  for (;;) {
    try {
      return await run();
    } catch (fault) {
      if (!(fault instanceof RequestError && fault.status === 409)) throw fault;
      await pause(BUSY_MS, signal);
    }
  }
}

/** A fault as a sentence. */
export function inWords(fault: unknown): string {
  if (fault instanceof RequestError) return fault.message;
  if (fault instanceof TypeError && /fetch|network/i.test(fault.message))
    return "the server does not answer: is `auricle view` still running?";
  return fault instanceof Error ? fault.message : String(fault);
}
