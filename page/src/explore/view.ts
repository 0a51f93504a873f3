/** Explore: a surface, its maps, and what the first k harmonics make of them. */
import { registerView } from "../registry";
import { mountExplore } from "./explore";

registerView({
  id: "explore",
  label: "Explore",
  order: 1,
  about: "The surface and its maps, rebuilt live from any number of manifold harmonics.",
  available: (app) => app.surface !== null,
  mount: mountExplore,
});
