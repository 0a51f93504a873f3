/** Spectrum and error against the number of harmonics, linked to the slider. */
import { logLimits, Plot, type Series } from "../charts/plot";
import { h } from "../dom";
import type { Signal, SurfaceCase } from "../surfacecase";
import { powerShare } from "./numbers";

export class Charts {
  readonly element = h("div", { class: "charts" });
  private readonly spectrum = new Plot();
  private readonly error = new Plot();

  /** `picked` is told the number of harmonics that was clicked. */
  constructor(private readonly picked: (count: number) => void) {
    this.element.append(this.spectrum.element, this.error.element);
  }

  /** Shows the charts of a signal; of the geometry with the distances of k points. */
  show(surface: SurfaceCase, signal: Signal): void {
    const numbers = Array.from({ length: surface.nModes }, (_, i) => i + 1);
    const picked = (x: number): void => this.picked(Math.round(x));
    const shares = powerShare(signal);
    const [low, high] = logLimits(shares, 1e-9);
    this.spectrum.show({
      title: `Spectrum: ${signal.title}`,
      x: { label: "harmonic", log: false, low: 0, high: surface.nModes },
      y: { label: "share of power", log: true, low, high },
      series: [{ name: "power", xs: numbers, ys: shares, kind: "bars", look: 1 }],
      picked,
    });
    const series = errorSeries(surface, signal, numbers);
    const [least, most] = logLimits(series.flatMap((each) => Array.from(each.ys)), 1e-5);
    this.error.show({
      title: `Error: ${signal.title}`,
      x: { label: "harmonics, or points", log: true, low: 4, high: surface.nModes },
      y: { label: signal.errorUnit ? `error (${signal.errorUnit})` : "error", log: true, low: least, high: most },
      series,
      picked,
    });
  }

  mark(count: number): void {
    this.spectrum.mark(count);
    this.error.mark(Math.max(count, 4));
  }
}

function errorSeries(surface: SurfaceCase, signal: Signal, numbers: number[]): Series[] {
  const from = 3;
  const rms: Series = {
    name: "RMS, harmonics",
    xs: numbers.slice(from),
    ys: signal.error.subarray(from),
    kind: "line",
    look: 1,
  };
  if (signal !== surface.signals[0]) return [rms];
  const measured = (name: string, look: number, places: SurfaceCase["pointDistances"]): Series => ({
    name,
    xs: places.map((each) => each.count),
    ys: places.map((each) => each.gd_mm),
    kind: "dots",
    look,
  });
  return [
    rms,
    measured("distance, harmonics", 2, surface.harmonicDistances),
    measured("distance, points", 3, surface.pointDistances),
  ];
}
