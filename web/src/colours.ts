/** A perceptually even scale of colours, as a table and as a texture. */
import { DataTexture, LinearFilter, RGBAFormat, ClampToEdgeWrapping } from "three";

/** Viridis (Smith and van der Walt, CC0) by the polynomial of Matt Zucker (CC0), within 1 % of the table. */
const viridis: readonly (readonly number[])[] = [
  [0.2777273272, 0.005407344544, 0.3340998053],
  [0.1050930431, 1.404613529, 1.384590162],
  [-0.3308618287, 0.214847559, 0.09509516302],
  [-4.634230498, -5.799100973, -19.33244095],
  [6.228269936, 14.17993336, 56.6905526],
  [4.776384997, -13.74514537, -65.35303263],
  [-5.435455855, 4.645852612, 26.3124352],
];

/** Red, green and blue, 0 to 255, of a place between 0 and 1 on the scale. */
export function scaleColour(place: number): [number, number, number] {
  const t = Math.min(Math.max(place, 0), 1);
  const channel = (c: number) => {
    let sum = 0;
    for (let power = viridis.length - 1; power >= 0; --power) sum = sum * t + viridis[power][c];
    return Math.round(255 * Math.min(Math.max(sum, 0), 1));
  };
  return [channel(0), channel(1), channel(2)];
}

export const scaleTable: Uint8Array = (() => {
  const table = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) table.set([...scaleColour(i / 255), 255], 4 * i);
  return table;
})();

export function scaleTexture(): DataTexture {
  const texture = new DataTexture(scaleTable, 256, 1, RGBAFormat);
  texture.minFilter = LinearFilter;
  texture.magFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

/** Of the sonar's picture: dark water, bright echoes; even in lightness. */
export const echoTable: Uint8Array = (() => {
  const table = new Uint8Array(4 * 256);
  const stops = [
    [9, 14, 24],
    [16, 42, 67],
    [30, 84, 110],
    [62, 134, 140],
    [128, 182, 150],
    [214, 220, 160],
    [255, 249, 219],
  ];
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    const part = at - low;
    table.set([...stops[low].map((c, k) => Math.round(c + part * (stops[low + 1][k] - c))), 255], 4 * i);
  }
  return table;
})();
