/** The files on the desk: what was dropped and what commands wrote. The commands find them in one folder, by these names. */

export const ROLES = { program: "program", job: "job", probe: "readings of a probe", dimensions: "dimensions", other: "other" } as const;
export type Role = keyof typeof ROLES;

export class Desk {
  /** Bytes by name; a name with a folder was written by a command. */
  readonly files = new Map<string, Uint8Array>();
  readonly roles = new Map<string, Role>();

  constructor(private readonly changed: () => void) {}

  /** Puts a file on it; what it is for is guessed from its content. */
  put(name: string, bytes: Uint8Array, role = guess(name, bytes)): void {
    this.files.set(name, bytes);
    this.give(name, role);
  }

  /** Gives a file a role; whoever had it is another file from then on. */
  give(name: string, role: Role): void {
    if (role !== "other") for (const [other, had] of this.roles) if (had === role) this.roles.set(other, "other");
    this.roles.set(name, role);
    this.changed();
  }

  remove(name: string): void {
    this.files.delete(name);
    this.roles.delete(name);
    this.changed();
  }

  clear(): void {
    this.files.clear();
    this.roles.clear();
    this.changed();
  }

  /** The name of the file that has a role. */
  of(role: Exclude<Role, "other">): string | undefined {
    for (const [name, had] of this.roles) if (had === role) return name;
    return undefined;
  }

  text(name: string): string {
    return new TextDecoder().decode(this.files.get(name));
  }

  /** What a command left; files that it removed go. */
  take(files: [string, Uint8Array][]): void {
    const left = new Set(files.map(([name]) => name));
    for (const name of [...this.files.keys()]) if (!left.has(name)) this.files.delete(name);
    for (const [name, bytes] of files) this.files.set(name, bytes);
    this.changed();
  }
}

const PROGRAMS = /\.(nc|ngc|cnc|tap|gcode|mpf|spf|h|eia|iso|min|txt)$/i;

/** What a file is for, by what is in it. A wrong guess can be corrected in the list. */
export function guess(name: string, bytes: Uint8Array): Role {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, 1 << 16));
  if (/\.toml$/i.test(name)) return /^\s*\[\[dimension\]\]/m.test(text) ? "dimensions" : "job";
  if (/^(BEGIN|END) PGM/m.test(text) || /^\s*(?:\d+ )?(?:TOOL CALL|L [XYZ])/m.test(text)) return "program";
  // A program moves; readings are figures with some words.
  const moves = /(?:^|[\s\d])G0?[0-3](?!\d)/im.test(text);
  if (moves && PROGRAMS.test(name)) return "program";
  if (/\.(tpi|html|svg|json)$/i.test(name)) return "other";
  return "probe";
}
