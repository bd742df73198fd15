import { describe, expect, test } from "vitest";
import { NpzError, readNpy, readNpz } from "../src/npz";
import { codesOf, npy, zip } from "./archive";

const floats = npy("<f4", [2, 3], new Float32Array([1, 2, 3, 4, 5, 6.5]));

describe("npz", () => {
  test.each([["stored", false, false], ["deflated", true, false], ["streamed", true, true]] as const)(
    "an array comes back as it was written (%s)",
    async (_how, deflated, streamed) => {
      const array = (await readNpz(await zip({ "root_positions.npy": floats }, deflated, streamed))).get("root_positions");
      expect(array?.shape).toEqual([2, 3]);
      expect([...(array?.values ?? [])]).toEqual([1, 2, 3, 4, 5, 6.5]);
    },
  );

  test("only the arrays that are asked for are read", async () => {
    const arrays = await readNpz(await zip({ "a.npy": floats, "b.npy": new Uint8Array([1]) }, true), ["a"]);
    expect([...arrays.keys()]).toEqual(["a"]);
  });

  test("text loses its padding", () => {
    const codes = new Uint32Array(12);
    codes.set(codesOf("head"));
    codes.set(codesOf("pelvis"), 6);
    expect(readNpy(npy("<U6", [2], codes)).values).toEqual(["head", "pelvis"]);
  });

  test("numbers without a shape and wide whole numbers are read", () => {
    expect([...readNpy(npy("<i8", [], new BigInt64Array([30n]))).values]).toEqual([30]);
  });

  test("what is not an npz is refused with a reason", async () => {
    await expect(readNpz(new TextEncoder().encode("{\"title\": \"Not found\", \"status\": 404}").buffer)).rejects.toThrow(NpzError);
    expect(() => readNpy(npy("<c8", [1], new Float32Array(2)))).toThrow(/c8/);
    expect(() => readNpy(npy("<f4", [9], new Float32Array(2)))).toThrow(/cut off/);
    expect(() => readNpy(npy(">f4", [1], new Float32Array(1)))).toThrow(NpzError);
  });
});
