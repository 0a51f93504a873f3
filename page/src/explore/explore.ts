/** Builds the view and keeps it with the surface that is open. */
import type { App } from "../app";
import type { MountedView } from "../registry";
import { DIRECTIONS } from "../scene/directions";
import { Explorer } from "./explorer";
import { timedSlide } from "./timing";

export function mountExplore(root: HTMLElement, app: App): MountedView {
  let explorer: Explorer | null = null;
  app.onSurface((surface) => {
    explorer?.dispose();
    explorer = new Explorer(root, app, surface);
  });
  // For tests and measurements: what is drawn, as numbers.
  Object.assign(window, {
    explore: {
      current: () => explorer,
      pixels: () => explorer?.stage.pixels(),
      slide: (count: number) => explorer && timedSlide(explorer, count),
    },
  });
  root.addEventListener("keydown", (event) => {
    const typing = (event.target as HTMLElement).matches("input, select, textarea");
    if (!explorer || typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const view = DIRECTIONS[Number(event.key) - 1];
    if (view) explorer.stage.look(view.name);
    else if (event.key === "[") explorer.setCount(explorer.state.count - 1);
    else if (event.key === "]") explorer.setCount(explorer.state.count + 1);
  });
  return {
    shown: () => explorer?.stage.draw(),
    saved: () => explorer?.saved() ?? null,
    restore: (state) => explorer?.restore(state),
    keys: [["[ ]", "one harmonic fewer or more (or the arrow keys on the slider)"]],
  };
}
