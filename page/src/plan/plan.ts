/** Builds the view and keeps it with the surface that is open. */
import type { App } from "../app";
import type { MountedView } from "../registry";
import { DIRECTIONS } from "../scene/directions";
import type { Choices } from "./wanted";
import { Planner } from "./planner";

export function mountPlan(root: HTMLElement, app: App): MountedView {
  let planner: Planner | null = null;
  let restoring: unknown = null;
  /** A table that came before the view was ready for it. */
  let waiting: File | null = null;
  app.onSurface((surface) => {
    planner?.dispose();
    planner = null;
    void app.attempt(async () => {
      const choices = await app.api<Choices>("/api/plan/choices");
      planner = new Planner(root, app, surface, choices);
      await planner.live.refresh();
      if (restoring) planner.restore(restoring);
      restoring = null;
      if (waiting) void planner.loadTable(waiting);
      waiting = null;
      root.dataset["ready"] = "true";
    });
  });
  // For tests and measurements.
  Object.assign(window, { plan: { get planner() { return planner; } } });
  root.addEventListener("keydown", (event) => {
    const typing = (event.target as HTMLElement).matches("input:not([type=range]), select, textarea");
    if (!planner || typing || event.altKey) return;
    if (keyed(planner, event)) event.preventDefault();
  });
  return {
    shown: () => planner?.pictures.stage.draw(),
    saved: () => planner?.saved() ?? null,
    restore: (state) => {
      if (planner) planner.restore(state);
      else restoring = state;
    },
    dropped: (files) => {
      const table = files.find((file) => /\.(csv|txt|tsv)$/i.test(file.name));
      if (!table || !app.surface) return false;
      app.show("plan");
      if (planner) void planner.loadTable(table);
      else waiting = table;
      return true;
    },
    keys: [
      ["Ctrl Z", "take back the last sample"],
      ["Ctrl Y", "take it again"],
      ["N", "take the proposed next point"],
    ],
  };
}

function keyed(planner: Planner, event: KeyboardEvent): boolean {
  const key = event.key.toLowerCase();
  if (event.ctrlKey || event.metaKey) {
    if (key === "z" && !event.shiftKey) planner.undo();
    else if (key === "y" || key === "z") planner.redo();
    else return false;
    return true;
  }
  const view = DIRECTIONS[Number(event.key) - 1];
  if (view) planner.pictures.stage.look(view.name);
  else if (key === "n") void planner.takeNext();
  else return false;
  return true;
}
