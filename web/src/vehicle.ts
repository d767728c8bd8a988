/** The vehicle on its path, and the beam that its sonar hears at the time. */
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  GreaterDepth,
  Group,
  Mesh,
  MeshBasicMaterial,
  Vector3,
} from "three";
import type { Pose } from "./path";
import { WideLines } from "./wide_lines";

/** The vehicle's length: in metres, or on the screen where that would be smaller. */
const length = { metres: 0.5, pixels: 26 };
const arcSteps = 16;

export class Vehicle {
  readonly group = new Group();
  private readonly hull: Group;
  private readonly beam: Mesh;
  private readonly arc = new WideLines(4, { opacity: 0.5 });
  private readonly axis = new WideLines(1.5, { opacity: 0.3 });

  constructor() {
    this.hull = new Group();
    const geometry = hullGeometry();
    for (const hidden of [false, true]) {
      const material = new MeshBasicMaterial({ vertexColors: 2, side: DoubleSide });
      if (hidden) {
        material.depthFunc = GreaterDepth;
        material.transparent = true;
        material.opacity = 0.35;
        material.depthWrite = false;
      }
      const mesh = new Mesh(geometry, material);
      mesh.renderOrder = hidden ? 4 : 0;
      this.hull.add(mesh);
    }
    const light = new MeshBasicMaterial({ transparent: true, opacity: 0.22, depthWrite: false, side: DoubleSide });
    this.beam = new Mesh(new BufferGeometry(), light);
    this.beam.frustumCulled = false;
    this.beam.renderOrder = 2;
    this.group.add(this.hull, this.beam, this.arc, this.axis);
    this.group.visible = false;
  }

  setColours(accent: string, ink: string): void {
    (this.beam.material as MeshBasicMaterial).color.set(accent);
    this.arc.setColour(accent);
    this.axis.setColour(ink);
  }

  setViewport(width: number, height: number): void {
    this.arc.setViewport(width, height);
    this.axis.setViewport(width, height);
  }

  /** @param metresPerPixel where the vehicle is */
  setPose(pose: Pose | null, metresPerPixel: number): void {
    this.group.visible = pose !== null;
    if (!pose) return;
    this.hull.position.copy(pose.position);
    this.hull.quaternion.copy(pose.attitude);
    this.hull.scale.setScalar(Math.max(length.metres, length.pixels * metresPerPixel));
  }

  /** A beam from a sonar's pose; null shows none. `echo` and `range` in metres, angles in radians. */
  setBeam(
    beam: { sonar: Pose; bearing: number; width: number; height: number; range: number; echo: number } | null,
  ): void {
    for (const part of [this.beam, this.arc, this.axis]) part.visible = beam !== null;
    if (!beam) return;
    const { sonar } = beam;
    const at = (range: number, bearing: number, elevation: number) =>
      new Vector3(
        range * Math.cos(elevation) * Math.cos(bearing),
        range * Math.cos(elevation) * Math.sin(bearing),
        range * Math.sin(elevation),
      )
        .applyQuaternion(sonar.attitude)
        .add(sonar.position);
    const end = Number.isFinite(beam.echo) ? beam.echo : beam.range;
    const elevation = (step: number) => (step / arcSteps - 0.5) * beam.height;
    const points = [sonar.position];
    for (const side of [-0.5, 0.5]) {
      for (let step = 0; step <= arcSteps; ++step)
        points.push(at(end, beam.bearing + side * beam.width, elevation(step)));
    }
    const left = 1;
    const right = left + arcSteps + 1;
    const triangles: number[] = [0, left, right, 0, left + arcSteps, right + arcSteps];
    for (let step = 0; step < arcSteps; ++step) {
      triangles.push(0, left + step, left + step + 1, 0, right + step, right + step + 1);
      triangles.push(left + step, left + step + 1, right + step, right + step, left + step + 1, right + step + 1);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute(
      "position",
      new BufferAttribute(Float32Array.from(points.flatMap((p) => [p.x, p.y, p.z])), 3),
    );
    geometry.setIndex(new BufferAttribute(Uint16Array.from(triangles), 1));
    (this.beam.geometry as BufferGeometry).dispose();
    this.beam.geometry = geometry;
    this.axis.setLine([sonar.position, at(end, beam.bearing, 0)]);
    this.arc.visible = Number.isFinite(beam.echo);
    if (this.arc.visible) {
      this.arc.setLine(Array.from({ length: arcSteps + 1 }, (_, step) => at(end, beam.bearing, elevation(step))));
    }
  }
}

/** An arrow of length 1 that looks along x, its upper side bright. */
function hullGeometry(): BufferGeometry {
  const tip = [0.6, 0, 0];
  const left = [-0.4, 0.3, 0];
  const right = [-0.4, -0.3, 0];
  const notch = [-0.22, 0, 0];
  const top = [-0.2, 0, 0.14];
  const bottom = [-0.2, 0, -0.14];
  const faces: [number[][], number][] = [
    [[tip, left, top], 1],
    [[tip, top, right], 0.86],
    [[left, notch, top], 0.7],
    [[notch, right, top], 0.7],
    [[tip, bottom, left], 0.5],
    [[tip, right, bottom], 0.45],
    [[left, bottom, notch], 0.4],
    [[notch, bottom, right], 0.4],
  ];
  const geometry = new BufferGeometry();
  geometry.setAttribute(
    "position",
    new BufferAttribute(Float32Array.from(faces.flatMap(([corners]) => corners.flat())), 3),
  );
  const colours = faces.flatMap(([corners, light]) => corners.flatMap(() => [light, 0.97 * light, 0.92 * light]));
  geometry.setAttribute("color", new BufferAttribute(Float32Array.from(colours), 3));
  return geometry;
}
