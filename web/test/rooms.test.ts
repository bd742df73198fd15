import { describe, expect, test } from "vitest";
import { listing, namesIn, nameOf, pieceName, placeWords, several } from "../src/furniture-words";
import { kindOf, ranked } from "../src/glyphs";
import { apart } from "../src/names";
import { readQuery } from "../src/query";
import { formatOf } from "../src/upload";

describe("what is looked for", () => {
  test("commas part, a plus joins, a colon says what is done, a number means so many", () => {
    const { nodes, edges } = readQuery("sofa:sit + coffee table, 2 armchairs:sit/touch , lamp");
    expect(nodes.map((node) => [node.category, node.instance, node.needs])).toEqual([
      ["sofa", 1, ["sit"]],
      ["coffee table", 1, []],
      ["armchairs", 1, ["sit", "touch"]],
      ["armchairs", 2, ["sit", "touch"]],
      ["lamp", 1, []],
    ]);
    expect(edges).toEqual([[0, 1]]);
  });

  test("a word that comes again is the same piece, whatever its number and letters", () => {
    const { nodes, edges } = readQuery("Sofa + coffee table, sofa:lie + tv stand, 2 sofas, coffee  table + sofa");
    expect(nodes.map((node) => node.category)).toEqual(["Sofa", "coffee table", "tv stand", "sofas"]);
    expect(nodes[0]!.needs).toEqual(["lie"]);
    expect(nodes[3]!.instance).toBe(2);
    expect(edges.map((edge) => [...edge].sort())).toEqual([[0, 1], [0, 2]]);
  });

  test("a table stands beside each of its chairs, and a chain goes on from the first", () => {
    expect(readQuery("dining table + 3 chairs").edges).toEqual([[0, 1], [0, 2], [0, 3]]);
    expect(readQuery("bed + nightstand + lamp").edges).toEqual([[0, 1], [1, 2]]);
  });

  test.each(["", " , ,", "+ sofa", "sofa +", "sofa + sofa", "sofa:fly", ":sit", "0 sofas", "99 chairs", "7"])("%o is refused with a sentence", (words) => {
    expect(() => readQuery(words)).toThrow(/[.]$/);
  });
});

describe("furniture in words", () => {
  test("several of a kind", () => {
    expect(["bench", "bookshelf", "TV stand", "chair"].map((name) => several(2, name))).toEqual(["2 benches", "2 bookshelves", "2 TV stands", "2 chairs"]);
    expect(listing({ multi_seat_sofa: 1, side_table: 1, corner_side_table: 2 })).toBe("sofa, 3 side tables");
  });

  test("only what has its name in common is numbered", () => {
    const names = namesIn([{ id: "a", category: "stool" }, { id: "b", category: "desk" }, { id: "c", category: "stool" }]);
    expect(Object.fromEntries(names)).toEqual({ a: "stool 1", b: "desk", c: "stool 2" });
  });

  test("a piece has one name, in the script as in the form that changes it", () => {
    const [id] = namesIn([{ id: "0/l_shaped_sofa_1", category: "l_shaped_sofa" }]).values();
    expect([id, nameOf("l_shaped_sofa"), pieceName("0/l_shaped_sofa_1")]).toEqual(["corner sofa", "corner sofa", "corner sofa"]);
    expect(placeWords({ object_id: "0/l_shaped_sofa_1", furniture: "sofa", room: "living_room" })).toBe("corner sofa, living room");
    expect(placeWords({ object_id: null, furniture: "floor", room: null })).toBe("floor");
  });

  test("what a room is for comes first", () => {
    expect(Object.keys(ranked({ ceiling_lamp: 1, picture: 2, rug: 1, desk: 1, double_bed: 1, office_chair: 1 }))).toEqual(["double_bed", "office_chair", "desk", "rug", "ceiling_lamp", "picture"]);
    expect(["sofa_bed", "pet_bed", "nightstand", "tv_stand", "bookshelf", "book", "zither"].map(kindOf)).toEqual(["bed", "decor", "storage", "media", "storage", "decor", "other"]);
  });
});

test("a file's format is told by its name, else by how it begins", () => {
  expect(formatOf("a.GLB", "")).toBe("glb");
  expect(formatOf("a.obj", "v 0 0 0")).toBe("obj");
  expect(formatOf("a.json", '{"id": "a", "floor_polygon": [], "doors": []}')).toBe("native");
  expect(formatOf("a.json", '{"uid": "x", "jobid": "y", "furniture": [')).toBe("3d-front");
  expect(formatOf("a.json", '{"nodes": [{"id": 1, "class_name": "sofa"')).toBe("virtualhome");
  expect(formatOf("test.jsonl.gz", "\u001f\u008b")).toBe("procthor");
  expect(formatOf("a.json", '{"assetId": "Sofa_1"')).toBe("procthor");
});

test("signs that lie over each other are pushed apart, the others stay", () => {
  const moved = apart([[0, 0], [0, 0], [3, 1], [100, 100]], 10);
  expect(moved[3]).toEqual([100, 100]);
  for (const [i, a] of moved.entries()) for (const b of moved.slice(i + 1)) expect(Math.hypot(a[0] - b[0], a[1] - b[1])).toBeGreaterThan(9.5);
});
