/** The figures of a run, the obstacles around the vehicle, and the controls. */
import { element, fitCanvas, fixed, styleColour } from "./dom";
import type { Connection, LiveStatus } from "./live_connection";

const lateSeconds = 3;
const sectors = 72;
const connectionTexts: Record<Connection, string> = {
  open: "",
  lost: "Connection lost – reconnecting",
  refused: "The program was restarted: open the address that it prints",
};

export class LivePanel {
  private status: LiveStatus | null = null;
  /** The last settings that the controls of the head showed. */
  private shownHead = "";
  /** The controls of the head were edited and not sent: they are not overwritten. */
  private isEditing = false;
  private told = 0;
  private newMapTimer = 0;

  /** @param control where commands are sent; null: this address may not */
  constructor(private readonly control: string | null) {
    element("live").hidden = false;
    new ResizeObserver(() => this.drawObstacles()).observe(element("obstacles"));
    if (control === null) return;
    const button = element<HTMLButtonElement>("control");
    button.hidden = false;
    button.addEventListener("click", () => this.toggle());
    element("head-form").addEventListener("input", () => (this.isEditing = true));
    element("head-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.sendHead();
    });
    const isSector = element<HTMLInputElement>("head-is-sector");
    isSector.addEventListener("change", () => (element("head-sector").hidden = !isSector.checked));
    element("record").addEventListener("click", () =>
      this.send(this.status?.recording ? "recording/end" : "recording/begin"),
    );
    element("new-map").addEventListener("click", () => this.askNewMap());
  }

  toggle(): void {
    const panel = element("control-panel");
    panel.hidden = !panel.hidden;
    element("control").setAttribute("aria-expanded", String(!panel.hidden));
    if (panel.hidden) this.isEditing = false;
    else element("display-panel").hidden = true;
  }

  setConnection(connection: Connection): void {
    const text = element("connection");
    document.documentElement.dataset.live = connection;
    text.hidden = connection === "open";
    text.textContent = connectionTexts[connection];
  }

  show(status: LiveStatus): void {
    this.status = status;
    const set = (id: string, text: string) => (element(id).textContent = text);
    const age = (seconds: number | null) => (seconds === null ? "–" : `${fixed(seconds, seconds < 10 ? 1 : 0)} s`);
    const lost = status.damaged + status.unanswered + status.unexpected;
    set("live-depth", status.depth_m === null ? "–" : `${fixed(status.depth_m, 1)} m`);
    set("live-heading", status.heading_deg === null ? "–" : `${fixed(status.heading_deg, 0)}°`);
    set("live-position", positionText(status));
    set("live-nearest", nearestText(status.obstacles_m));
    set("live-beams", `${status.beams} · ${fixed(status.beams_per_s, 0)}/s`);
    set("live-lost", `${lost} · ${status.not_mapped}`);
    set("live-late", `${fixed(status.latency_ms, 0)} ms`);
    set("live-map-age", age(status.map_age_s));
    set("live-pose-age", age(status.pose_age_s));
    set("live-record", recordText(status));
    element("live-record").title = status.recording_file ?? "";
    const slam = status.slam;
    element("live-slam").parentElement!.hidden = slam === null;
    if (slam) set("live-slam", `${slam.motion} · ${slam.loops} loops${slam.correcting ? " · correcting" : ""}`);
    const head = element("head-state");
    head.hidden = status.connected && status.beam_age_s < lateSeconds;
    head.textContent = status.connected ? `No beam for ${age(status.beam_age_s)}` : `Head: ${status.problem || "not connected"}`;
    element("live").dataset.recording = status.recording_failed ? "failed" : status.recording ? "on" : "off";
    this.showMessages(status);
    this.drawObstacles();
    if (this.control !== null) this.showControls(status);
  }

  private showMessages({ messages, told }: LiveStatus): void {
    if (told === this.told) return;
    this.told = told;
    const text = element("live-message");
    text.hidden = messages.length === 0;
    text.textContent = messages[messages.length - 1] ?? "";
    text.title = messages.join("\n");
  }

  private showControls({ head, recording }: LiveStatus): void {
    element("record").textContent = recording ? "Stop recording" : "Start recording";
    element("record").setAttribute("aria-pressed", String(recording));
    element("head-form").hidden = head.range_m === undefined;
    const now = JSON.stringify(head);
    if (this.isEditing || head.range_m === undefined || now === this.shownHead) return;
    this.shownHead = now;
    const value = (id: string, text: string) => (element<HTMLInputElement>(id).value = text);
    value("head-range", String(Number(head.range_m.toFixed(2))));
    value("head-gain", head.gain ?? "normal");
    value("head-step", String(Number((head.step_deg ?? 0).toFixed(4))));
    const sector = head.sector_deg ?? null;
    element<HTMLInputElement>("head-is-sector").checked = sector !== null;
    element("head-sector").hidden = sector === null;
    const [from, to] = sector ?? [-60, 60];
    value("head-from", String(Number(from.toFixed(1))));
    value("head-to", String(Number(to.toFixed(1))));
  }

  private sendHead(): void {
    const value = (id: string) => element<HTMLInputElement>(id).value;
    const sector = element<HTMLInputElement>("head-is-sector").checked
      ? `${value("head-from")},${value("head-to")}`
      : "full";
    this.send(`head?range=${value("head-range")}&gain=${value("head-gain")}&step=${value("head-step")}&sector=${sector}`);
    // The controls then follow the head; where it refuses, the input stays.
    this.isEditing = false;
  }

  /** Needs a second press to confirm. */
  private askNewMap(): void {
    const button = element("new-map");
    const isSure = this.newMapTimer !== 0;
    clearTimeout(this.newMapTimer);
    this.newMapTimer = 0;
    button.textContent = isSure ? "New map" : "Start a new map?";
    if (isSure) {
      this.send("map/new");
      return;
    }
    this.newMapTimer = window.setTimeout(() => {
      this.newMapTimer = 0;
      button.textContent = "New map";
    }, 4000);
  }

  private send(what: string): void {
    const note = element("control-note");
    fetch(`${this.control}${what}`, { method: "POST" })
      .then(async (response) => {
        note.hidden = response.ok;
        note.textContent = response.ok ? "" : await response.text();
      })
      .catch(() => {
        note.hidden = false;
        note.textContent = "Not sent: no connection";
      });
  }

  /** Seen from above, ahead upwards: the nearer the obstacle, the longer the sector's mark. */
  private drawObstacles(): void {
    const fitted = fitCanvas(element<HTMLCanvasElement>("obstacles"));
    const ranges = this.status?.obstacles_m;
    if (!fitted) return;
    const { context, width, height } = fitted;
    context.clearRect(0, 0, width, height);
    const radius = Math.min(width, height) / 2 - 2;
    const range = this.status?.head.range_m ?? Math.max(...(ranges ?? []).map((m) => m ?? 0), 1);
    element("obstacles").title = `Obstacles, ahead upwards; circles at ${fixed(range / 2, 1)} and ${fixed(range, 1)} m`;
    context.translate(width / 2, height / 2);
    context.lineWidth = 1;
    context.strokeStyle = styleColour("--line");
    for (const part of [0.5, 1]) {
      context.beginPath();
      context.arc(0, 0, part * radius, 0, 2 * Math.PI);
      context.stroke();
    }
    const half = Math.PI / sectors;
    (ranges ?? []).forEach((metres, sector) => {
      if (metres === null) return;
      const middle = (2 * Math.PI * sector) / sectors - Math.PI / 2;
      const inner = metres < 0 ? 1 : Math.min(metres / range, 1);
      context.beginPath();
      context.arc(0, 0, radius, middle - half, middle + half);
      context.arc(0, 0, Math.min(inner * radius, radius - 2), middle + half, middle - half, true);
      context.fillStyle = metres < 0 ? styleColour("--curve") : styleColour("--accent");
      context.fill();
    });
    context.fillStyle = styleColour("--ink");
    context.beginPath();
    context.moveTo(0, -6);
    context.lineTo(4, 5);
    context.lineTo(0, 2.5);
    context.lineTo(-4, 5);
    context.fill();
  }
}

/** With the age of the last recorded beam. */
function recordText({ recording, recording_failed, beam_age_s }: LiveStatus): string {
  if (recording_failed) return "failed";
  return recording ? `on · ${fixed(beam_age_s, 1)} s` : "off";
}

/** With its standard deviation, where that exceeds the digits shown. */
function positionText({ position_m, deviation_m }: LiveStatus): string {
  if (!position_m) return "–";
  const [x, y] = position_m.map((m) => fixed(m, 1));
  return `${x}, ${y}${deviation_m >= 0.1 ? ` ± ${fixed(deviation_m, 1)}` : ""}`;
}

function nearestText(ranges: readonly (number | null)[] | null): string {
  if (!ranges) return "–";
  let nearest = -1;
  ranges.forEach((metres, sector) => {
    if (metres !== null && metres >= 0 && (nearest < 0 || metres < ranges[nearest]!)) nearest = sector;
  });
  if (nearest < 0) return ranges.some((metres) => metres !== null) ? "none near" : "unknown";
  const degrees = (360 * nearest) / sectors;
  const side = degrees === 0 ? " ahead" : degrees === 180 ? " behind" : degrees < 180 ? "° right" : "° left";
  const amount = degrees === 0 || degrees === 180 ? "" : ` ${degrees < 180 ? degrees : 360 - degrees}`;
  return `${fixed(ranges[nearest]!, 1)} m${amount}${side}`;
}
