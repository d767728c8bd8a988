/** A camera that goes around a point, with the vertical upright: free (perspective), from above and from the side. */
import { Box3, Matrix4, OrthographicCamera, PerspectiveCamera, Vector3 } from "three";

export type View = "free" | "top" | "side";

const fieldOfView = (45 * Math.PI) / 180;
const moveSeconds = 0.3;
/** Around the whole scene. */
const margin = 1.12;

interface Place {
  target: Vector3;
  distance: number;
  /** Direction from the target to the camera: angle from east, and from straight up. */
  azimuth: number;
  polar: number;
}

export class OrbitCamera {
  view: View = "free";
  place: Place = { target: new Vector3(), distance: 10, azimuth: -Math.PI / 3, polar: Math.PI / 3.2 };
  /** Where a ray through a point of the screen (both -1 to 1) meets the map. */
  pick: (x: number, y: number) => Vector3 | null = () => null;
  /** After each change; `moving` while there is more to come. */
  onChange: (moving: boolean) => void = () => {};
  onView: (view: View) => void = () => {};

  /** Whether it was moved since the whole scene was shown. */
  isMoved = false;

  private readonly perspective = new PerspectiveCamera((fieldOfView * 180) / Math.PI);
  private readonly orthographic = new OrthographicCamera(-1, 1, 1, -1);
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private readonly box = new Box3();
  private readonly sphere = { centre: new Vector3(), radius: 10 };
  private width = 1;
  private height = 1;
  private move = 0;

  constructor(private readonly element: HTMLElement) {
    element.addEventListener("pointerdown", this.onPointerDown);
    element.addEventListener("pointermove", this.onPointerMove);
    element.addEventListener("pointerup", this.onPointerUp);
    element.addEventListener("pointercancel", this.onPointerUp);
    element.addEventListener("wheel", this.onWheel, { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("keydown", this.onKey);
    this.perspective.matrixAutoUpdate = false;
    this.orthographic.matrixAutoUpdate = false;
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.view === "free" ? this.perspective : this.orthographic;
  }

  /** Metres on the target's plane for each pixel of the element. */
  get metresPerPixel(): number {
    return (2 * this.place.distance * Math.tan(fieldOfView / 2)) / this.height;
  }

  resize(width: number, height: number): void {
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
    this.apply();
  }

  /** What there is to see. */
  setScene(box: Box3): void {
    this.box.copy(box);
    box.getCenter(this.sphere.centre);
    this.sphere.radius = Math.max(box.min.distanceTo(box.max) / 2, 0.5);
  }

  /** Shows the whole scene in a view. */
  showAll(view = this.view, animate: "animate" | "jump" = "animate"): void {
    const angles = {
      free: { azimuth: -Math.PI / 3, polar: Math.PI / 3.4 },
      top: { azimuth: -Math.PI / 2, polar: 0 },
      side: { azimuth: -Math.PI / 2, polar: Math.PI / 2 },
    }[view];
    this.view = view;
    this.isMoved = false;
    this.onView(view);
    const distance = this.fittingDistance(angles);
    this.goTo({ target: this.sphere.centre.clone(), distance, ...angles }, animate);
  }

  /** From where all corners of the scene are in the picture. */
  private fittingDistance(angles: { azimuth: number; polar: number }): number {
    const tangent = Math.tan(fieldOfView / 2);
    const [right, up, back] = axesOf(angles);
    let distance = 0.5;
    for (let i = 0; i < 8; ++i) {
      const corner = new Vector3(
        i & 1 ? this.box.max.x : this.box.min.x,
        i & 2 ? this.box.max.y : this.box.min.y,
        i & 4 ? this.box.max.z : this.box.min.z,
      ).sub(this.sphere.centre);
      const across = Math.abs(corner.dot(right)) / (this.width / this.height);
      const nearer = this.view === "free" ? corner.dot(back) : 0;
      distance = Math.max(distance, (margin * Math.max(across, Math.abs(corner.dot(up)))) / tangent + nearer);
    }
    return distance;
  }

  turnTo(azimuth: number): void {
    this.isMoved = true;
    this.goTo({ ...this.place, target: this.place.target.clone(), azimuth }, "animate");
  }

  lookAt(target: Vector3): void {
    this.isMoved = true;
    this.goTo({ ...this.place, target: target.clone() }, "animate");
  }

  /** A ray through a point of the screen, both coordinates -1 to 1. */
  ray(x: number, y: number): { start: Vector3; direction: Vector3 } {
    const near = new Vector3(x, y, -1).unproject(this.camera);
    const far = new Vector3(x, y, 1).unproject(this.camera);
    return { start: near, direction: far.sub(near).normalize() };
  }

  /** Turns by angles, moves by pixels, or comes nearer by a factor. */
  turn(azimuth: number, polar: number): void {
    this.isMoved = true;
    if (this.view === "top") polar = 0;
    this.place.azimuth += azimuth;
    this.place.polar = Math.min(Math.max(this.place.polar + polar, this.view === "free" ? 0.001 : 0), Math.PI - 0.001);
    if (this.view === "side") this.place.polar = Math.PI / 2;
    this.apply();
  }

  pan(right: number, up: number): void {
    this.isMoved = true;
    const scale = this.metresPerPixel;
    const [x, y] = axesOf(this.place);
    this.place.target.addScaledVector(x, right * scale).addScaledVector(y, up * scale);
    this.apply();
  }

  zoom(factor: number, anchor: Vector3 | null = null): void {
    this.isMoved = true;
    const distance = Math.min(Math.max(this.place.distance * factor, 0.05), 50 * this.sphere.radius);
    if (anchor) this.place.target.lerp(anchor, 1 - distance / this.place.distance);
    this.place.distance = distance;
    this.apply();
  }

  private goTo(place: Place, how: "animate" | "jump"): void {
    cancelAnimationFrame(this.move);
    const from = { ...this.place, target: this.place.target.clone() };
    // The short way around.
    from.azimuth =
      place.azimuth + Math.atan2(Math.sin(from.azimuth - place.azimuth), Math.cos(from.azimuth - place.azimuth));
    const started = performance.now();
    const step = () => {
      const still = how === "jump" || matchMedia("(prefers-reduced-motion: reduce)").matches;
      const part = still ? 1 : Math.min((performance.now() - started) / 1000 / moveSeconds, 1);
      const eased = part * part * (3 - 2 * part);
      this.place.target.lerpVectors(from.target, place.target, eased);
      this.place.distance = from.distance * (place.distance / from.distance) ** eased;
      this.place.azimuth = from.azimuth + (place.azimuth - from.azimuth) * eased;
      this.place.polar = from.polar + (place.polar - from.polar) * eased;
      this.apply(part < 1);
      if (part < 1) this.move = requestAnimationFrame(step);
    };
    step();
  }

  private apply(moving = false): void {
    const { camera } = this;
    const [right, up, back] = axesOf(this.place);
    const { radius, centre } = this.sphere;
    const orthographicDistance = Math.max(this.place.distance, 2 * radius + this.place.target.distanceTo(centre));
    const distance = this.view === "free" ? this.place.distance : orthographicDistance;
    const position = this.place.target.clone().addScaledVector(back, distance);
    camera.position.copy(position);
    camera.matrix.copy(new Matrix4().makeBasis(right, up, back).setPosition(position.x, position.y, position.z));
    camera.matrixWorldNeedsUpdate = true;
    const far = position.distanceTo(centre) + 1.5 * radius;
    const aspect = this.width / this.height;
    if (camera instanceof PerspectiveCamera) {
      camera.aspect = aspect;
      camera.far = far;
      camera.near = Math.max(far / 20000, Math.min(this.place.distance / 50, far - 3 * radius));
    } else {
      const half = this.place.distance * Math.tan(fieldOfView / 2);
      camera.left = -half * aspect;
      camera.right = half * aspect;
      camera.top = half;
      camera.bottom = -half;
      camera.near = 0.01;
      camera.far = far;
    }
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    this.onChange(moving);
  }

  private screen(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.element.getBoundingClientRect();
    return [((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2];
  }

  /** The point under the pointer: of the map, or on the target's plane. */
  private anchor(event: { clientX: number; clientY: number }): Vector3 {
    const [x, y] = this.screen(event);
    const picked = this.pick(x, y);
    if (picked) return picked;
    const { start, direction } = this.ray(x, y);
    const back = axesOf(this.place)[2];
    const distance = this.place.target.clone().sub(start).dot(back) / direction.dot(back);
    return start.addScaledVector(direction, distance);
  }

  private readonly onPointerDown = (event: PointerEvent) => {
    cancelAnimationFrame(this.move);
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  };

  private readonly onPointerMove = (event: PointerEvent) => {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    if (this.pointers.size === 1) {
      const isPan = (event.buttons & 6) !== 0 || event.shiftKey;
      if (isPan !== (this.view === "top")) this.pan(-dx, dy);
      else this.turn((-dx * Math.PI) / this.height, (-dy * Math.PI) / this.height);
    } else if (this.pointers.size === 2) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)![1];
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      const middle = { clientX: (event.clientX + other.x) / 2, clientY: (event.clientY + other.y) / 2 };
      this.pan(-dx / 2, dy / 2);
      if (before > 0 && after > 0) this.zoom(before / after, this.anchorOnPlane(middle));
    }
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  };

  private anchorOnPlane(event: { clientX: number; clientY: number }): Vector3 {
    const pick = this.pick;
    this.pick = () => null;
    const anchor = this.anchor(event);
    this.pick = pick;
    return anchor;
  }

  private readonly onPointerUp = (event: PointerEvent) => {
    this.pointers.delete(event.pointerId);
  };

  private readonly onWheel = (event: WheelEvent) => {
    event.preventDefault();
    cancelAnimationFrame(this.move);
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
    const factor = Math.exp(Math.min(Math.max(event.deltaY * lines, -300), 300) * 0.0015);
    this.zoom(factor, this.anchor(event));
  };

  private readonly onKey = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const angle = Math.PI / 36;
    const pixels = this.height / 20;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => (this.view === "top" || event.shiftKey ? this.pan(-pixels, 0) : this.turn(-angle, 0)),
      ArrowRight: () => (this.view === "top" || event.shiftKey ? this.pan(pixels, 0) : this.turn(angle, 0)),
      ArrowUp: () => (this.view !== "free" || event.shiftKey ? this.pan(0, pixels) : this.turn(0, -angle)),
      ArrowDown: () => (this.view !== "free" || event.shiftKey ? this.pan(0, -pixels) : this.turn(0, angle)),
      "+": () => this.zoom(0.8),
      "=": () => this.zoom(0.8),
      "-": () => this.zoom(1.25),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  };
}

/** Right, up and back of the camera. */
function axesOf({ azimuth, polar }: { azimuth: number; polar: number }): [Vector3, Vector3, Vector3] {
  const back = new Vector3(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar));
  const right = new Vector3(-Math.sin(azimuth), Math.cos(azimuth), 0);
  return [right, new Vector3().crossVectors(back, right), back];
}
