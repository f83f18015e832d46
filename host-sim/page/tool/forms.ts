/** Questions of `init` as fields, and words of a command line. */

import { el } from "../src/dom";

/** A question as `init --questions --json` prints it. */
export interface Question { name: string; text: string; proposal: string | null; choices: string[] }

/** What stands for an answer that is left out. */
const UNKNOWN = "unknown";

/** A field for a question; empty, the proposal holds. */
export function field(question: Question): HTMLElement {
  const id = `answer-${question.name}`;
  const [first, ...more] = question.text.split("\n");
  const proposal = question.proposal ?? "";
  const attributes = { id, name: question.name };
  const { choices } = question;
  let input: HTMLElement;
  if (choices.length > 0) {
    const options = [...(choices.includes(proposal) ? [] : [""]), ...choices];
    input = el("select", attributes, ...options.map((value) => el("option", value === proposal ? { value, selected: "" } : { value }, value)));
  } else {
    input = el("input", { ...attributes, type: "text", value: proposal === UNKNOWN ? "" : proposal, autocomplete: "off", spellcheck: "false" });
  }
  const note = more.length > 0 ? el("pre", { class: "choices" }, more.join("\n")) : null;
  return el("div", { class: "question" }, el("label", { for: id }, first), note, input);
}

/** The answers of a form as `--set` words; empty fields say nothing. */
export function answers(form: HTMLFormElement): string[] {
  return [...new FormData(form)].filter(([, value]) => String(value).trim() !== "").flatMap(([name, value]) => ["--set", `${name}=${String(value).trim()}`]);
}

/** The words of a command line; quotation marks hold a word together. */
export function words(line: string): string[] {
  const found = [...line.matchAll(/"([^"]*)"|'([^']*)'|(\S+)/g)].map(([, double, single, bare]) => double ?? single ?? bare);
  return found[0] === "truepath" ? found.slice(1) : found;
}

/** Words as one types them. */
export function line(list: string[]): string {
  return ["truepath", ...list].map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `"${word}"`)).join(" ");
}
