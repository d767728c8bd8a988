/** Keeps the cells of the maps in a worker and makes faces of them when the page asks. */
import { coarserLevel, everything, type Filter, finestLevel, forEachCell, type Level } from "./cells";
import { Chunk, chunkEdge, CubeChunks, FaceList, loadCells, makeFaces } from "./faces";
import type {
  Answer,
  CellBounds,
  FacesRequest,
  MapAnswer,
  MapRequest,
  Request,
  SpaceAnswer,
  SpaceRequest,
} from "./faces_protocol";
import { type CubeColumns, readCells, readFree } from "./scene";

interface LoadedMap {
  levels: Level[];
  free: CubeColumns | null;
  /** The same by chunks of the level that was asked for last. */
  cubes: CubeChunks | null;
}

const mostLevels = 12;
/** Of free or unknown space: where there would be more, it is shown by coarser cells. */
const mostSpaceChunks = 1500;

export class FaceMaker {
  private readonly maps = new Map<number, LoadedMap>();
  private readonly chunk = new Chunk();
  private readonly other = new Chunk();
  private readonly faces = new FaceList();

  answer(request: Request): Answer {
    switch (request.kind) {
      case "map":
        return this.load(request);
      case "faces":
        return this.makeChunk(request);
      case "space":
        return this.makeSpace(request);
    }
  }

  private load(request: MapRequest): MapAnswer {
    const agreement = request.agreement ? new Uint8Array(request.agreement) : null;
    const levels = [finestLevel(readCells(request.cells), agreement)];
    const chunks = [chunksOf(levels[0])];
    while (chunks[chunks.length - 1].length > 4 && levels.length < mostLevels) {
      levels.push(coarserLevel(levels[levels.length - 1]));
      chunks.push(chunksOf(levels[levels.length - 1]));
    }
    const free = this.maps.get(request.map)?.free ?? null;
    this.maps.set(request.map, { levels, free, cubes: null });
    return { kind: "map", map: request.map, levels: chunks, ...extentOf(levels[0]) };
  }

  private makeChunk({ map, level, at, filter, classOf, border, generation }: FacesRequest): Answer {
    const cells = this.maps.get(map)!.levels[level];
    // A map that has changed may have fewer levels.
    if (cells) loadCells(this.chunk, cells, level, at, filter, classOf);
    else this.chunk.clear();
    if (border === "closed") this.chunk.closeBorder();
    this.faces.clear();
    makeFaces(this.chunk, classOf, this.faces);
    return { kind: "faces", map, level, at, generation, corners: this.faces.corners(), cells: this.chunk.cells };
  }

  private makeSpace({ map, space, free, bounds: known, filter, generation }: SpaceRequest): SpaceAnswer {
    const loaded = this.maps.get(map)!;
    if (free) {
      loaded.free = readFree(free);
      loaded.cubes = null;
    }
    const bounds = known ?? boundsOf(loaded.levels[0], loaded.free!);
    let level = 0;
    const chunkRange = () => {
      const unit = chunkEdge * 2 ** level;
      return { from: bounds.from.map((c) => Math.floor(c / unit)), end: bounds.end.map((c) => Math.ceil(c / unit)) };
    };
    const countOf = ({ from, end }: { from: number[]; end: number[] }) =>
      from.reduce((product, c, axis) => product * (end[axis] - c), 1);
    while (countOf(chunkRange()) > mostSpaceChunks && level + 1 < loaded.levels.length) ++level;
    if (loaded.cubes?.level !== level) loaded.cubes = new CubeChunks(loaded.free!, level);
    const { cubes } = loaded;
    const chunks: SpaceAnswer["chunks"] = [];
    const { from, end } = chunkRange();
    for (let z = from[2]; z < end[2]; ++z) {
      for (let y = from[1]; y < end[1]; ++y) {
        for (let x = from[0]; x < end[0]; ++x) {
          const at = [x, y, z];
          cubes.load(this.chunk, at, filter);
          if (space === "unknown") this.complement(loaded.levels[level], level, at, bounds, filter);
          this.faces.clear();
          makeFaces(this.chunk, "none", this.faces);
          if (this.faces.faces > 0) chunks.push({ at, corners: this.faces.corners() });
        }
      }
    }
    return { kind: "space", map, space, generation, level, chunks };
  }

  /**
   * Turns free cells into unknown ones. Without limits of height all that is around the map is unknown, which shows no
   * faces outside; with limits it is a block, cut at the map's bounds.
   */
  private complement(
    level: Level,
    number: number,
    at: number[],
    bounds: CellBounds,
    filter: Filter,
  ): void {
    const limits: Filter = { ...everything, lowest: filter.lowest, end: filter.end };
    loadCells(this.other, level, number, at, limits, "none");
    const isBlock = filter.lowest > bounds.from[2] || filter.end < bounds.end[2];
    if (!isBlock) {
      this.chunk.complementWith(this.other, [-2, -2, -2], [chunkEdge + 2, chunkEdge + 2, chunkEdge + 2]);
      return;
    }
    const unit = 2 ** number;
    const from = [bounds.from[0], bounds.from[1], Math.max(bounds.from[2], filter.lowest)];
    const end = [bounds.end[0], bounds.end[1], Math.min(bounds.end[2], filter.end)];
    this.chunk.complementWith(
      this.other,
      from.map((c, axis) => Math.floor(c / unit) - at[axis] * chunkEdge),
      end.map((c, axis) => Math.ceil(c / unit) - at[axis] * chunkEdge),
    );
  }
}

/** x, y, z and number of cells of each chunk. */
function chunksOf(level: Level): Int32Array {
  const found = new Map<string, number>();
  const chunks: number[] = [];
  for (let b = 0; b < level.bricks; ++b) {
    const at = [level.x[b] >> 3, level.y[b] >> 3, level.z[b] >> 3];
    const key = at.join(",");
    let place = found.get(key);
    if (place === undefined) {
      place = chunks.length;
      found.set(key, place);
      chunks.push(...at, 0);
    }
    const end = b + 1 < level.bricks ? level.first[b + 1] : level.probability.length;
    chunks[place + 3] += end - level.first[b];
  }
  return Int32Array.from(chunks);
}

function extentOf(level: Level): Pick<MapAnswer, "layers" | "lowestLayer" | "from" | "end"> {
  const from = [Infinity, Infinity, Infinity];
  const end = [-Infinity, -Infinity, -Infinity];
  const counts = new Map<number, number>();
  for (let b = 0; b < level.bricks; ++b) {
    const corner = [level.x[b] * 4, level.y[b] * 4, level.z[b] * 4];
    forEachCell(level, b, (bit) => {
      const cell = [corner[0] + (bit & 3), corner[1] + ((bit >> 2) & 3), corner[2] + (bit >> 4)];
      for (let axis = 0; axis < 3; ++axis) {
        if (cell[axis] < from[axis]) from[axis] = cell[axis];
        if (cell[axis] >= end[axis]) end[axis] = cell[axis] + 1;
      }
      counts.set(cell[2], (counts.get(cell[2]) ?? 0) + 1);
    });
  }
  if (level.bricks === 0) return { layers: new Uint32Array(0), lowestLayer: 0, from: [0, 0, 0], end: [0, 0, 0] };
  const layers = new Uint32Array(end[2] - from[2]);
  for (const [z, count] of counts) layers[z - from[2]] = count;
  return { layers, lowestLayer: from[2], from, end };
}

/** Of occupied and free cells. */
function boundsOf(level: Level, free: CubeColumns): CellBounds {
  const { from, end } = extentOf(level);
  const isEmpty = level.bricks === 0;
  [free.x, free.y, free.z].forEach((column, axis) => {
    let lowest = isEmpty ? Infinity : from[axis];
    let highest = isEmpty ? -Infinity : end[axis];
    for (let i = 0; i < column.length; ++i) {
      lowest = Math.min(lowest, column[i]);
      highest = Math.max(highest, column[i] + free.size[i]);
    }
    from[axis] = lowest < highest ? lowest : 0;
    end[axis] = lowest < highest ? highest : 0;
  });
  return { from, end };
}

/** Answers the messages of a worker's scope. */
export function serveFaces(scope: { onmessage: ((event: MessageEvent) => void) | null }): void {
  const maker = new FaceMaker();
  scope.onmessage = (event) => {
    const answer = maker.answer(event.data as Request);
    const buffers =
      answer.kind === "faces"
        ? [answer.corners.buffer]
        : answer.kind === "space"
          ? answer.chunks.map((chunk) => chunk.corners.buffer)
          : [];
    (scope as unknown as Worker).postMessage(answer, buffers as Transferable[]);
  };
}
