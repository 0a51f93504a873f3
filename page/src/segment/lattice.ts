/** Voxels on a straight lattice in LPS mm: the CT as the page draws it, and masks. */

export type Vec3 = readonly [number, number, number];

export class Lattice<A extends Int16Array | Uint8Array> {
  constructor(
    readonly voxels: A,
    readonly shape: Vec3,
    readonly origin: Vec3,
    readonly step: number,
  ) {
    if (voxels.length !== shape[0] * shape[1] * shape[2])
      throw new Error("the server sent a volume of another size: reload the page");
  }

  /** Fractional index of a coordinate along an axis. */
  index(axis: number, mm: number): number {
    return (mm - this.origin[axis]) / this.step;
  }

  first(axis: number): number {
    return this.origin[axis];
  }

  last(axis: number): number {
    return this.origin[axis] + (this.shape[axis] - 1) * this.step;
  }

  /** Steps in the array from a voxel to the next along each axis. */
  get strides(): Vec3 {
    return [1, this.shape[0], this.shape[0] * this.shape[1]];
  }

  /** The value at a place, nearest voxel; undefined outside. */
  at(place: Vec3): number | undefined {
    let offset = 0;
    for (let axis = 0; axis < 3; axis += 1) {
      const index = Math.round(this.index(axis, place[axis]));
      if (index < 0 || index >= this.shape[axis]) return undefined;
      offset += index * this.strides[axis];
    }
    return this.voxels[offset];
  }
}

/** How many voxels of a box have which value: counts of bins from `low`, each `width` wide. */
export function histogram(
  lattice: Lattice<Int16Array>,
  box: readonly [Vec3, Vec3],
  low: number,
  width: number,
  nBins: number,
): Float64Array {
  const counts = new Float64Array(nBins);
  const [sx, sy, sz] = lattice.strides;
  const range = [0, 1, 2].map((axis) => [
    Math.max(Math.ceil(lattice.index(axis, Math.min(box[0][axis], box[1][axis]))), 0),
    Math.min(Math.floor(lattice.index(axis, Math.max(box[0][axis], box[1][axis]))), lattice.shape[axis] - 1),
  ]);
  for (let z = range[2][0]; z <= range[2][1]; z += 1)
    for (let y = range[1][0]; y <= range[1][1]; y += 1)
      for (let x = range[0][0]; x <= range[0][1]; x += 1) {
        const bin = Math.floor((lattice.voxels[x * sx + y * sy + z * sz] - low) / width);
        if (bin >= 0 && bin < nBins) counts[bin] += 1;
      }
  return counts;
}
