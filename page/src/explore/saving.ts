/** Pictures and tables to keep. */
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

/** The pictures with their captions and what the colours mean. */
export function savePicture(stage: Stage, surface: SurfaceCase, words: readonly string[], bars: readonly Element[]): void {
  const style = getComputedStyle(document.documentElement);
  const ground = style.getPropertyValue("--stage").trim();
  const picture = stage.snapshot(ground);
  const ratio = picture.width / Math.max(stage.element.clientWidth, 1);
  const pen = picture.getContext("2d") as CanvasRenderingContext2D;
  pen.fillStyle = style.getPropertyValue("--ink").trim();
  pen.font = `600 ${13 * ratio}px system-ui, sans-serif`;
  stage.captionPlaces().forEach(({ text, x, y }) => pen.fillText(text, x * ratio, y * ratio));
  pen.font = `${12 * ratio}px system-ui, sans-serif`;
  words.forEach((line, i) => pen.fillText(line, 12 * ratio, picture.height - (10 + 16 * (words.length - 1 - i)) * ratio));
  const base = stage.element.getBoundingClientRect();
  void Promise.all(bars.map((bar) => drawBar(pen, bar, base, ratio))).then(() => {
    picture.toBlob((blob) => blob && saveFile(`${fileStem(surface)}.png`, blob, "image/png"));
  });
}

/** Draws a colour bar of the page where it stands; its colours are spelt out for the picture. */
async function drawBar(pen: CanvasRenderingContext2D, bar: Element, base: DOMRect, ratio: number): Promise<void> {
  const drawing = bar.querySelector("svg[role=img]");
  if (!drawing) return;
  const copy = drawing.cloneNode(true) as SVGElement;
  const ink = getComputedStyle(bar).color;
  for (const text of copy.querySelectorAll("text")) {
    text.setAttribute("fill", ink);
    text.setAttribute("font", "11px sans-serif");
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
  pen.drawImage(image, (box.left - base.left) * ratio, (box.top - base.top) * ratio, box.width * ratio, box.height * ratio);
  const title = bar.querySelector("figcaption");
  if (!title) return;
  const place = title.getBoundingClientRect();
  pen.font = `${12 * ratio}px system-ui, sans-serif`;
  pen.fillText(title.textContent ?? "", (place.left - base.left) * ratio, (place.bottom - base.top - 3) * ratio);
}
