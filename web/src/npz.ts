/** Reads NumPy's npz: a zip of npy arrays, stored or deflated. */

export interface NpyArray {
  /** NumPy's type without byte order, such as "f4", "i4" or "U12". */
  readonly type: string;
  readonly shape: readonly number[];
  /** Numbers row by row; one string an element for text. */
  readonly values: Float32Array | Float64Array | Int32Array | Uint8Array | readonly (string | number)[];
}

/** What is wrong with a file that should have been an npz. */
export class NpzError extends Error {}

interface Entry {
  readonly name: string;
  readonly deflated: boolean;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

const END_OF_DIRECTORY = 0x06054b50;
const DIRECTORY_ENTRY = 0x02014b50;
const STORED = 0;
const DEFLATED = 8;

/** Every array of the file by name, or only those asked for. NpzError if it is not an npz. */
export async function readNpz(buffer: ArrayBuffer, only?: readonly string[]): Promise<Map<string, NpyArray>> {
  const arrays = new Map<string, NpyArray>();
  for (const entry of entries(buffer)) {
    const name = entry.name.replace(/\.npy$/, "");
    if (only && !only.includes(name)) continue;
    arrays.set(name, readNpy(entry.deflated ? await inflate(entry.bytes) : entry.bytes));
  }
  return arrays;
}

/** The files of a zip, found by its directory: sizes in local headers may be left open. */
function entries(buffer: ArrayBuffer): Entry[] {
  const view = new DataView(buffer);
  const end = endOfDirectory(view);
  const count = view.getUint16(end + 10, true);
  let at = view.getUint32(end + 16, true);
  const found: Entry[] = [];
  for (let i = 0; i < count; i++) {
    if (at + 46 > view.byteLength || view.getUint32(at, true) !== DIRECTORY_ENTRY) throw new NpzError("broken zip directory");
    const method = view.getUint16(at + 10, true);
    if (method !== STORED && method !== DEFLATED) throw new NpzError(`zip method ${method} is not read`);
    const size = view.getUint32(at + 20, true);
    const nameLength = view.getUint16(at + 28, true);
    const local = view.getUint32(at + 42, true);
    const name = new TextDecoder().decode(new Uint8Array(buffer, at + 46, nameLength));
    const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
    if (start + size > view.byteLength) throw new NpzError(`${name} is cut off`);
    found.push({ name, deflated: method === DEFLATED, bytes: new Uint8Array(buffer, start, size) });
    at += 46 + nameLength + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
  }
  return found;
}

function endOfDirectory(view: DataView): number {
  // The record is 22 bytes and may be followed by a comment.
  for (let at = view.byteLength - 22; at >= 0; at--) {
    if (view.getUint32(at, true) === END_OF_DIRECTORY) return at;
  }
  throw new NpzError("not a zip file");
}

async function inflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** One array. NpzError for types or orders that motions do not use. */
export function readNpy(bytes: Uint8Array<ArrayBuffer>): NpyArray {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 10 || bytes[0] !== 0x93 || new TextDecoder().decode(bytes.subarray(1, 6)) !== "NUMPY") {
    throw new NpzError("not an npy array");
  }
  const wide = (bytes[6] ?? 1) > 1;
  const start = wide ? 12 : 10;
  const length = wide ? view.getUint32(8, true) : view.getUint16(8, true);
  const header = new TextDecoder().decode(bytes.subarray(start, start + length));
  const descr = /'descr':\s*'([<>|=])(\w+)'/.exec(header);
  const shape = /'shape':\s*\(([^)]*)\)/.exec(header);
  if (!descr?.[2] || !shape || descr[1] === ">" || /'fortran_order':\s*True/.test(header)) {
    throw new NpzError(`npy header is not read: ${header.trim()}`);
  }
  const sizes = (shape[1] ?? "").split(",").map((s) => s.trim()).filter(Boolean).map(Number);
  return { type: descr[2], shape: sizes, values: valuesOf(bytes, start + length, descr[2], product(sizes)) };
}

function product(sizes: readonly number[]): number {
  return sizes.reduce((a, b) => a * b, 1);
}

function valuesOf(bytes: Uint8Array<ArrayBuffer>, start: number, type: string, count: number): NpyArray["values"] {
  const width = type.startsWith("U") ? 4 * Number(type.slice(1)) : Number(type.slice(1));
  const stop = start + count * width;
  if (stop > bytes.length) throw new NpzError("npy data are cut off");
  // A copy, since typed arrays must begin at a multiple of their width.
  const data = bytes.slice(start, stop).buffer;
  switch (type) {
    case "f4":
      return new Float32Array(data);
    case "f8":
      return new Float64Array(data);
    case "i4":
      return new Int32Array(data);
    case "b1":
    case "u1":
      return new Uint8Array(data);
    case "i8":
      return Array.from(new BigInt64Array(data), Number);
    default:
      if (type.startsWith("U")) return texts(new Uint32Array(data), width / 4, count);
      throw new NpzError(`npy type ${type} is not read`);
  }
}

/** NumPy pads text with zeros to the longest of the array. */
function texts(codes: Uint32Array, width: number, count: number): string[] {
  return Array.from({ length: count }, (_, i) =>
    String.fromCodePoint(...codes.subarray(i * width, (i + 1) * width).filter((code) => code > 0)),
  );
}
