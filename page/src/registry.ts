/** The views of the page. Each `src/<name>/view.ts` registers itself; main.ts finds them. */
import type { App } from "./app";

export interface View {
  /** Short name, part of the page's address. */
  readonly id: string;
  /** Words on its tab. */
  readonly label: string;
  /** Place among the tabs, from left to right. */
  readonly order: number;
  /** One sentence: what one sees and does here. */
  readonly about: string;
  /** Whether it is offered for what is open. */
  available(app: App): boolean;
  /** Builds the view in `root`, once, when it is first shown. */
  mount(root: HTMLElement, app: App): MountedView;
}

export interface MountedView {
  /** Called each time the view comes into sight. */
  shown?(): void;
  /** Called each time it leaves sight. */
  hidden?(): void;
  /** What the saved state of the page keeps of this view, ready for JSON. */
  saved?(): unknown;
  /** Takes back what `saved` gave; anything else must be refused by throwing an Error. */
  restore?(state: unknown): void;
  /** Files dropped on the page; true if they are taken. */
  dropped?(files: readonly File[]): boolean;
  /** Keys of this view, for the help. */
  readonly keys?: readonly (readonly [key: string, words: string])[];
}

const registered: View[] = [];

export function registerView(view: View): void {
  registered.push(view);
  registered.sort((one, other) => one.order - other.order);
}

export function views(): readonly View[] {
  return registered;
}
