/** The frame around the views: head, tabs, messages, help, saved state, dropped files. */
import { inWords, type Frame, type PageApp, type Tone } from "./app";
import { uploaded, type Stage } from "./connection";
import { droppedFiles, inFolder, isTable, packed, type Dropped } from "./dropping";
import { fill, h, saveFile } from "./dom";
import { MapChoice, openButton } from "./opener";
import { views, type MountedView, type View } from "./registry";
import { button } from "./widgets/panel";

const NOTICE = "For research use only. Not a medical device.";
const STATE_FORMAT = "auricle page state 1";
const KEYS: readonly (readonly [string, string])[] = [
  ["?", "this help"],
  ["← → ↑ ↓", "turn the surface (with Shift: shift it), when the picture is focused"],
  ["+ −", "zoom"],
  ["R", "show the whole surface"],
  ["1 … 8", "standard views: AP, PA, LAO 45, RAO 30, LL, RL, SUP, INF"],
];

interface State {
  readonly format: string;
  readonly surface: string;
  readonly view: string;
  readonly views: Record<string, unknown>;
}

export class PageFrame implements Frame {
  private readonly mounted = new Map<string, { root: HTMLElement; view: MountedView }>();
  private readonly tabs = h("nav", { class: "tabs", "aria-label": "Views" });
  private readonly title = h("h1", { class: "case-name" });
  private readonly stageRoot = h("main", { id: "view", tabindex: -1 });
  private readonly toasts = h("div", { class: "toasts", role: "status", "aria-live": "polite" });
  private readonly spoken = h("div", { class: "unseen", role: "status", "aria-live": "polite" });
  private readonly help = h("dialog", { class: "help", "aria-label": "Help" });
  private readonly maps: MapChoice;
  private readonly opener = openButton((files) => this.dropped(files));
  private current = "";

  constructor(
    private readonly root: HTMLElement,
    private readonly app: PageApp,
  ) {
    this.maps = new MapChoice(app);
    app.frame = this;
  }

  async begin(): Promise<void> {
    fill(this.root, this.head(), this.stageRoot, this.foot(), this.toasts, this.spoken, this.help);
    this.welcome("Opening …");
    this.app.onChange(() => this.refresh());
    this.listen();
    try {
      await this.app.begin();
    } catch (fault) {
      this.welcome(`The case cannot be shown: ${inWords(fault)}.`);
    }
    document.documentElement.dataset["ready"] = "true";
  }

  show(id: string): void {
    const view = views().find((each) => each.id === id && each.available(this.app));
    if (!view) return;
    this.mounted.get(this.current)?.view.hidden?.();
    this.current = id;
    const shown = this.mounted.get(id) ?? this.mount(view);
    fill(this.stageRoot, shown.root);
    this.stageRoot.setAttribute("aria-label", view.label);
    shown.view.shown?.();
    this.refresh();
  }

  toast(words: string, tone: Tone): void {
    const note = h("div", { class: `toast ${tone}` }, words);
    const close = h("button", { type: "button", "aria-label": "Dismiss", onclick: () => note.remove() }, "×");
    note.append(close);
    this.toasts.append(note);
    while (this.toasts.children.length > 4) this.toasts.firstElementChild?.remove();
    if (tone !== "bad") setTimeout(() => note.remove(), 6000);
  }

  announce(words: string): void {
    this.spoken.textContent = words;
  }

  working(title: string, cancel: () => void): { stage(stage: Stage): void; end(): void } {
    const bar = h("progress", { max: 1, "aria-label": title });
    const words = h("p", { class: "note" }, "");
    const box = h(
      "dialog",
      { class: "working", "aria-label": title },
      h("h2", {}, title),
      bar,
      words,
      button("Cancel", cancel),
    );
    box.addEventListener("cancel", cancel);
    this.root.append(box);
    box.showModal();
    return {
      stage: ({ stage, done, total }) => {
        words.textContent = stage;
        if (total > 0) bar.value = done / total;
      },
      end: () => box.remove(),
    };
  }

  private head(): HTMLElement {
    const theme = button("Theme", () => this.app.setTheme(this.app.theme === "dark" ? "light" : "dark"), {
      kind: "small",
      title: "Dark or light",
    });
    const restore = h("input", { type: "file", accept: ".json,application/json", class: "unseen", tabindex: -1, "aria-label": "State file" });
    restore.addEventListener("change", () => {
      if (restore.files?.[0]) void this.restore(restore.files[0]);
      restore.value = "";
    });
    return h(
      "header",
      { class: "head" },
      h("span", { class: "brand" }, "auricle"),
      this.title,
      this.maps.element,
      this.tabs,
      h(
        "div",
        { class: "head-tools" },
        this.opener,
        button("Save", () => this.save(), { kind: "small", title: "Save the state of the page as a JSON file" }),
        button("Restore", () => restore.click(), { kind: "small", title: "Restore a saved state of the page" }),
        restore,
        theme,
        button("?", () => this.showHelp(), { kind: "small", title: "Help and keys" }),
      ),
    );
  }

  private foot(): HTMLElement {
    const where = this.app.mode === "exported" ? "" : " Nothing leaves this machine.";
    return h("footer", { class: "foot" }, NOTICE + where);
  }

  private mount(view: View): { root: HTMLElement; view: MountedView } {
    const root = h("div", { class: `view view-${view.id}` });
    fill(this.stageRoot, root);
    const mounted = { root, view: view.mount(root, this.app) };
    this.mounted.set(view.id, mounted);
    return mounted;
  }

  private welcome(words: string): void {
    fill(this.stageRoot, h("p", { class: "welcome" }, words));
  }

  /** Tabs of what is open; the first of them if none is shown yet. */
  private refresh(): void {
    const offered = views().filter((view) => view.available(this.app));
    this.title.textContent = this.app.session.name;
    document.title = this.app.session.name ? `${this.app.session.name} – auricle` : "auricle";
    this.maps.refresh();
    this.opener.hidden = this.app.mode === "exported";
    const alone = offered.length < 2;
    fill(
      this.tabs,
      ...(alone ? [] : offered).map((view) =>
        h(
          "button",
          {
            type: "button",
            title: view.about,
            "aria-current": view.id === this.current ? "page" : null,
            onclick: () => this.show(view.id),
          },
          view.label,
        ),
      ),
    );
    if (offered.length && !offered.some((view) => view.id === this.current)) this.show(offered[0].id);
  }

  private listen(): void {
    document.addEventListener("keydown", (event) => {
      const typing = (event.target as HTMLElement).closest?.("input:not([type=range]), textarea, select");
      if (event.key === "?" && !typing) this.showHelp();
    });
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      if (event.dataTransfer) void this.app.attempt(async () => this.dropped(await droppedFiles(event.dataTransfer as DataTransfer)));
    });
  }

  private dropped(files: readonly Dropped[]): void {
    if (!files.length) return;
    if (files.length === 1 && files[0].file.name.endsWith(".json") && !inFolder(files[0])) {
      void this.restore(files[0].file);
      return;
    }
    const loose = files.filter((each) => isTable(each) && !inFolder(each));
    if (loose.length === files.length && this.taken(loose)) return;
    if (this.app.mode === "exported")
      this.toast(`${files[0].file.name} cannot be opened in an exported page: use auricle view`, "bad");
    else void this.open(files, loose);
  }

  /** Whether a view, that in sight before all others, has taken tables. */
  private taken(tables: readonly Dropped[]): boolean {
    const files = tables.map(({ file }) => file);
    const shown = this.mounted.get(this.current)?.view;
    if (shown?.dropped?.(files)) return true;
    return [...this.mounted.values()].some(({ view }) => view !== shown && view.dropped?.(files));
  }

  /** Opens dropped files in place of what is open; tables beside one file are then samples on it. */
  private async open(files: readonly Dropped[], tables: readonly Dropped[]): Promise<void> {
    const cases = files.filter((each) => !tables.includes(each));
    const alone = cases.length === 1 && !inFolder(cases[0]) ? cases[0].file : files.length === 1 ? files[0].file : null;
    const title = `Opening ${alone?.name ?? `${files.length} files`}`;
    const opened = alone
      ? await this.app.workWith(title, "/api/open", uploaded(alone))
      : await this.app.workWith(title, "/api/open-dropped", packed(files));
    if (opened === undefined) return;
    await this.app.attempt(() => this.app.refreshSession());
    if (!alone || !tables.length || files.length === 1 || !this.app.session.views.includes("plan")) return;
    this.show("plan");
    this.taken(tables);
  }

  private save(): void {
    const states = [...this.mounted].map(([id, { view }]) => [id, view.saved?.() ?? null]);
    const state: State = {
      format: STATE_FORMAT,
      surface: this.app.session.name,
      view: this.current,
      views: Object.fromEntries(states) as Record<string, unknown>,
    };
    saveFile("auricle-state.json", JSON.stringify(state, null, 2), "application/json");
  }

  private async restore(file: File): Promise<void> {
    await this.app.attempt(async () => {
      const state = parsedState(await file.text(), file.name);
      for (const [id, saved] of Object.entries(state.views)) {
        const view = views().find((each) => each.id === id && each.available(this.app));
        if (!view || saved === null) continue;
        this.show(id);
        this.mounted.get(id)?.view.restore?.(saved);
      }
      this.show(state.view);
      if (state.surface !== this.app.session.name)
        this.toast(`the state was saved with ${state.surface}, another file`, "info");
    });
  }

  private showHelp(): void {
    const view = views().find((each) => each.id === this.current);
    const keys = [...KEYS, ...(this.mounted.get(this.current)?.view.keys ?? [])];
    fill(
      this.help,
      h("h2", {}, view ? view.label : "auricle"),
      h("p", {}, view?.about ?? ""),
      h("dl", { class: "keys" }, ...keys.map(([key, words]) => h("div", {}, h("dt", {}, h("kbd", {}, key)), h("dd", {}, words)))),
      h("p", { class: "notice" }, NOTICE),
      button("Close", () => this.help.close(), { kind: "primary" }),
    );
    if (!this.help.open) this.help.showModal();
  }
}

function parsedState(text: string, name: string): State {
  let state: Partial<State> | null = null;
  try {
    state = JSON.parse(text) as Partial<State>;
  } catch {
    // Said below, with the file's name.
  }
  if (state?.format !== STATE_FORMAT || typeof state.views !== "object" || typeof state.view !== "string")
    throw new Error(`${name} is not a saved state of this page`);
  return state as State;
}
