/** The map in three dimensions: renderer, camera and what is in the scene. Draws when something has changed. */
import { Box3, Color, Frustum, Matrix4, PerspectiveCamera, Scene as World, Vector3, WebGLRenderer } from "three";
import { OrbitCamera } from "./camera";
import type { MapLayer } from "./map_layer";

/** Faces drawn while the camera moves: the number goes up and down with the time that a frame takes. */
const budgets = { bySoftware: 1.5e5, byGraphics: 1e6, least: 3e4, most: 3e6 };
/** So many times more are drawn when the camera rests. */
const restFactor = 4;
const slowFrame = 0.075;
const fastFrame = 0.03;
/** Until the whole is drawn in full detail after the camera came to rest. */
const restSeconds = 0.25;

export class View3D {
  readonly world = new World();
  readonly orbit: OrbitCamera;
  readonly layers: MapLayer[] = [];
  /** Before each frame. */
  onFrame: (() => void)[] = [];

  private readonly renderer: WebGLRenderer;
  private budget: number;
  private pending = false;
  /** The camera has moved since the last frame. */
  private moved = false;
  private resting = true;
  private restTimer = 0;
  /** When the last frame of a movement began; 0 before its first. */
  private lastMoving = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const isSoftware = drawsBySoftware();
    this.budget = isSoftware ? budgets.bySoftware : budgets.byGraphics;
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware });
    this.renderer.setPixelRatio(isSoftware ? 1 : Math.min(window.devicePixelRatio, 2));
    this.world.matrixAutoUpdate = false;
    this.orbit = new OrbitCamera(canvas);
    this.orbit.onChange = () => {
      this.moved = true;
      this.resting = false;
      this.requestFrame();
    };
    this.orbit.pick = (x, y) => this.pick(x, y)?.point ?? null;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  setBackground(colour: string): void {
    this.renderer.setClearColor(new Color(colour), 1);
    this.requestFrame();
  }

  addLayer(layer: MapLayer): void {
    this.layers.push(layer);
    this.world.add(layer.group);
    layer.onChange = () => this.requestFrame();
    this.requestFrame();
  }

  requestFrame(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.frame();
    });
  }

  /** The nearest cell under a point of the screen, both coordinates -1 to 1. */
  pick(x: number, y: number) {
    const { start, direction } = this.orbit.ray(x, y);
    const hits = this.layers.flatMap((layer) => {
      const hit = layer.pick(start, direction);
      return hit ? [{ ...hit, layer, metres: hit.point.distanceTo(start) }] : [];
    });
    hits.sort((a, b) => a.metres - b.metres);
    return hits[0] ?? null;
  }

  get isComplete(): boolean {
    return this.layers.every((layer) => layer.complete);
  }

  /** Place on the canvas in CSS pixels, and whether it is before the camera. */
  project(point: Vector3): { x: number; y: number; inFront: boolean } {
    const { camera } = this.orbit;
    const at = point.clone().project(camera);
    const { clientWidth, clientHeight } = this.canvas;
    return { x: ((at.x + 1) / 2) * clientWidth, y: ((1 - at.y) / 2) * clientHeight, inFront: at.z < 1 };
  }

  /** Fits the canvas to the space that it has. */
  resize(): void {
    const parent = this.canvas.parentElement!;
    const { clientWidth, clientHeight } = parent;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.orbit.resize(clientWidth, clientHeight);
    // At once, as the canvas is empty after a change of size.
    this.frame();
  }

  private frame(): void {
    if (this.moved) this.adapt();
    const { camera } = this.orbit;
    const frustum = new Frustum().setFromMatrix(
      new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    const height = this.canvas.clientHeight * this.renderer.getPixelRatio();
    const nearest = new Vector3();
    const cellPixels = (box: Box3, cell: number) => {
      if (!frustum.intersectsBox(box)) return 0;
      if (!(camera instanceof PerspectiveCamera)) return (cell * height) / (camera.top - camera.bottom);
      const distance = box.clampPoint(camera.position, nearest).distanceTo(camera.position);
      return (cell * height * camera.projectionMatrix.elements[5]) / 2 / Math.max(distance, cell);
    };
    const budget = this.resting ? Math.min(restFactor * this.budget, budgets.most) : this.budget;
    for (const layer of this.layers) {
      layer.update({ cellPixels, enoughPixels: 1.5, budget });
    }
    for (const before of this.onFrame) before();
    this.renderer.render(this.world, camera);
    if (!this.moved) return;
    this.moved = false;
    clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => {
      this.resting = true;
      this.lastMoving = 0;
      this.requestFrame();
    }, 1000 * restSeconds);
  }

  /** By the time between the frames of a movement, as drawing goes on after the call. */
  private adapt(): void {
    const now = performance.now();
    const seconds = (now - this.lastMoving) / 1000;
    const isFirst = this.lastMoving === 0;
    this.lastMoving = now;
    if (isFirst) return;
    if (seconds > slowFrame) this.budget = Math.max(this.budget * Math.max(slowFrame / seconds, 0.5), budgets.least);
    if (seconds < fastFrame) this.budget = Math.min(this.budget * 1.1, budgets.most);
  }
}

/** Whether the processor draws: then a frame takes as long as its pixels are many. */
function drawsBySoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl");
  if (!context) throw new Error("The map needs WebGL, which this browser does not provide");
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name = names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /llvmpipe|softpipe|swiftshader|software|basic render/i.test(name);
}
