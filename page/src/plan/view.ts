/** Plan and map: how many points, where, and whether those taken are enough. */
import { registerView } from "../registry";
import { mountPlan } from "./plan";

registerView({
  id: "plan",
  label: "Plan and map",
  order: 2,
  about:
    "How many points a kind of map needs on this surface, and where. Take them by clicking, or play " +
    "back a study: the map, its uncertainty and the next point follow, and the page says when it is enough.",
  available: (app) => app.mode === "served" && app.session.views.includes("plan"),
  mount: mountPlan,
});
