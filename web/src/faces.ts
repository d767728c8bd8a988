/**
 * Faces of cells, a chunk of 32 x 32 x 32 at a time. A face is made where a cell has no neighbour; those in one plane
 * that belong to cells of one class are merged into rectangles. Rows of cells along x are words of 32 bits.
 */
import { bitCount, type Filter, forEachCell, type Level, lowestBit, showsLayer } from "./cells";
import type { CubeColumns } from "./scene";

export const chunkEdge = 32;
const bricksPerEdge = chunkEdge / 4;
/** A row more at each side, of the neighbouring chunks. */
const padded = chunkEdge + 2;
export const classCount = 32;

/** Whether the cells of neighbouring chunks hide faces. Where another level is drawn beside, they must not. */
export type Border = "neighbours" | "closed";

/** Cells of a chunk as bits, with those next to it. */
export class Chunk {
  /** Row (y, z) at (y + 1) + (z + 1) * 34. */
  readonly rows = new Uint32Array(padded * padded);
  /** 1 where there is a cell before the first one of a row, and after the last one. */
  readonly before = new Uint8Array(padded * padded);
  readonly after = new Uint8Array(padded * padded);
  /** Class of each cell at x + 32 y + 1024 z; faces of different classes are not merged. */
  readonly classes = new Uint8Array(chunkEdge ** 3);
  /** Cells of the chunk itself. */
  cells = 0;

  clear(): void {
    this.rows.fill(0);
    this.before.fill(0);
    this.after.fill(0);
    this.classes.fill(0);
    this.cells = 0;
  }

  /** Marks cells x in [from, to) of a row; all in -1 to 32. */
  mark(from: number, to: number, y: number, z: number): void {
    const row = y + 1 + (z + 1) * padded;
    if (from < 0 && to > -1) this.before[row] = 1;
    if (from <= chunkEdge && to > chunkEdge) this.after[row] = 1;
    const first = Math.max(from, 0);
    const end = Math.min(to, chunkEdge);
    if (first >= end) return;
    const length = end - first;
    this.rows[row] |= length === 32 ? 0xffffffff : ((1 << length) - 1) << first;
  }

  /** Marks what is from `low` to before `high`, and neither here nor in `other`. */
  complementWith(other: Chunk, low: readonly number[], high: readonly number[]): void {
    const first = Math.max(low[0], 0);
    const length = Math.min(high[0], chunkEdge) - first;
    const bits = length <= 0 ? 0 : length === 32 ? 0xffffffff : ((1 << length) - 1) << first;
    const before = low[0] <= -1 && high[0] > -1 ? 1 : 0;
    const after = low[0] <= chunkEdge && high[0] > chunkEdge ? 1 : 0;
    for (let z = -1; z <= chunkEdge; ++z) {
      for (let y = -1; y <= chunkEdge; ++y) {
        const at = y + 1 + (z + 1) * padded;
        const inside = z >= low[2] && z < high[2] && y >= low[1] && y < high[1];
        this.rows[at] = inside ? bits & ~(this.rows[at] | other.rows[at]) : 0;
        this.before[at] = inside ? before & ~(this.before[at] | other.before[at]) : 0;
        this.after[at] = inside ? after & ~(this.after[at] | other.after[at]) : 0;
      }
    }
  }

  /** Forgets the neighbours, so that all faces at the border are made. */
  closeBorder(): void {
    this.before.fill(0);
    this.after.fill(0);
    for (let i = 0; i < padded; ++i) {
      for (const edge of [0, padded - 1]) {
        this.rows[i + edge * padded] = 0;
        this.rows[edge + i * padded] = 0;
      }
    }
  }
}

export type ClassOf = "none" | "probability" | "agreement";

/** Class of a probability or an agreement; 0 is only that of 0, which says that an agreement was not judged. */
export function classOfValue(value: number): number {
  return value === 0 ? 0 : 1 + Math.floor(((value - 1) * (classCount - 1)) / 255);
}

/** Fills a chunk with the cells of a level that the filter shows. `at` counts chunks of this level. */
export function loadCells(
  chunk: Chunk,
  level: Level,
  number: number,
  at: readonly number[],
  filter: Filter,
  classOf: ClassOf,
): void {
  chunk.clear();
  const values = classOf === "agreement" ? level.agreement : classOf === "probability" ? level.probability : null;
  const corner = at.map((c) => c * bricksPerEdge);
  for (let bz = -1; bz <= bricksPerEdge; ++bz) {
    for (let by = -1; by <= bricksPerEdge; ++by) {
      for (let bx = -1; bx <= bricksPerEdge; ++bx) {
        const b = level.index.find(corner[0] + bx, corner[1] + by, corner[2] + bz);
        if (b < 0) continue;
        const inside = (bx | by | bz) >= 0 && Math.max(bx, by, bz) < bricksPerEdge;
        let low = level.low[b];
        let high = level.high[b];
        if (filter.threshold > 0 || (inside && values)) {
          low = 0;
          high = 0;
          forEachCell(level, b, (bit, cell) => {
            if (level.probability[cell] < filter.threshold) return;
            if (bit < 32) low |= 1 << bit;
            else high |= 1 << (bit - 32);
            if (inside && values) {
              const x = 4 * bx + (bit & 3);
              const y = 4 * by + ((bit >> 2) & 3);
              const z = 4 * bz + (bit >> 4);
              chunk.classes[x + 32 * y + 1024 * z] = classOfValue(values[cell]);
            }
          });
        }
        for (let z = 0; z < 4; ++z) {
          const row = 4 * bz + z;
          if (row < -1 || row > chunkEdge) continue;
          if (!showsLayer(filter, 4 * level.z[b] + z, number)) continue;
          const plane = ((z < 2 ? low : high) >>> (16 * (z & 1))) & 0xffff;
          if (plane === 0) continue;
          if (inside) chunk.cells += bitCount(plane);
          for (let y = 0; y < 4; ++y) {
            const nibble = (plane >>> (4 * y)) & 15;
            const column = 4 * by + y;
            if (nibble === 0 || column < -1 || column > chunkEdge) continue;
            const at = column + 1 + (row + 1) * padded;
            if (bx < 0) chunk.before[at] |= nibble >>> 3;
            else if (bx === bricksPerEdge) chunk.after[at] |= nibble & 1;
            else chunk.rows[at] |= nibble << (4 * bx);
          }
        }
      }
    }
  }
}

/** In the upper bits of a coordinate: at which side of its rectangle the corner is. */
export const lowerSide = 64;
export const upperSide = 128;

/**
 * Rectangles as four corners of {x, y, z, direction * 32 + class}; directions are +x -x +y -y +z -z. Coordinates go
 * from 0 to 32; those along the rectangle have `lowerSide` or `upperSide` besides, so that drawing can close the gaps of
 * less than a pixel where the corner of one rectangle is at the edge of another.
 */
export class FaceList {
  private bytes = new Uint8Array(1 << 16);
  private length = 0;

  get faces(): number {
    return this.length / 16;
  }

  clear(): void {
    this.length = 0;
  }

  /** A copy of the corners, 16 bytes a face. */
  corners(): Uint8Array {
    return this.bytes.slice(0, this.length);
  }

  /** A rectangle [u0, u1] x [v0, v1] in the plane `at` across the direction's axis. */
  add(direction: number, at: number, u0: number, u1: number, v0: number, v1: number, kind: number): void {
    if (this.length + 16 > this.bytes.length) {
      const larger = new Uint8Array(2 * this.bytes.length);
      larger.set(this.bytes);
      this.bytes = larger;
    }
    // x and z: u cross v is the axis; y: the opposite.
    const forward = ((direction & 1) === 0) !== (direction >> 1 === 1);
    const [left, right, front, back] = [u0 | lowerSide, u1 | upperSide, v0 | lowerSide, v1 | upperSide];
    this.corner(direction, at, left, front, kind);
    if (forward) this.corner(direction, at, right, front, kind);
    else this.corner(direction, at, left, back, kind);
    this.corner(direction, at, right, back, kind);
    if (forward) this.corner(direction, at, left, back, kind);
    else this.corner(direction, at, right, front, kind);
  }

  private corner(direction: number, at: number, u: number, v: number, kind: number): void {
    const axis = direction >> 1;
    this.bytes[this.length] = axis === 0 ? at : u;
    this.bytes[this.length + 1] = axis === 0 ? u : axis === 1 ? at : v;
    this.bytes[this.length + 2] = axis === 2 ? at : v;
    this.bytes[this.length + 3] = direction * classCount + kind;
    this.length += 4;
  }
}

const plane = new Uint32Array(chunkEdge);
const planes = new Uint32Array(chunkEdge * chunkEdge);

/** Appends the faces of a chunk. */
export function makeFaces(chunk: Chunk, classOf: ClassOf, faces: FaceList): void {
  for (let direction = 0; direction < 6; ++direction) {
    const axis = direction >> 1;
    const positive = (direction & 1) === 0;
    if (axis === 0) exposedAlongX(chunk, positive);
    for (let at = 0; at < chunkEdge; ++at) {
      if (axis === 0) plane.set(planes.subarray(at * chunkEdge, (at + 1) * chunkEdge));
      else exposedAcross(chunk, axis, positive, at);
      mergePlane(chunk, classOf !== "none", direction, at, faces);
    }
  }
}

/** Fills `planes`: for each x the rows over z, bits over y. */
function exposedAlongX(chunk: Chunk, positive: boolean): void {
  planes.fill(0);
  for (let z = 0; z < chunkEdge; ++z) {
    for (let y = 0; y < chunkEdge; ++y) {
      const at = y + 1 + (z + 1) * padded;
      const row = chunk.rows[at];
      if (row === 0) continue;
      const hidden = positive ? (row >>> 1) | (chunk.after[at] << 31) : (row << 1) | chunk.before[at];
      for (let left = row & ~hidden; left !== 0; left &= left - 1) planes[lowestBit(left) * chunkEdge + z] |= 1 << y;
    }
  }
}

/** Fills `plane` at a y (rows over z) or a z (rows over y), bits over x. */
function exposedAcross(chunk: Chunk, axis: number, positive: boolean, at: number): void {
  const along = axis === 1 ? 1 : padded;
  const across = axis === 1 ? padded : 1;
  const start = (at + 1) * along;
  const neighbour = positive ? along : -along;
  for (let v = 0; v < chunkEdge; ++v) {
    const row = start + (v + 1) * across;
    plane[v] = chunk.rows[row] & ~chunk.rows[row + neighbour];
  }
}

function mergePlane(chunk: Chunk, byClass: boolean, direction: number, at: number, faces: FaceList): void {
  const axis = direction >> 1;
  const positive = (direction & 1) === 0;
  const face = positive ? at + 1 : at;
  const { classes } = chunk;
  // Step of the class array along u and v, and its start.
  const du = axis === 0 ? 32 : 1;
  const dv = axis === 2 ? 32 : 1024;
  const base = at * (axis === 0 ? 1 : axis === 1 ? 32 : 1024);
  for (let v = 0; v < chunkEdge; ++v) {
    while (plane[v] !== 0) {
      const word = plane[v];
      const u = lowestBit(word);
      const gap = ~(word >>> u);
      // Zeros come in from the left, so there is a gap unless all 32 are set.
      let length = gap === 0 ? 32 : lowestBit(gap);
      let kind = 0;
      if (byClass) {
        kind = classes[base + u * du + v * dv];
        for (let i = 1; i < length; ++i) {
          if (classes[base + (u + i) * du + v * dv] !== kind) {
            length = i;
            break;
          }
        }
      }
      const mask = length === 32 ? 0xffffffff : ((1 << length) - 1) << u;
      let end = v + 1;
      for (; end < chunkEdge && (plane[end] & mask) >>> 0 === mask >>> 0; ++end) {
        if (byClass && !sameClass(classes, base + u * du + end * dv, du, length, kind)) break;
      }
      for (let row = v; row < end; ++row) plane[row] &= ~mask;
      faces.add(direction, face, u, u + length, v, end, kind);
    }
  }
}

function sameClass(classes: Uint8Array, at: number, step: number, count: number, kind: number): boolean {
  for (let i = 0; i < count; ++i) {
    if (classes[at + i * step] !== kind) return false;
  }
  return true;
}

/** Cubes by the chunks that they lie in, for chunks of cells that are 2^level as large. */
export class CubeChunks {
  private readonly byChunk = new Map<number, number[]>();

  constructor(
    private readonly cubes: CubeColumns,
    readonly level: number,
  ) {
    const { x, y, z, size } = cubes;
    // A cube is in the chunks beside it, too, as it hides their faces.
    const unit = chunkEdge * 2 ** level;
    const first = (c: number) => Math.floor((c - 2 ** level) / unit);
    const end = (c: number) => Math.floor((c + 2 ** level) / unit) + 1;
    for (let i = 0; i < x.length; ++i) {
      for (let cz = first(z[i]); cz < end(z[i] + size[i] - 1); ++cz) {
        for (let cy = first(y[i]); cy < end(y[i] + size[i] - 1); ++cy) {
          for (let cx = first(x[i]); cx < end(x[i] + size[i] - 1); ++cx) {
            const key = chunkKey(cx, cy, cz);
            const list = this.byChunk.get(key);
            if (list) list.push(i);
            else this.byChunk.set(key, [i]);
          }
        }
      }
    }
  }

  /** Fills a chunk with the parts of the cubes that the filter shows. */
  load(chunk: Chunk, at: readonly number[], filter: Filter): void {
    chunk.clear();
    const { x, y, z, size } = this.cubes;
    const unit = 2 ** this.level;
    const [left, front, bottom] = at.map((c) => c * chunkEdge);
    for (const i of this.byChunk.get(chunkKey(at[0], at[1], at[2])) ?? []) {
      const end = (c: number, corner: number) => Math.min(Math.ceil((c + size[i]) / unit) - corner, chunkEdge + 1);
      const begin = (c: number, corner: number) => Math.max(Math.floor(c / unit) - corner, -1);
      for (let row = begin(z[i], bottom); row < end(z[i], bottom); ++row) {
        if (!showsLayer(filter, bottom + row, this.level)) continue;
        for (let column = begin(y[i], front); column < end(y[i], front); ++column) {
          chunk.mark(begin(x[i], left), end(x[i], left), column, row);
        }
      }
    }
  }
}

/** A number for each chunk; coordinates are 17 bits with their sign. */
function chunkKey(x: number, y: number, z: number): number {
  return ((x + 65536) * 131072 + (y + 65536)) * 131072 + (z + 65536);
}
