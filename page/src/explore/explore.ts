/** Builds the view. */
import type { App } from "../app";
import { scaleOf } from "../colour/scale";
import { h } from "../dom";
import type { MountedView } from "../registry";
import { Stage } from "../scene/stage";

export function mountExplore(root: HTMLElement, app: App): MountedView {
  const host = h("div", { class: "stage-host" });
  root.append(host);
  const stage = new Stage(host, "The surface");
  const pane = stage.addPane("");
  app.onSurface((surface) => {
    stage.setSpace(surface.space);
    pane.setSurface(surface.positions, surface.faces);
    const field = surface.fields[0];
    if (field) pane.setValues(field.values, scaleOf(field.values, "viridis"));
    stage.fit(surface.positions);
  });
  return { shown: () => stage.draw() };
}
