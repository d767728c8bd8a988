// Faces, levels and rays against the plainest way of finding them, cell by cell.
import assert from "node:assert/strict";
import { test } from "node:test";
import { CellSet, randomNumbers } from "./fixture.mjs";
import { cells, faces, facesWorker, scene } from "./modules.mjs";

const directions = [
  [1, 0, 0],
  [-1, 0, 0],
  [0, 1, 0],
  [0, -1, 0],
  [0, 0, 1],
  [0, 0, -1],
];
const edge = faces.chunkEdge;
const key = (...numbers) => numbers.join(",");

/** Cells in and around the chunk at (-1, 0, 2): thin walls, a solid block, and dust. */
function randomCells(seed) {
  const random = randomNumbers(seed);
  const set = new CellSet();
  const [x0, y0, z0] = [-32, 0, 64];
  const probability = () => 110 + Math.floor(140 * random() ** 2);
  for (let i = 0; i < 1500; ++i) {
    const [x, y, z] = [0, 0, 0].map(() => Math.floor(random() * 40) - 4);
    set.set(x0 + x, y0 + y, z0 + z, probability());
  }
  for (let x = -4; x < 36; ++x) for (let z = -4; z < 36; ++z) set.set(x0 + x, y0 + 31, z0 + z, 200);
  for (let x = 10; x < 20; ++x)
    for (let y = 5; y < 15; ++y) for (let z = 8; z < 34; ++z) set.set(x0 + x, y0 + y, z0 + z, x < 15 ? 180 : 240);
  return set;
}

function levelOf(set) {
  return cells.finestLevel(scene.readCells(set.bytes(0.1).buffer), null);
}

/** Values by "x,y,z". */
function valuesOf(set) {
  const values = new Map();
  for (const { at, cells: bits } of set.bricks.values()) {
    bits.forEach((value, bit) => {
      if (value > 0)
        values.set(key(4 * at[0] + (bit & 3), 4 * at[1] + ((bit >> 2) & 3), 4 * at[2] + (bit >> 4)), value);
    });
  }
  return values;
}

/** Faces of single cells in a chunk: "direction,x,y,z" of the cell with its class. */
function oracle(isShown, at, classAt, border) {
  const expected = new Map();
  for (let z = 0; z < edge; ++z) {
    for (let y = 0; y < edge; ++y) {
      for (let x = 0; x < edge; ++x) {
        const cell = [x + at[0] * edge, y + at[1] * edge, z + at[2] * edge];
        if (!isShown(...cell)) continue;
        directions.forEach(([dx, dy, dz], direction) => {
          const beside = [x + dx, y + dy, z + dz];
          const isOutside = beside.some((c) => c < 0 || c >= edge);
          const hides = border === "closed" && isOutside ? false : isShown(cell[0] + dx, cell[1] + dy, cell[2] + dz);
          if (!hides) expected.set(key(direction, x, y, z), classAt(...cell));
        });
      }
    }
  }
  return expected;
}

/** The same of rectangles; each part must be there once, and corners must go around counter-clockwise. */
function unitFaces(corners) {
  const found = new Map();
  for (let at = 0; at < corners.length; at += 16) {
    const points = [0, 1, 2, 3].map((k) => [...corners.subarray(at + 4 * k, at + 4 * k + 3)].map((c) => c & 63));
    const direction = corners[at + 3] >> 5;
    const kind = corners[at + 3] & 31;
    const axis = direction >> 1;
    const side = (a, b) => b.map((c, i) => c - a[i]);
    const [a, b] = [side(points[0], points[1]), side(points[1], points[2])];
    const normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    assert.ok(normal[axis] * directions[direction][axis] > 0, "a face looks outwards");
    const low = [0, 1, 2].map((i) => Math.min(...points.map((p) => p[i])));
    const high = [0, 1, 2].map((i) => Math.max(...points.map((p) => p[i])));
    const plane = direction % 2 === 0 ? low[axis] - 1 : low[axis];
    low[axis] = plane;
    high[axis] = plane + 1;
    for (let z = low[2]; z < high[2]; ++z) {
      for (let y = low[1]; y < high[1]; ++y) {
        for (let x = low[0]; x < high[0]; ++x) {
          const name = key(direction, x, y, z);
          assert.ok(!found.has(name), `${name} is there twice`);
          found.set(name, kind);
        }
      }
    }
  }
  return found;
}

function facesOf(chunk, classOf) {
  const list = new faces.FaceList();
  faces.makeFaces(chunk, classOf, list);
  return list.corners();
}

const sorted = (map) => [...map].sort();

for (const classOf of ["none", "probability"]) {
  for (const border of ["neighbours", "closed"]) {
    for (const filter of [cells.everything, { threshold: 170, lowest: 70, end: 90 }]) {
      test(`faces are those of the single cells: ${classOf}, ${border}, from ${filter.threshold}`, () => {
        for (let seed = 1; seed <= 3; ++seed) {
          const set = randomCells(seed);
          const values = valuesOf(set);
          const at = [-1, 0, 2];
          const chunk = new faces.Chunk();
          faces.loadCells(chunk, levelOf(set), 0, at, filter, classOf);
          const isShown = (x, y, z) =>
            z >= filter.lowest && z < filter.end && (values.get(key(x, y, z)) ?? -1) >= filter.threshold;
          const inside = [...values.keys()].filter((name) => {
            const cell = name.split(",").map(Number);
            return isShown(...cell) && cell.every((c, axis) => Math.floor(c / edge) === at[axis]);
          });
          assert.equal(chunk.cells, inside.length);
          if (border === "closed") chunk.closeBorder();
          const kind = (x, y, z) => (classOf === "none" ? 0 : faces.classOfValue(values.get(key(x, y, z))));
          const corners = facesOf(chunk, classOf);
          const expected = oracle(isShown, at, kind, border);
          assert.ok(expected.size > 1000);
          assert.deepEqual(sorted(unitFaces(corners)), sorted(expected));
          assert.ok(corners.length / 16 < expected.size, "some are merged");
        }
      });
    }
  }
}

test("a wall is one rectangle a side", () => {
  const set = new CellSet();
  for (let x = 0; x < 32; ++x) for (let z = 0; z < 32; ++z) set.set(x, 16, z, 200);
  const chunk = new faces.Chunk();
  faces.loadCells(chunk, levelOf(set), 0, [0, 0, 0], cells.everything, "none");
  assert.equal(facesOf(chunk, "none").length / 16, 6);
});

test("classes hold the values apart, and zero is a class of its own", () => {
  const classes = Array.from({ length: 256 }, (_, value) => faces.classOfValue(value));
  assert.equal(classes[0], 0);
  assert.equal(classes[1], 1);
  assert.equal(classes[255], 31);
  for (let value = 1; value < 255; ++value) assert.ok(classes[value + 1] >= classes[value]);
});

test("a coarser cell is there where one of its eight is, with their highest probability", () => {
  const set = randomCells(7);
  const expected = new Map();
  for (const [name, value] of valuesOf(set)) {
    const parent = name
      .split(",")
      .map((c) => Number(c) >> 1)
      .join(",");
    expected.set(parent, Math.max(expected.get(parent) ?? 0, value));
  }
  const coarse = cells.coarserLevel(levelOf(set));
  const found = new Map();
  for (let b = 0; b < coarse.bricks; ++b) {
    cells.forEachCell(coarse, b, (bit, cell) => {
      const at = [4 * coarse.x[b] + (bit & 3), 4 * coarse.y[b] + ((bit >> 2) & 3), 4 * coarse.z[b] + (bit >> 4)];
      found.set(key(...at), coarse.probability[cell]);
      assert.equal(cells.findCell(coarse, ...at), cell);
    });
  }
  assert.deepEqual(sorted(found), sorted(expected));
  assert.equal(cells.findCell(coarse, 1000, 0, 0), -1);
});

test("a coarser cell agrees as the mean of those that were judged", () => {
  const set = new CellSet();
  for (const x of [0, 1, 2]) set.set(x, 0, 0, 200);
  const level = cells.finestLevel(scene.readCells(set.bytes(0.1).buffer), Uint8Array.of(100, 0, 0));
  const coarse = cells.coarserLevel(level);
  assert.deepEqual([...coarse.agreement], [100, 0]);
});

test("a ray meets the nearest cell that is shown", () => {
  const random = randomNumbers(11);
  const set = randomCells(3);
  const level = levelOf(set);
  const filter = { threshold: 150, lowest: 66, end: 95 };
  const shown = [...valuesOf(set)]
    .filter(([, value]) => value >= filter.threshold)
    .map(([name]) => name.split(",").map(Number));
  const candidates = shown.filter(([, , z]) => z >= filter.lowest && z < filter.end);
  let hits = 0;
  for (let i = 0; i < 300; ++i) {
    const start = [-16 + 80 * (random() - 0.5), 16 + 80 * (random() - 0.5), 80 + 80 * (random() - 0.5)];
    const aim = [-16, 16, 80].map((c, axis) => c + 30 * (random() - 0.5) - start[axis]);
    const length = Math.hypot(...aim);
    const direction = aim.map((c) => c / length);
    let nearest = Infinity;
    for (const cell of candidates) {
      let [from, to] = [0, Infinity];
      for (let axis = 0; axis < 3; ++axis) {
        const [a, b] = [cell[axis], cell[axis] + 1].map((c) => (c - start[axis]) / direction[axis]);
        from = Math.max(from, Math.min(a, b));
        to = Math.min(to, Math.max(a, b));
      }
      if (from < to) nearest = Math.min(nearest, from);
    }
    const hit = cells.castRay(level, 0, filter, start, direction, 200);
    if (hit) ++hits;
    assert.ok(
      nearest === Infinity ? hit === null : hit !== null && Math.abs(hit.distance - nearest) < 1e-3,
      `ray ${i}`,
    );
  }
  assert.ok(hits > 100 && hits < 300);
});

test("a ray in the plane of faces meets the cells beside it, and does not stop", () => {
  const set = new CellSet();
  for (let y = 0; y < 8; ++y) for (let z = 0; z < 8; ++z) set.set(40, y, z, 220);
  const level = levelOf(set);
  for (const [y, z] of [
    [4, 4],
    [3.5, 4],
    [8, 3],
    [0, 0],
  ]) {
    for (const tiny of [0, 1e-17, -1e-17, 1e-310]) {
      const hit = cells.castRay(level, 0, cells.everything, [-1e4, y, z], [1, tiny, -tiny], 2e4);
      const isBeside = y === 8 && tiny >= 0 ? hit === null || hit.cell[1] === 7 : hit !== null || y === 0;
      assert.ok(isBeside, `${y} ${z} ${tiny}`);
      if (hit) assert.ok(Math.abs(hit.distance - 10040) < 1e-6 && hit.cell[0] === 40);
    }
  }
});

/** Free cubes of different sizes beside the cells of a wall. */
function cubesAndCells() {
  const set = new CellSet();
  for (let y = 0; y < 40; ++y) for (let z = 0; z < 20; ++z) set.set(40, y, z, 220);
  const cubes = [];
  for (const [x, y, z, size] of [
    [0, 0, 0, 16],
    [16, 0, 0, 16],
    [32, 0, 0, 8],
    [0, 16, 0, 4],
    [4, 16, 0, 1],
    [5, 16, 0, 2],
    [-2, 3, 2, 2],
  ]) {
    cubes.push([x, y, z, size]);
  }
  const isFree = (x, y, z) =>
    cubes.some(
      ([cx, cy, cz, size]) => x >= cx && x < cx + size && y >= cy && y < cy + size && z >= cz && z < cz + size,
    );
  const words = [0x46585650, cubes.length, 0, 0, ...[0, 1, 2, 3].flatMap((i) => cubes.map((cube) => cube[i]))];
  return { set, isFree, free: Int32Array.from(words).buffer };
}

function answeredSpace(space, filter, bounds) {
  const { set, isFree, free } = cubesAndCells();
  const maker = new facesWorker.FaceMaker();
  maker.answer({ kind: "map", map: 0, cells: set.bytes(0.1).buffer, agreement: null });
  const answer = maker.answer({ kind: "space", map: 0, space, free, bounds, filter, generation: 3 });
  assert.equal(answer.level, 0);
  assert.equal(answer.generation, 3);
  return { answer, isFree, isOccupied: (x, y, z) => set.has(x, y, z) };
}

function compareSpace(answer, isShown, bounds) {
  const byChunk = new Map(answer.chunks.map(({ at, corners }) => [key(...at), corners]));
  const chunk = (c) => Math.floor(c / edge);
  for (let z = chunk(bounds.from[2]); z <= chunk(bounds.end[2] - 1); ++z) {
    for (let y = chunk(bounds.from[1]); y <= chunk(bounds.end[1] - 1); ++y) {
      for (let x = chunk(bounds.from[0]); x <= chunk(bounds.end[0] - 1); ++x) {
        const corners = byChunk.get(key(x, y, z)) ?? new Uint8Array(0);
        assert.deepEqual(sorted(unitFaces(corners)), sorted(oracle(isShown, [x, y, z], () => 0, "neighbours")));
      }
    }
  }
}

const bounds = { from: [-2, 0, 0], end: [41, 40, 20] };
const cut = { threshold: 0, lowest: -100, end: 6 };

test("free space has the faces of its cells, whatever their cubes", () => {
  for (const filter of [cells.everything, cut]) {
    const { answer, isFree } = answeredSpace("free", filter, bounds);
    compareSpace(answer, (x, y, z) => z >= filter.lowest && z < filter.end && isFree(x, y, z), bounds);
  }
});

test("unknown space is what is neither free nor occupied; when it is cut, a block within the bounds", () => {
  const whole = answeredSpace("unknown", cells.everything, bounds);
  compareSpace(whole.answer, (x, y, z) => !whole.isFree(x, y, z) && !whole.isOccupied(x, y, z), bounds);
  const block = answeredSpace("unknown", cut, bounds);
  const isInside = (...cell) => cell.every((c, axis) => c >= bounds.from[axis] && c < bounds.end[axis]);
  const isUnknown = (x, y, z) =>
    isInside(x, y, z) && z < cut.end && !block.isFree(x, y, z) && !block.isOccupied(x, y, z);
  compareSpace(block.answer, isUnknown, bounds);
});

test("the worker's levels and extent are those of the cells", () => {
  const set = randomCells(5);
  const maker = new facesWorker.FaceMaker();
  const answer = maker.answer({ kind: "map", map: 2, cells: set.bytes(0.1).buffer, agreement: null });
  const all = [...valuesOf(set).keys()].map((name) => name.split(",").map(Number));
  for (let axis = 0; axis < 3; ++axis) {
    assert.equal(answer.from[axis], Math.min(...all.map((cell) => cell[axis])));
    assert.equal(answer.end[axis], Math.max(...all.map((cell) => cell[axis])) + 1);
  }
  assert.equal(
    answer.layers.reduce((sum, count) => sum + count, 0),
    set.count,
  );
  const sums = answer.levels.map((chunks) =>
    chunks.filter((_, i) => i % 4 === 3).reduce((sum, count) => sum + count, 0),
  );
  assert.equal(sums[0], set.count);
  for (let level = 1; level < sums.length; ++level) assert.ok(sums[level] <= sums[level - 1]);
  assert.ok(answer.levels.at(-1).length <= 4 || answer.levels.length === 12);
});

test("an empty map has no faces and no extent", () => {
  const maker = new facesWorker.FaceMaker();
  const answer = maker.answer({ kind: "map", map: 0, cells: new CellSet().bytes(0.1).buffer, agreement: null });
  assert.deepEqual(answer.end, [0, 0, 0]);
  assert.equal(answer.levels[0].length, 0);
});
