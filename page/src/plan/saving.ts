/** Tables to keep: samples, the map, the planned points. */
import { csvText, saveFile } from "../dom";
import { fileStem } from "../explore/saving";
import type { SurfaceCase } from "../surfacecase";
import type { Judgement, LiveState } from "./live";

const rows = (positions: Float32Array): number[][] =>
  Array.from({ length: positions.length / 3 }, (_, i) => [...positions.subarray(3 * i, 3 * i + 3)].map((each) => Number(each.toFixed(3))));

const labelled = (name: string, unit: string): string => (unit ? `${name}_${unit}` : name);

/** Samples in the order they were taken; `auricle reconstruct` reads them. */
export function saveSamples(surface: SurfaceCase, state: LiveState): void {
  const head = ["x_mm", "y_mm", "z_mm", labelled(state.name, state.unit)];
  const table = rows(state.positions).map((position, i) => [...position, state.values[i]]);
  saveFile(`${fileStem(surface)}_samples.csv`, csvText([head, ...table]), "text/csv");
}

/** Map, deviation and supported wavelength, one vertex a row. */
export function saveMap(surface: SurfaceCase, state: LiveState, judgement: Judgement | null): void {
  const { mean, std } = state;
  if (!mean || !std) return;
  const label = labelled(state.name, state.unit);
  const waves = judgement?.n_taken === state.n_taken ? judgement.wavelengths : null;
  const head = ["vertex", "x_mm", "y_mm", "z_mm", label, `standard_deviation${state.unit && `_${state.unit}`}`, "supported_wavelength_mm"];
  const table = rows(surface.positions).map((position, i) => [i, ...position, mean[i], std[i], waves ? waves[i] : NaN]);
  saveFile(`${fileStem(surface)}_map.csv`, csvText([head, ...table]), "text/csv");
}

/** Planned points in the order to take them. */
export function savePlan(surface: SurfaceCase, positions: Float32Array): void {
  const table = rows(positions).map((position, i) => [i + 1, ...position]);
  saveFile(`${fileStem(surface)}_plan.csv`, csvText([["point", "x_mm", "y_mm", "z_mm"], ...table]), "text/csv");
}
