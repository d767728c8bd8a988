// Calls the program in a folder of its own.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

/** A folder in which the program is called; `remove()` it. */
export class Workplace {
  folder = mkdtempSync(join(tmpdir(), "pingvox-"));

  call(...words) {
    const done = spawnSync(process.env.PINGVOX, words, { cwd: this.folder, encoding: "utf8" });
    if (done.status !== 0) throw new Error(`${words.join(" ")}: ${done.stderr}`);
    return done.stdout;
  }
  write(name, text) {
    writeFileSync(join(this.folder, name), text);
  }
  read(name) {
    return readFileSync(join(this.folder, name));
  }
  path(name) {
    return join(this.folder, name);
  }
  remove() {
    rmSync(this.folder, { recursive: true });
  }
}
