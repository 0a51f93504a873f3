/** The numbers beside the pictures. */
import type { MeasuredDistance, Signal, SurfaceCase } from "../surfacecase";
import { figures, percent, withUnit } from "../words";
import type { Facts } from "../widgets/panel";

export interface Measured {
  /** Root mean square error of the shape and of the map, as rebuilt now; NaN if not rebuilt. */
  readonly shape: number;
  readonly map: number;
}

/** Fills in what k harmonics and k points come to. */
export function showNumbers(
  facts: Facts,
  surface: SurfaceCase,
  map: Signal | null,
  count: number,
  measured: Measured,
): void {
  const shape = surface.signals[0];
  facts.show([
    ["Shape error, RMS", withUnit(measured.shape, "mm", 4), "shape-rms"],
    ["Power of the shape", percent(shape.share[count - 1]), "shape-share"],
    ...(map ? mapNumbers(map, count, measured.map) : []),
    ["Shortest wavelength", withUnit(wavelength(surface, count), "mm"), "wavelength"],
    [`Distance, ${count} harmonics`, distance(surface.harmonicDistances, count), "gd-harmonics"],
    [`Distance, ${count} points`, distance(surface.pointDistances, count), "gd-points"],
  ]);
}

function mapNumbers(map: Signal, count: number, error: number): [string, string, string][] {
  return [
    ["Map error, RMS", withUnit(error, map.errorUnit, 4), "map-rms"],
    ["Map error, relative", percent(error / map.spread), "map-nrmse"],
    ["Power of the map", percent(map.share[count - 1]), "map-share"],
  ];
}

/** Numbers of a single harmonic. */
export function showHarmonic(facts: Facts, surface: SurfaceCase, map: Signal | null, number: number): void {
  const share = (signal: Signal): string => percent(powerShare(signal)[number - 1]);
  const entries: [string, string, string][] = [
    ["Eigenvalue", withUnit(surface.eigenvalues[number - 1], "1/mm²"), "eigenvalue"],
    ["Wavelength", withUnit(wavelength(surface, number), "mm"), "wavelength"],
    ["Power of the shape in it", share(surface.signals[0]), "shape-power"],
  ];
  if (map) entries.push(["Power of the map in it", share(map), "map-power"]);
  facts.show(entries);
}

/** Wavelength of harmonic number `count`, mm: 2π/√λ; infinite for a constant one. */
export function wavelength(surface: SurfaceCase, count: number): number {
  const value = surface.eigenvalues[count - 1];
  return value > 0 ? (2 * Math.PI) / Math.sqrt(value) : Infinity;
}

/** Share of the power in each harmonic. */
export function powerShare(signal: Signal): Float64Array {
  const sum = signal.power.reduce((total, each) => total + each, 0);
  const all = sum / signal.share[signal.share.length - 1];
  return signal.power.map((each) => each / all);
}

/** A distance measured at this count, or between the neighbouring ones along a power law. */
export function distance(measured: readonly MeasuredDistance[], count: number): string {
  const above = measured.findIndex((each) => each.count >= count);
  if (above < 0) return "–";
  const high = measured[above];
  if (high.count === count) return `${figures(high.gd_mm)} mm`;
  const low = measured[above - 1];
  if (!low) return "–";
  const part = Math.log(count / low.count) / Math.log(high.count / low.count);
  return `≈ ${figures(low.gd_mm * (high.gd_mm / low.gd_mm) ** part)} mm`;
}
