/** Lines of a width in pixels. Where something hides them they are faint. */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GreaterDepth,
  Group,
  LessEqualDepth,
  Mesh,
  RawShaderMaterial,
  Vector2,
  type Vector3,
} from "three";

const vertexShader = `
precision highp float;
attribute vec3 position;
attribute vec3 other;
attribute vec3 corner;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform vec2 viewport;
uniform float width;
varying float vTime;
void main() {
  vec4 a = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(other, 1.0);
  // A point behind the camera goes to the plane just before it.
  const float near = 1e-3;
  if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport * corner.x;
  float pixels = length(along);
  along = pixels > 1e-4 ? along / pixels : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x) * corner.y;
  a.xy += (across - along * corner.x) * width / viewport * a.w;
  vTime = corner.z;
  gl_Position = a;
}`;

const fragmentShader = `
precision highp float;
uniform vec3 colour;
uniform float opacity;
uniform float now;
varying float vTime;
void main() {
  gl_FragColor = vec4(colour, opacity * (vTime > now ? 0.35 : 1.0));
}`;

export class WideLines extends Group {
  private readonly materials: RawShaderMaterial[];
  private geometry = new BufferGeometry();

  constructor(width: number, hidden: { opacity: number } = { opacity: 0.25 }) {
    super();
    this.materials = [LessEqualDepth, GreaterDepth].map(
      (depthFunc) =>
        new RawShaderMaterial({
          vertexShader,
          fragmentShader,
          transparent: true,
          depthWrite: false,
          depthFunc,
          uniforms: {
            viewport: { value: new Vector2(1, 1) },
            width: { value: width },
            colour: { value: new Color() },
            opacity: { value: depthFunc === GreaterDepth ? hidden.opacity : 1 },
            now: { value: Infinity },
          },
        }),
    );
  }

  /** A line through points; `times` say which part of it is still to come. */
  setLine(points: readonly Vector3[], times: ArrayLike<number> | null = null): void {
    const segments = Math.max(points.length - 1, 0);
    const position = new Float32Array(12 * segments);
    const other = new Float32Array(12 * segments);
    const corner = new Float32Array(12 * segments);
    const index = new Uint32Array(6 * segments);
    for (let i = 0; i < segments; ++i) {
      for (let k = 0; k < 4; ++k) {
        const [from, to] = k < 2 ? [i, i + 1] : [i + 1, i];
        points[from].toArray(position as unknown as number[], 12 * i + 3 * k);
        points[to].toArray(other as unknown as number[], 12 * i + 3 * k);
        corner.set([k < 2 ? 1 : -1, k % 2 === 0 ? 1 : -1, times ? times[from] : 0], 12 * i + 3 * k);
      }
      index.set(
        [0, 1, 2, 2, 1, 3].map((k) => 4 * i + k),
        6 * i,
      );
    }
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(position, 3));
    this.geometry.setAttribute("other", new BufferAttribute(other, 3));
    this.geometry.setAttribute("corner", new BufferAttribute(corner, 3));
    this.geometry.setIndex(new BufferAttribute(index, 1));
    this.remove(...this.children);
    for (const material of this.materials) {
      const mesh = new Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = 3;
      this.add(mesh);
    }
  }

  setColour(colour: string): void {
    for (const material of this.materials) material.uniforms.colour.value.set(colour);
  }

  /** Size of the canvas in CSS pixels. */
  setViewport(width: number, height: number): void {
    for (const material of this.materials) material.uniforms.viewport.value.set(width, height);
  }

  setNow(time: number): void {
    for (const material of this.materials) material.uniforms.now.value = time;
  }
}
