// Maps as meshes and as points, read by Khronos' validator of glTF and by the LAS reader of copc.js.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Las } from "copc";
import validator from "gltf-validator";
import { Workplace } from "./program.mjs";

let here;
before(() => {
  here = new Workplace();
  here.call("simulate", "tank", "-o", "tank.csv", "--seed", "1");
  here.call("map", "tank.csv", "-o", "tank.ot", "--resolution", "0.1");
});
after(() => here?.remove());

for (const colours of ["height", "probability"]) {
  test(`the mesh coloured by ${colours} is valid glTF`, async () => {
    const said = here.call("convert", "tank.ot", "-o", "tank.glb", "--colours", colours);
    const report = await validator.validateBytes(new Uint8Array(here.read("tank.glb")));
    assert.deepEqual(report.issues.messages, []);
    const rectangles = Number(/(\d+) rectangles/.exec(said)[1]);
    assert.ok(rectangles > 100);
    assert.equal(report.info.totalTriangleCount, 2 * rectangles);
    assert.equal(report.info.totalVertexCount, 4 * rectangles);
  });
}

test("the points have places, probabilities and a reference system", async () => {
  here.call("convert", "tank.ot", "-o", "tank.las", "--origin", "54.5,10.25");
  here.call("convert", "tank.ot", "-o", "tank.xyz");
  const bytes = new Uint8Array(here.read("tank.las"));
  const get = async (begin, end) => bytes.subarray(begin, end);
  const header = Las.Header.parse(bytes);
  const records = await Las.Vlr.walk(get, header);
  const extra = Las.ExtraBytes.parse(await Las.Vlr.fetch(get, Las.Vlr.find(records, "LASF_Spec", 4)));
  const wkt = new TextDecoder().decode(await Las.Vlr.fetch(get, Las.Vlr.find(records, "LASF_Projection", 2112)));
  assert.match(wkt, /Transverse_Mercator.*"latitude_of_origin",54\.5/);
  const view = Las.View.create(bytes.subarray(header.pointDataOffset), header, extra);
  const expected = here
    .read("tank.xyz")
    .toString()
    .split("\n")
    .filter((line) => line !== "")
    .map((line) => line.split(" ").map(Number));
  assert.equal(view.pointCount, expected.length);
  const [x, y, z, intensity, probability, size] = ["X", "Y", "Z", "Intensity", "probability", "size"].map((name) =>
    view.getter(name),
  );
  const isNear = (a, b, limit) => assert.ok(Math.abs(a - b) <= limit, `${a} and ${b}`);
  expected.forEach(([ex, ey, ez, logOdds, edge], i) => {
    isNear(x(i), ex, 1e-4);
    isNear(y(i), ey, 1e-4);
    isNear(z(i), ez, 1e-4);
    const p = 1 / (1 + Math.exp(-logOdds));
    isNear(probability(i), p, 1e-6);
    isNear(intensity(i), p * 65535, 1);
    isNear(size(i), edge, 1e-6);
  });
});
