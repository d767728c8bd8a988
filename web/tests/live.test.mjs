// The page of `pingvox live --view` in Chromium, with emulated devices. The program is named by PINGVOX.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { startBrowser } from "./browser.mjs";

const program = process.env.PINGVOX;
const longest = 120000;
let browser;
let folder;
const running = [];

/** Starts the program; `line` waits for a line of its standard output that a pattern matches. */
function start(...args) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "pipe"] });
  let text = "";
  const waiting = [];
  const take = (piece) => {
    text += piece;
    for (const check of [...waiting]) check();
  };
  child.stdout.on("data", take);
  child.stderr.on("data", take);
  const ended = new Promise((resolve) => child.on("exit", (code) => resolve({ code, text })));
  const line = (pattern) =>
    new Promise((resolve, reject) => {
      const check = () => {
        const found = text.match(pattern);
        if (!found) return;
        waiting.splice(waiting.indexOf(check), 1);
        resolve(found[0]);
      };
      waiting.push(check);
      check();
      void ended.then(() => reject(new Error(`${args[0]} ended: ${text}`)));
    });
  const stop = async () => {
    if (child.exitCode === null) child.kill("SIGINT");
    return ended;
  };
  running.push(stop);
  return { line, stop, child };
}

async function startLive(...args) {
  const head = start("emulate", "ping360", "--listen", "udp://127.0.0.1:0", "--rate", "60");
  const address = await head.line(/udp:\/\/127\.0\.0\.1:\d+/);
  const live = start("live", `ping360:${address}`, "--range", "4", "--vote", "beam", "--view", ...args);
  const url = await live.line(/http:\/\/127\.0\.0\.1:\d+\/\w+\//);
  return { ...live, url };
}

async function openPage(url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 700 }, colorScheme: "dark", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(longest);
  page.problems = [];
  page.on("console", (message) => page.problems.push(message.text()));
  page.on("pageerror", (error) => page.problems.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.page === "ready");
  return page;
}

const text = (page, id) => page.locator(`#${id}`).evaluate((found) => found.textContent);
const shown = async (page, id) => Number((await text(page, id)).replaceAll(",", ""));
const until = (page, condition, argument) => page.waitForFunction(condition, argument, { polling: 100 });
/** There are cells, and a state has been taken whole: only then has the page a version. */
const untilMapped = (page) =>
  until(
    page,
    () =>
      Number(document.getElementById("cells-drawn").textContent.replaceAll(",", "")) > 200 &&
      document.documentElement.dataset.version !== undefined,
  );
/** Both pages, as the one whose button is pressed next must know what the other shows. */
const untilRecording = async (pages, recording) => {
  for (const page of pages) await until(page, (wanted) => document.getElementById("live").dataset.recording === wanted, recording);
};
const untilBeamAfter = (page, beam) =>
  until(page, (before) => Number(document.getElementById("beam-number").textContent.split(" ")[0]) > before, beam);
const beamOf = (page) => page.locator("#beam-number").evaluate((found) => Number(found.textContent.split(" ")[0]));

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "pingvox-live-"));
  browser = await startBrowser();
});

after(async () => {
  await browser?.close();
  for (const stop of running) await stop();
  if (folder) rmSync(folder, { recursive: true });
});

test("map, picture and figures grow, and two pages see the same", { timeout: longest }, async () => {
  const live = await startLive("-o", join(folder, "grows.bt"));
  const [first, second] = [await openPage(live.url), await openPage(live.url)];
  await untilMapped(first);
  const cells = await shown(first, "cells-drawn");
  const beam = await beamOf(first);
  await untilBeamAfter(first, beam + 100);
  await until(first, (before) => Number(document.getElementById("cells-drawn").textContent.replaceAll(",", "")) > before, cells);
  assert.match(await text(first, "live-depth"), /^−?\d/);
  assert.match(await text(first, "live-nearest"), / m/);
  assert.match(await text(first, "live-beams"), /\d+ · \d+\/s/);
  assert.equal(await text(first, "live-record"), "off");
  // Both come to the same version, though one may be a moment later.
  await untilMapped(second);
  const version = Number(await first.evaluate(() => document.documentElement.dataset.version));
  await until(second, (wanted) => Number(document.documentElement.dataset.version) >= wanted, version);
  // An earlier time is chosen, and then what comes in again.
  const newest = await beamOf(first);
  await first.locator("#moment").evaluate((slider) => {
    slider.value = "300";
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  });
  assert.equal(await first.locator("#newest").getAttribute("aria-pressed"), "false");
  await until(first, (before) => Number(document.getElementById("beam-number").textContent.split(" ")[0]) < before, newest);
  const chosen = await beamOf(first);
  const at = Number(await first.evaluate(() => document.documentElement.dataset.version));
  await until(first, (before) => Number(document.documentElement.dataset.version) > before, at);
  assert.ok(Math.abs((await beamOf(first)) - chosen) <= 1, "the chosen time stays");
  await first.click("#newest");
  await untilBeamAfter(first, newest);
  for (const page of [first, second]) {
    assert.deepEqual(page.problems, []);
    await page.context().close();
  }
  const { code } = await live.stop();
  assert.equal(code, 0);
  assert.ok(existsSync(join(folder, "grows.bt")));
});

test("free space is shown on demand, and grows with the map", { timeout: longest }, async () => {
  const live = await startLive("-o", join(folder, "free.bt"));
  const page = await openPage(live.url);
  await untilMapped(page);
  const isFree = (answer) => answer.url().endsWith("map/0/free") && answer.status() === 200;
  await page.click("#display");
  const sizes = [];
  for (let i = 0; i < 2; ++i) {
    const answer = page.waitForResponse(isFree);
    if (i === 0) await page.check("#free");
    sizes.push((await (await answer).body()).length);
  }
  assert.ok(sizes[0] > 1000, "free cells of the tank");
  await until(page, () => document.documentElement.dataset.detail === "complete");
  await page.uncheck("#free");
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await live.stop();
});

test("on a phone the controls are within the screen", { timeout: longest }, async () => {
  const live = await startLive("-o", join(folder, "phone.bt"));
  const page = await openPage(live.url, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await untilMapped(page);
  for (const id of ["control", "sonar-toggle", "help", "play", "moment", "moment-text", "newest"]) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box && box.x >= 0 && box.x + box.width <= 390.5, id);
  }
  const [time, newest] = await Promise.all(["moment-text", "newest"].map((id) => page.locator(`#${id}`).boundingBox()));
  assert.ok(time.x + time.width <= newest.x, "the time is not covered");
  await page.context().close();
  await live.stop();
});

test("a connection that was lost comes back, with what it has missed", { timeout: longest }, async () => {
  const live = await startLive("-o", join(folder, "lost.bt"));
  const page = await openPage(live.url);
  await untilMapped(page);
  await page.context().setOffline(true);
  // Read at once: events may still come while nothing can be fetched.
  await until(page, () => {
    const connection = document.getElementById("connection");
    return document.documentElement.dataset.live === "lost" && !connection.hidden && /lost/.test(connection.textContent);
  });
  const version = Number(await page.evaluate(() => document.documentElement.dataset.version));
  await page.waitForTimeout(1000);
  await page.context().setOffline(false);
  await until(page, (before) => Number(document.documentElement.dataset.version) > before + 2, version);
  await until(page, () => document.getElementById("connection").hidden);
  await page.context().close();
  await live.stop();
});

test("controls drive the head, record, and begin a new map", { timeout: longest }, async () => {
  const live = await startLive("-o", join(folder, "dive.bt"), "--record", join(folder, "records"));
  const [page, looks] = [await openPage(live.url), await openPage(live.url.replace(/\w+\/$/, ""))];
  assert.ok(await looks.locator("#control").isHidden(), "without the token");
  await untilMapped(page);
  await untilRecording([page, looks], "on");
  await page.click("#control");
  await page.fill("#head-range", "3");
  await page.selectOption("#head-gain", "high");
  await page.check("#head-is-sector");
  await page.click("#head-form button");
  // The head says what it does, to both.
  const untilDriven = (each) =>
    until(each, async () => {
      const { head } = (await (await fetch("state")).json()).status;
      return head.range_m === 3 && head.gain === "high" && head.sector_deg !== null;
    });
  await untilDriven(page);
  await untilDriven(looks);
  await page.fill("#head-step", "1");
  await page.click("#head-form button");
  await until(page, () => /multiple/.test(document.getElementById("live-message").title));

  await page.click("#record");
  await untilRecording([page, looks], "off");
  assert.equal(await text(looks, "live-record"), "off");
  await page.click("#record");
  await untilRecording([page, looks], "on");
  assert.equal(readdirSync(join(folder, "records")).length, 2);

  await page.click("#new-map");
  await page.click("#new-map");
  await until(looks, () => /dive-1\.bt/.test(document.getElementById("live-message").title));
  await untilMapped(looks);
  for (const each of [page, looks]) {
    assert.deepEqual(each.problems, []);
    await each.context().close();
  }
  const { code } = await live.stop();
  assert.equal(code, 0);
  assert.ok(existsSync(join(folder, "dive-1.bt")));
  assert.ok(existsSync(join(folder, "dive.bt")));
});
