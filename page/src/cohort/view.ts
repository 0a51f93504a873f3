/** Cohort: the cases of a study side by side, and what the study says of them together. */
import { registerView } from "../registry";
import { mountCohort } from "./cohort";

registerView({
  id: "cohort",
  label: "Cohort",
  order: 4,
  about: "The cases of a study: their numbers in one table, Table 1 and the decay constants as pictures.",
  available: (app) => app.session.views.includes("cohort"),
  mount: mountCohort,
});
