/** A command in a worker: started, told of, taken back. */

import type { Message, Outcome, Request } from "./worker";

/** The worker's script, put here by the build. */
declare const WORKER: string;

/** The program, base64 of gzip in an element of the page. */
const place = "truepath-program";

let compiled: Promise<WebAssembly.Module> | undefined;

/** The program, unpacked and compiled once. */
export function program(): Promise<WebAssembly.Module> {
  compiled ??= (async () => {
    const packed = atob(document.getElementById(place)!.textContent!.trim());
    const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(plain).arrayBuffer());
  })();
  return compiled;
}

/** How a command ended. */
export type Ended = Outcome | "cancelled" | { fault: string };

/** A command on its way. */
export interface Running { ended: Promise<Ended>; cancel(): void }

/** Runs the words of a command line on files. */
export function start(files: Request["files"], words: string[], progress: (task: string, share: number) => void): Running {
  const address = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
  const worker = new Worker(address);
  let end: (ended: Ended) => void = () => {};
  const ended = new Promise<Ended>((resolve) => { end = resolve; }).finally(() => {
    worker.terminate();
    URL.revokeObjectURL(address);
  });
  worker.addEventListener("message", ({ data }: MessageEvent<Message>) => {
    if ("progress" in data) progress(...data.progress);
    else if ("done" in data) end(data.done);
    else end(data);
  });
  worker.addEventListener("error", (event) => end({ fault: event.message }));
  program().then((module) => worker.postMessage({ module, files, words } satisfies Request), (error) => end({ fault: String(error) }));
  return { ended, cancel: () => end("cancelled") };
}
