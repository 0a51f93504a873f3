/** The counter: enough, or not yet and why. */
import { fill, h } from "../dom";
import { percent } from "../words";
import type { Judgement, LiveState } from "./live";

export class VerdictBox {
  readonly element = h("section", { class: "section verdict", "aria-label": "Enough or not yet", "aria-live": "polite" });

  show(state: LiveState | null, judgement: Judgement | null): void {
    const taken = state?.n_taken ?? 0;
    const judged = judgement && judgement.n_taken > 0 ? judgement : null;
    const current = judged?.n_taken === taken;
    const error = current ? judged.predicted_nrmse : state?.predicted_nrmse;
    const enough = taken > 0 && judged !== null && judged.enough;
    this.element.dataset["enough"] = String(enough);
    const head = !taken ? "No sample yet" : !judged ? "Judging …" : judged.enough ? "Enough" : "Not yet";
    const reasons = taken && judged && !judged.enough ? judged.reasons : [];
    fill(
      this.element,
      h("p", { class: "verdict-head" }, h("strong", { "data-fact": "verdict" }, head), taken && judged && !current ? ` after ${judged.n_taken} samples` : ""),
      !taken && h("p", { class: "note" }, "Click on the surface to take one, load a table, or play back a study."),
      reasons.length ? h("ul", { class: "why" }, ...reasons.map((reason) => h("li", {}, reason))) : null,
      h(
        "dl",
        { class: "counts" },
        count("samples", String(taken), "taken"),
        count("predicted error", error === null || error === undefined ? "–" : percent(error), "predicted"),
        count("target", state ? percent(state.target_nrmse) : "–", "target"),
      ),
    );
  }
}

function count(name: string, value: string, fact: string): HTMLElement {
  return h("div", {}, h("dt", {}, name), h("dd", { "data-fact": fact }, value));
}
