/** What the program serves: `scene.json` and the columns it names. See web/README.md for the bytes. */

export interface MapEntry {
  id: number;
  name: string;
  format: string;
  resolution_m: number;
  occupancy: number;
  bounds: { min: number[]; max: number[] } | null;
  occupied_cells: number;
  free_cells: number;
  cells: string;
  free: string | null;
  agreement: string | null;
}

export interface PathEntry {
  id: number;
  name: string;
  poses: number;
  url: string;
  clock: "unix" | "log";
}

export interface PointsEntry {
  id: number;
  name: string;
  count: number;
  url: string;
}

export interface LogEntry {
  id: number;
  name: string;
  beams: number;
  bins: number;
  beam_width_deg: number;
  beam_height_deg: number;
  mount: { position: number[]; quaternion: number[] };
  path: number | null;
  url: string;
  intensities: string;
}

export interface Scene {
  title: string;
  version: number;
  unit: string;
  axes: { x: string; y: string };
  origin_m: number[];
  maps: MapEntry[];
  paths: PathEntry[];
  points: PointsEntry[];
  logs: LogEntry[];
  notes: string[];
  /** Of a live run: the addresses of updates and controls. */
  live?: { events: string; state: string; changes: string; control: string | null };
}

/** Columns of `map/N/cells`; the typed arrays lie on the answer's own bytes. */
export interface CellColumns {
  version: number;
  /** Whether other bricks are as they were, and bricks without cells among these have none any more. */
  isPart: boolean;
  lowestProbability: number;
  resolution: number;
  x: Int32Array;
  y: Int32Array;
  z: Int32Array;
  low: Uint32Array;
  high: Uint32Array;
  probability: Uint8Array;
}

/** Columns of `map/N/free`: cubes of free cells, corner and edge in cells. */
export interface CubeColumns {
  x: Int32Array;
  y: Int32Array;
  z: Int32Array;
  size: Uint32Array;
}

export interface PathColumns {
  version: number;
  /** Number of the first pose. */
  first: number;
  time: Float64Array;
  x: Float32Array;
  y: Float32Array;
  z: Float32Array;
  qx: Float32Array;
  qy: Float32Array;
  qz: Float32Array;
  qw: Float32Array;
}

export interface PointColumns {
  hasValue: boolean;
  x: Float32Array;
  y: Float32Array;
  z: Float32Array;
  value: Float32Array;
}

export interface LogColumns {
  beams: number;
  bins: number;
  /** Number of the first beam. */
  firstNumber: number;
  time: Float64Array;
  bearing: Float32Array;
  first: Float32Array;
  binLength: Float32Array;
  echo: Float32Array;
  echoProbability: Float32Array;
  threshold: Float32Array;
  sweep: Uint32Array;
}

const magics = { cells: 0x43585650, free: 0x46585650, path: 0x50585650, points: 0x58585650, log: 0x4c585650 };

/** Takes columns off a buffer one after the other. */
class Columns {
  private at: number;
  private readonly header: DataView;

  constructor(
    private readonly bytes: ArrayBuffer,
    kind: keyof typeof magics,
    headerLength: number,
  ) {
    if (bytes.byteLength < headerLength) throw new Error(`${kind}: truncated, ${bytes.byteLength} bytes`);
    this.header = new DataView(bytes);
    if (this.header.getUint32(0, true) !== magics[kind]) throw new Error(`${kind}: unexpected type of answer`);
    this.at = headerLength;
  }

  word(index: number): number {
    return this.header.getUint32(4 * index, true);
  }

  real(index: number): number {
    return this.header.getFloat32(4 * index, true);
  }

  int32 = (count: number): Int32Array => new Int32Array(this.bytes, this.take(4 * count), count);
  uint32 = (count: number): Uint32Array => new Uint32Array(this.bytes, this.take(4 * count), count);
  float32 = (count: number): Float32Array => new Float32Array(this.bytes, this.take(4 * count), count);
  float64 = (count: number): Float64Array => new Float64Array(this.bytes, this.take(8 * count), count);
  uint8 = (count: number): Uint8Array => new Uint8Array(this.bytes, this.take(count), count);

  private take(length: number): number {
    const start = this.at;
    if (start + length > this.bytes.byteLength) throw new Error("the answer is truncated");
    this.at += length;
    return start;
  }
}

export function readCells(bytes: ArrayBuffer): CellColumns {
  const columns = new Columns(bytes, "cells", 32);
  const bricks = columns.word(1);
  return {
    version: columns.word(3),
    isPart: columns.word(6) === 1,
    lowestProbability: columns.real(4),
    resolution: columns.real(5),
    x: columns.int32(bricks),
    y: columns.int32(bricks),
    z: columns.int32(bricks),
    low: columns.uint32(bricks),
    high: columns.uint32(bricks),
    probability: columns.uint8(columns.word(2)),
  };
}

export function readFree(bytes: ArrayBuffer): CubeColumns {
  const columns = new Columns(bytes, "free", 16);
  const count = columns.word(1);
  return {
    x: columns.int32(count),
    y: columns.int32(count),
    z: columns.int32(count),
    size: columns.uint32(count),
  };
}

export function readPath(bytes: ArrayBuffer): PathColumns {
  const columns = new Columns(bytes, "path", 16);
  const count = columns.word(1);
  return {
    version: columns.word(2),
    first: columns.word(3),
    time: columns.float64(count),
    x: columns.float32(count),
    y: columns.float32(count),
    z: columns.float32(count),
    qx: columns.float32(count),
    qy: columns.float32(count),
    qz: columns.float32(count),
    qw: columns.float32(count),
  };
}

export function readPoints(bytes: ArrayBuffer): PointColumns {
  const columns = new Columns(bytes, "points", 16);
  const count = columns.word(1);
  return {
    hasValue: columns.word(2) !== 0,
    x: columns.float32(count),
    y: columns.float32(count),
    z: columns.float32(count),
    value: columns.float32(count),
  };
}

export function readLog(bytes: ArrayBuffer): LogColumns {
  const columns = new Columns(bytes, "log", 16);
  const beams = columns.word(1);
  return {
    beams,
    bins: columns.word(2),
    firstNumber: columns.word(3),
    time: columns.float64(beams),
    bearing: columns.float32(beams),
    first: columns.float32(beams),
    binLength: columns.float32(beams),
    echo: columns.float32(beams),
    echoProbability: columns.float32(beams),
    threshold: columns.float32(beams),
    sweep: columns.uint32(beams),
  };
}
