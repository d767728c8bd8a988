/** Cells of a map that grows: what is known, and the bricks that have changed since. */
import { bitCount, BrickIndex } from "./cells";
import { type CellColumns, readCells } from "./scene";

const headerLength = 32;

/** The answer of `map/N/cells` after bricks have changed: those without cells are left out. */
export function mergeCells(known: ArrayBuffer, changes: ArrayBuffer): ArrayBuffer {
  const [old, changed] = [readCells(known), readCells(changes)];
  if (!changed.isPart) return changes;
  const index = new BrickIndex(changed.x, changed.y, changed.z, changed.x.length);
  const kept: [CellColumns, number, number][] = [];
  let cells = 0;
  const keepAll = (columns: CellColumns, isKept: (b: number) => boolean) => {
    for (let b = 0, first = 0; b < columns.x.length; ++b) {
      const count = bitCount(columns.low[b]) + bitCount(columns.high[b]);
      if (count > 0 && isKept(b)) {
        kept.push([columns, b, first]);
        cells += count;
      }
      first += count;
    }
  };
  keepAll(old, (b) => index.find(old.x[b], old.y[b], old.z[b]) < 0);
  keepAll(changed, () => true);

  const bricks = kept.length;
  const merged = new ArrayBuffer((headerLength + 20 * bricks + cells + 3) & ~3);
  new Uint8Array(merged).set(new Uint8Array(changes, 0, headerLength));
  const header = new Uint32Array(merged, 0, headerLength / 4);
  header[1] = bricks;
  header[2] = cells;
  header[6] = 0;
  const columns = readCells(merged);
  let next = 0;
  kept.forEach(([from, b, first], i) => {
    columns.x[i] = from.x[b];
    columns.y[i] = from.y[b];
    columns.z[i] = from.z[b];
    columns.low[i] = from.low[b];
    columns.high[i] = from.high[b];
    const count = bitCount(from.low[b]) + bitCount(from.high[b]);
    columns.probability.set(from.probability.subarray(first, first + count), next);
    next += count;
  });
  return merged;
}

/** Keys "x,y,z" of the chunks of a level that bricks are in or next to. */
export function chunksAround(bricks: CellColumns, level: number, chunkEdge: number): Set<string> {
  const found = new Set<string>();
  for (let b = 0; b < bricks.x.length; ++b) {
    const [from, to] = [-1, 1].map((side) =>
      [bricks.x[b], bricks.y[b], bricks.z[b]].map((brick) =>
        Math.floor((((4 * brick + (side > 0 ? 3 : 0)) >> level) + side) / chunkEdge),
      ),
    );
    for (let z = from[2]; z <= to[2]; ++z)
      for (let y = from[1]; y <= to[1]; ++y) for (let x = from[0]; x <= to[0]; ++x) found.add(`${x},${y},${z}`);
  }
  return found;
}
