/** Tables of samples: which columns are meant is asked, never guessed in silence. */
import { fill, h } from "../dom";
import { button, Choice } from "../widgets/panel";

const LOOKED_AT = 65_536;

export interface Columns {
  readonly x: string;
  readonly y: string;
  readonly z: string;
  readonly value: string;
  readonly noise: string;
}

/** Headings of a table: its first line that is not a comment. */
export async function headings(file: File): Promise<string[]> {
  const text = (await file.slice(0, LOOKED_AT).text()).replace(/^\uFEFF/, "");
  const line = text.split(/\r\n|\r|\n/).find((each) => each.trim() && !each.trimStart().startsWith("#")) ?? "";
  const count = (letter: string): number => line.split(letter).length - 1;
  const delimiter = [";", "\t", ","].reduce((most, each) => (count(each) > count(most) ? each : most));
  return line.split(delimiter).map((each) => each.trim().replace(/^"(.*)"$/, "$1"));
}

/** Asks which columns are meant; null if the user thinks better of it. */
export function askColumns(file: File, names: readonly string[]): Promise<Columns | null> {
  const axes = ["x", "y", "z"] as const;
  const options = names.map((name) => [name, name] as const);
  const like = (pattern: RegExp): string => names.find((name) => pattern.test(name)) ?? "";
  const choices = new Map<string, Choice>();
  const chosen = new Set<string>();
  for (const axis of axes) {
    const guess = like(new RegExp(`^${axis}([ _[(].*)?$`, "i")) || names[axes.indexOf(axis)] || "";
    chosen.add(guess);
    choices.set(axis, offered(`Position ${axis}`, options, guess));
  }
  const likely = like(/^(lat|local_activation|value|bipolar|unipolar)/i);
  const free = names.find((name) => !chosen.has(name) && !/^(point|id|number|included|projected|n_merged)/i.test(name));
  choices.set("value", offered("Value", options, likely || free || names[names.length - 1]));
  choices.set("noise", offered("Its deviation", [["", "not in the table"], ...options], ""));
  const dialog = h("dialog", { class: "columns", "aria-label": "Columns of the table" });
  return new Promise((resolve) => {
    const end = (columns: Columns | null): void => {
      resolve(columns);
      dialog.remove();
    };
    const accept = (): void =>
      end(Object.fromEntries([...choices].map(([name, choice]) => [name, choice.value])) as unknown as Columns);
    fill(
      dialog,
      h("h2", {}, "Which columns are meant?"),
      h("p", { class: "note" }, `${file.name}: positions in the frame of the surface.`),
      ...[...choices.values()].map((choice) => choice.element),
      h("div", { class: "buttons" }, button("Load", accept, { kind: "primary" }), button("Cancel", () => end(null))),
    );
    dialog.addEventListener("cancel", () => end(null));
    document.body.append(dialog);
    dialog.showModal();
  });
}

function offered(label: string, options: readonly (readonly [string, string])[], guess: string): Choice {
  const choice = new Choice(label, () => undefined);
  choice.setOptions(options, guess);
  return choice;
}
