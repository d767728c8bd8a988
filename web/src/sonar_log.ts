/** The beams of a sonar by time; intensities are fetched in blocks on demand. */
import type { Answers } from "./answers";
import { lastNotAfter } from "./path";
import type { LogColumns, LogEntry } from "./scene";

const blockBeams = 512;
const mostBlocks = 64;
/** Beams that a turn may have at most. */
const mostBeams = 4096;

export class SonarLog {
  /** Called when intensities have come. */
  onLoad: () => void = () => {};
  onError: (error: unknown) => void = () => {};
  /** By number, the least used first; null: on its way. */
  firstNumber = 0;
  /** Echoes of beams from this number on are not known yet. */
  settled = Infinity;
  private readonly blocks = new Map<number, Uint8Array | null>();

  constructor(
    readonly entry: LogEntry,
    public columns: LogColumns,
    private readonly answers: Answers,
  ) {}

  beamAt(time: number): number {
    return lastNotAfter(this.columns.time, time);
  }

  /** Intensities of a beam; null until they have come. */
  intensities(beam: number): Uint8Array | null {
    const number = Math.floor(beam / blockBeams);
    const block = this.blocks.get(number);
    if (block === undefined) void this.load(number);
    if (!block) return null;
    this.blocks.delete(number);
    this.blocks.set(number, block);
    const { bins } = this.columns;
    const start = (beam - number * blockBeams) * bins;
    return block.subarray(start, start + bins);
  }

  /** The first beam of the turn that ends with `beam`. */
  turnStart(beam: number): number {
    const { bearing } = this.columns;
    let turned = 0;
    let first = beam;
    while (first > 0 && beam - first < mostBeams) {
      turned += angleBetween(bearing[first - 1], bearing[first]);
      if (turned >= 2 * Math.PI - 1e-3) break;
      --first;
    }
    return first;
  }

  /** Range at the end of a beam's last bin. */
  rangeOf(beam: number): number {
    return this.columns.first[beam] + this.columns.binLength[beam] * this.columns.bins;
  }

  private async load(number: number): Promise<void> {
    this.blocks.set(number, null);
    const from = number * blockBeams;
    const to = Math.min(from + blockBeams, this.columns.beams);
    try {
      this.blocks.set(number, await this.answers.rows(this.entry.intensities, from, to, this.columns.bins));
    } catch (error) {
      this.onError(error);
      return;
    }
    for (const [oldest, block] of this.blocks) {
      if (this.blocks.size <= mostBlocks) break;
      if (block) this.blocks.delete(oldest);
    }
    this.onLoad();
  }
}

export function angleBetween(a: number, b: number): number {
  const apart = Math.abs(a - b) % (2 * Math.PI);
  return Math.min(apart, 2 * Math.PI - apart);
}
