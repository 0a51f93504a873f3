/** The three planes in one picture to keep. */
import { h, saveFile } from "../dom";
import type { SlicePlane } from "./plane";

const [LINE, EDGE] = [22, 8];

/** Saves the planes side by side with what they are; no name of the CT is written. */
export function savePlanes(planes: readonly SlicePlane[], words: string): void {
  const ratio = Math.max(devicePixelRatio, 1);
  const line = LINE * ratio;
  const width = planes.reduce((sum, { canvas }) => sum + canvas.width, 0);
  const height = Math.max(...planes.map(({ canvas }) => canvas.height));
  const picture = h("canvas", { width, height: height + 2 * line });
  const pen = picture.getContext("2d") as CanvasRenderingContext2D;
  pen.fillStyle = "#000";
  pen.fillRect(0, 0, picture.width, picture.height);
  pen.fillStyle = "#fff";
  pen.font = `${13 * ratio}px system-ui, sans-serif`;
  pen.textBaseline = "middle";
  let left = 0;
  for (const { canvas, caption } of planes) {
    pen.drawImage(canvas, left, line);
    pen.fillText(caption, left + EDGE * ratio, line / 2);
    left += canvas.width;
  }
  pen.fillText(words, EDGE * ratio, height + 1.5 * line);
  picture.toBlob((blob) => blob && saveFile("slices.png", blob, "image/png"));
}
