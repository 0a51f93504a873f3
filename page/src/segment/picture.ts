/** The pixels of one slice: grey values of the CT, the atrium's tint and its edge over them. */
import type { Lattice, Vec3 } from "./lattice";
import type { Orientation } from "./orientation";

/** Which part of the slice a picture shows. */
export interface Window {
  /** The coordinate one looks along, mm. */
  readonly level: number;
  /** The middle of the picture in the plane's two axes, mm. */
  readonly middle: readonly [number, number];
  /** Millimetres a pixel. */
  readonly scale: number;
}

export interface Overlay {
  readonly mask: Lattice<Uint8Array>;
  readonly colour: Vec3;
}

/** HU shown black and white, and those tinted as within the thresholds. */
export interface Greys {
  readonly black: number;
  readonly white: number;
  readonly tinted: readonly [low: number, high: number] | null;
}

const OUTSIDE = -1;
const TINT = 0.22;
const WITHIN: Vec3 = [226, 92, 170];

/** For each pixel of a row or column: offsets of the two voxels it lies between, and the share of the second. */
interface Run {
  readonly first: Int32Array;
  readonly second: Int32Array;
  readonly share: Float32Array;
  readonly nearest: Int32Array;
}

function run(lattice: Lattice<Int16Array> | Lattice<Uint8Array>, axis: number, start: number, pace: number, n: number): Run {
  const stride = lattice.strides[axis];
  const last = lattice.shape[axis] - 1;
  const made = {
    first: new Int32Array(n),
    second: new Int32Array(n),
    share: new Float32Array(n),
    nearest: new Int32Array(n),
  };
  for (let i = 0; i < n; i += 1) {
    const index = lattice.index(axis, start + pace * i);
    const inside = index > -0.5 && index < last + 0.5;
    const low = Math.min(Math.max(Math.floor(index), 0), last);
    made.first[i] = low * stride;
    made.second[i] = Math.min(low + 1, last) * stride;
    made.share[i] = Math.min(Math.max(index - low, 0), 1);
    made.nearest[i] = inside ? Math.min(Math.max(Math.round(index), 0), last) * stride : OUTSIDE;
  }
  return made;
}

/** The coordinates of a picture's first pixel, and the way from one pixel to the next. */
function runs(
  lattice: Lattice<Int16Array> | Lattice<Uint8Array>,
  plane: Orientation,
  window: Window,
  width: number,
  height: number,
): [across: Run, along: Run, base: number] {
  const { scale, middle } = window;
  const pace = scale * plane.down;
  const across = run(lattice, plane.across, middle[0] - (scale * (width - 1)) / 2, scale, width);
  const along = run(lattice, plane.along, middle[1] - (pace * (height - 1)) / 2, pace, height);
  const slice = Math.round(lattice.index(plane.through, window.level));
  const there = slice >= 0 && slice < lattice.shape[plane.through];
  return [across, along, there ? slice * lattice.strides[plane.through] : OUTSIDE];
}

/** Fills `pixels` (RGBA) with the slice. */
export function drawGreys(
  pixels: ImageData,
  volume: Lattice<Int16Array>,
  plane: Orientation,
  window: Window,
  greys: Greys,
): void {
  const { width, height, data } = pixels;
  const [across, along, base] = runs(volume, plane, window, width, height);
  const voxels = volume.voxels;
  const gain = 255 / Math.max(greys.white - greys.black, 1);
  const [low, high] = greys.tinted ?? [Infinity, -Infinity];
  for (let row = 0, place = 0; row < height; row += 1) {
    const missing = base === OUTSIDE || along.nearest[row] === OUTSIDE;
    const [r0, r1, t] = [base + along.first[row], base + along.second[row], along.share[row]];
    for (let column = 0; column < width; column += 1, place += 4) {
      data[place + 3] = 255;
      if (missing || across.nearest[column] === OUTSIDE) {
        data[place] = data[place + 1] = data[place + 2] = 0;
        continue;
      }
      const [c0, c1, s] = [across.first[column], across.second[column], across.share[column]];
      const upper = voxels[r0 + c0] + s * (voxels[r0 + c1] - voxels[r0 + c0]);
      const lower = voxels[r1 + c0] + s * (voxels[r1 + c1] - voxels[r1 + c0]);
      const hu = upper + t * (lower - upper);
      const grey = Math.min(Math.max((hu - greys.black) * gain, 0), 255);
      const mix = hu >= low && hu <= high ? TINT : 0;
      data[place] = grey + mix * (WITHIN[0] - grey);
      data[place + 1] = grey + mix * (WITHIN[1] - grey);
      data[place + 2] = grey + mix * (WITHIN[2] - grey);
    }
  }
}

/** Lays a mask over the slice: a tint inside, full colour along its edge. */
export function drawOverlay(pixels: ImageData, plane: Orientation, window: Window, overlay: Overlay): void {
  const { width, height, data } = pixels;
  const [across, along, base] = runs(overlay.mask, plane, window, width, height);
  if (base === OUTSIDE) return;
  const inside = insideOf(overlay.mask.voxels, across.nearest, along.nearest, base);
  const reach = Math.max(Math.round(devicePixelRatio), 1);
  for (let row = 0; row < height; row += 1)
    for (let column = 0; column < width; column += 1) {
      const here = row * width + column;
      if (!inside[here]) continue;
      const edge =
        row < reach || column < reach || row >= height - reach || column >= width - reach
          ? false
          : !(inside[here - reach] && inside[here + reach] && inside[here - reach * width] && inside[here + reach * width]);
      const mix = edge ? 1 : TINT;
      for (let part = 0; part < 3; part += 1) {
        const place = 4 * here + part;
        data[place] += mix * (overlay.colour[part] - data[place]);
      }
    }
}

function insideOf(voxels: Uint8Array, across: Int32Array, along: Int32Array, base: number): Uint8Array {
  const inside = new Uint8Array(across.length * along.length);
  for (let row = 0; row < along.length; row += 1) {
    if (along[row] === OUTSIDE) continue;
    for (let column = 0; column < across.length; column += 1)
      if (across[column] !== OUTSIDE && voxels[base + along[row] + across[column]])
        inside[row * across.length + column] = 1;
  }
  return inside;
}
