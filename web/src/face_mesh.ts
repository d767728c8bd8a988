/** Chunks of faces as meshes that share one list of indices. */
import { BufferAttribute, BufferGeometry, type Material, Mesh, Sphere, Vector3 } from "three";
import { chunkEdge } from "./faces";

let quads = makeQuads(1 << 12);

function makeQuads(count: number): BufferAttribute {
  const indices = new Uint32Array(6 * count);
  for (let i = 0; i < count; ++i) indices.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3], 6 * i);
  return new BufferAttribute(indices, 1);
}

/** @param corner of the chunk in metres of the scene, @param cell edge of its cells in metres */
export function faceMesh(corners: Uint8Array, corner: Vector3, cell: number, material: Material): Mesh {
  const faces = corners.length / 16;
  if (6 * faces > quads.count) {
    let count = quads.count / 6;
    while (count < faces) count *= 2;
    quads = makeQuads(count);
  }
  const geometry = new BufferGeometry();
  const positions = new BufferAttribute(corners, 4);
  // The graphics card has them then.
  positions.onUpload(() => (positions.array = []));
  geometry.setAttribute("position", positions);
  geometry.setIndex(quads);
  geometry.setDrawRange(0, 6 * faces);
  const half = chunkEdge / 2;
  geometry.boundingSphere = new Sphere(new Vector3(half, half, half), half * Math.sqrt(3));
  const mesh = new Mesh(geometry, material);
  mesh.matrixAutoUpdate = false;
  mesh.matrix.makeScale(cell, cell, cell).setPosition(corner.x, corner.y, corner.z);
  mesh.updateMatrixWorld(true);
  return mesh;
}

export function disposeMesh(mesh: Mesh): void {
  const geometry = mesh.geometry as BufferGeometry;
  // The indices stay, as others use them.
  geometry.index = null as unknown as BufferAttribute;
  geometry.dispose();
}
