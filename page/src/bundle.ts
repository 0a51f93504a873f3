/** A case as it comes from the server or lies in an exported page: a header and its arrays.
 *
 * gzip of: "AURC", length of the header (uint32, little-endian), the header (JSON, UTF-8), then
 * the arrays in C order, each at a multiple of 8 bytes from the header's end
 * (auricle.viewer.container writes it).
 */

export type Numbers = Float32Array | Float64Array | Int16Array | Int32Array | Uint32Array | Uint16Array | Uint8Array | Int8Array;

const KINDS = {
  float32: Float32Array,
  float64: Float64Array,
  int16: Int16Array,
  int32: Int32Array,
  uint32: Uint32Array,
  uint16: Uint16Array,
  uint8: Uint8Array,
  int8: Int8Array,
} as const;

interface ArrayEntry {
  readonly dtype: keyof typeof KINDS;
  readonly shape: readonly number[];
  readonly offset: number;
}

export interface Bundle {
  /** What the header says beside the arrays. */
  readonly header: Readonly<Record<string, unknown>>;
  /** An array by its name; throws if there is none. */
  array<T extends Numbers>(name: string): T;
  /** Whether there is an array of this name. */
  has(name: string): boolean;
  /** Its shape. */
  shape(name: string): readonly number[];
}

const MAGIC = "AURC";
const BEGIN = 8;

export async function readBundle(compressed: Uint8Array): Promise<Bundle> {
  const source = new Blob([compressed as BlobPart]).stream();
  const plain = source.pipeThrough(new DecompressionStream("gzip"));
  return unpacked(await new Response(plain).arrayBuffer());
}

/** Reads a container that is not compressed. */
export function unpacked(bytes: ArrayBuffer): Bundle {
  if (new TextDecoder().decode(bytes.slice(0, 4)) !== MAGIC)
    throw new Error("these are not the data of a case");
  const length = new DataView(bytes).getUint32(4, true);
  const start = BEGIN + length;
  const text = new TextDecoder().decode(bytes.slice(BEGIN, start));
  const header = JSON.parse(text) as { arrays: Record<string, ArrayEntry> };
  const entries = new Map(Object.entries(header.arrays));
  const known = (name: string): ArrayEntry => {
    const entry = entries.get(name);
    if (!entry) throw new Error(`the data hold no ${name}`);
    return entry;
  };
  return {
    header: header as unknown as Record<string, unknown>,
    has: (name) => entries.has(name),
    shape: (name) => known(name).shape,
    array: <T extends Numbers>(name: string): T => {
      const { dtype, shape, offset } = known(name);
      const count = shape.reduce((product, side) => product * side, 1);
      return new KINDS[dtype](bytes, start + offset, count) as T;
    },
  };
}

/** Bytes that were written as base64 text. */
export function fromBase64(text: string): Uint8Array {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  return bytes;
}
