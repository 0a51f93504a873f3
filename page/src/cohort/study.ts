/** A study as the server describes it. */

export interface Column {
  readonly key: string;
  readonly words: string;
  readonly unit: string;
}

export interface StudyCase {
  readonly key: string;
  readonly name: string;
  readonly kind: string;
  /** Whether it kept a surface that can be opened. */
  readonly opens: boolean;
  readonly numbers: Readonly<Record<string, number | null>>;
}

/** A line of a table of the study. */
export type Row = Readonly<Record<string, string | number | null>>;

export interface Study {
  readonly name: string;
  readonly columns: readonly Column[];
  readonly cases: readonly StudyCase[];
  readonly medians: Readonly<Record<string, number | null>>;
  readonly failed: readonly { readonly name: string; readonly error: string }[];
  readonly table1: readonly Row[];
  readonly decay: readonly Row[];
}

export interface Order {
  /** A column's key, "name" or "kind". */
  readonly by: string;
  readonly falling: boolean;
}

/** Cases in order; those without the number come last either way. */
export function ordered(cases: readonly StudyCase[], order: Order): StudyCase[] {
  const sign = order.falling ? -1 : 1;
  const word = (each: StudyCase): string => (order.by === "kind" ? each.kind : each.name);
  return [...cases].sort((one, other) => {
    if (order.by === "name" || order.by === "kind")
      return sign * word(one).localeCompare(word(other), undefined, { numeric: true });
    const [first, second] = [one.numbers[order.by], other.numbers[order.by]];
    if (first === null || second === null) return Number(first === null) - Number(second === null);
    return sign * (first - second);
  });
}

/** A number of a row; null where it has none. */
export function numberOf(row: Row, name: string): number | null {
  const value = row[name];
  return typeof value === "number" ? value : null;
}

/** Three figures, thousands apart. */
export function words(value: number | null): string {
  if (value === null) return "–";
  const size = Math.abs(value);
  const digits = size >= 100 || Number.isInteger(value) ? 0 : size >= 10 ? 1 : 2;
  return value.toLocaleString("en-GB", { minimumFractionDigits: digits, maximumFractionDigits: digits });
}
