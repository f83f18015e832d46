// Makes the tool's page, one file: markup, style, script, the program (WebAssembly) and an example.
//   node build-tool.mjs PROGRAM.wasm EXAMPLE-FOLDER PAGE.html
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const [program, example, file] = process.argv.slice(2);
const common = { bundle: true, minify: true, charset: "ascii", legalComments: "none", write: false };
const script = { ...common, format: "iife", target: "es2022" };
const text = async (options) => (await build(options)).outputFiles[0].text.trim();
const worker = await text({ ...script, entryPoints: ["tool/worker.ts"] });
const code = await text({ ...script, entryPoints: ["tool/main.ts"], define: { WORKER: JSON.stringify(worker) } });
const style = await text({ ...common, entryPoints: ["tool/tool.css"], loader: { ".woff2": "dataurl" } });
if (/<\/script|<!--/i.test(code) || /<\/style/i.test(style)) throw new Error("the bundle would end its own element");
const files = ["program.nc", "job.toml", "probe.txt"];
const corner = Object.fromEntries(await Promise.all(files.map(async (name) => [name, await readFile(join(example, name), "utf8")])));
// Without the time of the build: the same sources give the same bytes.
const packed = gzipSync(await readFile(program), { level: 9 });
// Named without its scheme: a page has no address of the network in it.
const holder = (await readFile("font/OFL.txt", "utf8")).split("\n")[0].replace("https://", "");
const html = (await readFile("tool/tool.html", "utf8"))
  .replace("/*style*/", () => `/* Letters: Arimo. ${holder}. SIL Open Font License 1.1, openfontlicense.org */\n${style}`)
  .replace("/*examples*/", () => JSON.stringify({ corner }).replaceAll("<", "\\u003c"))
  .replace("/*program*/", () => packed.toString("base64"))
  .replace("/*script*/", () => code);
await mkdir(dirname(file), { recursive: true });
await writeFile(file, html);
console.log(`${file}: ${(html.length / 1e6).toFixed(2)} MB, program ${(packed.length / 1e6).toFixed(2)} MB packed`);
