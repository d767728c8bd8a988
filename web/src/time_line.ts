/** The line of time: chosen moment, play, speed, and where the turns of the head begin. */
import type { Clock } from "./clock";
import { element, fitCanvas, styleColour } from "./dom";
import type { SonarPanel } from "./sonar_panel";

/** Later ones are times of the day, others seconds since the start of something. */
const earliestUnixTime = 1e8;
const sliderSteps = 1000;

export function timeText(time: number, from: number): string {
  if (from < earliestUnixTime) return `${(time - from).toFixed(1)} s`;
  return `${new Date(time * 1000).toISOString().slice(11, 21)} UTC`;
}

export class TimeLine {
  private readonly slider = element<HTMLInputElement>("moment");
  private readonly button = element<HTMLButtonElement>("play");
  private readonly track = element<HTMLCanvasElement>("track");

  constructor(
    private readonly clock: Clock,
    private readonly panel: SonarPanel | null,
  ) {
    element("time").hidden = false;
    this.slider.addEventListener("input", () => {
      // To pause shows the time as it was, on the slider, too.
      const { value } = this.slider;
      clock.pause();
      clock.now = clock.from + (Number(value) / sliderSteps) * (clock.to - clock.from);
    });
    this.button.addEventListener("click", () => this.toggle());
    const speed = element<HTMLSelectElement>("speed");
    clock.speed = Number(speed.value);
    speed.addEventListener("change", () => (clock.speed = Number(speed.value)));
    for (const [id, beams] of [
      ["beam-back", -1],
      ["beam-on", 1],
    ] as const) {
      element(id).hidden = panel === null;
      element(id).addEventListener("click", () => panel?.step(beams));
    }
    clock.onChange(() => this.show());
    new ResizeObserver(() => this.drawTurns()).observe(this.track);
    this.show();
  }

  toggle(): void {
    if (this.clock.isPlaying) this.clock.pause();
    else this.clock.play();
  }

  drawTurns(): void {
    const fitted = fitCanvas(this.track);
    if (!fitted) return;
    const { context, width, height } = fitted;
    context.clearRect(0, 0, width, height);
    if (!this.panel) return;
    const { sweep, time } = this.panel.log.columns;
    context.fillStyle = styleColour("--quiet");
    // The slider's button goes from half its width to as much before the end.
    const inset = 8;
    let last = -Infinity;
    for (let i = 1; i < sweep.length; ++i) {
      if (sweep[i] === sweep[i - 1]) continue;
      const x = inset + ((time[i] - this.clock.from) / (this.clock.to - this.clock.from)) * (width - 2 * inset);
      if (x - last < 4) continue;
      last = x;
      context.fillRect(x, height - 3, 1, 3);
    }
  }

  private show(): void {
    const { from, to, now, isPlaying } = this.clock;
    this.slider.value = String(to > from ? ((now - from) / (to - from)) * sliderSteps : 0);
    const text = timeText(now, from);
    this.slider.setAttribute("aria-valuetext", text);
    element("moment-text").textContent = text;
    if (from >= earliestUnixTime) element("moment-text").title = new Date(now * 1000).toISOString();
    this.button.setAttribute("aria-pressed", String(isPlaying));
    this.button.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }
}
