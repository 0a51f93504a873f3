/** Opening by hand: files or a folder chosen in a dialog, and which map of an export is shown. */
import type { App } from "./app";
import { chosenFiles, type Dropped } from "./dropping";
import { fill, h } from "./dom";
import { button } from "./widgets/panel";

interface MapInfo {
  readonly number: number;
  readonly name: string;
  readonly n_points: number;
  readonly opens: boolean;
}

interface StudyInfo {
  readonly system: string;
  readonly chosen: number;
  readonly maps: readonly MapInfo[];
}

/** A button that asks whether files or a folder are meant; `chosen` gets what was picked. */
export function openButton(chosen: (files: readonly Dropped[]) => void): HTMLElement {
  const dialog = h("dialog", { class: "opening", "aria-label": "Open" });
  const picker = (label: string, folder: boolean): HTMLInputElement => {
    const input = h("input", { type: "file", multiple: true, webkitdirectory: folder, class: "unseen", tabindex: -1, "aria-label": label });
    input.addEventListener("change", () => {
      const files = chosenFiles(input.files ?? []);
      input.value = "";
      dialog.close();
      if (files.length) chosen(files);
    });
    return input;
  };
  const [files, folder] = [picker("Files to open", false), picker("Folder to open", true)];
  fill(
    dialog,
    h("h2", {}, "Open"),
    h("p", {}, "A surface, a CT, an export of a mapping system, or the folder of a result, in place of what is open. You can also drop them anywhere on the page."),
    h("div", { class: "buttons" }, button("Files …", () => files.click(), { kind: "primary" }), button("Folder …", () => folder.click()), button("Cancel", () => dialog.close())),
    files,
    folder,
  );
  const open = button("Open …", () => dialog.showModal(), { kind: "small", title: "Open a file or a folder in place of this one" });
  return h("span", {}, open, dialog);
}

/** The maps of an export to choose from; hidden where there is no choice. */
export class MapChoice {
  private readonly select = h("select", { "aria-label": "Map of the export" });
  readonly element = h("span", { class: "map-choice", hidden: true }, this.select);

  constructor(private readonly app: App) {
    this.select.addEventListener("change", () => void this.choose(Number(this.select.value)));
  }

  /** Shows what the session has open. */
  refresh(): void {
    const study = this.app.session["study"] as StudyInfo | undefined;
    this.element.hidden = (study?.maps.filter(({ opens }) => opens).length ?? 0) < 2;
    if (!study) return;
    const options = study.maps.map(({ number, name, n_points, opens }) =>
      h("option", { value: number, disabled: !opens }, `${number}: ${name}, ${opens ? `${n_points} points` : "no surface"}`),
    );
    fill(this.select, ...options);
    this.select.value = String(study.chosen);
  }

  private async choose(number: number): Promise<void> {
    const opened = await this.app.work("Opening another map", "/api/map", { number });
    if (opened !== undefined) await this.app.attempt(() => this.app.refreshSession());
    this.refresh();
  }
}
