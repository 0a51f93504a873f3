/** What the user has chosen about a segmentation, and the way back. */
import type { Vec3 } from "./lattice";

/** As the server takes it; lengths in mm, LPS. */
export interface Edits {
  /** null finds one. */
  readonly seed_mm: Vec3 | null;
  /** Two corners of a box, three and more of a polygon on a slice, none. */
  readonly region_mm: readonly Vec3[];
  readonly region_depth_mm: number;
  /** null takes it from the histogram. */
  readonly lower_hu: number | null;
  readonly upper_hu: number | null;
  readonly vein_stub_mm: number;
  /** x, y, z, radius of balls; x, y, z, normal, radius of discs. */
  readonly cuts_mm: readonly (readonly number[])[];
}

export const NO_EDITS: Edits = {
  seed_mm: null,
  region_mm: [],
  region_depth_mm: 60,
  lower_hu: null,
  upper_hu: null,
  vein_stub_mm: 12,
  cuts_mm: [],
};

const SAME_STRAND_MS = 1500;

/** One name for the same choices. */
export function editsKey(edits: Edits): string {
  return JSON.stringify(edits, Object.keys(NO_EDITS).sort());
}

export class History {
  private past: Edits[] = [];
  private future: Edits[] = [];
  /** Choices shown while a slider moves; they enter the history when it is let go. */
  private passing: Edits | null = null;
  private settled: Edits = NO_EDITS;
  private strand = "";
  private since = -Infinity;

  constructor(private readonly changed: () => void) {}

  get now(): Edits {
    return this.passing ?? this.settled;
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Takes other choices as a step one can undo; those of one strand in quick succession are one. */
  set(change: Partial<Edits>, strand = ""): void {
    const next = { ...this.settled, ...change };
    this.passing = null;
    if (editsKey(next) !== editsKey(this.settled)) {
      const now = performance.now();
      const goesOn = strand !== "" && strand === this.strand && now - this.since < SAME_STRAND_MS;
      if (!goesOn) this.past.push(this.settled);
      [this.strand, this.since] = [strand, now];
      this.future = [];
      this.settled = next;
    }
    this.changed();
  }

  /** Shows other choices for now. */
  pass(change: Partial<Edits>): void {
    this.passing = { ...this.settled, ...change };
    this.changed();
  }

  /** Forgets everything: another CT is open. */
  reset(): void {
    this.past = [];
    this.future = [];
    this.passing = null;
    this.settled = NO_EDITS;
  }

  undo(): void {
    this.step(this.past, this.future);
  }

  redo(): void {
    this.step(this.future, this.past);
  }

  private step(from: Edits[], to: Edits[]): void {
    const next = from.pop();
    if (!next) return;
    to.push(this.settled);
    this.passing = null;
    this.strand = "";
    this.settled = next;
    this.changed();
  }
}

/** Choices read back from a saved state; throws if they are none. */
export function editsOf(value: unknown): Edits {
  const given = value as Partial<Edits> | null;
  const number = (each: unknown): boolean => typeof each === "number" && Number.isFinite(each);
  const place = (each: unknown): boolean => Array.isArray(each) && each.length === 3 && each.every(number);
  const sound =
    typeof given === "object" &&
    given !== null &&
    (given.seed_mm === null || place(given.seed_mm)) &&
    Array.isArray(given.region_mm) &&
    given.region_mm.every(place) &&
    number(given.region_depth_mm) &&
    (given.lower_hu === null || number(given.lower_hu)) &&
    (given.upper_hu === null || number(given.upper_hu)) &&
    number(given.vein_stub_mm) &&
    Array.isArray(given.cuts_mm) &&
    given.cuts_mm.every((cut) => Array.isArray(cut) && [4, 7].includes(cut.length) && cut.every(number));
  if (!sound) throw new Error("the saved segmentation is damaged");
  const { seed_mm, region_mm, region_depth_mm, lower_hu, upper_hu, vein_stub_mm, cuts_mm } = given as Edits;
  return { seed_mm, region_mm, region_depth_mm, lower_hu, upper_hu, vein_stub_mm, cuts_mm };
}

/** The same segmentation on the command line. */
export function commandOf(edits: Edits): string {
  const place = (numbers: readonly number[]): string => numbers.map((each) => +each.toFixed(2)).join(",");
  const words = ["auricle segment CT -o atrium"];
  if (edits.seed_mm) words.push(`--seed=${place(edits.seed_mm)}`);
  if (edits.region_mm.length) words.push(`--roi=${edits.region_mm.map(place).join(":")}`);
  if (edits.region_mm.length > 2) words.push(`--depth ${edits.region_depth_mm}`);
  if (edits.lower_hu !== null) words.push(`--lower ${edits.lower_hu}`);
  if (edits.upper_hu !== null) words.push(`--upper ${edits.upper_hu}`);
  if (edits.vein_stub_mm !== NO_EDITS.vein_stub_mm) words.push(`--vein-stub ${edits.vein_stub_mm}`);
  for (const cut of edits.cuts_mm) words.push(`--cut=${place(cut)}`);
  return words.join(" ");
}
