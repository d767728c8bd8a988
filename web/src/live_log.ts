/** The last beams of a live head. */
import type { Answers } from "./answers";
import { type LogColumns, type LogEntry, readLog } from "./scene";
import { SonarLog } from "./sonar_log";

/** What the program says of its log. */
export interface LogState {
  first: number;
  end: number;
  settled: number;
  bins: number;
}

export class LiveLog extends SonarLog {
  private rows: Uint8Array[] = [];
  override settled = 0;

  constructor(
    entry: LogEntry,
    private readonly source: Answers,
  ) {
    super(entry, noBeams(entry.bins), source);
  }

  override intensities(beam: number): Uint8Array | null {
    return this.rows[beam] ?? null;
  }

  /** Number of the beam after the last one. */
  get end(): number {
    return this.firstNumber + this.columns.beams;
  }

  /** Fetches what is new. */
  async update(state: LogState): Promise<void> {
    const isOther = state.bins !== this.columns.bins || state.end < this.end || state.first > this.end;
    if (isOther) this.forget(state);
    if (state.end === this.end && state.settled === this.settled) return;
    const from = Math.max(Math.min(this.settled, this.end), this.firstNumber, state.first);
    const bytes = await this.source.bytes(`${this.entry.url}?from=${from}`);
    const fresh = readLog(bytes);
    if (fresh.bins !== this.columns.bins || fresh.firstNumber !== from) return this.forget(state);
    const end = from + fresh.beams;
    const known = this.end;
    if (end > known) {
      const bins = new Uint8Array(await this.source.bytes(`${this.entry.intensities}?from=${known}&to=${end}`));
      if (bins.length !== (end - known) * fresh.bins) return this.forget(state);
      for (let i = known; i < end; ++i)
        this.rows.push(bins.subarray((i - known) * fresh.bins, (i - known + 1) * fresh.bins));
    }
    // Those that the program has no more are dropped here, too.
    const kept = Math.max(state.first, this.firstNumber);
    this.rows = this.rows.slice(kept - this.firstNumber);
    this.columns = joined(this.columns, kept - this.firstNumber, from - this.firstNumber, fresh);
    this.firstNumber = kept;
    this.settled = Math.min(state.settled, end);
  }

  private forget(state: LogState): void {
    this.rows = [];
    this.columns = noBeams(state.bins);
    this.firstNumber = this.settled = state.first;
  }
}

function noBeams(bins: number): LogColumns {
  const none = new Float32Array(0);
  return {
    beams: 0,
    bins,
    firstNumber: 0,
    time: new Float64Array(0),
    bearing: none,
    first: none,
    binLength: none,
    echo: none,
    echoProbability: none,
    threshold: none,
    sweep: new Uint32Array(0),
  };
}

/** Rows [from, to) of the old columns, and then all of the new ones. */
function joined(old: LogColumns, from: number, to: number, fresh: LogColumns): LogColumns {
  const join = <T extends Float32Array | Float64Array | Uint32Array>(before: T, after: T): T => {
    const kept = before.subarray(from, Math.max(to, from)) as T;
    const dropped = Math.max(from - to, 0);
    const column = new (before.constructor as new (length: number) => T)(kept.length + after.length - dropped);
    column.set(kept);
    column.set(after.subarray(dropped) as T, kept.length);
    return column;
  };
  return {
    beams: Math.max(to - from, 0) + fresh.beams - Math.max(from - to, 0),
    bins: fresh.bins,
    firstNumber: old.firstNumber,
    time: join(old.time, fresh.time),
    bearing: join(old.bearing, fresh.bearing),
    first: join(old.first, fresh.first),
    binLength: join(old.binLength, fresh.binLength),
    echo: join(old.echo, fresh.echo),
    echoProbability: join(old.echoProbability, fresh.echoProbability),
    threshold: join(old.threshold, fresh.threshold),
    sweep: join(old.sweep, fresh.sweep),
  };
}
