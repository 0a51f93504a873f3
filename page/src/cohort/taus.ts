/** Decay constants: a dot a case, mean and deviation, and what the paper prints. */
import { svg } from "../dom";
import { diamond } from "./ranges";
import { numberOf, words, type Study } from "./study";

const [TALL, LEFT, RIGHT, TOP, BASE] = [330, 52, 12, 26, 280];
const GROUPS = [
  { key: "tau_mha_gd", error: "GD", method: "mha", words: "MHA" },
  { key: "tau_qslim_gd", error: "GD", method: "qslim", words: "Qslim" },
  { key: "tau_mha_mse", error: "MSE", method: "mha", words: "MHA" },
  { key: "tau_qslim_mse", error: "MSE", method: "qslim", words: "Qslim" },
] as const;
/** Where the dots of one group stand beside its middle, so that they do not hide each other. */
const ASIDE = [0, -10, 10, -5, 5, -14, 14];

interface Group {
  readonly title: string;
  readonly mean: number | null;
  readonly deviation: number | null;
  readonly printed: number | null;
}

/** Drawn for a place so many pixels wide. */
export function tausPicture(study: Study, wide: number): SVGElement {
  const groups = GROUPS.map((group): Group => {
    const row = study.decay.find((each) => each["error"] === group.error);
    const of = (name: string): number | null => (row ? numberOf(row, name) : null);
    return {
      title: `${group.error}, ${group.words}`,
      mean: of(`${group.method}_mean`),
      deviation: of(`${group.method}_deviation`),
      printed: of(`printed_${group.method}`),
    };
  });
  const all = [
    ...study.cases.flatMap((one) => GROUPS.map((group) => one.numbers[group.key] ?? 0)),
    ...groups.flatMap((group) => [group.printed ?? 0, (group.mean ?? 0) + (group.deviation ?? 0)]),
  ];
  const most = Math.max(10, ...all) * 1.08;
  const y = (tau: number): number => BASE - (tau / most) * (BASE - TOP);
  const middle = (place: number): number => LEFT + ((place + 0.5) / GROUPS.length) * (wide - LEFT - RIGHT);
  return svg(
    "svg",
    { viewBox: `0 0 ${wide} ${TALL}`, role: "img", "aria-label": spoken(groups) },
    ...ticksTo(most).flatMap((tau) => [
      svg("path", { d: `M${LEFT} ${y(tau)}H${wide - RIGHT}`, class: "grid" }),
      svg("text", { x: LEFT - 6, y: y(tau) + 4, class: "end" }, tau),
    ]),
    svg("text", { x: 14, y: (TOP + BASE) / 2, class: "middle", transform: `rotate(-90 14 ${(TOP + BASE) / 2})` }, "τ, harmonics or points"),
    ...groups.flatMap((group, place) => marks(group, middle(place), y)),
    ...GROUPS.flatMap((group, place) =>
      study.cases.flatMap((one, number) => {
        const tau = one.numbers[group.key];
        if (tau === null) return [];
        const x = middle(place) + 22 + ASIDE[number % ASIDE.length] * 0.6;
        return [svg("circle", { cx: x, cy: y(tau), r: 3, class: "case", "data-key": one.key }, svg("title", {}, `${one.name}: ${words(tau)}`))];
      }),
    ),
    ...GROUPS.map((group, place) => svg("text", { x: middle(place), y: BASE + 17, class: "middle" }, group.words)),
    svg("text", { x: (middle(0) + middle(1)) / 2, y: BASE + 36, class: "middle strong" }, "GD (distance)"),
    svg("text", { x: (middle(2) + middle(3)) / 2, y: BASE + 36, class: "middle strong" }, "MSE"),
    ...key(),
  );
}

function marks(group: Group, x: number, y: (tau: number) => number): SVGElement[] {
  const made: SVGElement[] = [];
  const { mean, deviation, printed } = group;
  if (mean !== null && deviation !== null) made.push(svg("path", { d: `M${x} ${y(mean - deviation)}V${y(mean + deviation)}`, class: "medians" }));
  if (mean !== null) made.push(svg("circle", { cx: x, cy: y(mean), r: 4.5, class: "median" }, svg("title", {}, `mean ${words(mean)} ± ${words(deviation)}`)));
  if (printed !== null) made.push(svg("path", { d: diamond(x - 20, y(printed)), class: "printed" }, svg("title", {}, `printed ${words(printed)}`)));
  return made;
}

function key(): SVGElement[] {
  return [
    svg("circle", { cx: 10, cy: 10, r: 4.5, class: "median" }),
    svg("text", { x: 20, y: 14 }, "mean ± deviation"),
    svg("circle", { cx: 140, cy: 10, r: 3, class: "case" }),
    svg("text", { x: 148, y: 14 }, "a case"),
    svg("path", { d: diamond(206, 10), class: "printed" }),
    svg("text", { x: 216, y: 14 }, "printed in the paper"),
  ];
}

function ticksTo(most: number): number[] {
  const rough = most / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough) ?? rough;
  return Array.from({ length: Math.floor(most / step) + 1 }, (_, place) => place * step);
}

function spoken(groups: readonly Group[]): string {
  const lines = groups.map((group) => `${group.title}: ${words(group.mean)} ± ${words(group.deviation)}, printed ${words(group.printed)}`);
  return `Decay constants τ, mean ± deviation over cases. ${lines.join("; ")}.`;
}
