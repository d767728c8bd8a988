/**
 * Occupied cells of one level of a map, in bricks of 4 x 4 x 4: a mask says which cells of a brick are there
 * (bit x + 4 y + 16 z), and their values follow in the order of bricks and bits. A cell of level n + 1 holds eight of
 * level n and has the highest of their probabilities, so a threshold means the same at each level.
 */
import type { CellColumns } from "./scene";

export const brickEdge = 4;

export interface Level {
  bricks: number;
  x: Int32Array;
  y: Int32Array;
  z: Int32Array;
  low: Uint32Array;
  high: Uint32Array;
  /** Index of each brick's first cell. */
  first: Uint32Array;
  probability: Uint8Array;
  /** 0: not judged, 1 to 255: share of the echoes that agree. */
  agreement: Uint8Array | null;
  index: BrickIndex;
}

export function bitCount(word: number): number {
  word -= (word >>> 1) & 0x55555555;
  word = (word & 0x33333333) + ((word >>> 2) & 0x33333333);
  return Math.imul((word + (word >>> 4)) & 0x0f0f0f0f, 0x01010101) >>> 24;
}

/** Finds a brick by its coordinates: open addressing, at most half full. */
export class BrickIndex {
  private readonly slots: Int32Array;
  private readonly mask: number;

  /** Over columns that hold up to `capacity` bricks; the first `count` are taken up. */
  constructor(
    private readonly x: Int32Array,
    private readonly y: Int32Array,
    private readonly z: Int32Array,
    count: number,
    capacity = count,
  ) {
    let size = 16;
    while (size < 2 * capacity) size *= 2;
    this.slots = new Int32Array(size).fill(-1);
    this.mask = size - 1;
    for (let i = 0; i < count; ++i) this.insert(i);
  }

  /** Index of the brick, or -1. */
  find(x: number, y: number, z: number): number {
    for (let slot = hash(x, y, z) & this.mask; ; slot = (slot + 1) & this.mask) {
      const i = this.slots[slot];
      if (i < 0 || (this.x[i] === x && this.y[i] === y && this.z[i] === z)) return i;
    }
  }

  /** Takes up brick `i`, whose coordinates stand in the columns. */
  insert(i: number): void {
    let slot = hash(this.x[i], this.y[i], this.z[i]) & this.mask;
    while (this.slots[slot] >= 0) slot = (slot + 1) & this.mask;
    this.slots[slot] = i;
  }
}

function hash(x: number, y: number, z: number): number {
  const mixed = Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35);
  return (mixed ^ (mixed >>> 15)) >>> 0;
}

export function finestLevel(columns: CellColumns, agreement: Uint8Array | null): Level {
  const { x, y, z, low, high, probability } = columns;
  const bricks = x.length;
  return {
    bricks,
    x,
    y,
    z,
    low,
    high,
    probability,
    agreement,
    first: firstCells(low, high),
    index: new BrickIndex(x, y, z, bricks),
  };
}

function firstCells(low: Uint32Array, high: Uint32Array): Uint32Array {
  const first = new Uint32Array(low.length);
  for (let b = 0, cells = 0; b < low.length; ++b) {
    first[b] = cells;
    cells += bitCount(low[b]) + bitCount(high[b]);
  }
  return first;
}

/** Calls `visit(bit, cell)` for each cell of brick `b`; `cell` is the index of its values. */
export function forEachCell(level: Level, b: number, visit: (bit: number, cell: number) => void): void {
  let cell = level.first[b];
  for (let word = level.low[b]; word !== 0; word &= word - 1) visit(lowestBit(word), cell++);
  for (let word = level.high[b]; word !== 0; word &= word - 1) visit(32 + lowestBit(word), cell++);
}

export function lowestBit(word: number): number {
  return 31 - Math.clz32(word & -word);
}

/** Index of the values of a cell, or -1 where there is none. */
export function findCell(level: Level, x: number, y: number, z: number): number {
  const b = level.index.find(x >> 2, y >> 2, z >> 2);
  if (b < 0) return -1;
  const bit = (x & 3) | ((y & 3) << 2) | ((z & 3) << 4);
  const word = bit < 32 ? level.low[b] : level.high[b];
  const mask = 1 << (bit & 31);
  if ((word & mask) === 0) return -1;
  const below = bitCount(word & (mask - 1));
  return level.first[b] + below + (bit < 32 ? 0 : bitCount(level.low[b]));
}

/** The next coarser level. */
export function coarserLevel(fine: Level): Level {
  const x = new Int32Array(fine.bricks);
  const y = new Int32Array(fine.bricks);
  const z = new Int32Array(fine.bricks);
  const parents = new BrickIndex(x, y, z, 0, fine.bricks);
  const parent = new Int32Array(fine.bricks);
  let bricks = 0;
  for (let b = 0; b < fine.bricks; ++b) {
    x[bricks] = fine.x[b] >> 1;
    y[bricks] = fine.y[b] >> 1;
    z[bricks] = fine.z[b] >> 1;
    const found = parents.find(x[bricks], y[bricks], z[bricks]);
    if (found < 0) parents.insert(bricks);
    parent[b] = found < 0 ? bricks++ : found;
  }

  const highest = new Uint8Array(64 * bricks);
  const present = new Uint8Array(64 * bricks);
  const judged = fine.agreement ? new Uint8Array(64 * bricks) : null;
  const agreed = fine.agreement ? new Uint16Array(64 * bricks) : null;
  for (let b = 0; b < fine.bricks; ++b) {
    const corner = 64 * parent[b] + 2 * (fine.x[b] & 1) + 8 * (fine.y[b] & 1) + 32 * (fine.z[b] & 1);
    forEachCell(fine, b, (bit, cell) => {
      const at = corner + ((bit >> 1) & 1) + 4 * ((bit >> 3) & 1) + 16 * (bit >> 5);
      present[at] = 1;
      highest[at] = Math.max(highest[at], fine.probability[cell]);
      if (judged && agreed && fine.agreement![cell] > 0) {
        judged[at] += 1;
        agreed[at] += fine.agreement![cell];
      }
    });
  }

  const low = new Uint32Array(bricks);
  const high = new Uint32Array(bricks);
  for (let at = 0; at < present.length; ++at) {
    if (!present[at]) continue;
    const bit = at & 63;
    if (bit < 32) low[at >> 6] |= 1 << bit;
    else high[at >> 6] |= 1 << (bit - 32);
  }
  const shared = { x: x.slice(0, bricks), y: y.slice(0, bricks), z: z.slice(0, bricks) };
  return {
    bricks,
    ...shared,
    low,
    high,
    first: firstCells(low, high),
    probability: highest.filter((_, at) => present[at] !== 0),
    agreement:
      judged && agreed
        ? Uint8Array.from(agreed, (sum, at) => (judged[at] ? Math.round(sum / judged[at]) : 0)).filter(
            (_, at) => present[at] !== 0,
          )
        : null,
    index: new BrickIndex(shared.x, shared.y, shared.z, bricks),
  };
}

/** What of a map is shown: cells at or above a probability, between two heights given in cells of the finest level. */
export interface Filter {
  /** Probability times 255, as cells have it. */
  threshold: number;
  lowest: number;
  /** The first layer of cells that is not shown any more. */
  end: number;
}

export const everything: Filter = { threshold: 0, lowest: -(2 ** 31), end: 2 ** 31 };

/** Whether a filter shows layer `z` of a level: coarse cells where any part of them is between the heights. */
export function showsLayer(filter: Filter, z: number, level: number): boolean {
  return (z + 1) * 2 ** level > filter.lowest && z * 2 ** level < filter.end;
}

export interface Hit {
  /** Distance from the start in cells. */
  distance: number;
  cell: [number, number, number];
  /** Index of its values. */
  values: number;
}

/** The first cell that a ray meets and the filter shows. Start in cells of this level; `direction` has length 1. */
export function castRay(
  level: Level,
  number: number,
  filter: Filter,
  start: readonly number[],
  direction: readonly number[],
  end: number,
): Hit | null {
  let hit: Hit | null = null;
  // Bricks one after the other, and the cells of those that are there.
  walkCubes(start, direction, 0, end, brickEdge, (brick, enters, leaves) => {
    if (level.index.find(brick[0], brick[1], brick[2]) < 0) return false;
    walkCubes(start, direction, enters, leaves, 1, (cell, distance) => {
      if (!showsLayer(filter, cell[2], number)) return false;
      const values = findCell(level, cell[0], cell[1], cell[2]);
      if (values < 0 || level.probability[values] < filter.threshold) return false;
      hit = { distance, cell: [cell[0], cell[1], cell[2]], values };
      return true;
    });
    return hit !== null;
  });
  return hit;
}

/**
 * Visits the cubes that a ray passes between two distances, until a visit returns true. One axis steps at a time, so
 * that a ray in the plane of faces goes on as well.
 */
function walkCubes(
  start: readonly number[],
  direction: readonly number[],
  from: number,
  end: number,
  edge: number,
  visit: (cube: readonly number[], enters: number, leaves: number) => boolean,
): void {
  const cube = [0, 0, 0];
  const next = [Infinity, Infinity, Infinity];
  for (let axis = 0; axis < 3; ++axis) {
    cube[axis] = Math.floor((start[axis] + direction[axis] * from) / edge);
    if (direction[axis] === 0) continue;
    next[axis] = ((cube[axis] + (direction[axis] > 0 ? 1 : 0)) * edge - start[axis]) / direction[axis];
  }
  for (let enters = from; ;) {
    const axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : next[1] <= next[2] ? 1 : 2;
    const leaves = Math.max(next[axis], enters);
    if (visit(cube, enters, Math.min(leaves, end)) || !(leaves < end)) return;
    enters = leaves;
    cube[axis] += Math.sign(direction[axis]);
    next[axis] += edge / Math.abs(direction[axis]);
  }
}
