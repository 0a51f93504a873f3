/** Pictures and tables to keep. */
import { cssColour } from "../colour/palettes";
import { UNKNOWN } from "../colour/scale";
import { csvText, h, saveFile } from "../dom";
import type { Stage } from "../scene/stage";
import type { SurfaceCase } from "../surfacecase";
import { powerShare } from "./numbers";

/** A name for a file, from that of the case. */
export function fileStem(surface: SurfaceCase): string {
  const plain = surface.name.replace(/\.[a-z0-9]{2,5}$/i, "").replace(/[^\p{L}\p{N}._-]+/gu, "_");
  return plain.slice(0, 60) || "surface";
}

/** Positions, values as read and as rebuilt, one vertex a row. */
export function saveVertices(
  surface: SurfaceCase,
  count: number,
  shape: Float32Array,
  map: { name: string; unit: string; values: Float32Array; rebuilt: Float64Array | null } | null,
): void {
  const label = map && (map.unit ? `${map.name}_${map.unit}` : map.name);
  const head = ["vertex", "x_mm", "y_mm", "z_mm", `x_${count}_harmonics_mm`, `y_${count}_harmonics_mm`, `z_${count}_harmonics_mm`];
  if (label) head.push(label, `${label}_${count}_harmonics`);
  const rows: (string | number)[][] = [head];
  for (let i = 0; i < surface.nVertices; i += 1) {
    const row: number[] = [i, ...surface.positions.subarray(3 * i, 3 * i + 3), ...shape.subarray(3 * i, 3 * i + 3)];
    if (map) row.push(map.values[i], map.rebuilt ? map.rebuilt[i] : NaN);
    rows.push(row);
  }
  saveFile(`${fileStem(surface)}_vertices.csv`, csvText(rows), "text/csv");
}

/** Power and error of every signal, one harmonic a row. */
export function saveSpectrum(surface: SurfaceCase): void {
  const head: (string | number)[] = ["harmonic", "eigenvalue_per_mm2"];
  for (const signal of surface.signals) {
    const unit = signal.errorUnit ? `_${signal.errorUnit}` : "";
    head.push(`${signal.name}_power_share`, `${signal.name}_cumulative_share`, `${signal.name}_rms_error${unit}`);
  }
  const shares = surface.signals.map(powerShare);
  const rows = Array.from(surface.eigenvalues, (eigenvalue, i) => [
    i + 1,
    eigenvalue,
    ...surface.signals.flatMap((signal, place) => [shares[place][i], signal.share[i], signal.error[i]]),
  ]);
  saveFile(`${fileStem(surface)}_spectrum.csv`, csvText([head, ...rows]), "text/csv");
}

/** The pictures with their captions, and the colour bars beside them that say what colours mean. */
export function savePicture(stage: Stage, surface: SurfaceCase, words: readonly string[], bars: readonly Element[]): void {
  const style = getComputedStyle(document.documentElement);
  const ground = style.getPropertyValue("--stage").trim();
  const drawn = stage.snapshot(ground);
  const inside = stage.element.getBoundingClientRect();
  const ratio = drawn.width / Math.max(inside.width, 1);
  const boxes = [inside, ...bars.map((bar) => bar.getBoundingClientRect())];
  const [left, top] = [Math.min(...boxes.map((box) => box.left)), Math.min(...boxes.map((box) => box.top))];
  const [right, bottom] = [Math.max(...boxes.map((box) => box.right)), Math.max(...boxes.map((box) => box.bottom))];
  const picture = h("canvas", { width: Math.round((right - left) * ratio), height: Math.round((bottom - top) * ratio) });
  const pen = picture.getContext("2d") as CanvasRenderingContext2D;
  pen.scale(ratio, ratio);
  pen.fillStyle = ground;
  pen.fillRect(0, 0, right - left, bottom - top);
  pen.translate(-left, -top);
  pen.drawImage(drawn, inside.left, inside.top, inside.width, inside.height);
  pen.fillStyle = style.getPropertyValue("--ink").trim();
  pen.font = "600 13px system-ui, sans-serif";
  stage.captionPlaces().forEach(({ text, x, y }) => pen.fillText(text, inside.left + x, inside.top + y));
  pen.font = "12px system-ui, sans-serif";
  words.forEach((line, i) => pen.fillText(line, left + 12, bottom - 10 - 16 * (words.length - 1 - i)));
  void Promise.all(bars.map((bar) => drawBar(pen, bar))).then(() => {
    picture.toBlob((blob) => blob && saveFile(`${fileStem(surface)}.png`, blob, "image/png"));
  });
}

/** Draws a colour bar where it stands on the page; its colours are spelt out for the picture. */
async function drawBar(pen: CanvasRenderingContext2D, bar: Element): Promise<void> {
  const drawing = bar.querySelector("svg[role=img]");
  if (!drawing) return;
  const copy = drawing.cloneNode(true) as SVGElement;
  const ink = getComputedStyle(bar).color;
  for (const text of copy.querySelectorAll("text")) {
    text.setAttribute("fill", ink);
    text.setAttribute("font-family", "system-ui, sans-serif");
    text.setAttribute("font-size", "11");
  }
  for (const line of copy.querySelectorAll("line")) line.setAttribute("stroke", ink);
  copy.querySelector(".bar-frame")?.setAttribute("fill", "none");
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const image = h("img", {}) as HTMLImageElement;
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
  await image.decode();
  const box = drawing.getBoundingClientRect();
  pen.drawImage(image, box.left, box.top, box.width, box.height);
  for (const words of bar.querySelectorAll(".bar-title, .unit, .bar-unknown")) drawWords(pen, words);
  const grey = bar.querySelector(".bar-unknown rect")?.getBoundingClientRect();
  if (!grey) return;
  pen.save();
  pen.fillStyle = cssColour(UNKNOWN);
  pen.fillRect(grey.left, grey.top, grey.width, grey.height);
  pen.restore();
}

/** Draws the words of an element line by line, as the page has broken them. */
function drawWords(pen: CanvasRenderingContext2D, element: Element): void {
  const { font } = getComputedStyle(element);
  pen.font = font;
  const text = [...element.childNodes].find((node) => node.nodeType === Node.TEXT_NODE);
  const range = document.createRange();
  for (const { 0: word, index } of (text?.textContent ?? "").matchAll(/\S+/g)) {
    range.setStart(text as Node, index);
    range.setEnd(text as Node, index + word.length);
    const place = range.getBoundingClientRect();
    pen.fillText(word, place.left, place.bottom - 0.22 * place.height);
  }
}
