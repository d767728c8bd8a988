/** How faces look: their colour on the scale, lit by direction, with the edges of near cells. */
import { Color, DoubleSide, FrontSide, RawShaderMaterial, type Texture, Vector2 } from "three";

export type ColourBy = "height" | "probability" | "agreement";

const vertexShader = `
precision highp float;
attribute vec4 position;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform float height;
varying vec3 vCell;
varying float vHeight;
varying float vClass;
varying float vLight;
varying vec3 vAcross;
void main() {
  float direction = floor(position.w / 32.0);
  vClass = position.w - 32.0 * direction;
  float axis = floor(direction / 2.0);
  vAcross = vec3(axis == 0.0, axis == 1.0, axis == 2.0);
  // From above and from the south-east.
  vLight = direction == 0.0 ? 0.86 : direction == 1.0 ? 0.70 : direction == 2.0 ? 0.64
         : direction == 3.0 ? 0.92 : direction == 4.0 ? 1.0 : 0.52;
  // A third of a pixel outwards, see FaceList.
  vec3 side = floor(position.xyz / 64.0);
  vec3 corner = position.xyz - 64.0 * side;
  vec4 centre = projectionMatrix * viewMatrix * modelMatrix * vec4(corner, 1.0);
  float cellsPerPixel = 2.0 * centre.w / (projectionMatrix[1][1] * height * length(modelMatrix[0].xyz));
  vec3 outwards = side * (2.0 * side - 3.0);
  vCell = corner + outwards * min(0.33 * cellsPerPixel, 0.25);
  vec4 world = modelMatrix * vec4(vCell, 1.0);
  vHeight = world.z;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const fragmentShader = `
#extension GL_OES_standard_derivatives : enable
precision highp float;
uniform sampler2D scale;
uniform vec2 range;
uniform vec2 slab;
uniform float mode;
uniform vec3 colour;
uniform float opacity;
varying vec3 vCell;
varying float vHeight;
varying float vClass;
varying float vLight;
varying vec3 vAcross;
void main() {
  if (vHeight < slab.x || vHeight > slab.y) discard;
  vec3 base = colour;
  if (mode == 0.0) {
    base = texture2D(scale, vec2((vHeight - range.x) / (range.y - range.x), 0.5)).rgb;
  } else if (mode < 2.5) {
    float value = (vClass - 0.5) / 31.0;
    base = texture2D(scale, vec2((value - range.x) / (range.y - range.x), 0.5)).rgb;
    if (mode == 2.0 && vClass < 0.5) base = vec3(0.5);
  }
  vec3 width = fwidth(vCell);
  vec3 edges = abs(fract(vCell - 0.5) - 0.5) / max(width, vec3(1e-6)) + 1e3 * vAcross;
  float edge = 1.0 - smoothstep(0.4, 1.4, min(edges.x, min(edges.y, edges.z)));
  float cellPixels = 1.0 / max(max(width.x, width.y), max(width.z, 1e-6));
  float visible = smoothstep(6.0, 16.0, cellPixels) * 0.28;
  gl_FragColor = vec4(base * vLight * (1.0 - edge * visible), opacity);
}`;

const modes: Record<ColourBy | "plain", number> = { height: 0, probability: 1, agreement: 2, plain: 3 };

export function faceMaterial(scale: Texture): RawShaderMaterial {
  return new RawShaderMaterial({
    vertexShader,
    fragmentShader,
    side: FrontSide,
    uniforms: {
      scale: { value: scale },
      range: { value: new Vector2(0, 1) },
      slab: { value: new Vector2(-1e9, 1e9) },
      mode: { value: 0 },
      colour: { value: new Color(1, 1, 1) },
      opacity: { value: 1 },
      height: { value: 1 },
    },
  });
}

/** For free and unknown space. */
export function plainMaterial(scale: Texture, colour: string, opacity: number): RawShaderMaterial {
  const material = faceMaterial(scale);
  material.uniforms.mode.value = modes.plain;
  material.uniforms.colour.value.set(colour);
  material.uniforms.opacity.value = opacity;
  if (opacity < 1) {
    material.transparent = true;
    material.depthWrite = false;
    material.side = DoubleSide;
  }
  return material;
}

export function setColouring(material: RawShaderMaterial, by: ColourBy, from: number, to: number): void {
  material.uniforms.mode.value = modes[by];
  material.uniforms.range.value.set(from, to > from ? to : from + 1e-3);
}

/** Height of the canvas in its own pixels. */
export function setCanvasHeight(material: RawShaderMaterial, height: number): void {
  material.uniforms.height.value = height;
}

export function setSlab(material: RawShaderMaterial, from: number, to: number): void {
  material.uniforms.slab.value.set(from, to);
}
