/** The open case: a surface, its maps, harmonics and levels of simplification. */
import type { Bundle } from "./bundle";

export interface Field {
  readonly name: string;
  readonly title: string;
  readonly unit: string;
  /** One value a vertex; NaN where unsampled. */
  readonly values: Float32Array;
  /** Whether a cyclic palette suits it (activation times). */
  readonly cyclic: boolean;
  /** Place of its coefficients among the signals, or -1 where it has no spectrum. */
  readonly signal: number;
  /** Why it has no spectrum, in words. */
  readonly fault: string;
}

/** A map with a spectrum: the geometry comes first, then fields. */
export interface Signal {
  readonly name: string;
  readonly title: string;
  readonly unit: string;
  /** Coefficients, (k, c), and the offset of each column that is not in them. */
  readonly coefficients: Float64Array;
  readonly offset: readonly number[];
  readonly nColumns: number;
  /** Power of each harmonic; its cumulative share; error of the first 1 … k harmonics. */
  readonly power: Float64Array;
  readonly share: Float64Array;
  readonly error: Float64Array;
  /** Unit of the error: mm for the geometry, the field's own otherwise. */
  readonly errorUnit: string;
  /** Standard deviation of the map, what relative errors refer to. */
  readonly spread: number;
}

export interface MeasuredDistance {
  readonly count: number;
  readonly gd_mm: number;
}

export class SurfaceCase {
  readonly name: string;
  /** "LPS" where the file says so, else "unknown". */
  readonly space: string;
  readonly remarks: readonly string[];
  readonly nVertices: number;
  readonly nFaces: number;
  readonly nModes: number;
  readonly areaMm2: number;
  /** (n, 3), mm. */
  readonly positions: Float32Array;
  /** (f, 3). */
  readonly faces: Uint32Array;
  /** Area of each vertex, mm². */
  readonly areas: Float64Array;
  readonly eigenvalues: Float64Array;
  /** Harmonic j at vertex i is modes[j * n + i] * modeScales[j], 1/mm. */
  readonly modes: Int16Array;
  readonly modeScales: Float64Array;
  readonly fields: readonly Field[];
  readonly signals: readonly Signal[];
  /** Mean distance from the surface to that of k harmonics and of k points, mm, where measured. */
  readonly harmonicDistances: readonly MeasuredDistance[];
  readonly pointDistances: readonly MeasuredDistance[];
  /** Simplification: vertex that stays and that goes at each collapse, and where the first went. */
  readonly collapses: { kept: Int32Array; gone: Int32Array; places: Float32Array } | null;
  readonly header: Readonly<Record<string, unknown>>;

  constructor(readonly bundle: Bundle) {
    const header = (this.header = bundle.header);
    this.name = String(header["name"]);
    this.space = String(header["space"]);
    this.remarks = header["remarks"] as string[];
    this.positions = bundle.array<Float32Array>("positions");
    this.faces = bundle.array<Uint32Array>("faces");
    this.areas = bundle.array<Float64Array>("areas");
    this.nVertices = this.positions.length / 3;
    this.nFaces = this.faces.length / 3;
    this.areaMm2 = Number(header["area_mm2"]);
    this.eigenvalues = bundle.array<Float64Array>("eigenvalues");
    this.nModes = this.eigenvalues.length;
    this.modes = bundle.array<Int16Array>("modes");
    this.modeScales = bundle.array<Float64Array>("mode_scales");
    this.fields = (header["fields"] as Omit<Field, "values">[]).map((field, place) => ({
      ...field,
      values: bundle.array<Float32Array>(`field_${place}`),
    }));
    this.signals = (header["signals"] as SignalEntry[]).map((signal, place) => ({
      name: signal.name,
      title: signal.title,
      unit: signal.unit,
      errorUnit: signal.unit,
      spread: signal.spread,
      offset: signal.offset,
      nColumns: signal.offset.length,
      coefficients: bundle.array<Float64Array>(`coefficients_${place}`),
      power: bundle.array<Float64Array>(`power_${place}`),
      share: bundle.array<Float64Array>(`share_${place}`),
      error: bundle.array<Float64Array>(`error_${place}`),
    }));
    this.harmonicDistances = header["harmonic_distances"] as MeasuredDistance[];
    this.pointDistances = header["point_distances"] as MeasuredDistance[];
    this.collapses = bundle.has("collapse_kept")
      ? {
          kept: bundle.array<Int32Array>("collapse_kept"),
          gone: bundle.array<Int32Array>("collapse_gone"),
          places: bundle.array<Float32Array>("collapse_places"),
        }
      : null;
  }
}

interface SignalEntry {
  readonly name: string;
  readonly title: string;
  readonly unit: string;
  readonly spread: number;
  readonly offset: readonly number[];
}
