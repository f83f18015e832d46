// Processor time of a page, and how slow the machine is at what pages do: a bound in milliseconds is one of a machine.
import { availableParallelism, loadavg } from "node:os";

/** A clock of the page's own processor time, milliseconds. */
export async function processor(context, page) {
  const session = await context.newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  return {
    read: async () => (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value * 1000,
    close: () => session.detach(),
  };
}

/** Whether more wants to run here than there are processors for. */
export const busy = () => loadavg()[0] > availableParallelism() + 1;

/** Milliseconds of processor time of `work` on a machine that keeps the bounds with a factor of two to spare, idle. */
const REFERENCE = 180;

/**
 * What this machine now takes for work that no change of ours alters, over what it took there; at least 1.
 * A processor shared with other programs is slower as well: they take its caches and its other half.
 */
export async function slowness(context, page) {
  const clock = await processor(context, page);
  const from = await clock.read();
  await page.evaluate(work);
  const taken = await clock.read() - from;
  await clock.close();
  return Math.max(1, taken / REFERENCE);
}

/** A table that is laid out, numbers that are read, and a picture that is drawn: as in a report. */
function work() {
  const numbers = JSON.parse(JSON.stringify(Array.from({ length: 100_000 }, (_, i) => Math.sin(i) * 1e3)));
  const table = document.createElement("table");
  for (let row = 0; row < 400; row++) {
    const cells = table.insertRow();
    for (let column = 0; column < 8; column++) cells.insertCell().textContent = numbers[row * 8 + column].toFixed(4);
  }
  document.body.append(table);
  table.getBoundingClientRect();
  table.remove();
  const canvas = Object.assign(document.createElement("canvas"), { width: 1000, height: 1000 });
  const context = canvas.getContext("2d");
  context.beginPath();
  for (let at = 0; at < numbers.length; at++) context.lineTo(at / 100, 500 + numbers[at] / 3);
  context.stroke();
  context.getImageData(0, 0, 1, 1);
}
