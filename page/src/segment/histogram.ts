/** CT numbers of the region one looks in, and the thresholds among them. */
import { fill, h, svg } from "../dom";
import { histogram, type Lattice, type Vec3 } from "./lattice";
import { signed } from "./orientation";

const [LOW, WIDTH, N_BINS] = [-200, 10, 100];
const [ACROSS, HIGH, BASE, LEFT] = [400, 220, 182, 20];

export interface Level {
  readonly hu: number;
  readonly words: string;
  readonly kind: "threshold" | "measured";
}

export class HistogramFigure {
  readonly element: HTMLElement;
  private readonly drawing = svg("svg", {
    viewBox: `0 0 ${ACROSS} ${HIGH}`,
    role: "img",
    preserveAspectRatio: "xMidYMid meet",
  });
  private readonly title = h("span", {}, "CT numbers in the region");
  private counts: Float64Array = new Float64Array(N_BINS);
  private boxed = "";
  private drawn = "";

  constructor() {
    this.element = h("figure", { class: "slice histogram" }, h("figcaption", {}, this.title), this.drawing);
  }

  /** Counts anew: another CT is open. */
  reset(): void {
    this.boxed = "";
    this.drawn = "";
  }

  show(volume: Lattice<Int16Array>, box: readonly [Vec3, Vec3], levels: readonly Level[]): void {
    const key = JSON.stringify(box);
    const told = key + JSON.stringify(levels);
    if (told === this.drawn) return;
    this.drawn = told;
    if (key !== this.boxed) this.counts = histogram(volume, box, LOW, WIDTH, N_BINS);
    this.boxed = key;
    const most = Math.max(...this.counts.slice(1), 1);
    const x = (hu: number): number => LEFT + ((hu - LOW) / (WIDTH * N_BINS)) * (ACROSS - 2 * LEFT);
    const bars = [...this.counts].map((count, bin) => {
      const height = Math.min(Math.sqrt(count / most), 1) * (BASE - 46);
      return `M${x(LOW + bin * WIDTH).toFixed(1)} ${BASE}v${(-height).toFixed(1)}H${x(LOW + (bin + 1) * WIDTH).toFixed(1)}V${BASE}z`;
    });
    const words = levels.map((level) => `${level.words} ${level.hu.toFixed(0)} HU`).join(", ");
    this.drawing.setAttribute("aria-label", `Histogram of CT numbers; ${words || "no thresholds yet"}`);
    const ticks = [-200, 0, 200, 400, 600, 800];
    fill(
      this.drawing,
      svg("path", { d: bars.join(""), class: "bars" }),
      svg("path", { d: `M${LEFT} ${BASE}H${ACROSS - LEFT}`, class: "axis" }),
      ...ticks.map((hu) => svg("text", { x: x(hu), y: BASE + 15, class: "tick" }, signed(hu))),
      svg("text", { x: ACROSS / 2, y: HIGH - 3, class: "tick" }, "CT number, HU (height: square root of the count)"),
      ...levels.flatMap((level, place) => this.level(level, x(level.hu), place)),
    );
  }

  private level(level: Level, x: number, place: number): SVGElement[] {
    if (x < LEFT || x > ACROSS - LEFT) return [];
    const y = 12 + 12 * (place % 3);
    const late = x > ACROSS - 90;
    return [
      svg("path", { d: `M${x} ${y + 3}V${BASE}`, class: level.kind }),
      svg("text", { x: late ? x - 4 : x + 4, y, class: `level ${late ? "late" : ""}` }, `${level.words} ${level.hu.toFixed(0)}`),
    ];
  }
}
