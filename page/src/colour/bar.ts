/** The colour bar: bands with their boundaries, and what grey means. */
import { fill, h, svg } from "../dom";
import { tick } from "../words";
import { colourAt, cssColour } from "./palettes";
import { boundaries, UNKNOWN, type ColourScale } from "./scale";

const HEIGHT = 190;
const WIDTH = 16;
const CONTINUOUS_STEPS = 64;
const MOST_TICKS = 14;

export class ColourBar {
  readonly element = h("figure", { class: "colour-bar" });
  private shown = "";

  /** Shows a scale; `unknown` says what is grey, if anything is. Null hides the bar. */
  show(scale: ColourScale | null, title: string, unit: string, unknown = ""): void {
    const next = JSON.stringify([scale, title, unit, unknown]);
    if (next === this.shown) return;
    this.shown = next;
    this.element.hidden = scale === null;
    if (!scale) return;
    const label = unit ? `${title} (${unit})` : title;
    fill(
      this.element,
      h("figcaption", {}, h("span", { class: "bar-title" }, title), unit && h("span", { class: "unit" }, unit)),
      drawing(scale, label),
      unknown && h("p", { class: "bar-unknown" }, svg("svg", { width: 12, height: 12, "aria-hidden": "true" }, svg("rect", { width: 12, height: 12, fill: cssColour(UNKNOWN) })), ` ${unknown}`),
    );
  }
}

function drawing(scale: ColourScale, label: string): SVGSVGElement {
  const count = scale.bands || CONTINUOUS_STEPS;
  const step = HEIGHT / count;
  const blocks = Array.from({ length: count }, (_, band) =>
    svg("rect", {
      x: 0,
      y: HEIGHT - (band + 1) * step,
      width: WIDTH,
      height: step + (scale.bands ? 0 : 0.6),
      fill: cssColour(colourAt(scale.palette, (band + 0.5) / count)),
    }),
  );
  const edges = boundaries(scale);
  const every = Math.ceil(edges.length / MOST_TICKS);
  const ticks = edges.flatMap((value, place) => {
    if (place % every) return [];
    const y = HEIGHT - (place * HEIGHT) / (edges.length - 1);
    return [
      svg("line", { x1: WIDTH, x2: WIDTH + 4, y1: y, y2: y, class: "axis" }),
      svg("text", { x: WIDTH + 7, y, dy: "0.35em" }, tick(Number(value.toPrecision(4)))),
    ];
  });
  const frame = svg("rect", { x: 0, y: 0, width: WIDTH, height: HEIGHT, class: "bar-frame" });
  const words = `Colour bar, ${label}, from ${tick(scale.low)} to ${tick(scale.high)}`;
  return svg(
    "svg",
    { width: 70, height: HEIGHT + 14, viewBox: `-1 -7 70 ${HEIGHT + 14}`, role: "img", "aria-label": words },
    ...blocks,
    frame,
    ...ticks,
  );
}
