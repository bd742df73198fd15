/** Writes npy arrays and zips, as NumPy would. */

/** An npy of version 1.0, header padded as NumPy does. */
export function npy(descr: string, shape: number[], data: ArrayBufferView<ArrayBuffer>): Uint8Array<ArrayBuffer> {
  const tuple = shape.length === 1 ? `(${shape[0]},)` : `(${shape.join(", ")})`;
  const header = `{'descr': '${descr}', 'fortran_order': False, 'shape': ${tuple}, }`;
  const padded = header.padEnd(64 * Math.ceil((header.length + 11) / 64) - 11) + "\n";
  const bytes = new Uint8Array(10 + padded.length + data.byteLength);
  bytes.set([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, padded.length & 255, padded.length >> 8]);
  bytes.set(new TextEncoder().encode(padded), 10);
  bytes.set(new Uint8Array(data.buffer, data.byteOffset, data.byteLength), 10 + padded.length);
  return bytes;
}

/** Its letters, as NumPy keeps them. */
export const codesOf = (text: string): number[] => Array.from(text, (letter) => letter.codePointAt(0) ?? 0);

/** A zip of those files, deflated or stored; sizes only in the directory when `streamed`. */
export async function zip(files: Record<string, Uint8Array<ArrayBuffer>>, deflated: boolean, streamed = false): Promise<ArrayBuffer> {
  const out: number[] = [];
  const directory: number[] = [];
  const u16 = (n: number): number[] => [n & 255, (n >> 8) & 255];
  const u32 = (n: number): number[] => [...u16(n & 0xffff), ...u16(n >>> 16)];
  const names = Object.keys(files);
  for (const name of names) {
    const raw = files[name]!;
    const content = deflated ? await deflate(raw) : raw;
    const code = [...new TextEncoder().encode(name)];
    const head = [...u16(20), ...u16(streamed ? 8 : 0), ...u16(deflated ? 8 : 0), ...u32(0), ...u32(0)];
    const sizes = [...u32(content.length), ...u32(raw.length)];
    directory.push(...u32(0x02014b50), ...u16(20), ...head, ...sizes, ...u16(code.length));
    directory.push(...u16(0), ...u16(0), ...u16(0), ...u16(0), ...u32(0), ...u32(out.length), ...code);
    out.push(...u32(0x04034b50), ...head, ...(streamed ? [...u32(0), ...u32(0)] : sizes), ...u16(code.length), ...u16(0));
    out.push(...code, ...content);
  }
  const start = out.length;
  out.push(...directory, ...u32(0x06054b50), ...u16(0), ...u16(0), ...u16(names.length), ...u16(names.length));
  out.push(...u32(directory.length), ...u32(start), ...u16(0));
  return new Uint8Array(out).buffer;
}

async function deflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
