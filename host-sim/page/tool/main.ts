/** The page of the tool: files, job, readings, results. Whatever is computed is a command of the program on the files here. */

import { card, el } from "../src/dom";
import { themeButton } from "../src/theme";
import { Desk, ROLES, type Role } from "./desk";
import { type Question, answers, field, line, words } from "./forms";
import { type Running, start } from "./command";
import { zip } from "./zip";

const CONTROLS = { linuxcnc: "LinuxCNC", haas: "Haas", fanuc: "Fanuc", grbl: "grbl, grblHAL" };
/** Folders that the buttons write. */
const OUT = { inspect: "inspection", correct: "corrected", image: "image", learn: "next-part" };
const JOB = "job.toml";
/** The readings of the part that was cut with the correction. */
const SECOND = "second.txt";

const desk = new Desk(refresh);
/** Parts of the page that show the desk. */
const shown: (() => void)[] = [];
let running: Running | undefined;
/** Addresses of files that are shown or offered now. */
const addresses = new Set<string>();

function refresh(): void {
  for (const show of shown) show();
}

function address(bytes: Uint8Array, type: string): string {
  const made = URL.createObjectURL(new Blob([bytes as BlobPart], { type }));
  addresses.add(made);
  return made;
}

const TYPES: Record<string, string> = { html: "text/html", svg: "image/svg+xml", json: "application/json", tpi: "application/octet-stream" };

function download(name: string): HTMLElement {
  const type = TYPES[name.split(".").pop()!.toLowerCase()] ?? "text/plain";
  return el("a", { href: address(desk.files.get(name)!, type), download: name.split("/").pop()! }, name);
}

/** A button that can say why it does nothing yet. */
function action(title: string, work: () => void, lacks: () => string | undefined = () => undefined, kind = ""): HTMLButtonElement {
  const button = el("button", { type: "button", class: kind }, title);
  const why = () => (running ? "another command is running" : lacks());
  button.addEventListener("click", () => {
    const missing = why();
    if (missing) announce(`Not yet: ${missing}.`);
    else work();
  });
  shown.push(() => {
    const missing = why();
    button.setAttribute("aria-disabled", String(missing !== undefined));
    button.title = missing ?? "";
  });
  return button;
}

const live = el("p", { class: "hidden", role: "status", "aria-live": "polite", id: "live" });
const note = el("p", { class: "said", id: "note", hidden: "" });
function announce(text: string): void {
  live.textContent = text;
  note.textContent = text;
  note.hidden = text === "";
}

const needs = (...roles: Exclude<Role, "other">[]) => () => {
  const missing = roles.filter((role) => desk.of(role) === undefined);
  return missing.length > 0 ? `what is missing is the ${missing.map((role) => ROLES[role]).join(" and the ")}` : undefined;
};
const needsReadings = () => needs("program", "job")() ?? (desk.of("probe") || desk.of("dimensions") ? undefined : "readings of a probe, or dimensions, are missing");
const readings = () => [...(desk.of("probe") ? ["--probe", desk.of("probe")!] : []), ...(desk.of("dimensions") ? ["--dimensions", desk.of("dimensions")!] : [])];

// A command: its bar, its cancel button, what it said.

const bar = el("progress", { max: "1", "aria-labelledby": "task" });
const task = el("p", { id: "task" });
const cancel = el("button", { type: "button", id: "cancel" }, "cancel");
cancel.addEventListener("click", () => running?.cancel());
const panel = el("div", { class: "running", id: "running", hidden: "" }, task, bar, el("div", { class: "actions" }, cancel));

interface Result { code: number; out: string; said: string }

/** Runs words on the desk, and shows how it went at `place`; nothing when it was cancelled. */
async function command(list: string[], place: HTMLElement): Promise<Result | undefined> {
  announce("");
  task.textContent = line(list);
  bar.removeAttribute("value");
  panel.hidden = false;
  running = start([...desk.files], list, (what, share) => {
    task.textContent = `${line(list)}: ${what}`;
    if (share > 0) bar.value = share;
  });
  refresh();
  const ended = await running.ended;
  running = undefined;
  panel.hidden = true;
  place.replaceChildren();
  if (ended === "cancelled") {
    announce("Cancelled; the files are as they were.");
    refresh();
    return undefined;
  }
  if ("fault" in ended) {
    place.append(el("pre", { class: "said wrong", tabindex: "0", "aria-label": "what the program said" }, `A fault of the program, not of your files: ${ended.fault}`));
    announce("The program stopped with a fault of its own.");
    refresh();
    return undefined;
  }
  desk.take(ended.files);
  announce(ended.code === 0 ? "Done." : "Not done: the message says what to change.");
  return ended;
}

function say(place: HTMLElement, { code, out, said }: Result, list: string[]): void {
  const whole = `${said}${said && out ? "\n" : ""}${out}`.trim();
  place.append(
    el("pre", { class: code === 0 ? "said" : "said wrong", tabindex: "0", role: "region", "aria-label": "what the program said" }, whole || "Done."),
    el("p", { class: "quiet" }, "On a PC the same is: ", el("code", {}, line(list))),
  );
}

/** Runs words, says what they said, and offers what lies in `folder` afterwards. */
async function produce(list: string[], place: HTMLElement, folder?: string): Promise<void> {
  const result = await command(list, place);
  if (!result) return;
  say(place, result, list);
  if (result.code === 0 && folder) offer(place, folder);
  place.scrollIntoView({ block: "start" });
}

/** Links to the files of a folder, all of them as one, and its report. */
function offer(place: HTMLElement, folder: string): void {
  const names = [...desk.files.keys()].filter((name) => name.startsWith(`${folder}/`));
  if (names.length === 0) return;
  const list = el("ul", { class: "files" }, ...names.map((name) => el("li", {}, el("span", { class: "name" }, download(name)), size(name))));
  const all = el("a", { href: "#", download: `${folder}.zip` }, `all of them: ${folder}.zip`);
  zip(names.map((name) => [name, desk.files.get(name)!])).arrayBuffer().then((bytes) => { all.href = address(new Uint8Array(bytes), "application/zip"); });
  place.append(el("h3", {}, "Files to take along"), all, list);
  const report = `${folder}/report.html`;
  if (desk.files.has(report)) {
    const page = address(desk.files.get(report)!, "text/html");
    place.append(
      el("h3", {}, "Report"),
      el("p", {}, el("a", { href: page, target: "_blank", rel: "noopener" }, "open it in a window of its own")),
      el("iframe", { src: page, title: "Report" }),
    );
  }
}

function size(name: string): HTMLElement {
  const bytes = desk.files.get(name)!.length;
  return el("span", { class: "quiet" }, bytes < 2000 ? `${bytes} bytes` : `${Math.round(bytes / 1000)} kB`);
}

// 1. Files.

async function take(list: Iterable<File>, role?: Role): Promise<void> {
  for (const file of list) desk.put(file.name, new Uint8Array(await file.arrayBuffer()), role);
}

function files(): HTMLElement {
  const input = el("input", { type: "file", multiple: "", id: "files" });
  input.addEventListener("change", async () => { await take(input.files ?? []); input.value = ""; });
  const drop = el("div", { class: "drop" },
    el("p", {}, el("label", { for: "files" }, "Drop your program here, with its job and readings if you have them, or choose them:")), input);
  for (const kind of ["dragenter", "dragover"]) drop.addEventListener(kind, (event) => { event.preventDefault(); drop.classList.add("over"); });
  for (const kind of ["dragleave", "drop"]) drop.addEventListener(kind, () => drop.classList.remove("over"));
  drop.addEventListener("drop", (event) => { event.preventDefault(); take((event as DragEvent).dataTransfer?.files ?? []); });

  const list = el("ul", { class: "files", id: "desk" });
  shown.push(() => {
    list.replaceChildren(...[...desk.roles].map(([name, role]) => {
      const select = el("select", { "aria-label": `what ${name} is` },
        ...Object.entries(ROLES).map(([key, title]) => el("option", key === role ? { value: key, selected: "" } : { value: key }, title)));
      select.addEventListener("change", () => desk.give(name, select.value as Role));
      const remove = el("button", { type: "button", "aria-label": `take away ${name}` }, "take away");
      remove.addEventListener("click", () => desk.remove(name));
      return el("li", {}, el("span", { class: "name" }, name), size(name), select, remove);
    }));
  });
  const examples = JSON.parse(document.getElementById("truepath-examples")!.textContent!) as Record<string, Record<string, string>>;
  const example = action("Try it with the corner of the demonstration", () => {
    desk.clear();
    for (const [name, text] of Object.entries(examples.corner)) desk.put(name, new TextEncoder().encode(text));
    announce("A program, its job and five lines of readings lie on the desk. Go on with: Correct the program.");
  });
  return card("part", "1  Your files", drop, list, el("div", { class: "actions" }, example));
}

// 2. Job.

function job(): HTMLElement {
  const place = el("div", {});
  const form = el("form", { id: "questions", hidden: "" });
  const ask = async () => {
    const said = form.hidden ? [] : answers(form);
    const list = ["init", desk.of("program")!, "--questions", "--json", ...said];
    const result = await command(list, place);
    if (!result) return;
    if (result.code !== 0) { refuse(place, result); return; }
    const asked = JSON.parse(result.out) as { questions: Question[]; facts: string[] };
    form.replaceChildren(
      ...asked.facts.map((fact) => el("p", { class: "quiet" }, fact)),
      ...asked.questions.map(field),
      el("div", { class: "actions" }, el("button", { type: "submit", class: "first" }, "Write the job")),
    );
    form.hidden = false;
    announce("The rest is in the program. Fields that you leave as they are take the usual value.");
  };
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (running) return;
    const list = ["init", desk.of("program")!, "--yes", ...answers(form), "-o", JOB, "--force"];
    const result = await command(list, place);
    if (!result) return;
    say(place, result, list);
    if (result.code !== 0) return;
    desk.give(JOB, "job");
    form.hidden = true;
  });
  const text = el("textarea", { id: "job-text", spellcheck: "false", "aria-label": "the text of the job" });
  const fold = el("details", { id: "job-fold" }, el("summary", {}, "Look at the job, or change it"), text);
  let seen = "";
  shown.push(() => {
    const name = desk.of("job");
    fold.hidden = name === undefined;
    const now = name === undefined ? "" : desk.text(name);
    if (now !== seen) text.value = seen = now;
  });
  text.addEventListener("change", () => {
    seen = text.value;
    desk.put(desk.of("job")!, new TextEncoder().encode(text.value), "job");
  });
  return card("job", "2  The job",
    el("p", {}, "The job says what the program does not: stock left on the wall, cutter, material, probe. Have you none, it is made from the program; what the program does not show is asked."),
    el("div", { class: "actions" }, action("Make the job from the program", ask, needs("program"))), form, place, fold);
}

/** The message of a refused command that was asked for JSON. */
function refuse(place: HTMLElement, { said }: Result): void {
  const lines = said.trim().split("\n").map((text) => { try { return JSON.parse(text); } catch { return null; } });
  const error = lines.find((entry) => entry?.error)?.error;
  const text = error ? [error.found ?? error.message, error.expected && `expected: ${error.expected}`, error.help && `help: ${error.help}`].filter(Boolean).join("\n") : said;
  place.append(el("pre", { class: "said wrong", tabindex: "0", role: "region", "aria-label": "what the program said" }, text));
}

// 3. Touching the wall.

function touching(): HTMLElement {
  const place = el("div", {});
  const control = el("select", { id: "control" }, ...Object.entries(CONTROLS).map(([key, title]) => el("option", { value: key }, title)));
  const probe = action("Write the probing program", async () => {
    const list = ["probe", desk.of("job")!, "--dialect", control.value, "-o", "probing/verify.nc", "--force"];
    await produce(list, place, "probing");
  }, needs("program", "job"));
  const sheet = action("Write a sheet for a calliper instead", async () => {
    const list = ["probe", desk.of("job")!, "--dimensions", "-o", "dimensions/sheet.html", "--force"];
    await produce(list, place, "dimensions");
  }, needs("program", "job"));
  return card("touching", "3  Mill, then touch the wall",
    el("p", {}, "Mill the part with your program as it is. Then touch the wall where it tells most: this writes the program that does it. Put its readings on the desk above."),
    el("div", { class: "actions" }, el("div", {}, el("label", { for: "control" }, "Control "), control), probe, sheet), place);
}

// 4. Results.

function results(): HTMLElement {
  const place = el("div", { id: "result" });
  const inspect = action("Inspect the wall", () => produce(["inspect", desk.of("job")!, ...readings(), "-o", OUT.inspect, "--force"], place, OUT.inspect), needsReadings);
  const correct = action("Correct the program", () => produce(["correct", desk.of("job")!, ...readings(), "-o", OUT.correct, "--force"], place, OUT.correct), needsReadings, "first");
  const image = action("Image for the coprocessor",
    () => produce(["correct", desk.of("job")!, ...readings(), "--route", "coprocessor", "-o", OUT.image, "--force"], place, OUT.image), needsReadings);
  return card("results", "4  Results", el("div", { class: "actions" }, correct, inspect, image), place);
}

// 5. The next part.

function next(): HTMLElement {
  const place = el("div", {});
  const second = el("input", { type: "file", id: "second" });
  second.addEventListener("change", async () => {
    const [file] = second.files ?? [];
    if (file) desk.put(SECOND, new Uint8Array(await file.arrayBuffer()), "other");
  });
  const earlier = el("input", { type: "file", id: "earlier", multiple: "" });
  earlier.addEventListener("change", async () => {
    for (const file of earlier.files ?? []) desk.files.set(`${OUT.correct}/${file.name}`, new Uint8Array(await file.arrayBuffer()));
    refresh();
  });
  const learn = action("Make the program of the next part",
    () => produce(["learn", desk.of("job")!, "--probe", SECOND, "--from", OUT.correct, "-o", OUT.learn, "--force"], place, OUT.learn),
    () => needs("program", "job")() ?? (desk.files.has(SECOND) ? undefined : "the readings of the corrected part are missing")
      ?? ([...desk.files.keys()].some((name) => name.startsWith(`${OUT.correct}/`)) ? undefined : "the files of its correction are missing"));
  return card("next", "5  The next part",
    el("p", {}, "Mill the corrected program, touch that part too, and the next program is better than the last."),
    el("p", {}, el("label", { for: "second" }, "Readings of the corrected part: "), second),
    el("p", {}, el("label", { for: "earlier" }, "Its correction, if it was made another day (the files you took along): "), earlier),
    el("div", { class: "actions" }, learn), place);
}

// Everything else.

function everything(): HTMLElement {
  const place = el("div", {});
  const text = el("input", { type: "text", id: "line", autocomplete: "off", spellcheck: "false", value: "truepath --help" });
  const form = el("form", { class: "line" }, el("label", { for: "line" }, "Command"), text,
    el("div", { class: "actions" }, el("button", { type: "submit" }, "Run")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (running) return;
    const list = words(text.value);
    const at = list.findIndex((word) => word === "-o" || word === "--output");
    produce(list, place, at < 0 ? undefined : list[at + 1]?.replace(/\/[^/]*\.[^/]*$/, ""));
  });
  const fold = el("details", {}, el("summary", {}, "Type a command as on a PC"),
    el("p", { class: "quiet" }, "On the files of the desk, by their names. Left out here: what needs a board, a port or the disk (device, hil, study, pack)."), form, place);
  return card("everything", "Everything else", fold);
}

const top = document.getElementById("top")!;
top.append(
  el("div", { class: "title" }, el("h1", {}, "Truepath in the browser"),
    el("p", { class: "source" }, "Mill once, touch the wall in a few places, and get the program that cuts it true.")),
  el("div", { class: "buttons tools" }, themeButton(() => {})),
  el("p", { id: "stays" }, "Everything stays on this computer. This page has no connection to any network, sends nothing and keeps nothing: close it, and your files are gone from it."),
);
document.getElementById("main")!.append(live, note, files(), job(), touching(), results(), next(), everything(), panel);
refresh();
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => event.preventDefault());
