/** Segment: the left atrium out of a contrast CT, looked at in three planes while it is found. */
import { registerView } from "../registry";
import { mountSegment } from "./segment";

registerView({
  id: "segment",
  label: "Segment",
  order: 3,
  about: "The left atrium found in a contrast CT: seed, region, threshold and cutters, with the result in three planes.",
  available: (app) => app.session.views.includes("segment"),
  mount: mountSegment,
});
