/** The bar of standard views above a picture. */
import { h } from "../dom";
import { DIRECTIONS } from "../scene/directions";
import { button } from "./panel";

export class ViewBar {
  readonly element: HTMLElement;

  /** `look` is told a view's name; `reset` that all of the surface is wanted; `about` says what one sees. */
  constructor(space: string, about: string, look: (name: string) => void, reset: () => void) {
    const lps = space === "LPS";
    const buttons = DIRECTIONS.map(({ name, seenFrom }, place) =>
      button(name, () => look(name), {
        kind: "small",
        title: `${lps ? `From ${seenFrom}` : `As ${name} if the file's axes are LPS, which it does not say`} (key ${place + 1})`,
      }),
    );
    const note = h("span", { class: "space-note" }, lps ? "" : "Axes unknown: views by the file's own x, y, z");
    this.element = h(
      "div",
      { class: "view-bar", role: "toolbar", "aria-label": "Views" },
      ...buttons,
      button("Fit", reset, { kind: "small", title: "Show the whole surface (key R on the picture)" }),
      note,
      h("span", { class: "view-about" }, about),
    );
  }
}
