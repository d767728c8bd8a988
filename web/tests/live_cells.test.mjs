// A map that grows, as the page puts it together.
import assert from "node:assert/strict";
import { test } from "node:test";
import { randomNumbers } from "./fixture.mjs";
import { liveCells, path, scene } from "./modules.mjs";

/** An answer with bricks "x,y,z" -> Map(bit -> probability). */
function answerOf(bricks, version, isPart) {
  const entries = [...bricks].map(([key, cells]) => [
    key.split(",").map(Number),
    [...cells].sort(([a], [b]) => a - b),
  ]);
  const cells = entries.flatMap(([, found]) => found.map(([, probability]) => probability));
  const bytes = new ArrayBuffer((32 + 20 * entries.length + cells.length + 3) & ~3);
  const view = new DataView(bytes);
  [0x43585650, entries.length, cells.length, version].forEach((word, i) => view.setUint32(4 * i, word, true));
  view.setFloat32(16, 0.4, true);
  view.setFloat32(20, 0.1, true);
  view.setUint32(24, isPart ? 1 : 0, true);
  entries.forEach(([place, found], b) => {
    place.forEach((at, axis) => view.setInt32(32 + 4 * (axis * entries.length + b), at, true));
    for (const half of [0, 1]) {
      const mask = found
        .filter(([bit]) => bit >> 5 === half)
        .reduce((word, [bit]) => (word | (1 << (bit & 31))) >>> 0, 0);
      view.setUint32(32 + 4 * ((3 + half) * entries.length + b), mask, true);
    }
  });
  new Uint8Array(bytes).set(cells, 32 + 20 * entries.length);
  return bytes;
}

function bricksOf(bytes) {
  const columns = scene.readCells(bytes);
  const bricks = new Map();
  let next = 0;
  for (let b = 0; b < columns.x.length; ++b) {
    const cells = new Map();
    for (let bit = 0; bit < 64; ++bit) {
      const word = bit < 32 ? columns.low[b] : columns.high[b];
      if ((word >>> (bit & 31)) & 1) cells.set(bit, columns.probability[next++]);
    }
    bricks.set([columns.x[b], columns.y[b], columns.z[b]].join(), cells);
  }
  assert.equal(next, columns.probability.length);
  return bricks;
}

test("changes put together are the map", () => {
  for (let seed = 1; seed <= 20; ++seed) {
    const random = randomNumbers(seed);
    const whole = (count) => Math.floor(count * random());
    let known = answerOf(new Map(), 1, false);
    const truth = new Map();
    for (let version = 2; version < 30; ++version) {
      const changes = new Map();
      for (let i = 0; i < 5; ++i) {
        const cells = new Map();
        const isEmpty = random() < 0.3;
        for (let k = 0; !isEmpty && k < 1 + whole(20); ++k) cells.set(whole(64), 100 + whole(155));
        const key = [whole(3) - 1, whole(3) - 1, whole(2) - 1].join();
        changes.set(key, cells);
        if (cells.size > 0) truth.set(key, cells);
        else truth.delete(key);
      }
      const isPart = random() < 0.9;
      known = liveCells.mergeCells(known, isPart ? answerOf(changes, version, true) : answerOf(truth, version, false));
      assert.equal(scene.readCells(known).version, version);
      assert.equal(scene.readCells(known).isPart, false);
      const sorted = (bricks) => [...bricks].map(([key, cells]) => [key, [...cells].sort(([a], [b]) => a - b)]).sort();
      assert.deepEqual(sorted(bricksOf(known)), sorted(truth));
    }
  }
});

test("chunks next to a brick that has changed are made anew, too", () => {
  const around = (x, level) => {
    const bricks = new Map([[[x, 1, 1].join(), new Map([[0, 200]])]]);
    return [...liveCells.chunksAround(scene.readCells(answerOf(bricks, 2, true)), level, 32)].sort();
  };
  assert.deepEqual(around(1, 0), ["0,0,0"]);
  assert.deepEqual(around(7, 0), ["0,0,0", "1,0,0"]);
  assert.deepEqual(around(8, 0), ["0,0,0", "1,0,0"]);
  assert.ok(around(15, 1).includes("1,0,0"));
  assert.ok(around(-1, 0).includes("-1,0,0"));
});

test("poses that follow are put behind those before", () => {
  const poses = (times, first, version) => {
    const column = () => Float32Array.from(times);
    return {
      version,
      first,
      time: Float64Array.from(times),
      ...Object.fromEntries(["x", "y", "z", "qx", "qy", "qz", "qw"].map((name) => [name, column()])),
    };
  };
  const joined = path.joinPaths(poses([1, 2, 3], 0, 1), poses([30, 4], 2, 1));
  assert.deepEqual([...joined.time], [1, 2, 30, 4]);
  assert.deepEqual([...joined.qw], [1, 2, 30, 4]);
});
