/** The state of a run: by server-sent events, or by polling where there are none. */
import type { LogState } from "./live_log";

export interface LiveStatus {
  time_s: number;
  connected: boolean;
  problem: string;
  head: {
    name: string;
    range_m?: number;
    gain?: string;
    step_deg?: number;
    sector_deg?: [number, number] | null;
  };
  beams: number;
  beams_per_s: number;
  mapped: number;
  not_mapped: number;
  waiting: number;
  echoes: number;
  damaged: number;
  unanswered: number;
  unexpected: number;
  latency_ms: number;
  map_age_s: number;
  beam_age_s: number;
  recording: boolean;
  recording_failed: boolean;
  recording_file: string | null;
  position_m: number[] | null;
  /** Standard deviation of the position since the last solution of SLAM, else 0. */
  deviation_m: number;
  depth_m: number | null;
  heading_deg: number | null;
  pose_age_s: number | null;
  /** Clockwise from ahead; null: not known, -1: nothing near. */
  obstacles_m: (number | null)[] | null;
  slam: { motion: string; loops: number; corrections: number; correcting: boolean } | null;
  messages: string[];
  told: number;
}

export interface LiveState {
  run: number;
  map: { version: number; cells: number };
  path: { version: number; poses: number };
  log: LogState;
  status: LiveStatus;
}

export type Connection = "open" | "lost" | "refused";

const askSeconds = 0.5;
const askAgainSeconds = 2;
/** Until events are tried again after a refusal. */
const eventsAgainSeconds = 30;

export class LiveConnection {
  onConnection: (connection: Connection) => void = () => {};
  private latest: LiveState | null = null;
  private isTaking = false;

  /** @param take called with one state at a time; states that arrive meanwhile are dropped but for the last one */
  constructor(
    private readonly urls: { events: string; state: string },
    private readonly take: (state: LiveState) => Promise<void>,
  ) {}

  start(): void {
    const source = new EventSource(this.urls.events);
    source.onmessage = (event) => void this.offer(JSON.parse(event.data as string) as LiveState);
    source.onerror = () => {
      // The browser tries again by itself, unless it was refused.
      if (source.readyState === EventSource.CLOSED) void this.ask(performance.now());
      else this.onConnection("lost");
    };
  }

  private async ask(started: number): Promise<void> {
    let wait = askSeconds;
    try {
      const response = await fetch(this.urls.state);
      if (response.ok) await this.offer((await response.json()) as LiveState);
      else {
        this.onConnection("refused");
        wait = askAgainSeconds;
      }
    } catch {
      this.onConnection("lost");
      wait = askAgainSeconds;
    }
    if (performance.now() - started > 1000 * eventsAgainSeconds) this.start();
    else setTimeout(() => void this.ask(started), 1000 * wait);
  }

  private async offer(state: LiveState): Promise<void> {
    this.latest = state;
    if (this.isTaking) return;
    this.isTaking = true;
    while (this.latest) {
      const next: LiveState = this.latest;
      this.latest = null;
      try {
        await this.take(next);
        this.onConnection("open");
      } catch {
        // What could not be fetched follows with the next state.
        this.onConnection("lost");
      }
    }
    this.isTaking = false;
  }
}
