// Modules of the page that need no document, as web/check bundles them.
const folder = new URL("../../build/web/modules/", import.meta.url);
export const cells = await import(new URL("cells.js", folder));
export const faces = await import(new URL("faces.js", folder));
export const facesWorker = await import(new URL("faces_worker.js", folder));
export const detail = await import(new URL("level_of_detail.js", folder));
export const liveCells = await import(new URL("live_cells.js", folder));
export const path = await import(new URL("path.js", folder));
export const scene = await import(new URL("scene.js", folder));
export const dom = await import(new URL("dom.js", folder));
