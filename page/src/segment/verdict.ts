/** What came out: volume, verdict, and every reason for doubt by its name. */
import { fill, h } from "../dom";
import { button } from "../widgets/panel";
import type { Vec3 } from "./lattice";
import type { Reason, TrialDocument } from "./trials";

const WORDS = {
  ok: "nothing speaks against it",
  check: "look before using it",
  refused: "no atrium was found",
} as const;

const PREVIEW: Vec3 = [255, 210, 63];
const SKETCH: Vec3 = [92, 184, 209];

/** The colour a trial has in the slices. */
export function colourOf(document: TrialDocument | null): Vec3 {
  return document?.sketch ? SKETCH : PREVIEW;
}

export class VerdictPanel {
  readonly element: HTMLElement;
  private readonly volume = h("output", { class: "volume", "data-fact": "volume" }, "–");
  private readonly kind = h("span", { class: "volume-kind", "data-fact": "kind" });
  /** In the colour the atrium has in the slices. */
  private readonly swatch = h("span", { class: "volume-swatch", "aria-hidden": "true", hidden: true });
  private readonly chip = h("p", { class: "verdict", "data-fact": "verdict" });
  private readonly reasons = h("ul", { class: "reasons" });
  private readonly looked = h("input", { type: "checkbox", id: "looked" });
  private readonly looking = h(
    "p",
    { class: "looking", hidden: true },
    this.looked,
    h("label", { for: "looked" }, "I have looked at each of them"),
  );
  private shown = "";

  constructor(
    private readonly goTo: (place: Vec3) => void,
    lookedAt: () => void,
  ) {
    this.looked.addEventListener("change", lookedAt);
    this.element = h(
      "div",
      { class: "verdict-panel" },
      h("p", { class: "volume-line" }, this.volume, this.swatch, this.kind),
      this.chip,
      this.reasons,
      this.looking,
    );
  }

  /** Whether every reason that stops has been looked at, or there is none. */
  get cleared(): boolean {
    return Boolean(this.looking.hidden) || this.looked.checked;
  }

  show(document: TrialDocument | null, kind: string): void {
    const { volume_ml } = document ?? {};
    this.volume.textContent = volume_ml === undefined ? "– ml" : `${volume_ml.toFixed(1)} ml`;
    this.kind.textContent = kind;
    this.swatch.hidden = volume_ml === undefined;
    this.swatch.style.background = `rgb(${colourOf(document).join(",")})`;
    const key = document ? `${document.key} ${document.verdict}` : "";
    if (key === this.shown) return;
    this.shown = key;
    this.chip.hidden = !document;
    this.chip.className = `verdict ${document?.verdict ?? ""}`;
    if (document) fill(this.chip, h("strong", {}, document.verdict), `: ${WORDS[document.verdict]}`);
    fill(this.reasons, ...(document?.reasons ?? []).map((reason) => this.reason(reason)));
    this.looked.checked = false;
    this.looking.hidden = document?.sketch !== false || document.verdict !== "check";
  }

  private reason(reason: Reason): HTMLElement {
    const place = reason.position_mm;
    return h(
      "li",
      { class: reason.stops ? "stops" : "told", "data-code": reason.code },
      h("strong", {}, reason.code.replaceAll("_", " ")),
      h("span", {}, reason.cause),
      h("span", { class: "remedy" }, reason.remedy),
      place && button("Go there", () => this.goTo(place), { kind: "small" }),
    );
  }
}
