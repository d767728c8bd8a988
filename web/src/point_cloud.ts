/** Points of a cloud, coloured by their value, or by height where they have none. */
import { BufferAttribute, BufferGeometry, Points, PointsMaterial } from "three";
import { scaleColour } from "./colours";
import type { PointColumns } from "./scene";

export function pointCloud(columns: PointColumns): Points {
  const { x, y, z } = columns;
  const values = columns.hasValue ? columns.value : z;
  let [from, to] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < from) from = value;
    if (value > to) to = value;
  }
  const positions = new Float32Array(3 * x.length);
  const colours = new Uint8Array(3 * x.length);
  for (let i = 0; i < x.length; ++i) {
    positions.set([x[i], y[i], z[i]], 3 * i);
    colours.set(scaleColour(to > from ? (values[i] - from) / (to - from) : 0.5), 3 * i);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("color", new BufferAttribute(colours, 3, true));
  return new Points(geometry, new PointsMaterial({ size: 3, sizeAttenuation: false, vertexColors: 2 }));
}
