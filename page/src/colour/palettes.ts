/** Palettes: colours at evenly spaced places, between which one goes in straight lines.
 *
 * The stretches are those of the report (auricle.report.palettes), so a map looks the same there.
 */
import type { PaletteName } from "./scale";

const STOPS: Record<PaletteName, string> = {
  viridis:
    "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d 2f6b8e 2c728e " +
    "297a8e 26828e 23898e 21918c 1f988b 1fa088 22a785 28ae80 32b67a 3fbc73 4ec36b 5ec962 70cf57 " +
    "84d44b 98d83e addc30 c2df23 d8e219 ece51b fde725",
  cividis:
    "00224e 00285b 002e6a 053371 1a386f 273e6e 32436d 3b496c 434e6c 4b546c 535a6d 5a5f6e 61656f " +
    "686a71 6f7073 767676 7d7c78 848279 8c8878 938e78 9b9476 a39a74 aba072 b4a76f bcae6c c4b468 " +
    "cdbb63 d5c25e dec958 e7d150 f0d846 f9e03a fee838",
  classic:
    "ff0000 ff2300 ff4700 ff6a00 ff8e00 ffb700 ffdb00 faf900 ddff00 b3ff00 90ff00 6cff00 49ff00 " +
    "20ff00 04ff08 00ff27 00ff4b 00ff74 00ff97 00ffbb 00ffde 00f6ff 00d3ff 00afff 008cff 0063ff " +
    "003fff 001cff 0800ff 2b00ff 5400ff 7800ff 9b00ff",
  cyclic:
    "e2d9e2 d7d7dd c4ced4 acc2cc 95b5c7 81a6c3 7297c1 6887be 6276ba 5f64b5 5e51ad 5d3da1 592a8f " +
    "511b77 45135c 381145 2f1436 3a113a 4a1342 5f174a 741e4f 872750 983550 a64550 b25652 bb6958 " +
    "c27c63 c89073 cca389 d1b6a3 d8c7be dfd4d6 e2d9e2",
  diverging:
    "10457e 185493 1f63a8 2a71b2 337eb8 3e8cbf 4c99c6 62a7ce 7bb6d6 90c4dd a2cde3 b6d7e8 c7e0ed " +
    "d5e7f1 e1edf3 ecf2f5 f6f7f7 f9efe9 fae7dc fcdecd fcd3bc f9c4a9 f6b394 f3a481 eb9172 e27b62 " +
    "da6853 d05548 c53e3d bb2a34 ae172a 991027 840924",
  distance:
    "ffffcc fffbc2 fff7b7 fff3ae ffeea3 ffe998 ffe58f fee084 fedb7b fed470 feca66 fec15d feb852 " +
    "feaf4b fea647 fd9d43 fd953f fd8a3b fd7c37 fc6c33 fc5d2e fc4f2a f64227 f13624 ea2920 e41c1d " +
    "dc151e d30f20 ca0923 c10325 b40026 a60026 970026",
};

export const PALETTE_LABELS: Record<PaletteName, string> = {
  viridis: "Perceptual (viridis)",
  cividis: "Perceptual (cividis)",
  classic: "EP classic (red to purple)",
  cyclic: "Cyclic (activation times)",
  diverging: "Diverging (signed)",
  distance: "Distance (light to red)",
};

const stops = (palette: PaletteName): number[][] =>
  STOPS[palette].split(" ").map((each) => [0, 2, 4].map((at) => parseInt(each.slice(at, at + 2), 16)));

/** Colour at `place` of a palette, 0 to 1, as three numbers 0 to 255. */
export function colourAt(palette: PaletteName, place: number): [number, number, number] {
  const all = stops(palette);
  const at = Math.min(Math.max(place, 0), 1) * (all.length - 1);
  const below = Math.min(Math.floor(at), all.length - 2);
  return [0, 1, 2].map((i) => all[below][i] + (all[below + 1][i] - all[below][i]) * (at - below)) as [
    number,
    number,
    number,
  ];
}

/** `count` colours as bytes RGBA; with bands, those of the middles of the bands. */
export function colourTable(palette: PaletteName, bands: number, count = 256): Uint8Array {
  const table = new Uint8Array(4 * count);
  for (let i = 0; i < count; i += 1) {
    const place = i / (count - 1);
    const shown = bands ? (Math.min(Math.floor(place * bands), bands - 1) + 0.5) / bands : place;
    table.set([...colourAt(palette, shown).map(Math.round), 255], 4 * i);
  }
  return table;
}

/** Colour as CSS has it. */
export function cssColour([red, green, blue]: readonly number[]): string {
  return `rgb(${Math.round(red)} ${Math.round(green)} ${Math.round(blue)})`;
}
