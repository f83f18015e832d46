// Bundles src/ into one self-contained file, dist/report.html or the one named, with an empty place for the data.
import { readFile, mkdir, writeFile } from "node:fs/promises";
import { dirname } from "node:path";
import { build } from "esbuild";

const script = await build({
  entryPoints: ["src/main.ts"],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "ascii",
  legalComments: "none",
  write: false,
});
const style = await build({ entryPoints: ["src/page.css"], bundle: true, minify: true, write: false, loader: { ".woff2": "dataurl" } });
const page = await readFile("src/page.html", "utf8");
const code = script.outputFiles[0].text.trim();
const css = style.outputFiles[0].text.trim();
if (/<\/script|<!--/i.test(code) || /<\/style/i.test(css)) throw new Error("the bundle would end its own element");
// Named without its scheme: a page has no address of the network in it.
const holder = (await readFile("font/OFL.txt", "utf8")).split("\n")[0].replace("https://", "");
const licence = (await readFile("node_modules/uplot/LICENSE", "utf8")).trim();
const { version } = JSON.parse(await readFile("node_modules/uplot/package.json", "utf8"));
const html = page
  .replace("/*style*/", () => `/* Letters: Arimo. ${holder}. SIL Open Font License 1.1, openfontlicense.org */\n${css}`)
  .replace("/*script*/", () => `/* Contains uPlot ${version}.\n${licence}\n*/\n${code}`);
if (html.split('id="truepath-data">null</script>').length !== 2) throw new Error("the place for the data must occur once");
const file = process.argv[2] ?? "dist/report.html";
await mkdir(dirname(file), { recursive: true });
await writeFile(file, html.endsWith("\n") ? html : `${html}\n`);
console.log(`${file}: ${(html.length / 1024).toFixed(0)} KiB`);
