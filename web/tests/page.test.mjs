// What the page does in Chromium: numbers are read from it, and pixels where it is about pixels.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { startBrowser } from "./browser.mjs";
import { beamSeconds, beamsPerTurn, origin, startTime, tankScene } from "./fixture.mjs";
import { exportPage, serve } from "./server.mjs";

const folder = fileURLToPath(new URL("../../build/web", import.meta.url));
const tank = tankScene();
const longest = 60000;
let browser;
let server;
/** Decodes screenshots. */
let decoder;

before(async () => {
  server = await serve(tank, folder);
  browser = await startBrowser();
  decoder = await browser.newPage();
});

after(async () => {
  await browser?.close();
  await server?.close();
});

/** A page with the tank; `problems` are errors, messages of the console and foreign requests. */
async function openPage({ address = server.address, ...options } = {}) {
  const context = await browser.newContext({
    viewport: { width: 900, height: 600 },
    colorScheme: "dark",
    reducedMotion: "reduce",
    ...options,
  });
  const page = await context.newPage();
  page.problems = [];
  page.setDefaultTimeout(longest);
  page.on("console", (message) => page.problems.push(message.text()));
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => {
    const isOwn = [address, "data:", "blob:"].some((start) => request.url().startsWith(start));
    if (!isOwn) page.problems.push(`foreign: ${request.url()}`);
  });
  page.on("requestfailed", (request) => page.problems.push(`failed: ${request.url()}`));
  await page.goto(address);
  await isReady(page);
  return page;
}

async function isReady(page) {
  await page.waitForFunction(() => document.documentElement.dataset.page === "ready");
  await settled(page);
}

/** All faces are made, and a frame was drawn with them. */
async function settled(page) {
  await page.waitForFunction(() => document.documentElement.dataset.detail === "complete");
  await nextFrames(page);
}

/** What has happened is drawn, and events of the pointer have come. */
function nextFrames(page) {
  return page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

async function closePage(page) {
  const { problems } = page;
  await page.context().close();
  assert.deepEqual(problems, []);
}

/** What the page says after all that has happened was drawn. */
async function text(page, id) {
  await nextFrames(page);
  return page.locator(`#${id}`).evaluate((found) => found.textContent);
}
const count = async (page, id) => Number((await text(page, id)).replaceAll(",", ""));
const numbers = (string) => (string.replaceAll("−", "-").match(/-?\d+(\.\d+)?/g) ?? []).map(Number);

/** A picture of a part of the page, to be compared as a whole, when no frame is on its way to the screen any more. */
async function picture(page, clip) {
  for (let last = ""; ; ) {
    await settled(page);
    const next = (await page.screenshot({ clip })).toString("base64");
    if (next === last) return next;
    last = next;
    await page.waitForTimeout(100);
  }
}

/** Waits until the condition holds, however slow the machine is. */
async function until(condition, message) {
  for (const end = Date.now() + longest; !(await condition()); ) assert.ok(Date.now() < end, message);
}

const untilHidden = (page, id) => page.locator(`#${id}`).waitFor({ state: "hidden" });

/** The picture that follows another one. */
async function pictureAfter(page, clip, before, message) {
  let next = before;
  await until(async () => (next = await picture(page, clip)) !== before, message);
  return next;
}

/** Red, green and blue of each pixel of a small part of the page, one after the other. */
async function pixels(page, clip) {
  return decoder.evaluate(
    async (png) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      return [...context.getImageData(0, 0, image.width, image.height).data].filter((_, i) => i % 4 < 3);
    },
    await picture(page, clip),
  );
}

const mapBox = (page) => page.locator("#map").boundingBox();

/** A part around the middle of the map. */
async function middle(page, size = 60) {
  const box = await mapBox(page);
  return { x: box.x + box.width / 2 - size / 2, y: box.y + box.height / 2 - size / 2, width: size, height: size };
}

async function readingAt(page, x, y) {
  await page.mouse.move(x - 3, y);
  await page.mouse.move(x, y);
  await nextFrames(page);
  return numbers(await text(page, "readout"));
}

async function metresPerPixel(page) {
  await nextFrames(page);
  const width = await page.locator("#scale-line").evaluate((line) => line.getBoundingClientRect().width);
  const label = await text(page, "scale-text");
  return (numbers(label)[0] / width) * (label.endsWith("cm") ? 0.01 : 1);
}

async function setSlider(page, id, value) {
  await page.locator(`#${id}`).evaluate((slider, wanted) => {
    slider.value = wanted;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }, String(value));
}

async function openDisplay(page) {
  await page.click("#display");
  await page.waitForSelector("#display-panel:not([hidden])");
}

/** Cells of the tank, as the program sends them: z in cells and probability. */
const tankCells = (() => {
  const view = new DataView(tank["map/0/cells"].buffer);
  const [bricks, cells] = [view.getUint32(4, true), view.getUint32(8, true)];
  const found = [];
  let next = 32 + 20 * bricks;
  for (let b = 0; b < bricks; ++b) {
    const at = [0, 1, 2].map((axis) => view.getInt32(32 + 4 * (axis * bricks + b), true));
    for (let bit = 0; bit < 64; ++bit) {
      const word = view.getUint32(32 + 4 * ((bit < 32 ? 3 : 4) * bricks + b), true);
      if ((word >>> (bit & 31)) & 1) found.push({ z: 4 * at[2] + (bit >> 4), probability: view.getUint8(next++) });
    }
  }
  assert.equal(found.length, cells);
  return found;
})();

test("the map is there, with its numbers, and nothing went wrong", async () => {
  const page = await openPage();
  assert.equal(await page.title(), "tank.bin – pingvox");
  assert.equal(await text(page, "title"), "tank.bin");
  assert.match(await text(page, "notes"), /1 note.*one turn of the head/s);
  assert.equal(await count(page, "cells-drawn"), tankCells.filter((cell) => cell.probability >= 128).length);
  const faces = await count(page, "faces-drawn");
  assert.ok(faces > 100 && faces < 3000, `${faces} faces, as those of the walls are merged`);
  assert.match(await text(page, "bytes-received"), /[kM]B, .* a face/);
  assert.equal(await page.locator("#progress").isVisible(), false);
  const [first, ...others] = await pixels(page, await middle(page));
  assert.ok(others.some((value) => value !== first));
  await closePage(page);
});

test("from above, from the side and free, by buttons and by keys", async () => {
  const page = await openPage();
  await page.click("[data-view=top]");
  assert.equal(await page.getAttribute("[data-view=top]", "aria-pressed"), "true");
  const box = await mapBox(page);
  const centre = [box.x + box.width / 2, box.y + box.height / 2];
  // The middle of the tank, its bottom.
  const [x, y, z] = await readingAt(page, ...centre);
  const scale = await metresPerPixel(page);
  assert.ok(Math.abs(x - origin[0] - 4) < 0.3 && Math.abs(y - origin[1] - 2.5) < 0.3, `${x} ${y}`);
  assert.ok(Math.abs(z + 2.95) < 0.06, `${z}`);
  const [right] = await readingAt(page, centre[0] + 100, centre[1]);
  assert.ok(Math.abs(right - x - 100 * scale) < 0.03, "a scale that holds from above");
  await page.keyboard.press("3");
  assert.equal(await page.getAttribute("[data-view=side]", "aria-pressed"), "true");
  const [sideX, sideY, sideZ] = await readingAt(page, ...centre);
  assert.ok(
    Math.abs(sideX - x) < 0.06 && Math.abs(sideY - origin[1]) < 0.06 && sideZ > -3 && sideZ < 0,
    `the southern wall: ${sideX} ${sideY} ${sideZ} for ${x}`,
  );
  await page.keyboard.press("1");
  assert.equal(await page.getAttribute("[data-view=free]", "aria-pressed"), "true");
  await page.mouse.move(5, 5);
  const before = await picture(page, await middle(page, 200));
  await page.focus("#map");
  for (let i = 0; i < 6; ++i) await page.keyboard.press("ArrowLeft");
  await pictureAfter(page, await middle(page, 200), before, "the view turns");
  await closePage(page);
});

test("the wheel comes nearer to what is under it, a drag turns, a drag from above moves", async () => {
  const page = await openPage();
  await page.keyboard.press("2");
  const box = await mapBox(page);
  const spot = [box.x + 0.6 * box.width, box.y + 0.4 * box.height];
  const before = { at: await readingAt(page, ...spot), scale: await metresPerPixel(page) };
  await page.mouse.wheel(0, -400);
  await settled(page);
  const near = { at: await readingAt(page, ...spot), scale: await metresPerPixel(page) };
  assert.ok(near.scale < 0.7 * before.scale);
  assert.ok(Math.hypot(near.at[0] - before.at[0], near.at[1] - before.at[1]) < 0.06);
  await page.mouse.down();
  await page.mouse.move(spot[0] - 80, spot[1], { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const [moved] = await readingAt(page, ...spot);
  assert.ok(Math.abs(moved - near.at[0] - 80 * near.scale) < 0.06);
  await page.keyboard.press("0");
  await page.keyboard.press("1");
  const needle = async () => {
    await nextFrames(page);
    return page.getAttribute("#needle", "transform");
  };
  const turned = await needle();
  await page.mouse.down();
  await page.mouse.move(spot[0] + 60, spot[1], { steps: 4 });
  await page.mouse.up();
  assert.notEqual(await needle(), turned);
  await page.click("#compass");
  assert.match(await needle(), /rotate\(-?(0|360)\.0\)/);
  await closePage(page);
});

test("colours: a scale, a legend and a picture for each", async () => {
  const page = await openPage();
  await page.keyboard.press("2");
  const seen = new Set();
  const titles = { height: "Height, m", probability: "Probability", agreement: "Agreement" };
  for (const [colour, title] of Object.entries(titles)) {
    await page.click(`[data-colour=${colour}]`);
    await settled(page);
    assert.equal(await text(page, "legend-title"), title);
    const ticks = await page.locator("#legend-ticks li").allTextContents();
    const values = ticks.map((tick) => numbers(tick)[0]);
    assert.ok(Math.min(...values) >= (colour === "height" ? -3 : 0) && Math.max(...values) <= 1 && values.length >= 3);
    await page.mouse.move(5, 5);
    seen.add(await picture(page, await middle(page)));
  }
  assert.equal(seen.size, 3);
  await page.keyboard.press("c");
  assert.equal(await page.getAttribute("[data-colour=height]", "aria-pressed"), "true");
  await settled(page);
  // The bottom has the lowest colour of the scale, lit from above.
  await page.mouse.move(5, 5);
  const box = await mapBox(page);
  const [r, g, b] = await pixels(page, {
    x: box.x + box.width / 2 - 40,
    y: box.y + box.height / 2 + 60,
    width: 1,
    height: 1,
  });
  assert.ok(Math.abs(r - 71) < 12 && g < 20 && Math.abs(b - 88) < 12, `${r} ${g} ${b}`);
  await closePage(page);
});

test("heights, threshold and size of cells choose what is drawn", async () => {
  const page = await openPage();
  await openDisplay(page);
  const shown = (from, end, threshold) =>
    tankCells.filter(({ z, probability }) => z >= from && z < end && probability >= threshold).length;
  await setSlider(page, "slab-high", 40);
  await settled(page);
  assert.match(await text(page, "slab-text"), /−3\.00 to −1\.00 m/);
  assert.equal(await count(page, "cells-drawn"), shown(-60, -20, 128));
  await setSlider(page, "slab-low", 10);
  await settled(page);
  assert.equal(await count(page, "cells-drawn"), shown(-50, -20, 128));
  await setSlider(page, "threshold", 0.4);
  await settled(page);
  assert.equal(await count(page, "cells-drawn"), shown(-50, -20, 102));
  assert.ok(shown(-50, -20, 102) > shown(-50, -20, 128));
  await setSlider(page, "threshold", 0.9);
  await settled(page);
  assert.equal(await count(page, "cells-drawn"), shown(-50, -20, 230));
  await page.click("#reset");
  await settled(page);
  assert.equal(await count(page, "cells-drawn"), shown(-60, 0, 128));
  assert.match(await text(page, "slab-text"), /−3\.00 to 0\.00 m/);
  await page.selectOption("#cell-size", { label: "0.2 m" });
  await settled(page);
  const coarse = await count(page, "cells-drawn");
  assert.ok(coarse > 500 && coarse < shown(-60, 0, 128) / 8, `${coarse} cells`);
  // A ruler's point is where the cut is.
  await page.click("#reset");
  await setSlider(page, "slab-high", 20);
  await page.keyboard.press("d");
  await settled(page);
  await page.keyboard.press("2");
  const scale = await metresPerPixel(page);
  const box = await mapBox(page);
  const wall = await readingAt(page, box.x + box.width / 2 - 3.975 / scale, box.y + box.height / 2);
  assert.ok(Math.abs(wall[2] + 2) < 0.02, `the wall is cut at ${wall[2]} m`);
  await closePage(page);
});

test("free and unknown space come and go", async () => {
  const page = await openPage();
  await openDisplay(page);
  await setSlider(page, "slab-high", 40);
  await settled(page);
  const clip = { ...(await mapBox(page)), width: 500 };
  const without = await picture(page, clip);
  for (const space of ["free", "unknown"]) {
    await page.check(`#${space}`);
    await pictureAfter(page, clip, without, space);
    await page.uncheck(`#${space}`);
    await until(async () => (await picture(page, clip)) === without, space);
  }
  await closePage(page);
});

test("layers are switched off and on", async () => {
  const page = await openPage();
  await page.keyboard.press("2");
  await openDisplay(page);
  assert.deepEqual(await page.locator("#layers label").allTextContents(), ["tank.bt", "slam.tum", "cloud.ply"]);
  const box = await mapBox(page);
  const clip = { ...box, width: box.width - 320 };
  for (const name of ["slam.tum", "tank.bt"]) {
    const before = await picture(page, clip);
    await page.getByLabel(name).uncheck();
    await pictureAfter(page, clip, before, name);
  }
  await until(async () => (await count(page, "faces-drawn")) === 0, "no faces without the map");
  await page.click("#reset");
  await settled(page);
  assert.ok((await count(page, "faces-drawn")) > 100);
  await closePage(page);
});

test("the ruler measures between two points", async () => {
  const page = await openPage();
  await page.keyboard.press("2");
  await page.click("#measure");
  assert.match(await text(page, "readout"), /first point/);
  const scale = await metresPerPixel(page);
  const box = await mapBox(page);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2 + 50];
  await page.mouse.click(x - 60, y);
  assert.match(await text(page, "readout"), /second point/);
  await page.mouse.click(x + 90, y - 40);
  const [distance, level, height] = numbers(await text(page, "readout"));
  const expected = Math.hypot(150, 40) * scale;
  assert.ok(Math.abs(distance - expected) < 0.02, `${distance} m for ${expected} m`);
  assert.ok(Math.abs(level - expected) < 0.02 && Math.abs(height) < 0.01);
  assert.equal(numbers(await text(page, "ruler-label"))[0], distance);
  // The wall is as high as the tank is deep.
  await page.keyboard.press("Escape");
  await untilHidden(page, "ruler-label");
  await page.keyboard.press("r");
  await page.mouse.click(x, y);
  await page.mouse.click(box.x + box.width / 2 - 3.975 / scale, y);
  assert.ok(Math.abs(numbers(await text(page, "readout"))[2] - 2.95) < 0.02);
  await closePage(page);
});

test("the time line chooses a beam in all parts", async () => {
  const page = await openPage();
  await page.waitForFunction(
    (beam) => document.getElementById("beam-number").textContent === `${beam} / 1600`,
    beamsPerTurn,
  );
  await page.keyboard.press("2");
  await page.mouse.move(5, 5);
  const clip = await mapBox(page);
  const before = await picture(page, clip);
  await setSlider(page, "moment", 500);
  await page.waitForFunction(() => document.getElementById("beam-number").textContent !== "400 / 1600");
  const beam = numbers(await text(page, "beam-number"))[0];
  assert.ok(Math.abs(beam - 800) <= 1);
  await pictureAfter(page, clip, before, "the vehicle has moved");
  const time = new Date((startTime + (beam - 1) * beamSeconds) * 1000).toISOString().slice(11, 19);
  assert.match(await text(page, "moment-text"), new RegExp(`${time}.*UTC`));
  await page.keyboard.press(".");
  await page.waitForFunction(
    (wanted) => document.getElementById("beam-number").textContent === `${wanted} / 1600`,
    beam + 1,
  );
  await page.click("#beam-back");
  await page.waitForFunction(
    (wanted) => document.getElementById("beam-number").textContent === `${wanted} / 1600`,
    beam,
  );
  await page.keyboard.press("Shift+>");
  await page.waitForFunction(
    (least) => parseInt(document.getElementById("beam-number").textContent) > least,
    beam + beamsPerTurn - 3,
  );
  await closePage(page);
});

test("play goes on at its speed, and pause stops", async () => {
  const page = await openPage();
  await page.selectOption("#speed", "16");
  await setSlider(page, "moment", 0);
  const started = Date.now();
  await page.keyboard.press(" ");
  assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
  await page.waitForFunction(() => parseInt(document.getElementById("beam-number").textContent) > 200);
  await page.click("#play");
  const beam = numbers(await text(page, "beam-number"))[0];
  const most = (16 * (Date.now() - started)) / 1000 / beamSeconds;
  assert.ok(beam <= most + 2, `${beam} of at most ${most}`);
  assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
  await page.waitForTimeout(200);
  assert.equal(numbers(await text(page, "beam-number"))[0], beam);
  await closePage(page);
});

test("the sonar image: fan, waterfall, echoes and threshold", async () => {
  const page = await openPage();
  await until(async () => (await text(page, "beam-number")) === "400 / 1600");
  const frame = await page.locator("#picture").boundingBox();
  const radius = Math.min(frame.width, frame.height) / 2 - 14;
  const centre = [frame.x + frame.width / 2, frame.y + frame.height / 2];
  // A click to the left chooses a beam at 90 degrees to the left.
  await page.mouse.click(centre[0] - radius / 2, centre[1]);
  await page.waitForFunction(() => /left/.test(document.getElementById("beam-bearing").textContent));
  const [degrees] = numbers(await text(page, "beam-bearing"));
  assert.ok(Math.abs(degrees - 90) < 2, `${degrees} degrees`);
  const [echo] = numbers(await text(page, "beam-echo"));
  assert.ok(echo > 0 && echo < 10);
  assert.equal(await text(page, "beam-threshold"), "90");
  const states = [await picture(page, frame)];
  await page.uncheck("#show-echoes");
  states.push(await pictureAfter(page, frame, states[0], "echoes"));
  // Water between ahead and the beam, behind the walls.
  const water = { x: centre[0] - 0.55 * radius, y: centre[1] - 0.55 * radius, width: 16, height: 16 };
  const light = async () => (await pixels(page, water)).reduce((sum, value) => sum + value, 0);
  const whole = await light();
  await page.check("#show-threshold");
  states.push(await pictureAfter(page, frame, states[1], "threshold"));
  assert.equal(new Set(states).size, 3);
  assert.ok((await light()) < 0.6 * whole, "what is below the threshold is dark");
  // The echo is where the curve says: bright at its range, dark water before it.
  await page.uncheck("#show-threshold");
  const range = 10;
  const strip = await pixels(page, { x: centre[0] - radius, y: centre[1] - 4, width: radius, height: 1 });
  const brightness = Array.from(
    { length: Math.floor(strip.length / 3) },
    (_, i) => strip[3 * i] + strip[3 * i + 1] + strip[3 * i + 2],
  );
  const at = Math.round(radius * (1 - echo / range));
  assert.ok(Math.max(...brightness.slice(at - 4, at + 5)) > 300, "an echo");
  await page.click("[data-picture=waterfall]");
  await nextFrames(page);
  const waterfall = await page.locator("#picture").boundingBox();
  await page.mouse.click(waterfall.x + waterfall.width - 10, waterfall.y + 80);
  const beam = numbers(await text(page, "beam-number"))[0];
  assert.ok(beam > 600, `beam ${beam}`);
  await page.click("#sonar-toggle");
  await untilHidden(page, "sonar");
  await closePage(page);
});

test("help names the keys", async () => {
  const page = await openPage();
  await page.keyboard.press("?");
  assert.ok(await page.locator("#help-dialog").isVisible());
  await page.getByRole("button", { name: "Close" }).click();
  await untilHidden(page, "help-dialog");
  await closePage(page);
});

test("light and dark", async () => {
  const page = await openPage();
  const box = await mapBox(page);
  const corner = { x: box.x + 4, y: box.y + 4, width: 1, height: 1 };
  const light = (rgb) => rgb[0] + rgb[1] + rgb[2];
  assert.ok(light(await pixels(page, corner)) < 150);
  await page.emulateMedia({ colorScheme: "light" });
  await until(async () => light(await pixels(page, corner)) > 600, "a light ground");
  await closePage(page);
});

test("on a phone all is within the screen, and two fingers come nearer", async () => {
  const page = await openPage({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  for (const id of ["measure", "display", "sonar-toggle", "help", "play", "moment", "picture", "curve", "map"]) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box && box.x >= 0 && box.x + box.width <= 390.5 && box.y >= 0 && box.y + box.height <= 844.5, id);
  }
  const box = await mapBox(page);
  assert.ok(box.height > 300);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const before = await metresPerPixel(page);
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) =>
    session.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: points.map(([tx, ty], id) => ({ x: tx, y: ty, id })),
    });
  await touch("touchStart", [
    [x - 30, y],
    [x + 30, y],
  ]);
  for (let i = 1; i <= 5; ++i)
    await touch("touchMove", [
      [x - 30 - 10 * i, y],
      [x + 30 + 10 * i, y],
    ]);
  await touch("touchEnd", []);
  await settled(page);
  const ratio = (await metresPerPixel(page)) / before;
  assert.ok(Math.abs(ratio - 60 / 160) < 0.05, `${ratio}`);
  await page.tap("#display");
  assert.ok(await page.locator("[data-colour=probability]").isVisible());
  await page.tap("[data-colour=probability]");
  assert.equal(await text(page, "legend-title"), "Probability");
  await closePage(page);
});

test("an exported page opens from a file, without any request", async () => {
  const place = mkdtempSync(join(tmpdir(), "pingvox-page-"));
  const file = join(place, "page.html");
  writeFileSync(file, exportPage(tank, folder));
  const page = await openPage({ address: `file://${file}` });
  assert.equal(await count(page, "cells-drawn"), tankCells.filter((cell) => cell.probability >= 128).length);
  await page.keyboard.press(".");
  await page.waitForFunction(() => document.getElementById("beam-number").textContent === "401 / 1600");
  await openDisplay(page);
  await page.check("#free");
  await settled(page);
  await closePage(page);
  rmSync(place, { recursive: true });
});

test("what is missing is said", async () => {
  const { "map/0/cells": _, ...broken } = tank;
  const other = await serve(broken, folder);
  const page = await browser.newPage();
  await page.goto(other.address);
  await page.waitForSelector("#error:not([hidden])");
  assert.match(await text(page, "error"), /map\/0\/cells: 404/);
  await page.close();
  await other.close();
});

test("a path without a map, and a page with nothing in it", async () => {
  const list = JSON.parse(new TextDecoder().decode(tank["scene.json"]));
  for (const scene of [
    { ...list, maps: [], logs: [], points: [] },
    { ...list, maps: [], logs: [], points: [], paths: [], notes: [] },
  ]) {
    const other = await serve({ ...tank, "scene.json": new TextEncoder().encode(JSON.stringify(scene)) }, folder);
    const page = await openPage({ address: other.address });
    assert.equal(await page.locator("#legend").isVisible(), false);
    assert.equal(await page.locator("#time").isVisible(), scene.paths.length > 0);
    assert.equal(await page.locator("#progress").isVisible(), false);
    await closePage(page);
    await other.close();
  }
});

/** More of them where the environment asks for it. */
const loads = Number(process.env.PINGVOX_LOADS ?? 12);

test("many loads do not grow", async () => {
  const page = await openPage();
  const session = await page.context().newCDPSession(page);
  await session.send("HeapProfiler.enable");
  const heap = async () => {
    await session.send("HeapProfiler.collectGarbage");
    return (await session.send("Runtime.getHeapUsage")).usedSize;
  };
  const sizes = [];
  for (let i = 0; i < loads; ++i) {
    await page.reload();
    await isReady(page);
    if (i >= 4) sizes.push(await heap());
  }
  assert.ok(Math.min(...sizes.slice(-4)) < 1.1 * Math.min(...sizes.slice(0, 4)) + 1e6, sizes.join(" "));
  assert.equal(page.workers().length, 1);
  await closePage(page);
});
