/** Table 1 as a picture: how many harmonics each kind of map needs, over cases and placements. */
import { svg } from "../dom";
import { numberOf, words, type Row } from "./study";

const [LEFT, RIGHT, LINE, GAP] = [150, 16, 13, 4];
/** Pixels of the page from which on the key fits into one line. */
const ROOMY = 580;
const TICKS = [1, 3, 10, 30, 100, 300, 1000, 3000, 10000];

/** Drawn for a place so many pixels wide. */
export function rangesPicture(rows: readonly Row[], wide: number): SVGElement {
  const top = wide < ROOMY ? 44 : 26;
  const tall = top + rows.reduce((sum, _, place) => sum + LINE + (begins(rows, place) ? GAP : 0), 0) + 34;
  const most = Math.max(10, ...rows.flatMap((row) => ["high", "printed"].map((name) => numberOf(row, name) ?? 0)));
  const x = (count: number): number => LEFT + (Math.log(Math.max(count, 1)) / Math.log(most * 1.15)) * (wide - LEFT - RIGHT);
  const ticks = TICKS.filter((count) => count <= most * 1.15 && (wide >= ROOMY || Number.isInteger(Math.log10(count))));
  const marks: SVGElement[] = [];
  let y = top;
  rows.forEach((row, place) => {
    if (begins(rows, place)) {
      y += GAP;
      marks.push(svg("text", { x: LEFT - 46, y: y + LINE - 3, class: "end" }, nameOf(row)));
    }
    marks.push(...line(row, x, y + LINE / 2, wide - RIGHT));
    y += LINE;
  });
  return svg(
    "svg",
    { viewBox: `0 0 ${wide} ${tall}`, role: "img", "aria-label": spoken(rows) },
    ...ticks.flatMap((count) => [
      svg("path", { d: `M${x(count)} ${top}V${y + 2}`, class: "grid" }),
      svg("text", { x: x(count), y: y + 16, class: "middle" }, count.toLocaleString("en-GB")),
    ]),
    svg("text", { x: (LEFT + wide - RIGHT) / 2, y: y + 31, class: "middle" }, "harmonics, the constant one counted"),
    ...key(wide),
    ...marks,
  );
}

function line(row: Row, x: (count: number) => number, y: number, end: number): SVGElement[] {
  const [low, high, median] = ["low", "high", "median"].map((name) => numberOf(row, name));
  const [from, to] = ["case_median_low", "case_median_high"].map((name) => numberOf(row, name));
  const printed = numberOf(row, "printed");
  const share = numberOf(row, "share");
  const made: SVGElement[] = [svg("text", { x: LEFT - 8, y: y + 4, class: "end soft" }, share === null ? "" : `${Math.round(100 * share)} %`)];
  if (low !== null) made.push(svg("path", { d: `M${x(low)} ${y}H${high === null ? end : x(high)}`, class: "range" }));
  if (from !== null && to !== null) made.push(svg("path", { d: `M${x(from) - 1} ${y}H${x(to) + 1}`, class: "medians" }));
  if (median !== null) made.push(svg("circle", { cx: x(median), cy: y, r: 3.5, class: "median" }, svg("title", {}, `${nameOf(row)}: median ${words(median)}`)));
  if (printed !== null) made.push(svg("path", { d: diamond(x(printed), y), class: "printed" }, svg("title", {}, `printed ${words(printed)}`)));
  return made;
}

function key(wide: number): SVGElement[] {
  const entry = (left: number, y: number, mark: SVGElement, label: string): SVGElement[] => [mark, svg("text", { x: left + 26, y: y + 4 }, label)];
  // On a narrow page two lines from its edge, else one from the axis.
  const [first, second, low] = wide < ROOMY ? [4, 4, 28] : [LEFT, LEFT + 186, 10];
  return [
    ...entry(first, 10, svg("path", { d: `M${first} 10h20`, class: "range" }), "all"),
    ...entry(first + 60, 10, svg("path", { d: `M${first + 60} 10h20`, class: "medians" }), "cases' medians"),
    ...entry(second, low, svg("circle", { cx: second + 14, cy: low, r: 3.5, class: "median" }), "median"),
    ...entry(second + 82, low, svg("path", { d: diamond(second + 96, low), class: "printed" }), "printed in the paper"),
  ];
}

export function diamond(x: number, y: number): string {
  return `M${x} ${y - 5}l5 5l-5 5l-5 -5z`;
}

function begins(rows: readonly Row[], place: number): boolean {
  return place === 0 || nameOf(rows[place]) !== nameOf(rows[place - 1]);
}

function nameOf(row: Row): string {
  const n = numberOf(row, "n_foci");
  if (n === null) return String(row["size"] ?? "");
  return `${n} ${String(row["size"])} ${n === 1 ? "focus" : "foci"}`;
}

function spoken(rows: readonly Row[]): string {
  const lines = rows.map((row) => {
    const share = Math.round(100 * (numberOf(row, "share") ?? NaN));
    return `${nameOf(row)}, ${share} %: ${words(numberOf(row, "median"))}, printed ${words(numberOf(row, "printed"))}`;
  });
  return `Harmonics that hold a share of the power, median over cases and placements. ${lines.join("; ")}.`;
}
