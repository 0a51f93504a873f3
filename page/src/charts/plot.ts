/** A chart as SVG: lines or dots over a number, a marker, and clicks that choose a number. */
import { fill, h, svg } from "../dom";
import { tick } from "../words";

export interface Series {
  readonly name: string;
  readonly xs: ArrayLike<number>;
  readonly ys: ArrayLike<number>;
  /** "line", "dots" (with a thin line) or "bars" from the bottom. */
  readonly kind: "line" | "dots" | "bars";
  /** 1 to 4: colour and dashes. */
  readonly look: number;
}

export interface Axis {
  readonly label: string;
  readonly log: boolean;
  readonly low: number;
  readonly high: number;
}

export interface PlotOptions {
  readonly title: string;
  readonly x: Axis;
  readonly y: Axis;
  readonly series: readonly Series[];
  /** Called with the place on the x axis that was clicked or dragged to. */
  readonly picked?: (x: number) => void;
}

const LEFT = 52;
const RIGHT = 10;
const TOP = 8;
const BOTTOM = 34;

export class Plot {
  readonly element = h("figure", { class: "plot" });
  private options: PlotOptions | null = null;
  private readonly heading = h("figcaption", {});
  private readonly host = h("div", { class: "plot-host" });
  /** Apart from the drawing, so that moving it draws nothing anew. */
  private readonly line = h("div", { class: "marker" });
  private marked: number | null = null;
  /** Pixels of the page; asked for once, since asking makes the browser lay the page out. */
  private width = 0;
  private height = 0;

  constructor() {
    this.element.append(this.heading, this.host);
    new ResizeObserver(() => {
      this.width = this.host.clientWidth;
      this.height = this.host.clientHeight;
      this.render();
    }).observe(this.host);
  }

  /** Draws something else. */
  show(options: PlotOptions): void {
    this.options = options;
    fill(this.heading, h("span", { class: "plot-title" }, options.title), legend(options.series));
    this.render();
  }

  /** Puts the marker at a place on the x axis. */
  mark(x: number): void {
    this.marked = x;
    const { options } = this;
    this.line.hidden = false;
    if (!options || !this.line.isConnected) return;
    this.line.style.transform = `translateX(${this.across(options.x)(x) - 0.75}px)`;
  }

  private across(axis: Axis): (value: number) => number {
    return mapping(axis, LEFT, this.width - RIGHT);
  }

  private render(): void {
    const { options } = this;
    if (!options || this.width < LEFT + RIGHT + 20 || this.height < TOP + BOTTOM + 10) return;
    const x = this.across(options.x);
    const y = mapping(options.y, this.height - BOTTOM, TOP);
    const drawing = svg(
      "svg",
      { width: this.width, height: this.height, role: "img", "aria-label": described(options) },
      ...this.grid(options, x, y),
      ...options.series.flatMap((series) => drawn(series, x, y, this.height - BOTTOM, TOP)),
    );
    this.line.style.top = `${TOP}px`;
    this.line.style.height = `${this.height - BOTTOM - TOP}px`;
    this.line.hidden = this.marked === null;
    if (options.picked) this.listen(drawing, options.x, options.picked);
    fill(this.host, drawing, this.line);
    if (this.marked !== null) this.mark(this.marked);
  }

  private grid(
    { x: xAxis, y: yAxis }: PlotOptions,
    x: (value: number) => number,
    y: (value: number) => number,
  ): SVGElement[] {
    const bottom = this.height - BOTTOM;
    const right = this.width - RIGHT;
    const lines: SVGElement[] = [];
    for (const value of ticks(xAxis, Math.max(3, Math.floor(this.width / 70)))) {
      const at = x(value);
      lines.push(
        svg("line", { x1: at, x2: at, y1: TOP, y2: bottom, class: "grid" }),
        svg("text", { x: at, y: bottom + 14, "text-anchor": "middle" }, tick(value)),
      );
    }
    for (const value of ticks(yAxis, Math.max(2, Math.floor(this.height / 40)))) {
      const at = y(value);
      lines.push(
        svg("line", { x1: LEFT, x2: right, y1: at, y2: at, class: "grid" }),
        svg("text", { x: LEFT - 6, y: at, dy: "0.35em", "text-anchor": "end" }, tick(value)),
      );
    }
    const middle = (TOP + bottom) / 2;
    lines.push(
      svg("text", { x: (LEFT + right) / 2, y: this.height - 4, "text-anchor": "middle", class: "axis-label" }, xAxis.label),
      svg("text", { transform: `translate(11 ${middle}) rotate(-90)`, "text-anchor": "middle", class: "axis-label" }, yAxis.label),
      svg("rect", { x: LEFT, y: TOP, width: right - LEFT, height: bottom - TOP, class: "plot-frame" }),
    );
    return lines;
  }

  private listen(drawing: SVGSVGElement, axis: Axis, picked: (x: number) => void): void {
    const choose = (event: PointerEvent): void => {
      const at = event.clientX - drawing.getBoundingClientRect().left;
      const share = Math.min(Math.max((at - LEFT) / (this.width - RIGHT - LEFT), 0), 1);
      picked(axis.log ? axis.low * (axis.high / axis.low) ** share : axis.low + (axis.high - axis.low) * share);
    };
    drawing.classList.add("pickable");
    drawing.addEventListener("pointerdown", (event) => {
      drawing.setPointerCapture(event.pointerId);
      choose(event);
    });
    drawing.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) choose(event);
    });
  }
}

function mapping(axis: Axis, from: number, to: number): (value: number) => number {
  const place = axis.log
    ? (value: number) => Math.log(value / axis.low) / Math.log(axis.high / axis.low)
    : (value: number) => (value - axis.low) / (axis.high - axis.low);
  return (value) => from + (to - from) * place(value);
}

function drawn(
  series: Series,
  x: (value: number) => number,
  y: (value: number) => number,
  bottom: number,
  top: number,
): SVGElement[] {
  const look = `series look-${series.look}`;
  const places: [number, number][] = [];
  for (let i = 0; i < series.xs.length; i += 1) {
    const at: [number, number] = [x(series.xs[i]), y(series.ys[i])];
    if (at.every(Number.isFinite)) places.push([at[0], Math.min(Math.max(at[1], top), bottom)]);
  }
  if (series.kind === "bars")
    return [
      svg("path", {
        class: `${look} bars`,
        d: places.map(([px, py]) => `M${px.toFixed(1)} ${bottom}V${py.toFixed(1)}`).join(""),
      }),
    ];
  const path = places.map(([px, py]) => `${px.toFixed(1)},${py.toFixed(1)}`).join(" ");
  const line = svg("polyline", { class: look, points: path });
  if (series.kind === "line") return [line];
  return [line, ...places.map(([px, py]) => svg("circle", { class: `${look} dot`, cx: px, cy: py, r: 2.6 }))];
}

function legend(series: readonly Series[]): HTMLElement | null {
  if (series.length < 2) return null;
  const entries = series.map(({ name, look, kind }) =>
    h(
      "span",
      {},
      svg(
        "svg",
        { width: 22, height: 8, "aria-hidden": "true" },
        svg("line", { x1: 0, x2: 22, y1: 4, y2: 4, class: `series look-${look}` }),
        kind === "dots" && svg("circle", { cx: 11, cy: 4, r: 2.6, class: `series look-${look} dot` }),
      ),
      name,
    ),
  );
  return h("span", { class: "legend" }, ...entries);
}

function described({ title, x, y, series }: PlotOptions): string {
  const names = series.map(({ name }) => name).join(", ");
  return `${title}: ${names}. Across ${x.label} from ${tick(x.low)} to ${tick(x.high)}, upwards ${y.label} from ${tick(y.low)} to ${tick(y.high)}.`;
}

/** Round numbers inside an axis, about `count` of them. */
export function ticks(axis: Axis, count: number): number[] {
  return axis.log ? logTicks(axis, count) : linearTicks(axis, count);
}

function linearTicks({ low, high }: Axis, count: number): number[] {
  const raw = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = ([1, 2, 5, 10].find((each) => each * decade >= raw * (1 - 1e-9)) ?? 10) * decade;
  const found: number[] = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + step * 1e-9; value += step)
    found.push(Number(value.toPrecision(12)));
  return found;
}

function logTicks({ low, high }: Axis, count: number): number[] {
  const decades = Math.log10(high / low);
  const digits = decades < Math.max(count / 3, 2) ? [1, 2, 5] : [1];
  const skip = Math.max(1, Math.ceil(decades / count));
  const found: number[] = [];
  for (let decade = Math.floor(Math.log10(low)); decade <= Math.ceil(Math.log10(high)); decade += 1) {
    if (digits.length === 1 && decade % skip) continue;
    for (const digit of digits) {
      const value = Number((digit * 10 ** decade).toPrecision(6));
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)) found.push(value);
    }
  }
  return found;
}

/** Limits of a logarithmic axis that hold all positive values, no lower than `floor` of the highest. */
export function logLimits(values: Iterable<number>, floor = 1e-6): [number, number] {
  let high = 0;
  for (const value of values) if (Number.isFinite(value)) high = Math.max(high, value);
  let low = high;
  for (const value of values) if (value > high * floor) low = Math.min(low, value);
  if (!(high > 0)) return [0.1, 1];
  return [low / 1.3, Math.max(high * 1.3, low * 10)];
}
