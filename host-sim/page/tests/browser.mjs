// One browser for all tests, pages opened from disk, and a record of everything a page complains about or asks the network for.
// The pages are those the program wrote into TRUEPATH_PAGES (`cargo xtask page`), otherwise into target/page.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { after } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { parse } from "./columns.mjs";

const root = fileURLToPath(new URL("..", import.meta.url));
export const pages = `${process.env.TRUEPATH_PAGES ?? fileURLToPath(new URL("../../../target/page", import.meta.url))}/`;
/** Pictures of the pages, for whoever wants to look. */
export const pictures = `${pages}pictures/`;
/** Pages with data made up for a test. */
const made = `${pages}made/`;
const PLACE = /(<script type="application\/json" id="truepath-data">)(.*?)(<\/script>)/s;
await mkdir(pictures, { recursive: true });
await mkdir(made, { recursive: true });

const FONTS = fileURLToPath(new URL("fonts", import.meta.url));

/**
 * What the browser finds of fonts, and how it draws letters: one font whose every character is a box, so that a letter that
 * is not of the page's own font is seen; or all of the system besides. How they are drawn is the same for both.
 */
async function fontconfig(system) {
  const given = '<edit name="antialias"><bool>true</bool></edit><edit name="hinting"><bool>false</bool></edit><edit name="autohint"><bool>false</bool></edit>'
    + '<edit name="hintstyle"><const>hintnone</const></edit><edit name="rgba"><const>none</const></edit>';
  const file = `${made}fonts-${system ? "system" : "boxes"}.conf`;
  await writeFile(file, `<?xml version="1.0"?>\n<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">\n<fontconfig>`
    + `${system ? '<include ignore_missing="yes">/etc/fonts/fonts.conf</include>' : ""}<dir>${FONTS}</dir><cachedir>${made}fonts</cachedir>`
    + `<match target="pattern">${given}</match><match target="font">${given}</match></fontconfig>\n`);
  return file;
}

export const PHONE = { viewport: { width: 360, height: 740 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true };

let launched;
export function browser() {
  launched ??= launch();
  return launched;
}

/** A browser with no font but that of boxes, or with those of the system, too; WebGL by the processor, or none. */
export async function launch({ system = false, webgl = true } = {}) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    env: { ...process.env, FONTCONFIG_FILE: await fontconfig(system) },
    args: ["--no-sandbox", "--disable-gpu", ...(webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-3d-apis"]), "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
      "--disable-sync", "--disable-dev-shm-usage", "--font-render-hinting=none", "--disable-lcd-text", "--force-color-profile=srgb"],
  });
}
after(async () => (await launched)?.close());

/** A page of the program: its file. The page is the committed one with data put in, nothing else. */
export async function report(name) {
  const file = `${pages}${name}/report.html`;
  const written = await readFile(file, "utf8").catch(() => assert.fail(`no ${file}: cargo xtask page has the program write it`));
  const page = await readFile(`${root}dist/report.html`, "utf8");
  if (written.replace(PLACE, "$1null$3") === page) return file;
  // While the page is being worked on, its newest build shows the program's data.
  assert.ok(!process.env.TRUEPATH_PAGES_AS_WRITTEN, `${file} is not host-sim/page/dist/report.html with data in it`);
  return write(name.replaceAll("/", "-"), JSON.parse(PLACE.exec(written)[2]));
}

/** The data the program put into a page. */
export async function dataOf(name) {
  return JSON.parse(PLACE.exec(await readFile(`${pages}${name}/report.html`, "utf8"))[2]);
}

/** The contours of the plate, in the order of its program. */
export const PLATE = ["pocket", "island", "window", "bore", "outside"];

/** Pages of single contours, as the program wrote them, on one page; its data. */
export function several(contours, title = "Cover plate") {
  const [{ page: { kind, by } }] = contours;
  return { version: 1, kind, title, by, contours };
}

/** The plate of the program with all of its contours, of one kind. */
export const plate = (kind) => dataOf(`plate/${kind}`);

/** A table the program wrote beside a page. */
export async function table(name) {
  return parse(await readFile(`${pages}${name}`, "utf8"));
}

/** A page with data made up for a test; its file. Without letters its own font is broken, so that one of the system has to do. */
export async function write(name, content, { letters = true } = {}) {
  const built = await readFile(`${root}dist/report.html`, "utf8");
  const page = letters ? built : built.replace(/url\(data:font\/woff2;base64,[^)]*\)/g, "url(data:font/woff2;base64,AAAA)");
  assert.ok(letters || page.length < built.length - 10_000, "the font was found and broken");
  const text = JSON.stringify(content).replaceAll("<", "\\u003c");
  const file = `${made}${name}.html`;
  await writeFile(file, page.replace(PLACE, (_, open, _data, close) => open + text + close));
  return file;
}

/** Tabs by the kind of screen and clock they were made with: making one costs more than a test. */
const tabs = new Map();

/** The tab of its kind, with a window of this size and a reader of these wishes. */
async function tab({ viewport = { width: 1440, height: 900 }, colorScheme = "light", reducedMotion = "no-preference", ...options }) {
  const key = JSON.stringify(options);
  if (!tabs.has(key)) {
    const { clock, ...given } = options;
    const context = await (await browser()).newContext({ viewport, ...given });
    if (clock) await context.clock.install({ time: 0 });
    const page = await context.newPage();
    const heard = { complaints: [], requests: [] };
    page.on("console", (message) => { if (["error", "warning"].includes(message.type())) heard.complaints.push(message.text()); });
    page.on("pageerror", (error) => heard.complaints.push(String(error)));
    page.on("request", (request) => { if (!/^(file|data|blob|about):/.test(request.url())) heard.requests.push(request.url()); });
    tabs.set(key, { context, page, heard });
  }
  const { page } = tabs.get(key);
  // A test that failed has left its page.
  if (page.url() !== "about:blank") await page.goto("about:blank");
  await page.setViewportSize(viewport);
  await page.emulateMedia({ colorScheme, reducedMotion });
  return tabs.get(key);
}

/**
 * Opens a page in a tab of its own for these options, which is left empty when it is closed.
 *
 * With `clock` its time stands, and goes on by `page.clock.runFor` alone: how long this machine takes is nothing to such a test.
 */
export async function open(file, options = {}) {
  const { context, page, heard } = await tab(options);
  heard.complaints = [];
  heard.requests = [];
  await page.mouse.move(0, 0);
  if (file !== "about:blank") await show(page, file);
  if (options.clock) await page.clock.pauseAt((await page.evaluate(() => Date.now())) + 3_600_000);
  return { context, page, complaints: heard.complaints, requests: heard.requests, close: () => page.goto("about:blank") };
}

/** Opens a page from disk and waits for its picture. */
export async function show(page, file) {
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(() => document.documentElement.dataset.firstPicture !== undefined);
}

/** Where a point of the part lies in the window, from what the first visible scene says of its view; scrolled to where it is not to be seen. */
export async function onPage(page, x, y) {
  return page.locator(".stage:visible").first().evaluate((stage, at) => {
    const [cx, cy, scale] = stage.dataset.view.split(" ").map(Number);
    const place = () => {
      const box = stage.getBoundingClientRect();
      return { x: box.x + box.width / 2 + (at.x - cx) * scale, y: box.y + box.height / 2 - (at.y - cy) * scale };
    };
    if (place().y < 0 || place().y >= innerHeight) scrollBy({ top: place().y - innerHeight / 2, behavior: "instant" });
    return place();
  }, { x, y });
}

/** The figures at the pointer, by name, as they stand together. */
export async function flag(page) {
  return page.evaluate(() => Object.fromEntries([...document.querySelectorAll(".flag.shown span")].map((name) => [name.textContent, name.nextElementSibling.textContent])));
}
