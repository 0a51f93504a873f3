/** Numbers as people read them. */

/** `value` with `count` significant figures, without an exponent where it can be helped. */
export function figures(value: number, count = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 6) return value.toExponential(count - 1).replace("e", " · 10^").replace("^+", "^");
  const text = value.toFixed(Math.max(0, count - 1 - size));
  return text.replace("-", "−");
}

/** A share as a percentage: 0.9991 is "99.91 %". */
export function percent(share: number): string {
  if (!Number.isFinite(share)) return "–";
  const digits = share > 0.9995 || share < 0.001 ? 3 : share > 0.99 || share < 0.01 ? 2 : 1;
  return `${(100 * share).toFixed(digits)} %`;
}

/** A number with its unit. */
export function withUnit(value: number, unit: string, count = 3): string {
  const text = figures(value, count);
  return unit && text !== "–" ? `${text} ${unit}` : text;
}

/** A short number for the end of an axis: no more figures than it needs. */
export function tick(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(Math.abs(value).toExponential(1)[2] === "0" ? 0 : 1).replace("e+", "e").replace("-", "−");
  return String(Number(value.toPrecision(6))).replace("-", "−");
}
