// Takes pictures of a page for the documentation: take_pictures.mjs ADDRESS FOLDER
import { join } from "node:path";
import { startBrowser } from "./browser.mjs";

const [address, folder] = process.argv.slice(2);
if (!folder) {
  console.error("Usage: node web/tests/take_pictures.mjs ADDRESS FOLDER");
  console.error("Writes view.png and view-phone.png; ADDRESS is what pingvox view prints.");
  process.exit(2);
}

const browser = await startBrowser();
for (const [name, options] of Object.entries({
  "view.png": { viewport: { width: 1200, height: 740 }, colorScheme: "dark" },
  "view-phone.png": { viewport: { width: 390, height: 780 }, colorScheme: "light", hasTouch: true, isMobile: true },
})) {
  const page = await browser.newPage({ reducedMotion: "reduce", ...options });
  page.setDefaultTimeout(120000);
  await page.goto(address);
  await page.waitForFunction(
    () => document.documentElement.dataset.page === "ready" && document.documentElement.dataset.detail === "complete",
  );
  // The intensities come last.
  await page.waitForTimeout(1000);
  await page.screenshot({ path: join(folder, name) });
  await page.close();
}
await browser.close();
