// What a page is looked over for: rules of axe, and texts that are cut off, over another or out of their block.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** Rules of axe that a page breaks. */
export async function violations(page) {
  await page.evaluate(axe);
  const result = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  return result.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(" ")).join(", ")}`);
}

/** Keeps what is written on the canvases, from their last clearing on. */
export async function listen(page) {
  await page.evaluate(() => {
    const written = globalThis.written = new Map();
    const { prototype } = CanvasRenderingContext2D;
    const { fillText, fillRect, clearRect } = prototype;
    const cleared = (canvas, x, y) => { if (x <= 0 && y <= 0) written.set(canvas, []); };
    prototype.fillRect = function kept(x, y, ...rest) { cleared(this.canvas, x, y); fillRect.call(this, x, y, ...rest); };
    prototype.clearRect = function kept(x, y, ...rest) { cleared(this.canvas, x, y); clearRect.call(this, x, y, ...rest); };
    prototype.fillText = function kept(text, x, y, ...rest) {
      const { a, e, d, f } = this.getTransform();
      const wide = this.measureText(text).width;
      const left = x - { left: 0, start: 0, center: wide / 2, right: wide, end: wide }[this.textAlign];
      const high = parseFloat(/[\d.]+px/.exec(this.font)[0]);
      const top = y - ({ top: 0, hanging: 0, middle: high / 2 }[this.textBaseline] ?? high);
      if (!written.has(this.canvas)) written.set(this.canvas, []);
      written.get(this.canvas).push({ text, colour: this.fillStyle, box: [a * left + e, d * top + f, a * (left + wide) + e, d * (top + high) + f] });
      fillText.call(this, text, x, y, ...rest);
    };
  });
}

/** What is written over something else, beyond its block or beyond the window; in words. */
export async function faults(page) {
  return page.evaluate(() => {
    const found = [];
    const over = (a, b, slack) => Math.min(a[2], b[2]) - Math.max(a[0], b[0]) > slack && Math.min(a[3], b[3]) - Math.max(a[1], b[1]) > slack;
    const clashes = (texts, what) => {
      texts.sort((a, b) => a.box[1] - b.box[1]);
      texts.forEach((one, i) => {
        for (let k = i + 1; k < texts.length && texts[k].box[1] < one.box[3]; k++) {
          if (over(one.box, texts[k].box, 1)) found.push(`${what}: "${one.text.slice(0, 40)}" over "${texts[k].text.slice(0, 40)}"`);
        }
      });
    };
    const { scrollWidth, clientWidth } = document.documentElement;
    if (scrollWidth > clientWidth) found.push(`the page is ${scrollWidth} wide in a window of ${clientWidth}`);
    // Style and frames of elements, asked for once each.
    const known = (make) => {
      const kept = new Map();
      return (of) => kept.get(of) ?? kept.set(of, make(of)).get(of);
    };
    const frame = known((of) => { const { left, top, right, bottom } = of.getBoundingClientRect(); return [left, top, right, bottom]; });
    const clipping = known((of) => {
      const above = of === document.body ? [] : clipping(of.parentElement);
      const { overflowX, overflowY } = getComputedStyle(of);
      return overflowX === "visible" && overflowY === "visible" ? above : [[of, [overflowX, overflowY].includes("auto")], ...above];
    });
    const size = known((of) => parseFloat(getComputedStyle(of).fontSize));
    const shown = known((of) => !of.closest("script, noscript, style, option, .hidden, .flag") && of.checkVisibility({ visibilityProperty: true }));
    const block = known((of) => of.closest(".card, .picture, .traces, .results, header, footer"));
    const texts = [];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walk.nextNode(); node; node = walk.nextNode()) {
      const parent = node.parentElement;
      if (!node.data.trim() || !shown(parent)) continue;
      const range = document.createRange();
      range.selectNodeContents(node);
      for (const line of range.getClientRects()) {
        if (line.width < 1) continue;
        // Where the ink is: a font may ask for far more room above and below.
        const middle = (line.top + line.bottom) / 2;
        let box = [line.left, middle - 0.3 * size(parent), line.right, middle + 0.3 * size(parent)];
        let seen = true;
        for (const [element, scrolls] of clipping(parent)) {
          const [left, top, right, bottom] = frame(element);
          if (box[0] >= left - 1 && box[2] <= right + 1 && box[1] >= top - 1 && box[3] <= bottom + 1) continue;
          // What is scrolled within its block can be reached.
          if (scrolls) seen = over(box, frame(element), 0);
          else found.push(`"${node.data.slice(0, 40)}" is cut off by ${element.className}`);
          box = [Math.max(box[0], left), Math.max(box[1], top), Math.min(box[2], right), Math.min(box[3], bottom)];
        }
        if (!seen) continue;
        if (box[2] > clientWidth + 1 || box[0] < -1) found.push(`"${node.data.slice(0, 40)}" runs out of the window`);
        const [left, , right] = block(parent) ? frame(block(parent)) : [-Infinity, 0, Infinity];
        if (box[2] > right + 1 || box[0] < left - 1) found.push(`"${node.data.slice(0, 40)}" runs out of its block`);
        // A heading that stays while its table scrolls lies over what is below it.
        if (!parent.closest("thead") || !parent.closest(".scroll")?.scrollTop) texts.push({ text: node.data, box });
      }
    }
    clashes(texts, "text");
    for (const [canvas, all] of globalThis.written ?? []) {
      if (!canvas.isConnected || !canvas.checkVisibility()) continue;
      for (const { text, box } of all) if (box[0] < -1 || box[2] > canvas.width + 1) found.push(`"${text}" is cut off in its drawing`);
      // Numbers of the axes; those of the points have a ground of their own.
      const quiet = getComputedStyle(document.documentElement).getPropertyValue("--quiet").trim();
      clashes(all.filter(({ colour }) => colour === quiet), canvas.closest(".trace") ? "trace" : "picture");
    }
    return [...new Set(found)];
  });
}

export const settled = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));

/** Names as people give them: long, in one word, in letters that the page's font lacks. */
export function named(data) {
  const long = "Гехäuse_壁掛け_part_without_a_blank_αβγ_".repeat(3);
  return { ...data, title: `${data.title} Деталь 部品 ${long}`, program: { ...data.program, name: `${long}.nc` },
    job: { ...data.job, material: long, facts: [...(data.job?.facts ?? []), { name: long, value: "17" }, { name: "operator", value: long }] },
    results: [...(data.results ?? []), { name: long, value: -1234.5678, decimals: 4, unit: "mm/min", note: long }],
    warnings: [...(data.warnings ?? []), long],
    ...(data.part ? { part: { ...data.part, name: long, customer: `${long} 株式会社` } } : {}) };
}
