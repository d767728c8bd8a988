/** The page of `pingvox view`: reads what the program serves and puts the parts together. */
import { Box3, Sphere } from "three";
import { Answers } from "./answers";
import { scaleTexture } from "./colours";
import { faceMaterial, plainMaterial, setColouring } from "./face_material";
import { FaceService, startWorker } from "./face_service";
import { serveFaces } from "./faces_worker";
import { MapLayer } from "./map_layer";
import type { Scene } from "./scene";
import { View3D } from "./view3d";

async function showPage(script: HTMLScriptElement): Promise<void> {
  const answers = new Answers();
  const scene = await answers.json<Scene>("scene.json");
  document.title = `${scene.title} – pingvox`;
  const view = new View3D(document.querySelector<HTMLCanvasElement>("#map")!);
  view.setBackground(getComputedStyle(document.documentElement).getPropertyValue("--ground").trim());
  const service = new FaceService(startWorker(script));
  const scale = scaleTexture();
  const material = faceMaterial(scale);
  const spaceMaterials = {
    free: plainMaterial(scale, "#6db4d8", 0.18),
    unknown: plainMaterial(scale, "#8a8f96", 1),
  };
  for (const entry of scene.maps) {
    const cells = await answers.bytes(entry.cells);
    const agreement = entry.agreement ? await answers.bytes(entry.agreement) : null;
    const extent = await service.ask({ kind: "map", map: entry.id, cells, agreement });
    view.addLayer(new MapLayer(entry, extent, cells, agreement, scene.origin_m, service, material, spaceMaterials));
  }
  const box = view.layers.reduce((all, layer) => all.union(layer.bounds), new Box3());
  const sphere = box.getBoundingSphere(new Sphere());
  setColouring(material, "height", box.min.z, box.max.z);
  view.orbit.setScene(sphere.center, sphere.radius);
  view.orbit.showAll("free", "jump");
}

if (typeof document === "undefined") {
  serveFaces(globalThis as unknown as Parameters<typeof serveFaces>[0]);
} else {
  void showPage(document.currentScript as HTMLScriptElement);
}
