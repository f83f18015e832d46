// The page of the tool, opened from disk in a real browser: what its commands write is what the command line writes, byte for byte.
// `cargo xtask web` builds page and program, and sets TRUEPATH_PROGRAM (the command line) and TRUEPATH_PAGES (target/web).
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, relative } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { PHONE, browser, pages, pictures } from "./browser.mjs";
import { violations } from "./checks.mjs";

const site = `${pages}site/index.html`;
const program = process.env.TRUEPATH_PROGRAM ?? fileURLToPath(new URL("../../../target/debug/truepath", import.meta.url));
const shop = fileURLToPath(new URL("../../../tests/data/shop/", import.meta.url));
const island = fileURLToPath(new URL("parts/island/", import.meta.url));
const demo = `${pages}demo/`;
/** What the page may be, packed as a server sends it, bytes. */
const LARGEST = 6_000_000;
/** What a command may take on a part of the demonstration, ms; machines are shared. */
const PATIENCE = 120_000;

const folders = [];
after(() => Promise.all(folders.map((folder) => rm(folder, { recursive: true, force: true }))));

/** A folder with copies of files. */
async function folderOf(...files) {
  const folder = await mkdtemp(join(tmpdir(), "truepath-web-"));
  folders.push(folder);
  for (const file of files) await cp(file, join(folder, file.split("/").pop()));
  return folder;
}

/** The command line in a folder; what it printed. */
function pc(folder, ...words) {
  return execFileSync(program, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

/** Milliseconds since the page was asked for. */
const sinceOpened = (page) => page.evaluate(() => Math.round(performance.now()));

/** The page, open; it must not complain or ask the network for anything. */
async function open(t, { expected, ...options } = {}) {
  const context = await (await browser()).newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  context.on("request", (request) => { if (!/^(file|blob|data):/.test(request.url())) complaints.push(`asked for ${request.url()}`); });
  t.after(async () => {
    await context.close();
    assert.deepEqual(complaints.filter((text) => !expected?.test(text)), []);
  });
  await page.goto(pathToFileURL(site).href);
  page.setDefaultTimeout(PATIENCE);
  return page;
}

const press = (page, name) => page.getByRole("button", { name }).click();

/** Waits until the command that was started has ended; what was announced. */
async function ended(page) {
  await page.locator("#running").waitFor({ state: "hidden" });
  await page.waitForFunction(() => document.getElementById("live").textContent !== "");
  return page.locator("#live").textContent();
}

/** Presses a button and waits for its command. */
async function run(page, name) {
  await press(page, name);
  const said = await ended(page);
  assert.equal(said, "Done.", await page.locator("pre.said").allTextContents().then((all) => all.join("\n")));
}

/** The files that a card offers, by name: its archive, unpacked by another program. */
async function offered(page, card, folder) {
  const link = page.locator(`#${card}`).getByText("all of them");
  await page.waitForFunction((a) => a.href.startsWith("blob:"), await link.elementHandle());
  const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
  const archive = join(await folderOf(), "all.zip");
  await download.saveAs(archive);
  const unpacked = await folderOf();
  execFileSync("python3", ["-m", "zipfile", "-e", archive, unpacked]);
  return below(join(unpacked, folder));
}

/** Every file below a folder by its name from `root` on. */
async function below(folder, root = folder) {
  const found = new Map();
  for (const entry of await readdir(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) for (const [name, bytes] of await below(path, root)) found.set(name, bytes);
    else found.set(relative(root, path), await readFile(path));
  }
  return found;
}

/** A JSON text whose numbers have twelve digits: beyond them the maths libraries of a PC and of the module may differ. */
const digits = (bytes) => JSON.stringify(JSON.parse(Buffer.from(bytes).toString()), (_, value) => (typeof value === "number" ? Number(value.toPrecision(12)) : value));

/** Files of the page and of the command line are the same, and there are some; those of `rounded` in twelve digits. */
function same(here, there, rounded = []) {
  assert.deepEqual([...here.keys()].sort(), [...there.keys()].sort());
  assert.ok(here.size > 0);
  for (const [name, bytes] of there) {
    if (rounded.includes(name)) assert.equal(digits(here.get(name)), digits(bytes), name);
    else assert.ok(Buffer.from(here.get(name)).equals(bytes), `${name} differs from that of the command line`);
  }
}

async function drop(page, ...files) {
  await page.locator("#files").setInputFiles(files);
  for (const file of files) await page.locator("#desk").getByText(file.split("/").pop(), { exact: true }).waitFor();
}

/** Job, readings and program of a part of the demonstration. */
const part = (name) => ["program.nc", "job.toml", "probe.txt"].map((file) => `${demo}${name}/${file}`);

test("the page is small, names no address of the network, and opens from disk without a complaint", async (t) => {
  const bytes = await readFile(site);
  const packed = gzipSync(bytes, { level: 6 }).length;
  assert.ok(packed < LARGEST, `${packed} bytes packed`);
  t.diagnostic(`${(bytes.length / 1e6).toFixed(2)} MB, packed ${(packed / 1e6).toFixed(2)} MB`);
  const text = bytes.toString();
  const foreign = [...text.matchAll(/(?:https?|wss?|ftp):\/\/[^"'` )<>]*/g)].map(([address]) => address);
  assert.deepEqual(foreign.filter((address) => address !== "http://www.w3.org/2000/svg"), []);
  const page = await open(t, { expected: /example\.org/ });
  assert.match(await page.locator("#stays").textContent(), /Everything stays on this computer/);
  // What the page may do at most is said to the browser, which refuses the rest.
  const refused = await page.evaluate(() => new Promise((resolve) => {
    addEventListener("securitypolicyviolation", (event) => resolve(event.effectiveDirective), { once: true });
    new Image().src = "https://example.org/pixel.png";
  }));
  assert.equal(refused, "img-src");
});

test("what is on the desk decides what can be done, and a button says what is missing", async (t) => {
  const page = await open(t);
  const correct = page.getByRole("button", { name: "Correct the program" });
  assert.equal(await correct.getAttribute("aria-disabled"), "true");
  // A button that cannot do anything yet says so when it is pressed all the same.
  await correct.click({ force: true });
  assert.equal(await page.locator("#note").textContent(), "Not yet: what is missing is the program and the job.");
  await drop(page, ...part("corner"));
  assert.equal(await correct.getAttribute("aria-disabled"), "false");
  const roles = await page.locator("#desk select").evaluateAll((all) => all.map((select) => select.value));
  assert.deepEqual(roles, ["program", "job", "probe"]);
});

test("the corner of the demonstration, one click away, comes out as on the command line", async (t) => {
  const page = await open(t);
  await press(page, "Try it with the corner");
  const folder = await folderOf(...part("corner"));
  const job = ["job.toml", "--probe", "probe.txt"];
  t.diagnostic(`the example is there ${await sinceOpened(page)} ms after the page was asked for`);
  for (const [button, out, words] of [
    ["Correct the program", "corrected", ["correct", ...job]],
    ["Inspect the wall", "inspection", ["inspect", ...job]],
    ["Image for the coprocessor", "image", ["correct", ...job, "--route", "coprocessor"]],
  ]) {
    await run(page, button);
    if (out === "corrected") t.diagnostic(`and its program is corrected after ${await sinceOpened(page)} ms`);
    const printed = pc(folder, ...words, "-o", out, "--force");
    // How certain the wall is comes of exponentials in floating point.
    same(await offered(page, "results", out), await below(join(folder, out)), ["summary.json"]);
    assert.ok((await page.locator("#results pre.said").textContent()).endsWith(printed.trim()), "the words differ");
    const report = page.frameLocator("#results iframe");
    await report.locator("h1").waitFor();
  }
});

for (const name of ["corner-helix", "pocket"]) {
  test(`the ${name} of the demonstration comes out as on the command line`, async (t) => {
    const page = await open(t);
    await drop(page, ...part(name));
    await run(page, "Correct the program");
    const folder = await folderOf(...part(name));
    pc(folder, "correct", "job.toml", "--probe", "probe.txt", "-o", "corrected");
    same(await offered(page, "results", "corrected"), await below(join(folder, "corrected")), ["summary.json"]);
  });
}

test("a part in steel, corrected, inspected and learnt from, comes out as on the command line", async (t) => {
  const page = await open(t);
  const files = ["program.nc", "job.toml", "probe.txt"].map((name) => `${island}${name}`);
  await drop(page, ...files);
  const folder = await folderOf(...files, `${island}probe-2.txt`);
  await run(page, "Correct the program");
  pc(folder, "correct", "job.toml", "--probe", "probe.txt", "-o", "corrected");
  same(await offered(page, "results", "corrected"), await below(join(folder, "corrected")), ["summary.json"]);
  await page.locator("#second").setInputFiles(`${island}probe-2.txt`);
  await run(page, "Make the program of the next part");
  await cp(`${island}probe-2.txt`, join(folder, "second.txt"));
  pc(folder, "learn", "job.toml", "--probe", "second.txt", "--from", "corrected", "-o", "next-part");
  // What parts show of a machine is fitted in floating point, with exponentials.
  same(await offered(page, "next", "next-part"), await below(join(folder, "next-part")), ["summary.json"]);
});

test("a program alone becomes a job by its questions, and a probing program, as on the command line", async (t) => {
  const page = await open(t);
  const name = "fusion-haas-block.nc";
  await drop(page, `${shop}${name}`);
  await press(page, "Make the job from the program");
  await page.locator("#questions").waitFor();
  await page.getByLabel("allowance_mm", { exact: false }).fill("0.4");
  await page.getByRole("button", { name: "Write the job" }).click();
  assert.equal(await ended(page), "Done.");
  const folder = await folderOf(`${shop}${name}`);
  const answers = await page.locator("#job p code").textContent();
  const words = answers.split(" ").slice(1).map((word) => word.replaceAll('"', ""));
  assert.ok(words.includes("allowance=0.4"), answers);
  pc(folder, ...words);
  assert.equal(await page.locator("#job-text").inputValue(), await readFile(join(folder, "job.toml"), "utf8"));
  await page.locator("#control").selectOption("haas");
  await run(page, "Write the probing program");
  pc(folder, "probe", "job.toml", "--dialect", "haas", "-o", "probing/verify.nc");
  same(await offered(page, "touching", "probing"), await below(join(folder, "probing")));
  await run(page, "Write a sheet for a calliper");
  pc(folder, "probe", "job.toml", "--dimensions", "-o", "dimensions/sheet.html");
  same(await offered(page, "touching", "dimensions"), await below(join(folder, "dimensions")));
});

test("a mistake is told with its place, as on the command line, and mended on the page", async (t) => {
  const page = await open(t);
  await press(page, "Try it with the corner");
  await page.locator("#job-fold summary").click();
  const text = await page.locator("#job-text").inputValue();
  await page.locator("#job-text").fill(text.replace("teeth = 6", "teeth = many"));
  await press(page, "Correct the program");
  assert.match(await ended(page), /^Not done/);
  const said = await page.locator("#results pre.wrong").textContent();
  assert.match(said, /job\.toml:\d+:\d+/);
  await page.locator("#job-text").fill(text);
  await run(page, "Correct the program");
});

test("every other command can be typed", async (t) => {
  const page = await open(t);
  await press(page, "Try it with the corner");
  await page.locator("#everything summary").click();
  const type = async (line) => {
    await page.locator("#line").fill(line);
    await run(page, "Run");
    return page.locator("#everything pre.said").textContent();
  };
  assert.equal(await type("truepath --version"), pc(tmpdir(), "--version").trim());
  assert.ok((await type("truepath simulate job.toml -o traced")).length > 0);
  const folder = await folderOf(...part("corner"));
  pc(folder, "simulate", "job.toml", "-o", "traced");
  same(await offered(page, "everything", "traced"), await below(join(folder, "traced")));
});

/** Program, job and readings of a contour of 10,000 lines: a wave with a wall 0.03 to 0.05 mm too far out. */
async function long() {
  const folder = `${pages}long`;
  await mkdir(folder, { recursive: true });
  const [lines, length, period, height] = [10_000, 0.1, 60, 6];
  const points = [[0, 0]];
  for (let x = 0, way = 0, last = [0, 0]; points.length <= lines;) {
    x += length / 200;
    const at = [x, height * Math.sin((2 * Math.PI * x) / period)];
    way += Math.hypot(at[0] - last[0], at[1] - last[1]);
    last = at;
    if (way >= length) { points.push(at); way = 0; }
  }
  const text = points.map(([x, y]) => `X${x.toFixed(4)} Y${y.toFixed(4)}`);
  const program = ["%", "G21 G90 G94", "T1 M6", "S4000 M3", `G0 ${text[0]}`, "G0 Z5", "G1 Z-10 F200", "F800", ...text.slice(1).map((at) => `G1 ${at}`), "G0 Z5", "M30", "%", ""];
  await writeFile(`${folder}/program.nc`, program.join("\n"));
  await writeFile(`${folder}/job.toml`, `version = 1
program = "program.nc"
wall = "right"
[stock]
allowance_mm = 0.5
[tool]
diameter_mm = 12.0
teeth = 4
helix_deg = 30
[cut]
axial_depth_mm = 10.0
[force]
ktc_n_per_mm2 = 820
krc_n_per_mm2 = 230
kte_n_per_mm = 12
kre_n_per_mm = 12
model = "helical"
[machine]
stiffness_x_n_per_mm = 1900
stiffness_y_n_per_mm = 1900
[probe]
ball_diameter_mm = 4.0
format = "linuxcnc"
z_reference = "centre"
`);
  // Centre of the ball beside the wall, which is on the right.
  const readings = [];
  for (const share of [0.1, 0.3, 0.5, 0.7, 0.9]) {
    const k = Math.floor(points.length * share);
    const [[ax, ay], [bx, by]] = [points[k], points[k + 1]];
    const span = Math.hypot(bx - ax, by - ay);
    for (const [z, error] of [[-9, 0.05], [-5, 0.035], [-1, 0.03]]) {
      const reach = (6 - 2 - error) / span;
      const at = [(ax + bx) / 2 + (by - ay) * reach, (ay + by) / 2 - (bx - ax) * reach, z];
      readings.push([...at.map((v) => v.toFixed(6)), 0, 0, 0, 0, 0, 0].join(" "));
    }
  }
  await writeFile(`${folder}/probe.txt`, `${readings.join("\n")}\n`);
  return ["program.nc", "job.toml", "probe.txt"].map((name) => `${folder}/${name}`);
}

test("a program of 10,000 lines shows how far it is, can be cancelled, and comes out as on the command line", async (t) => {
  const files = await long();
  const page = await open(t);
  await drop(page, ...files);
  await press(page, "Correct the program");
  await page.waitForFunction(() => document.querySelector("#running progress").value > 0);
  await press(page, "cancel");
  assert.equal(await ended(page), "Cancelled; the files are as they were.");
  assert.equal(await page.locator("#results pre").count(), 0);
  const begun = Date.now();
  await run(page, "Correct the program");
  t.diagnostic(`10,000 lines corrected in ${((Date.now() - begun) / 1000).toFixed(1)} s`);
  const folder = await folderOf(...files);
  pc(folder, "correct", "job.toml", "--probe", "probe.txt", "-o", "corrected");
  same(await offered(page, "results", "corrected"), await below(join(folder, "corrected")));
});

test("axe finds nothing, light, dark and on a phone, and nothing is wider than the window", async (t) => {
  for (const [what, options] of [["desk", {}], ["dark", { colorScheme: "dark" }], ["phone", PHONE]]) {
    const page = await open(t, options);
    assert.deepEqual(await violations(page), [], `${what}, empty`);
    await press(page, "Try it with the corner");
    await press(page, "Make the job from the program");
    await page.locator("#questions").waitFor();
    await run(page, "Correct the program");
    await page.frameLocator("#results iframe").locator("h1").waitFor();
    await page.locator("#job-fold summary").click();
    // The frame is the report, which has tests of its own.
    await page.locator("#results iframe").evaluate((frame) => frame.remove());
    assert.deepEqual(await violations(page), [], what);
    const wide = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
    assert.ok(wide[0] <= wide[1], `${what}: ${wide}`);
    await page.screenshot({ path: `${pictures}tool-${what}.png`, fullPage: true });
  }
});
