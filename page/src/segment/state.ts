/** What the three planes share: the volume, where one looks, and what lies over the slices. */
import type { Edits } from "./edits";
import type { Lattice, Vec3 } from "./lattice";
import type { Overlay } from "./picture";
import type { Tool } from "./tools";

export interface Look {
  /** The place the three planes meet, mm, LPS. */
  crosshair: Vec3;
  /** The middle of the pictures, mm. */
  middle: Vec3;
  /** Millimetres of the volume's longest side over those shown. */
  zoom: number;
  /** HU at the middle of grey, and from black to white. */
  level: number;
  width: number;
}

export interface Scene {
  readonly volume: Lattice<Int16Array>;
  readonly look: Look;
  readonly edits: Edits;
  /** HU tinted while thresholds are set; null leaves the slices grey. */
  readonly tinted: readonly [number, number] | null;
  readonly overlay: Overlay | null;
  readonly tool: Tool;
  /** Whether left, front and up of the file are known. */
  readonly oriented: boolean;
}
