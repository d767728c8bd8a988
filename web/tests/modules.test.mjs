// The choice of detail, poses on a path, columns of answers, ticks.
import assert from "node:assert/strict";
import { test } from "node:test";
import { randomNumbers, tankScene } from "./fixture.mjs";
import { detail, dom, path, scene } from "./modules.mjs";

function tree(level, random, parent = null) {
  const node = {
    level,
    parent,
    children: [],
    ready: true,
    faces: 50 + Math.floor(100 * random()),
    pixels: 2 ** level * (0.5 + random()),
  };
  if (level > 0)
    for (let i = 0; i < 1 + Math.floor(7 * random()); ++i) node.children.push(tree(level - 1, random, node));
  return node;
}

const leavesOf = (node) => (node.children.length === 0 ? [node] : node.children.flatMap(leavesOf));

function isCovered(leaf, drawn) {
  let count = 0;
  for (let node = leaf; node; node = node.parent) if (drawn.has(node)) ++count;
  return count === 1;
}

test("what is drawn covers each place once, within the budget", () => {
  const random = randomNumbers(2);
  for (const budget of [0, 1000, 5000, 1e9]) {
    const root = tree(4, random);
    const choice = detail.chooseDetail([root], (node) => node.pixels, { enoughPixels: 1, finestLevel: 0, budget });
    const drawn = new Set(choice.draw);
    assert.ok(leavesOf(root).every((leaf) => isCovered(leaf, drawn)));
    const faces = choice.draw.reduce((sum, node) => sum + node.faces, 0);
    assert.ok(faces <= Math.max(budget, root.faces));
    assert.ok(choice.complete);
    if (budget > 1e6) assert.ok(choice.draw.every((node) => node.level === 0 || node.pixels <= 1));
  }
});

test("a node stands for its children until all of them are there, and they are asked for", () => {
  const root = tree(2, randomNumbers(3));
  root.children[0].ready = false;
  const choice = detail.chooseDetail([root], () => 10, { enoughPixels: 1, finestLevel: 0, budget: 1e9 });
  assert.deepEqual(choice.draw, [root]);
  assert.deepEqual(choice.wanted, [root.children[0]]);
  assert.equal(choice.complete, false);
});

test("nothing is finer than the cut depth", () => {
  const root = tree(4, randomNumbers(4));
  const choice = detail.chooseDetail([root], () => 100, { enoughPixels: 1, finestLevel: 2, budget: 1e9 });
  assert.ok(choice.draw.every((node) => node.level >= 2));
});

test("a pose is between those of the path", () => {
  const half = Math.SQRT1_2;
  const columns = {
    time: Float64Array.of(10, 20),
    x: Float32Array.of(0, 2),
    y: Float32Array.of(0, 0),
    z: Float32Array.of(-1, -1),
    qx: Float32Array.of(0, 0),
    qy: Float32Array.of(0, 0),
    qz: Float32Array.of(0, half),
    qw: Float32Array.of(1, half),
  };
  const pose = path.poseAt(columns, 15);
  assert.ok(Math.abs(pose.position.x - 1) < 1e-6);
  assert.ok(Math.abs(2 * Math.atan2(pose.attitude.z, pose.attitude.w) - Math.PI / 4) < 1e-6);
  assert.equal(path.poseAt(columns, 0).position.x, 0);
  assert.equal(path.poseAt(columns, 99).position.x, 2);
  const sonar = path.mountedPose(path.poseAt(columns, 20), { position: [1, 0, 0], quaternion: [0, 0, 0, 1] });
  assert.ok(Math.abs(sonar.position.x - 2) < 1e-6 && Math.abs(sonar.position.y - 1) < 1e-6);
});

test("columns are read as they are written, and what is too short is refused", () => {
  const bytes = tankScene();
  const log = scene.readLog(bytes["log/0"].buffer);
  assert.equal(log.beams, 1600);
  assert.equal(log.bins, 400);
  assert.ok(Math.abs(log.binLength[7] - 0.025) < 1e-6);
  assert.equal(log.sweep[1599], 3);
  assert.ok(Number.isNaN(log.echo[0]));
  assert.throws(() => scene.readLog(bytes["log/0"].buffer.slice(0, 1000)), /the answer is truncated/);
  assert.throws(() => scene.readPath(bytes["log/0"].buffer), /unexpected type/);
  assert.throws(() => scene.readCells(new ArrayBuffer(3)), /truncated, 3 bytes/);
});

test("ticks are round and not too many", () => {
  assert.deepEqual(
    dom.ticksBetween(-3, 0, 5).values.map((value) => dom.fixed(value, 0)),
    ["−3", "−2", "−1", "0"],
  );
  assert.deepEqual(dom.ticksBetween(0.4, 1, 5), { values: [0.4, 0.6000000000000001, 0.8, 1], digits: 1 });
  assert.equal(dom.fixed(-0.001, 2), "0.00");
  assert.equal(dom.fixed(-1.5, 1), "−1.5");
});

test("controls are not for frames of other hosts", () => {
  const view = (...ancestorOrigins) => ({
    self: 1,
    top: 2,
    location: { hostname: "blueos.local", ancestorOrigins },
    document: { referrer: "" },
  });
  assert.ok(!dom.isFramedByAnotherHost({ ...view("http://evil.example"), top: 1 }), "not in a frame");
  assert.ok(!dom.isFramedByAnotherHost(view("http://blueos.local")));
  assert.ok(!dom.isFramedByAnotherHost(view("http://blueos.local:8080", "http://blueos.local")));
  assert.ok(dom.isFramedByAnotherHost(view("http://evil.example")));
  assert.ok(dom.isFramedByAnotherHost(view("http://blueos.local", "http://evil.example")));
  assert.ok(dom.isFramedByAnotherHost(view("null")), "a frame in a sandbox");
  const firefox = (referrer) => ({ ...view(), location: { hostname: "blueos.local" }, document: { referrer } });
  assert.ok(!dom.isFramedByAnotherHost(firefox("http://blueos.local/")));
  assert.ok(dom.isFramedByAnotherHost(firefox("")));
});
