/** The pictures: the map, and beside it how sure it is, or how fine a map the samples support. */
import { ColourBar } from "../colour/bar";
import { roundSteps, scaleOf, type ColourScale, type PaletteName } from "../colour/scale";
import { fill, h, svg } from "../dom";
import type { Pane } from "../scene/pane";
import { Stage, type PickedInPane } from "../scene/stage";
import type { SurfaceCase } from "../surfacecase";
import type { Live, LiveState } from "./live";
import type { Truth } from "./values";

export type Beside = "uncertainty" | "wavelength" | "error" | "truth" | "none";
export const BESIDE: readonly (readonly [Beside, string])[] = [
  ["uncertainty", "Uncertainty"],
  ["wavelength", "Finest wavelength"],
  ["truth", "The true map"],
  ["error", "Error"],
  ["none", "Nothing"],
];

const SAMPLE: readonly [number, number, number] = [22, 26, 30];
const NEXT: readonly [number, number, number] = [232, 62, 140];
const PLANNED: readonly [number, number, number] = [255, 255, 255];

const LEGEND: readonly (readonly [layer: string, words: string, colour: readonly [number, number, number]])[] = [
  ["samples", "sample", SAMPLE],
  ["planned", "planned", PLANNED],
  ["next", "next best", NEXT],
];

export interface Shown {
  readonly beside: Beside;
  readonly palette: PaletteName;
  readonly truth: Truth | null;
  /** Planned points, (m, 3) mm; null while they are hidden. */
  readonly planned: Float32Array | null;
  /** Finest wavelength the plan supports at each vertex, mm. */
  readonly plannedWavelengths: Float32Array | null;
  readonly showNext: boolean;
}

export class Pictures {
  readonly element: HTMLElement;
  readonly stage: Stage;
  private readonly left: Pane;
  private right: Pane | null = null;
  private readonly bar = new ColourBar();
  private readonly secondBar = new ColourBar();
  private readonly legend = h("p", { class: "points-legend" });
  private mapScale: ColourScale | null = null;
  private scaledFor = "";
  private shownState: LiveState | null = null;

  constructor(
    private readonly surface: SurfaceCase,
    picked: (place: PickedInPane) => void,
  ) {
    const host = h("div", { class: "stage-host" });
    this.element = h("div", { class: "stages" }, this.bar.element, host, this.secondBar.element);
    this.stage = new Stage(host, "The map. Click on it to take a sample", surface.space);
    this.stage.picked = picked;
    host.append(this.legend);
    this.left = this.stage.addPane();
    this.left.setSurface(surface.positions, surface.faces);
  }

  /** Shows the live map and what is asked for beside it, with the next frame. */
  show(live: Live, shown: Shown): void {
    this.beside(shown.beside !== "none");
    const { state } = live;
    if (state !== this.shownState) this.stage.moving();
    this.shownState = state;
    const map = state?.mean ?? null;
    const scale = map && state ? this.scale(map, state.values, state.cycle_length_ms, shown) : null;
    const unit = state?.unit ?? "";
    this.left.setValues(map, scale);
    this.left.setCaption(map ? `Map from ${state?.n_taken} samples` : "No map yet");
    this.bar.show(map ? scale : null, (state?.name ?? "").replaceAll("_", " "), unit);
    if (this.right) this.showRight(this.right, live, shown, scale);
    const seen = { samples: Boolean(state?.positions.length), planned: Boolean(shown.planned?.length), next: Boolean(state) && shown.showNext };
    fill(this.legend, ...LEGEND.filter(([layer]) => seen[layer as keyof typeof seen]).map(([, words, colour]) => h("span", {}, disc(colour), words)));
    for (const pane of [this.left, ...(this.right ? [this.right] : [])]) {
      pane.setPoints("planned", shown.planned && { positions: shown.planned, colours: PLANNED, size: 8 });
      pane.setPoints("samples", state && { positions: state.positions, colours: SAMPLE, size: 8 });
      const next = state && shown.showNext ? Float32Array.from(state.next) : new Float32Array(0);
      pane.setPoints("next", { positions: next, colours: NEXT, size: 13 });
    }
  }

  dispose(): void {
    this.stage.dispose();
  }

  private beside(wanted: boolean): void {
    if (wanted && !this.right) {
      this.right = this.stage.addPane();
      this.right.setSurface(this.surface.positions, this.surface.faces);
    } else if (!wanted && this.right) {
      this.stage.removePane(this.right);
      this.right = null;
      this.secondBar.show(null, "", "");
    }
  }

  private showRight(pane: Pane, live: Live, shown: Shown, mapScale: ColourScale | null): void {
    const { state, judgement } = live;
    const unit = state?.unit ?? "";
    const put = (caption: string, values: Float32Array | null, scale: ColourScale | null, title: string, of: string, grey = ""): void => {
      pane.setCaption(values ? caption : `${caption}: not yet known`);
      pane.setValues(values, scale);
      this.secondBar.show(values ? scale : null, title, of, grey);
    };
    const { truth } = shown;
    if (shown.beside === "uncertainty") {
      put("Uncertainty", state?.std ?? null, state?.std ? fromZero(state.std, "distance") : null, "standard deviation", unit);
    } else if (shown.beside === "wavelength") {
      const planned = !state?.n_taken && shown.plannedWavelengths !== null;
      const waves = planned ? shown.plannedWavelengths : (judgement?.wavelengths ?? null);
      put(planned ? "Finest wavelength of the plan" : "Finest wavelength supported", waves, waves && fromZero(waves, "viridis"), "wavelength", "mm", "none");
    } else if (shown.beside === "truth") {
      put(truth ? "The true map" : "No true map", truth?.values ?? null, truth && (mapScale ?? this.ownScale(truth.values, shown.palette)), (truth?.name ?? "").replaceAll("_", " "), truth?.unit ?? "");
    } else {
      const error = truth && state?.mean ? difference(state.mean, truth.values, state.cycle_length_ms) : null;
      put("Error against the true map", error, error && fromZero(error, "distance"), "error", unit);
    }
  }

  /** Colours of the map: by the true map if there is one, else by the samples; not at every step. */
  private scale(map: Float32Array, samples: Float64Array, cycle: number | null, shown: Shown): ColourScale {
    if (cycle !== null) return { palette: "cyclic", low: 0, high: cycle, bands: 12, lines: true };
    const key = shown.truth ? shown.truth.name : `${Math.ceil(Math.log2(samples.length + 1))}`;
    if (!this.mapScale || this.scaledFor !== key)
      this.mapScale = this.ownScale(shown.truth?.values ?? Float32Array.from([...samples, ...range(map)]), shown.palette);
    this.scaledFor = key;
    if (this.mapScale.palette !== shown.palette) this.mapScale = { ...this.mapScale, palette: shown.palette };
    return this.mapScale;
  }

  private ownScale(values: Float32Array, palette: PaletteName): ColourScale {
    return { ...scaleOf(values, palette), lines: true };
  }
}

/** A disc as the pictures draw it. */
function disc(colour: readonly [number, number, number]): SVGElement {
  const rim = colour === PLANNED ? "#141414" : "#ffffff";
  return svg("svg", { width: 14, height: 14, "aria-hidden": "true" }, svg("circle", { cx: 7, cy: 7, r: 5, fill: `rgb(${colour.join(",")})`, stroke: rim, "stroke-width": 2 }));
}

function range(map: Float32Array): number[] {
  const known = map.filter((value) => Number.isFinite(value)).sort();
  return known.length ? [known[Math.floor(0.02 * known.length)], known[Math.floor(0.98 * (known.length - 1))]] : [];
}

/** A scale from 0 to about the largest value. */
function fromZero(values: Float32Array, palette: PaletteName): ColourScale {
  const known = values.filter((value) => Number.isFinite(value)).sort();
  const most = known.length ? known[Math.floor(0.99 * (known.length - 1))] : 1;
  const steps = roundSteps(0, most || 1, 8);
  return { palette, low: 0, high: steps[steps.length - 1], bands: steps.length - 1, lines: false };
}

function difference(map: Float32Array, truth: Float32Array, cycle: number | null): Float32Array {
  return map.map((value, i) => {
    const plain = Math.abs(value - truth[i]);
    return cycle === null ? plain : Math.min(plain % cycle, cycle - (plain % cycle));
  });
}
