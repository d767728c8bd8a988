/** A map in the scene: chunks of its levels, made into faces as the camera needs them. */
import { Box3, Group, type Mesh, type RawShaderMaterial, Vector3 } from "three";
import { castRay, everything, type Filter, finestLevel, type Hit, type Level } from "./cells";
import { disposeMesh, faceMesh } from "./face_mesh";
import type { FaceService } from "./face_service";
import { chunkEdge, type ClassOf } from "./faces";
import type { MapAnswer, Space } from "./faces_protocol";
import { chooseDetail } from "./level_of_detail";
import { chunksAround } from "./live_cells";
import { type CellColumns, type MapEntry, readCells } from "./scene";

interface Node {
  level: number;
  at: number[];
  box: Box3;
  cells: number;
  children: Node[];
  mesh: Mesh | null;
  ready: boolean;
  faces: number;
  /** That of the filter which the faces were made for. */
  generation: number;
  /** How often its cells have changed. */
  revision: number;
  shownCells: number;
}

/** Chunks that are asked for at a time; the next ones are chosen when these are there. */
const batch = 96;
/** The first picture is of the finest level that has no more chunks. */
const mostFirstChunks = 400;
/** Faces that are kept, of which not all are drawn. */
const mostFacesKept = 4e6;
/** Free space of a map that grows is loaded so often at most. */
const freeEverySeconds = 4;
/** Of a cell of a chunk that was not made yet. */
const guessedFaces = 1;

export interface DetailOptions {
  cellPixels: (box: Box3, cell: number) => number;
  enoughPixels: number;
  budget: number;
}

export class MapLayer {
  readonly group = new Group();
  readonly spaces: Record<Space, Group> = { free: new Group(), unknown: new Group() };
  readonly bounds = new Box3();
  filter: Filter = everything;
  classOf: ClassOf = "none";
  /** Cells of this level are the smallest that are drawn: the cut depth. */
  finest = 0;
  /** Called when there is something new to draw. */
  onChange: () => void = () => {};
  onError: (error: unknown) => void = () => {};
  facesDrawn = 0;
  cellsDrawn = 0;
  complete = false;

  private nodes: Node[][] = [];
  private generation = 0;
  private asked = 0;
  private readonly picking: { level: Level | null } = { level: null };
  private drawn: Node[] = [];
  private readonly shown: Record<Space, boolean> = { free: false, unknown: false };
  private readonly spaceGeneration: Record<Space, number> = { free: -1, unknown: -1 };
  private freeCubes: ArrayBuffer | null = null;
  /** Whether free cubes are still to be loaded, are loaded, or are known to the worker. */
  private freeIs: "missing" | "here" | "known" = "missing";
  private freeAsked = -Infinity;

  constructor(
    readonly entry: MapEntry,
    public extent: MapAnswer,
    private columns: ArrayBuffer,
    private readonly agreement: ArrayBuffer | null,
    private readonly origin: readonly number[],
    private readonly service: FaceService,
    readonly material: RawShaderMaterial,
    private readonly spaceMaterials: Record<Space, RawShaderMaterial>,
  ) {
    this.makeNodes(() => false);
    this.group.add(this.spaces.unknown);
    this.group.add(this.spaces.free);
  }

  get cells(): ArrayBuffer {
    return this.columns;
  }

  /** Takes the cells of a map that has changed; `changed` are the bricks where it has, null: all of it. */
  replaceCells(extent: MapAnswer, columns: ArrayBuffer, changed: CellColumns | null): void {
    this.extent = extent;
    this.columns = columns;
    this.picking.level = null;
    const touched = extent.levels.map((_, level) => (changed ? chunksAround(changed, level, chunkEdge) : null));
    this.makeNodes((level, at) => touched[level]?.has(at) ?? true);
    this.onChange();
  }

  /** Makes the chunks of the levels; those that were there keep their faces until these are rebuilt. */
  private makeNodes(isChanged: (level: number, at: string) => boolean): void {
    const { extent } = this;
    const before = new Map<string, Node>();
    for (const node of this.nodes.flat()) before.set(`${node.level}:${node.at.join(",")}`, node);
    this.nodes = [];
    const byKey = new Map<string, Node>();
    for (let level = extent.levels.length - 1; level >= 0; --level) {
      const chunks = extent.levels[level];
      const nodes: Node[] = [];
      for (let i = 0; i < chunks.length; i += 4) {
        const at = [chunks[i], chunks[i + 1], chunks[i + 2]];
        const key = `${level}:${at.join(",")}`;
        const node = before.get(key) ?? this.newNode(level, at, chunks[i + 3]);
        before.delete(key);
        node.children = [];
        node.cells = chunks[i + 3];
        if (isChanged(level, at.join(","))) {
          node.generation = -1;
          ++node.revision;
        }
        nodes.push(node);
        byKey.set(key, node);
        byKey.get(`${level + 1}:${at.map((c) => c >> 1).join(",")}`)?.children.push(node);
      }
      this.nodes[level] = nodes;
    }
    for (const gone of before.values()) {
      this.drop(gone);
      gone.revision = -1;
    }
    const { from, end } = extent;
    if (end[0] > from[0]) this.bounds.set(this.metres(from), this.metres(end));
    else this.bounds.makeEmpty();
  }

  private newNode(level: number, at: number[], cells: number): Node {
    const corner = this.cornerOf(at, level);
    const edge = chunkEdge * this.cellOf(level);
    return {
      level,
      at,
      box: new Box3(corner, corner.clone().addScalar(edge)),
      cells,
      children: [],
      mesh: null,
      ready: false,
      faces: cells * guessedFaces,
      generation: -1,
      revision: 0,
      shownCells: 0,
    };
  }

  /** The level that the map is shown by at first. */
  private get firstLevel(): number {
    const first = this.nodes.findIndex((nodes) => nodes.length <= mostFirstChunks);
    return Math.max(first < 0 ? this.nodes.length - 1 : first, this.finest);
  }

  private get roots(): readonly Node[] {
    return this.nodes[this.firstLevel];
  }

  /** Chunks that cover the map within the budget, and those that are missing of a coarser level which would. */
  private cover(budget: number): { roots: readonly Node[]; missing: Node[] } {
    let level = this.firstLevel;
    while (level + 1 < this.nodes.length && this.nodes[level].reduce((sum, node) => sum + node.faces, 0) > budget) {
      const missing = this.nodes[level + 1].filter((node) => !node.ready);
      if (missing.length > 0) return { roots: this.nodes[level], missing };
      ++level;
    }
    return { roots: this.nodes[level], missing: [] };
  }

  /** Whether all of the map is drawn, be it coarsely. */
  get isShown(): boolean {
    return !this.group.visible || this.roots.every((node) => node.ready);
  }

  get levels(): number {
    return this.nodes.length;
  }

  cellOf(level: number): number {
    return this.entry.resolution_m * 2 ** level;
  }

  /** Scene coordinates of a cell's lower corner. */
  metres(cell: readonly number[]): Vector3 {
    const [x, y, z] = cell.map((c, axis) => c * this.entry.resolution_m - this.origin[axis]);
    return new Vector3(x, y, z);
  }

  /** Rebuilds all faces, as filter, classes or cut depth have changed; until then the old ones are shown. */
  remake(): void {
    ++this.generation;
    this.onChange();
  }

  /** Chooses what to draw and asks for what is missing. */
  update(options: DetailOptions): void {
    if (!this.group.visible) {
      this.complete = true;
      this.facesDrawn = this.cellsDrawn = 0;
      return;
    }
    const { roots, missing } = this.cover(options.budget);
    const choice = chooseDetail(roots, (node) => options.cellPixels(node.box, this.cellOf(node.level)), {
      enoughPixels: options.enoughPixels,
      finestLevel: this.finest,
      budget: options.budget,
    });
    for (const node of this.drawn) if (node.mesh) node.mesh.visible = false;
    this.drawn = choice.draw;
    this.facesDrawn = 0;
    this.cellsDrawn = 0;
    const stale: Node[] = [];
    for (const node of choice.draw) {
      if (node.mesh) node.mesh.visible = true;
      this.facesDrawn += node.faces;
      this.cellsDrawn += node.shownCells;
      if (node.generation !== this.generation) stale.push(node);
    }
    const staleSpaces = (["free", "unknown"] as const).filter(
      (space) => this.shown[space] && this.spaceGeneration[space] !== this.generation,
    );
    this.complete = choice.complete && stale.length === 0 && staleSpaces.length === 0;
    if (this.asked > 0) return;
    const wanted = [...stale, ...choice.wanted, ...missing].slice(0, batch);
    for (const node of wanted) this.make(node).catch(this.onError);
    if (wanted.length === 0 && staleSpaces.length > 0 && this.freeIs !== "missing")
      this.makeSpace(staleSpaces[0]).catch(this.onError);
    this.forgetUnused();
  }

  private async make(node: Node): Promise<void> {
    ++this.asked;
    const { level, at, revision } = node;
    const answer = await this.service.ask({
      kind: "faces",
      map: this.entry.id,
      level,
      at,
      filter: this.filter,
      classOf: this.classOf,
      border: level === this.finest ? "neighbours" : "closed",
      generation: this.generation,
    });
    --this.asked;
    if (node.revision < 0) {
      if (this.asked === 0) this.onChange();
      return;
    }
    this.drop(node);
    // Its cells may have changed meanwhile.
    node.generation = node.revision === revision ? answer.generation : -1;
    node.ready = true;
    node.faces = answer.corners.length / 16;
    node.shownCells = answer.cells;
    if (node.faces > 0) {
      node.mesh = faceMesh(answer.corners, this.cornerOf(at, level), this.cellOf(level), this.material);
      node.mesh.visible = this.drawn.includes(node);
      this.group.add(node.mesh);
    }
    if (this.asked === 0) this.onChange();
  }

  private drop(node: Node): void {
    if (!node.mesh) return;
    this.group.remove(node.mesh);
    disposeMesh(node.mesh);
    node.mesh = null;
  }

  private forgetUnused(): void {
    const ready = this.nodes.flat().filter((node) => node.mesh);
    let kept = ready.reduce((sum, node) => sum + node.faces, 0);
    if (kept <= mostFacesKept) return;
    const used = new Set([...this.drawn, ...this.roots]);
    for (const node of ready) {
      if (kept <= mostFacesKept / 2) break;
      if (used.has(node)) continue;
      kept -= node.faces;
      this.drop(node);
      node.ready = false;
    }
  }

  /** Shows free or unknown space; `load` brings the free cubes. */
  showSpace(space: Space, shown: boolean, load: () => Promise<ArrayBuffer>): void {
    this.shown[space] = shown;
    if (!shown) clearSpace(this.spaces[space]);
    else if (this.freeIs === "missing") this.loadFree(load).catch(this.onError);
    this.spaceGeneration[space] = -1;
    this.onChange();
  }

  /** Rebuilds what is shown, as the map has grown; now and then, since all free cubes come again. */
  renewSpaces(load: () => Promise<ArrayBuffer>): void {
    if (performance.now() - this.freeAsked < 1000 * freeEverySeconds) return;
    if (!this.shown.free && !this.shown.unknown) {
      if (this.freeIs === "known") this.freeIs = "missing";
      return;
    }
    // Where it fails, it is asked for again.
    this.loadFree(load).catch(() => {});
  }

  private async loadFree(load: () => Promise<ArrayBuffer>): Promise<void> {
    this.freeAsked = performance.now();
    this.freeCubes = await load();
    this.freeIs = "here";
    this.spaceGeneration.free = this.spaceGeneration.unknown = -1;
    this.onChange();
  }

  private async makeSpace(space: Space): Promise<void> {
    ++this.asked;
    const { resolution_m, bounds } = this.entry;
    const { generation } = this;
    const round = (m: number) => Math.round(m / resolution_m);
    const free = this.freeCubes;
    this.freeCubes = null;
    this.freeIs = "known";
    const answer = await this.service.ask({
      kind: "space",
      map: this.entry.id,
      space,
      free,
      filter: this.filter,
      generation,
      bounds: bounds && { from: bounds.min.map(round), end: bounds.max.map(round) },
    });
    --this.asked;
    const group = this.spaces[space];
    clearSpace(group);
    if (this.shown[space]) {
      this.spaceGeneration[space] = generation;
      for (const { at, corners } of answer.chunks) {
        const corner = this.cornerOf(at, answer.level);
        const mesh = faceMesh(corners, corner, this.cellOf(answer.level), this.spaceMaterials[space]);
        mesh.renderOrder = space === "free" ? 1 : 0;
        group.add(mesh);
      }
    }
    this.onChange();
  }

  /** Where a ray meets a cell that is shown; start in metres of the scene. */
  pick(start: Vector3, direction: Vector3): (Hit & { point: Vector3 }) | null {
    if (!this.group.visible || this.bounds.isEmpty()) return null;
    const box = this.bounds.clone().expandByScalar(this.entry.resolution_m);
    const enters = entersBox(box, start, direction);
    if (enters === null) return null;
    const level = (this.picking.level ??= finestLevel(
      readCells(this.columns),
      this.agreement ? new Uint8Array(this.agreement) : null,
    ));
    const cell = this.entry.resolution_m;
    const at = start.clone().addScaledVector(direction, enters.from);
    const inCells = [at.x, at.y, at.z].map((m, axis) => (m + this.origin[axis]) / cell);
    const hit = castRay(
      level,
      0,
      this.filter,
      inCells,
      [direction.x, direction.y, direction.z],
      (enters.to - enters.from) / cell,
    );
    if (!hit) return null;
    return { ...hit, point: at.addScaledVector(direction, hit.distance * cell) };
  }

  valuesOf(hit: Hit): { probability: number; agreement: number | null } {
    const level = this.picking.level!;
    return {
      probability: level.probability[hit.values] / 255,
      agreement: level.agreement ? level.agreement[hit.values] : null,
    };
  }

  private cornerOf(at: readonly number[], level: number): Vector3 {
    return this.metres(at.map((c) => c * chunkEdge * 2 ** level));
  }
}

function clearSpace(group: Group): void {
  for (const mesh of [...group.children] as Mesh[]) {
    group.remove(mesh);
    disposeMesh(mesh);
  }
}

function entersBox(box: Box3, start: Vector3, direction: Vector3): { from: number; to: number } | null {
  let from = 0;
  let to = Infinity;
  for (const axis of ["x", "y", "z"] as const) {
    if (direction[axis] === 0) {
      if (start[axis] < box.min[axis] || start[axis] > box.max[axis]) return null;
      continue;
    }
    const a = (box.min[axis] - start[axis]) / direction[axis];
    const b = (box.max[axis] - start[axis]) / direction[axis];
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  return from <= to ? { from, to } : null;
}
