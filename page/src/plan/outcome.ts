/** What a plan says: how many points, how dense, with which error, and for other errors. */
import { fill, h } from "../dom";
import { Facts } from "../widgets/panel";
import { figures, percent } from "../words";

interface Recommendation {
  readonly target_nrmse: number;
  readonly n_samples: number | null;
  readonly density_per_cm2: number | null;
  readonly spacing_mm: number | null;
  readonly wavelength_mm: number | null;
  readonly predicted_nrmse: number;
  readonly unreachable: string | null;
}

/** The parts of `auricle plan`'s result.json that are shown. */
export interface PlanDocument {
  readonly wanted: string;
  readonly n_samples: number | null;
  readonly n_existing: number;
  readonly n_planned: number;
  readonly n_placements: number | null;
  readonly recommendation: Recommendation;
  readonly by_target: readonly (Recommendation & { readonly acquisition: string })[];
  readonly plan: { readonly predicted_nrmse_least_squares: number; readonly coverage: { readonly radius_mm: number } } | null;
  readonly remarks: readonly string[];
}

export function showOutcome(into: HTMLElement, plan: PlanDocument | null): void {
  if (!plan) {
    fill(into);
    return;
  }
  const found = plan.recommendation;
  const facts = new Facts();
  if (found.spacing_mm !== null) facts.set("Between neighbours", `${figures(found.spacing_mm)} mm`, "spacing");
  if (found.density_per_cm2 !== null) facts.set("Density", `${figures(found.density_per_cm2)} per cm²`, "density");
  if (found.wavelength_mm !== null) facts.set("Finest wavelength", `${figures(found.wavelength_mm)} mm`, "wavelength");
  facts.set("Predicted error", percent(found.predicted_nrmse), "plan-error");
  if (plan.n_existing) facts.set("Taken already", String(plan.n_existing), "existing");
  if (plan.n_planned) facts.set("Shown on the surface", `${plan.n_planned} points`, "planned");
  if (plan.n_placements !== null) facts.set("Placements", String(plan.n_placements), "placements");
  if (plan.plan) facts.set("Farthest from a point", `${figures(plan.plan.coverage.radius_mm)} mm`, "radius");
  const needed =
    found.n_samples === null
      ? h("p", { class: "needed none" }, `No number of points suffices: ${found.unreachable ?? "solve for more harmonics"}.`)
      : h("p", { class: "needed" }, h("strong", { "data-fact": "needed" }, String(found.n_samples)), ` points for an error of ${percent(found.target_nrmse)}`);
  fill(into, needed, h("p", { class: "note" }, plan.wanted), facts.element, otherErrors(plan));
}

function otherErrors(plan: PlanDocument): HTMLElement {
  const targets = [...new Set(plan.by_target.map((each) => each.target_nrmse))].sort((one, other) => one - other);
  const cell = (target: number, how: string): HTMLElement => {
    const found = plan.by_target.find((each) => each.target_nrmse === target && each.acquisition === how);
    return h("td", {}, found?.n_samples ?? "none");
  };
  return h(
    "table",
    { class: "targets" },
    h("caption", {}, "Points for other errors"),
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Error"), h("th", { scope: "col" }, "as planned"), h("th", { scope: "col" }, "wherever"))),
    h("tbody", {}, ...targets.map((target) => h("tr", {}, h("th", { scope: "row" }, percent(target)), cell(target, "planned"), cell(target, "unplanned")))),
  );
}
