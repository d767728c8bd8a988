/** The sonar's part of the page: picture, the chosen beam in numbers and as a curve. */
import { drawBeamCurve } from "./beam_curve";
import type { Clock } from "./clock";
import { Choice, element, fixed } from "./dom";
import type { SonarLog } from "./sonar_log";
import { type Picture, SonarPicture } from "./sonar_picture";

export class SonarPanel {
  log: SonarLog;
  /** Called when another log or another beam is shown. */
  onChange: () => void = () => {};
  private readonly picture = new SonarPicture(element<HTMLCanvasElement>("picture"));
  private readonly curve = element<HTMLCanvasElement>("curve");
  private pending = false;

  constructor(
    private readonly logs: readonly SonarLog[],
    private readonly clock: Clock,
  ) {
    this.log = logs[0];
    for (const log of logs) log.onLoad = () => this.requestDraw();
    this.picture.setLog(this.log);
    this.picture.onChoose = (beam) => {
      clock.pause();
      clock.now = this.log.columns.time[beam];
    };
    new Choice<Picture>(element("pictures"), "picture", (picture) => {
      this.picture.picture = picture;
      this.draw();
    });
    element<HTMLInputElement>("show-echoes").addEventListener("change", (event) => {
      this.picture.showEchoes = (event.target as HTMLInputElement).checked;
      this.draw();
    });
    element<HTMLInputElement>("show-threshold").addEventListener("change", (event) => {
      this.picture.showThreshold = (event.target as HTMLInputElement).checked;
      this.draw();
    });
    const choice = element<HTMLSelectElement>("log-choice");
    choice.hidden = logs.length < 2;
    choice.replaceChildren(...logs.map((log, i) => new Option(log.entry.name, String(i))));
    choice.addEventListener("change", () => {
      this.log = this.logs[Number(choice.value)];
      this.picture.setLog(this.log);
      this.draw();
      this.onChange();
    });
    new ResizeObserver(() => this.requestDraw()).observe(this.curve);
    clock.onChange(() => this.requestDraw());
  }

  get beam(): number {
    return this.log.beamAt(this.clock.now);
  }

  /** Goes on or back by beams. */
  step(beams: number): void {
    this.clock.pause();
    const beam = Math.min(Math.max(this.beam + beams, 0), this.log.columns.beams - 1);
    this.clock.now = this.log.columns.time[beam];
  }

  /** Goes on or back by a turn of the head. */
  stepTurn(direction: number): void {
    const turn = this.beam - this.log.turnStart(this.beam) + 1;
    this.step(direction * turn);
  }

  requestDraw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  draw(): void {
    if (this.log.columns.beams === 0) return;
    const { beam, log } = this;
    const { bearing, echo, threshold, echoProbability } = log.columns;
    this.picture.setBeam(beam);
    drawBeamCurve(this.curve, log, beam);
    element("beam-number").textContent = `${log.firstNumber + beam + 1} / ${log.firstNumber + log.columns.beams}`;
    const degrees = (bearing[beam] * 180) / Math.PI;
    const toLeft = ((((degrees + 180) % 360) + 360) % 360) - 180;
    const side = Math.abs(toLeft) < 0.05 || Math.abs(toLeft) > 179.95 ? "" : toLeft > 0 ? " left" : " right";
    element("beam-bearing").textContent = `${fixed(Math.abs(toLeft), 1)}°${side}`;
    const hasEcho = Number.isFinite(echo[beam]);
    const probability =
      hasEcho && Number.isFinite(echoProbability[beam]) ? `, p ${fixed(echoProbability[beam], 2)}` : "";
    const missing = log.firstNumber + beam < log.settled ? "none" : "not yet";
    element("beam-echo").textContent = hasEcho ? `${fixed(echo[beam], 2)} m${probability}` : missing;
    element("beam-threshold").textContent = Number.isFinite(threshold[beam]) ? fixed(threshold[beam], 0) : missing;
  }
}
