// A browser with a report opened from disk, and a record of everything it complains about or asks the network for.
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const root = fileURLToPath(new URL("..", import.meta.url));
export const out = `${root}tests/out/`;
const PLACE = 'id="truepath-data">null</script>';

export async function launch() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
  });
}

export async function sample(name) {
  return JSON.parse(await readFile(`${root}samples/${name}.json`, "utf8"));
}

/** The report with data in it, as the program writes it; its path. */
export async function write(name, data) {
  const page = await readFile(`${root}dist/report.html`, "utf8");
  const text = JSON.stringify(data).replaceAll("<", "\\u003c");
  await mkdir(out, { recursive: true });
  const file = `${out}${name}.html`;
  await writeFile(file, page.replace(PLACE, () => `id="truepath-data">${text}</script>`));
  return file;
}

export async function open(browser, file, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: "light", reducedMotion: "no-preference", ...options });
  const page = await context.newPage();
  const complaints = [];
  const requests = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) requests.push(request.url()); });
  const url = pathToFileURL(file).href;
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.firstPicture !== undefined);
  return { context, page, complaints, requests, close: () => context.close() };
}

/** Where a point of the part lies on the page, from what the scene says of its view. */
export async function onPage(page, x, y, scene = 0) {
  const stage = page.locator(".stage:visible").nth(scene);
  const box = await stage.boundingBox();
  const [cx, cy, scale] = (await stage.getAttribute("data-view")).split(" ").map(Number);
  return { x: box.x + box.width / 2 + (x - cx) * scale, y: box.y + box.height / 2 - (y - cy) * scale };
}
