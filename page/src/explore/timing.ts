/** How long it takes from a move of the slider to the pixels of the picture, for measurements. */
import type { Explorer } from "./explorer";

/** Moves the slider as a hand would; milliseconds until the pixels can be read. */
export function timedSlide(explorer: Explorer, count: number): Promise<number> {
  const slider = explorer.root.querySelector<HTMLInputElement>("input[type=range]");
  if (!slider) throw new Error("there is no slider");
  return new Promise((done) => {
    const begin = performance.now();
    explorer.stage.drawn = () => {
      if (explorer.root.dataset["count"] !== slider.value) return;
      explorer.stage.drawn = null;
      explorer.stage.finish();
      done(performance.now() - begin);
    };
    slider.value = String(count);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  });
}
