/** The worker: one command on files in memory, then its end. It is a script of its own, made from text by the page. */

/** What the module of WebAssembly exports; see host-sim/web. */
interface Exports {
  memory: WebAssembly.Memory;
  begin(): void;
  room(length: number): number;
  answer(): number;
  answer_length(): number;
  put(name: number): number;
  get(): number;
  list(): void;
  run(): number;
  said(): void;
}

export type Files = [name: string, bytes: Uint8Array][];
/** A command with the files that it finds. */
export interface Request { module: WebAssembly.Module; files: Files; words: string[] }
export interface Outcome { code: number; out: string; said: string; files: Files }
export type Message = { progress: [task: string, share: number] } | { fault: string } | { done: Outcome };

const tell = (message: Message) => postMessage(message);

function run({ module, files, words }: Request): void {
  const decoder = new TextDecoder();
  const encoder = new TextEncoder();
  let told = "";
  const text = (at: number, length: number) => decoder.decode(new Uint8Array(exports.memory.buffer, at, length));
  const page = {
    progress: (at: number, length: number, share: number) => tell({ progress: [text(at, length), share] }),
    fault: (at: number, length: number) => { told = text(at, length); },
  };
  // A library for pictures brings imports for browsers along, which nothing calls: the program draws its own letters.
  const imports: WebAssembly.Imports = { page };
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] ??= () => { throw new Error(`the program asked for ${name}`); };
  }
  const exports = new WebAssembly.Instance(module, imports).exports as unknown as Exports;
  // The memory may have moved with every call: it is looked at anew each time.
  const hand = (...parts: Uint8Array[]) => {
    let at = exports.room(parts.reduce((sum, part) => sum + part.length, 0));
    for (const part of parts) {
      new Uint8Array(exports.memory.buffer, at, part.length).set(part);
      at += part.length;
    }
  };
  const answer = () => new Uint8Array(exports.memory.buffer, exports.answer(), exports.answer_length()).slice();
  try {
    exports.begin();
    for (const [name, bytes] of files) {
      const path = encoder.encode(name);
      hand(path, bytes);
      if (exports.put(path.length) !== 0) throw new Error(`${name} cannot be put beside the other files`);
    }
    hand(encoder.encode(JSON.stringify(words)));
    const code = exports.run();
    const out = decoder.decode(answer());
    exports.said();
    const said = decoder.decode(answer());
    exports.list();
    const names = decoder.decode(answer()).split("\n").filter((name) => name !== "");
    const after: Files = names.map((name) => {
      hand(encoder.encode(name));
      exports.get();
      return [name, answer()];
    });
    tell({ done: { code, out, said, files: after } });
  } catch (error) {
    tell({ fault: told || String(error) });
  }
}

addEventListener("message", (event: MessageEvent<Request>) => run(event.data));
