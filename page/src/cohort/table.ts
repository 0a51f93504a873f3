/** The cases of a study, a line each, in any order one likes. */
import { csvText, fill, h } from "../dom";
import { ordered, words, type Order, type Study, type StudyCase } from "./study";

export class CaseTable {
  readonly element = h("div", { class: "cases", tabindex: 0, role: "region", "aria-label": "Cases of the study" });
  private order: Order = { by: "name", falling: false };
  private readonly body = h("tbody");
  private readonly heads = new Map<string, HTMLElement>();

  constructor(
    private readonly study: Study,
    private readonly open: (one: StudyCase) => void,
    private readonly pointed: (one: StudyCase | null) => void,
  ) {
    const columns = study.columns.map((column) => this.head(column.key, column.words, column.unit));
    fill(
      this.element,
      h(
        "table",
        {},
        h("caption", { class: "unseen" }, "Cases of the study; a heading sorts, a name opens the case"),
        h("thead", {}, h("tr", {}, this.head("name", "Case", ""), this.head("kind", "Kind", ""), ...columns)),
        this.body,
        h("tfoot", {}, h("tr", {}, h("th", { scope: "row" }, "Median"), h("td"), ...study.columns.map((column) => h("td", {}, words(study.medians[column.key]))))),
      ),
    );
    this.sort(this.order);
  }

  get now(): Order {
    return this.order;
  }

  sort(order: Order): void {
    this.order = order;
    for (const [key, head] of this.heads) {
      const sorted = key === order.by ? (order.falling ? "descending" : "ascending") : null;
      if (sorted) head.setAttribute("aria-sort", sorted);
      else head.removeAttribute("aria-sort");
    }
    fill(this.body, ...ordered(this.study.cases, order).map((one) => this.row(one)), ...this.failures());
  }

  /** The table as CSV, units in its heads. */
  csv(): string {
    const { columns, cases } = this.study;
    const heads = columns.map((column) => (column.unit ? `${column.words} (${column.unit})` : column.words));
    const rows = ordered(cases, this.order).map((one) => [one.name, one.kind, ...columns.map((column) => one.numbers[column.key] ?? NaN)]);
    return csvText([["Case", "Kind", ...heads], ...rows]);
  }

  private head(key: string, label: string, unit: string): HTMLElement {
    const pressed = (): void => this.sort({ by: key, falling: this.order.by === key && !this.order.falling });
    const head = h(
      "th",
      { scope: "col" },
      h("button", { type: "button", class: "sort", onclick: pressed }, label, unit && h("span", { class: "unit" }, unit)),
    );
    this.heads.set(key, head);
    return head;
  }

  private row(one: StudyCase): HTMLElement {
    const name = one.opens
      ? h("button", { type: "button", class: "open", title: "Open in Explore", onclick: () => this.open(one) }, one.name)
      : one.name;
    const row = h(
      "tr",
      { "data-key": one.key },
      h("th", { scope: "row" }, name),
      h("td", { class: "kind" }, one.kind),
      ...this.study.columns.map((column) => h("td", {}, words(one.numbers[column.key]))),
    );
    row.addEventListener("pointerenter", () => this.pointed(one));
    row.addEventListener("pointerleave", () => this.pointed(null));
    row.addEventListener("focusin", () => this.pointed(one));
    row.addEventListener("focusout", () => this.pointed(null));
    return row;
  }

  private failures(): HTMLElement[] {
    return this.study.failed.map((failed) =>
      h(
        "tr",
        { class: "failed" },
        h("th", { scope: "row" }, failed.name),
        h("td", { colspan: this.study.columns.length + 1 }, `no result: ${failed.error}`),
      ),
    );
  }
}
