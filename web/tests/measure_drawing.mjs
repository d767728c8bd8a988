// Time to open and frames a second, of large maps in Chromium that draws by the processor.
// Usage: measure_drawing.mjs [CELLS]...
import { fileURLToPath } from "node:url";
import { startBrowser } from "./browser.mjs";
import { harbourScene } from "./fixture.mjs";
import { serve } from "./server.mjs";

const folder = fileURLToPath(new URL("../../build/web", import.meta.url));
const turnSeconds = 4;

/** Faces of single cells that have no neighbour: what a mesh without merging has. */
function exposedFaces(bytes) {
  const view = new DataView(bytes.buffer);
  const bricks = view.getUint32(4, true);
  const column = (i) => new Int32Array(bytes.buffer, 32 + 4 * i * bricks, bricks);
  const [x, y, z, low, high] = [0, 1, 2, 3, 4].map(column);
  const key = (a, b, c) => ((a + 65536) * 131072 + b + 65536) * 131072 + c + 65536;
  const index = new Map();
  for (let b = 0; b < bricks; ++b) index.set(key(x[b], y[b], z[b]), b);
  const has = (b, bit) => b !== undefined && (((bit < 32 ? low[b] : high[b]) >>> (bit & 31)) & 1) === 1;
  let faces = 0;
  for (let b = 0; b < bricks; ++b) {
    const beside = [1, -1].map((d) =>
      [key(x[b] + d, y[b], z[b]), key(x[b], y[b] + d, z[b]), key(x[b], y[b], z[b] + d)].map((k) => index.get(k)),
    );
    for (let bit = 0; bit < 64; ++bit) {
      if (!has(b, bit)) continue;
      [0, 2, 4].forEach((shift, axis) => {
        const at = (bit >> shift) & 3;
        if (!(at < 3 ? has(b, bit + (1 << shift)) : has(beside[0][axis], bit - (3 << shift)))) ++faces;
        if (!(at > 0 ? has(b, bit - (1 << shift)) : has(beside[1][axis], bit + (3 << shift)))) ++faces;
      });
    }
  }
  return faces;
}

const counts = process.argv.slice(2).map(Number);
const browser = await startBrowser();
for (const wanted of counts.length > 0 ? counts : [470e3, 5e6]) {
  const scene = harbourScene(wanted);
  const cells = JSON.parse(new TextDecoder().decode(scene["scene.json"])).maps[0].occupied_cells;
  const exposed = exposedFaces(scene["map/0/cells"]);
  const server = await serve(scene, folder);
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(300000);
  await page.goto(server.address);
  await page.waitForFunction(() => document.documentElement.dataset.map === "shown");
  const first = await page.evaluate(() => document.getElementById("first-picture").textContent);
  await page.waitForFunction(() => document.documentElement.dataset.detail === "complete");
  const complete = await page.evaluate(() => performance.now() / 1000);
  const drawn = await page.evaluate(() => document.getElementById("faces-drawn").textContent);
  const turning = await page.evaluate(async (seconds) => {
    const canvas = document.getElementById("map");
    const context = canvas.getContext("webgl");
    const pixel = new Uint8Array(4);
    const times = [];
    const started = performance.now();
    let last = started;
    while (performance.now() - started < 1000 * seconds) {
      canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
      await new Promise((resolve) => requestAnimationFrame(resolve));
      // Until all is drawn.
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
      times.push(performance.now() - last);
      last = performance.now();
    }
    times.sort((a, b) => a - b);
    return {
      frames: times.length,
      median: times[times.length >> 1],
      faces: document.getElementById("faces-drawn").textContent,
    };
  }, turnSeconds);
  console.log(
    `${cells} cells, ${exposed} exposed faces, ${(scene["map/0/cells"].length / exposed).toFixed(1)} bytes each: ` +
      `first picture after ${first}, complete after ${complete.toFixed(2)} s with ${drawn} faces; turning: ` +
      `${(turning.frames / turnSeconds).toFixed(1)} frames a second, median ${turning.median.toFixed(0)} ms, ${turning.faces} faces`,
  );
  await page.close();
  await server.close();
}
await browser.close();
