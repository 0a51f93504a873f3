/** A case as it comes from the server or lies in an exported page: a header and its arrays.
 *
 * gzip of: "AURICLE1", length of the header (uint32, little-endian), the header (JSON, UTF-8),
 * then the arrays, each starting at a multiple of 8 bytes from the beginning of the data.
 */

export type Numbers = Float32Array | Float64Array | Int16Array | Int32Array | Uint32Array | Uint16Array | Uint8Array;

const KINDS = {
  float32: Float32Array,
  float64: Float64Array,
  int16: Int16Array,
  int32: Int32Array,
  uint32: Uint32Array,
  uint16: Uint16Array,
  uint8: Uint8Array,
} as const;

interface ArrayEntry {
  readonly name: string;
  readonly kind: keyof typeof KINDS;
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

const MAGIC = "AURICLE1";

export async function readBundle(compressed: Uint8Array): Promise<Bundle> {
  const source = new Blob([compressed as BlobPart]).stream();
  const plain = source.pipeThrough(new DecompressionStream("gzip"));
  return unpacked(await new Response(plain).arrayBuffer());
}

function unpacked(bytes: ArrayBuffer): Bundle {
  if (new TextDecoder().decode(bytes.slice(0, 8)) !== MAGIC)
    throw new Error("these are not the data of a case");
  const length = new DataView(bytes).getUint32(8, true);
  const text = new TextDecoder().decode(bytes.slice(12, 12 + length));
  const header = JSON.parse(text) as { arrays: ArrayEntry[] } & Record<string, unknown>;
  const start = Math.ceil((12 + length) / 8) * 8;
  const entries = new Map(header.arrays.map((entry) => [entry.name, entry]));
  const known = (name: string): ArrayEntry => {
    const entry = entries.get(name);
    if (!entry) throw new Error(`the case holds no ${name}`);
    return entry;
  };
  return {
    header,
    has: (name) => entries.has(name),
    shape: (name) => known(name).shape,
    array: <T extends Numbers>(name: string): T => {
      const { kind, shape, offset } = known(name);
      const count = shape.reduce((product, side) => product * side, 1);
      return new KINDS[kind](bytes, start + offset, count) as T;
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
