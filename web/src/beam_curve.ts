/** The intensities of one beam over range, with its echo and the threshold. */
import { fitCanvas, fixed, roundStep, styleColour } from "./dom";
import type { SonarLog } from "./sonar_log";

const margin = { left: 30, right: 16, top: 8, bottom: 18 };
const highest = 255;
const tickPixels = 40;

export function drawBeamCurve(canvas: HTMLCanvasElement, log: SonarLog, beam: number): void {
  const fitted = fitCanvas(canvas);
  if (!fitted) return;
  const { context, width, height } = fitted;
  const { first, binLength, bins, threshold, echo } = log.columns;
  const range = log.rangeOf(beam);
  const x = (metres: number) => margin.left + (metres / range) * (width - margin.left - margin.right);
  const y = (value: number) => height - margin.bottom - (value / highest) * (height - margin.top - margin.bottom);
  context.clearRect(0, 0, width, height);
  context.font = "11px system-ui, sans-serif";
  context.strokeStyle = styleColour("--line");
  context.fillStyle = styleColour("--quiet");
  context.lineWidth = 1;
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const value of [0, highest]) {
    line(context, x(0), y(value), x(range), y(value));
    context.fillText(String(value), margin.left - 5, y(value));
  }
  context.textAlign = "center";
  context.textBaseline = "top";
  const step = roundStep(Math.max(range / 4, (tickPixels * range) / (width - margin.left - margin.right)));
  for (let metres = 0; metres <= range * 1.001; metres += step) {
    line(context, x(metres), y(0), x(metres), y(0) + 3);
    const isLast = metres + step > range * 1.001;
    context.fillText(`${fixed(metres, step < 1 ? 1 : 0)}${isLast ? " m" : ""}`, x(metres), y(0) + 5);
  }
  const values = log.intensities(beam);
  if (values) {
    context.beginPath();
    for (let bin = 0; bin < bins; ++bin) context.lineTo(x(first[beam] + (bin + 0.5) * binLength[beam]), y(values[bin]));
    context.strokeStyle = styleColour("--curve");
    context.lineWidth = 1.4;
    context.lineJoin = "round";
    context.stroke();
  }
  context.lineWidth = 1.2;
  if (Number.isFinite(threshold[beam])) {
    context.strokeStyle = styleColour("--quiet");
    context.setLineDash([5, 4]);
    line(context, x(0), y(threshold[beam]), x(range), y(threshold[beam]));
    context.setLineDash([]);
  }
  if (Number.isFinite(echo[beam])) {
    context.strokeStyle = styleColour("--accent");
    context.lineWidth = 2;
    line(context, x(echo[beam]), margin.top, x(echo[beam]), y(0));
  }
}

function line(context: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}
