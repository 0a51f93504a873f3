/** What Explore shows: plain data that can be saved and restored. */
import { PALETTE_LABELS } from "../colour/palettes";
import { scaleOf, type ColourScale, type PaletteName } from "../colour/scale";
import type { Outlook } from "../scene/orbit";
import type { Cut } from "../scene/stage";
import type { Field, SurfaceCase } from "../surfacecase";

export type Picture = "original" | "harmonics" | "points";
export const PICTURES: readonly Picture[] = ["original", "harmonics", "points"];

export interface ExploreState {
  /** Number of harmonics, and of points. */
  count: number;
  /** Only harmonic number `count`, instead of the first `count`. */
  single: boolean;
  /** Name of the field shown; empty for the bare surface. */
  field: string;
  /** What is rebuilt from harmonics. */
  rebuild: "shape" | "map" | "both";
  /** Whether the rebuilt picture shows the map or its error. */
  colour: "map" | "error";
  pictures: Picture[];
  /** Colours of each field, by its name. */
  scales: Record<string, ColourScale>;
  edges: boolean;
  cut: Cut | null;
}

export interface SavedExplore extends ExploreState {
  readonly outlook: Outlook;
}

export function initialState(surface: SurfaceCase, width: number): ExploreState {
  return {
    count: Math.min(50, surface.nModes),
    single: false,
    field: surface.fields.find((field) => field.signal >= 0)?.name ?? "",
    rebuild: "both",
    colour: "map",
    pictures: width >= 760 ? [...PICTURES] : ["harmonics"],
    scales: {},
    edges: false,
    cut: null,
  };
}

/** Colours a field starts with: times go round in themselves and have isochrones. */
export function defaultScale(field: Field): ColourScale {
  if (!field.cyclic) return scaleOf(field.values, "viridis");
  return { ...scaleOf(field.values, "cyclic", 12), lines: true };
}

const finite = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);

/** A saved state made sure of; throws in words if it is not one of this surface. */
export function checkedState(saved: unknown, surface: SurfaceCase): SavedExplore {
  const state = saved as Partial<SavedExplore> | null;
  const fault = (what: string): Error => new Error(`the saved state has no usable ${what}: save it again`);
  if (typeof state !== "object" || state === null) throw fault("content");
  if (!finite(state.count)) throw fault("number of harmonics");
  const known = surface.fields.some((field) => field.name === state.field);
  if (!Array.isArray(state.pictures)) throw fault("pictures");
  const pictures = PICTURES.filter((each) => state.pictures?.includes(each));
  const { outlook } = state;
  if (!outlook || ![...outlook.turn, ...outlook.centre, outlook.halfHeight].every(finite))
    throw fault("direction of view");
  return {
    count: Math.min(Math.max(Math.round(state.count), 1), surface.nModes),
    single: state.single === true,
    field: known ? String(state.field) : "",
    rebuild: state.rebuild === "shape" || state.rebuild === "map" ? state.rebuild : "both",
    colour: state.colour === "error" ? "error" : "map",
    pictures: pictures.length ? pictures : ["harmonics"],
    scales: checkedScales(state.scales),
    edges: state.edges === true,
    cut: checkedCut(state.cut),
    outlook,
  };
}

function checkedScales(saved: unknown): Record<string, ColourScale> {
  const scales: Record<string, ColourScale> = {};
  for (const [name, value] of Object.entries((saved ?? {}) as Record<string, Partial<ColourScale>>)) {
    const { palette, low, high, bands, lines } = value;
    if (!palette || !(palette in PALETTE_LABELS) || !finite(low) || !finite(high) || low === high) continue;
    scales[name] = {
      palette: palette as PaletteName,
      low,
      high,
      bands: finite(bands) ? Math.min(Math.max(Math.round(bands), 0), 64) : 10,
      lines: lines === true,
    };
  }
  return scales;
}

function checkedCut(saved: unknown): Cut | null {
  const cut = saved as Partial<Cut> | null | undefined;
  if (!cut || !finite(cut.at) || ![0, 1, 2].includes(Number(cut.axis))) return null;
  return { axis: cut.axis as 0 | 1 | 2, at: cut.at, flipped: cut.flipped === true };
}
