/** The view: the cases above, the study's Table 1 and decay constants below. */
import type { App } from "../app";
import { fill, h, saveFile } from "../dom";
import type { MountedView } from "../registry";
import { button } from "../widgets/panel";
import { rangesPicture } from "./ranges";
import { type Order, type Study, type StudyCase } from "./study";
import { CaseTable } from "./table";
import { tausPicture } from "./taus";

export function mountCohort(root: HTMLElement, app: App): MountedView {
  const view = new CohortView(root, app);
  void view.load();
  return view;
}

class CohortView implements MountedView {
  readonly keys = [["Tab, Enter", "sort by a heading, open a case by its name"]] as const;
  private table: CaseTable | null = null;
  private opened = "";

  constructor(
    private readonly root: HTMLElement,
    private readonly app: App,
  ) {
    app.onChange(() => {
      if (this.opened && this.told() && this.told() !== this.opened) void this.load();
    });
  }

  async load(): Promise<void> {
    this.opened = this.told();
    fill(this.root, h("p", { class: "welcome" }, "Reading the study …"));
    await this.app.attempt(async () => this.build(await this.app.api<Study>("/api/cohort")));
  }

  saved(): unknown {
    return { order: this.table?.now ?? null };
  }

  restore(state: unknown): void {
    const { order } = (state ?? {}) as { order?: Partial<Order> };
    if (typeof order?.by === "string" && typeof order.falling === "boolean") this.table?.sort(order as Order);
  }

  /** What tells one study from another. */
  private told(): string {
    return JSON.stringify(this.app.session["cohort"] ?? "");
  }

  private build(study: Study): void {
    this.table = new CaseTable(study, (one) => void this.open(one), (one) => this.point(one));
    const table = this.table;
    const n = study.cases.length;
    const failed = study.failed.length ? `, ${study.failed.length} without a result` : "";
    fill(
      this.root,
      h(
        "div",
        { class: "cohort" },
        h(
          "div",
          { class: "cohort-head" },
          h("h2", {}, `${n} ${n === 1 ? "case" : "cases"}${failed}`),
          h("p", { class: "note" }, "A line a case, opened by its name. –: not known, or more than the harmonics solved for"),
          button("Save as CSV", () => saveFile("cases.csv", table.csv(), "text/csv"), { kind: "small" }),
        ),
        table.element,
        h(
          "div",
          { class: "pictures" },
          figure("Table 1: how many harmonics hold 85 and 90 % of the power", study.table1.length > 0 && ((wide) => rangesPicture(study.table1, wide))),
          figure("τ: how fast the surface's error falls", study.cases.length > 0 && ((wide) => tausPicture(study, wide))),
        ),
      ),
    );
  }

  private async open(one: StudyCase): Promise<void> {
    const done = await this.app.work(`Opening ${one.name}`, "/api/cohort/open", { key: one.key });
    if (!done) return;
    await this.app.attempt(() => this.app.refreshSession());
    this.app.show("explore");
  }

  /** Shows in the picture which dots are this case's. */
  private point(one: StudyCase | null): void {
    for (const dot of this.root.querySelectorAll<SVGElement>("circle.case"))
      dot.classList.toggle("pointed", one !== null && dot.dataset["key"] === one.key);
  }
}

/** A picture drawn anew for the width it is given; without one, that it is not there yet. */
function figure(title: string, drawn: false | ((wide: number) => SVGElement)): HTMLElement {
  const host = h("div", { class: "picture-host" });
  if (drawn) new ResizeObserver(() => host.clientWidth && fill(host, drawn(host.clientWidth))).observe(host);
  else fill(host, h("p", { class: "note" }, "Not there yet: finish the study."));
  return h("figure", { class: "picture" }, h("figcaption", {}, title), host);
}
