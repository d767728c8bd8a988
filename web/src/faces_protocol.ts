/** The messages between page and worker. */
import type { Filter } from "./cells";
import type { Border, ClassOf } from "./faces";

export type Space = "free" | "unknown";

export interface MapRequest {
  kind: "map";
  map: number;
  cells: ArrayBuffer;
  agreement: ArrayBuffer | null;
}

export interface FacesRequest {
  kind: "faces";
  map: number;
  level: number;
  at: number[];
  filter: Filter;
  classOf: ClassOf;
  border: Border;
  /** Comes back with the answer. */
  generation: number;
}

export interface CellBounds {
  from: number[];
  end: number[];
}

export interface SpaceRequest {
  kind: "space";
  map: number;
  space: Space;
  /** Bytes of `map/N/free`; null when an earlier request brought them. */
  free: ArrayBuffer | null;
  /** First and end cell of the map's bounds; null: those of its cells. */
  bounds: CellBounds | null;
  filter: Filter;
  generation: number;
}

export type Request = MapRequest | FacesRequest | SpaceRequest;

export interface MapAnswer {
  kind: "map";
  map: number;
  /** Chunks of each level, from the finest: x, y, z and number of cells. */
  levels: Int32Array[];
  /** Cells in each layer of the finest level, from `lowestLayer` on. */
  layers: Uint32Array;
  lowestLayer: number;
  /** First and end cell of what is occupied. */
  from: number[];
  end: number[];
}

export interface FacesAnswer {
  kind: "faces";
  map: number;
  level: number;
  at: number[];
  generation: number;
  corners: Uint8Array;
  /** Cells shown in the chunk. */
  cells: number;
}

export interface SpaceAnswer {
  kind: "space";
  map: number;
  space: Space;
  generation: number;
  level: number;
  chunks: { at: number[]; corners: Uint8Array }[];
}

export type Answer = MapAnswer | FacesAnswer | SpaceAnswer;
