// Serves the page and a scene as the program does, with its strict policy; and makes exported pages.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { deflateRawSync } from "node:zlib";

const types = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css", json: "application/json" };

export const policy =
  "default-src 'none'; script-src 'self'; style-src 'self'; worker-src 'self'; connect-src 'self'; img-src data:";

/** @param scene answers by URL, @param folder with page.html, page.css and page.js, @returns address and `close` */
export async function serve(scene, folder) {
  const server = createServer((request, response) => {
    const url = new URL(request.url, "http://localhost");
    const name = decodeURIComponent(url.pathname.slice(1)) || "page.html";
    let body = scene[name];
    if (body && url.searchParams.has("from")) {
      const bins = JSON.parse(new TextDecoder().decode(scene["scene.json"])).logs[0].bins;
      body = body.subarray(Number(url.searchParams.get("from")) * bins, Number(url.searchParams.get("to")) * bins);
    }
    if (!body && ["page.html", "page.css", "page.js"].includes(name)) body = readFileSync(`${folder}/${name}`);
    if (!body) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, {
      "Content-Type": types[name.split(".").pop()] ?? "application/octet-stream",
      "Content-Security-Policy": policy,
      "Cache-Control": "no-store",
    });
    response.end(body);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    close: () => new Promise((resolve) => server.close(resolve)),
  };
}

/** One file with all in it. */
export function exportPage(scene, folder) {
  const read = (name) => readFileSync(`${folder}/${name}`, "utf8");
  const data = Object.entries(scene)
    .map(
      ([url, bytes]) =>
        `<script type="application/octet-stream" id="${url}">${deflateRawSync(bytes).toString("base64")}</script>`,
    )
    .join("\n");
  return read("page.html")
    .replace('<link rel="stylesheet" href="page.css">', () => `<style>${read("page.css")}</style>`)
    .replace('<script src="page.js"></script>', () => `${data}\n<script>${read("page.js")}</script>`);
}
