/** The sonar image: as a fan with ahead upwards, or as a waterfall with the range upwards. */
import { echoTable } from "./colours";
import { drawing, fitCanvas, fixed, roundStep, styleColour } from "./dom";
import { angleBetween, type SonarLog } from "./sonar_log";

export type Picture = "fan" | "waterfall";

/** Bearings are resolved in steps of a quarter of a degree. */
const slots = 1440;
/** A beam covers no more than this to each side of its bearing. */
const widestStep = (6 * Math.PI) / 180;
const waterfallBeams = 800;
const fanMargin = 14;
/** Rings of range are at least about so far apart, so that their labels have room. */
const ringPixels = 40;
const waterfallMargin = { left: 34, bottom: 4, top: 6, right: 4 };

function slotOf(bearing: number): number {
  const slot = Math.floor((bearing / (2 * Math.PI)) * slots) % slots;
  return slot < 0 ? slot + slots : slot;
}

export class SonarPicture {
  picture: Picture = "fan";
  showEchoes = true;
  /** Dims what is below the beam's threshold. */
  showThreshold = false;
  onChoose: (beam: number) => void = () => {};

  private log: SonarLog | null = null;
  private beam = 0;
  private slotBeams = new Int32Array(slots);
  private image: ImageData | null = null;
  private readonly buffer = document.createElement("canvas");

  constructor(private readonly canvas: HTMLCanvasElement) {
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.choose(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) this.choose(event);
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  setLog(log: SonarLog): void {
    this.log = log;
  }

  setBeam(beam: number): void {
    this.beam = beam;
    this.draw();
  }

  draw(): void {
    const fitted = fitCanvas(this.canvas);
    if (!fitted || !this.log) return;
    if (this.picture === "fan") this.drawFan(this.log, fitted);
    else this.drawWaterfall(this.log, fitted);
  }

  /** An image of this size in device pixels. */
  private imageOf(width: number, height: number): ImageData {
    if (this.image?.width !== width || this.image.height !== height) {
      this.buffer.width = width;
      this.buffer.height = height;
      this.image = drawing(this.buffer).createImageData(width, height);
    }
    return this.image;
  }

  private drawFan(log: SonarLog, { context, width, height, ratio }: NonNullable<ReturnType<typeof fitCanvas>>): void {
    const first = log.turnStart(this.beam);
    const range = this.fillSlots(log, first);
    const radius = Math.min(width, height) / 2 - fanMargin;
    const size = Math.max(2, Math.round(2 * radius * ratio));
    const image = this.imageOf(size, size);
    const pixels = new Uint32Array(image.data.buffer);
    pixels.fill(0);
    const colours = new Uint32Array(echoTable.buffer);
    const { first: firsts, binLength, bins, threshold } = log.columns;
    const intensities = new Map<number, Uint8Array | null>();
    const half = size / 2;
    const metres = range / half;
    for (let y = 0; y < size; ++y) {
      const up = half - y - 0.5;
      for (let x = 0; x < size; ++x) {
        const right = x + 0.5 - half;
        const r = Math.hypot(right, up) * metres;
        if (r > range) continue;
        const turn = Math.atan2(-right, up) / (2 * Math.PI);
        const beam = this.slotBeams[Math.floor((turn < 0 ? turn + 1 : turn) * slots) % slots];
        if (beam < 0) continue;
        let values = intensities.get(beam);
        if (values === undefined) intensities.set(beam, (values = log.intensities(beam)));
        if (!values) continue;
        const bin = Math.floor((r - firsts[beam]) / binLength[beam]);
        if (bin < 0 || bin >= bins) continue;
        const value = values[bin];
        const dim = this.showThreshold && value < threshold[beam];
        pixels[y * size + x] = dim ? dimmed(colours[value]) : colours[value];
      }
    }
    const [left, top] = [width / 2 - radius, height / 2 - radius];
    context.clearRect(0, 0, width, height);
    context.beginPath();
    context.arc(width / 2, height / 2, radius, 0, 2 * Math.PI);
    context.fillStyle = "#090e18";
    context.fill();
    drawing(this.buffer).putImageData(image, 0, 0);
    context.drawImage(this.buffer, 0, 0, size, size, left, top, 2 * radius, 2 * radius);
    const place = (r: number, bearing: number): [number, number] => [
      width / 2 - (Math.sin(bearing) * r * radius) / range,
      height / 2 - (Math.cos(bearing) * r * radius) / range,
    ];

    context.lineWidth = 1;
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    const step = roundStep(Math.max(range / 2.2, (ringPixels * range) / radius));
    for (let ring = step; ring <= range * 1.001; ring += step) {
      context.beginPath();
      context.arc(width / 2, height / 2, (ring * radius) / range, 0, 2 * Math.PI);
      context.strokeStyle = "rgb(255 255 255 / 22%)";
      context.stroke();
      context.fillStyle = "rgb(255 255 255 / 75%)";
      if (ring < range * 0.97) context.fillText(`${ring < 1 ? fixed(ring, 1) : ring} m`, ...place(ring, -0.6));
    }
    context.fillStyle = styleColour("--quiet");
    context.fillText("ahead", width / 2, height / 2 - radius - 4);

    if (this.showEchoes) {
      context.fillStyle = styleColour("--accent");
      const dot = Math.min(Math.max(radius / 80, 1.2), 2.5);
      for (let beam = first; beam <= this.beam; ++beam) {
        const echo = log.columns.echo[beam];
        // Where a later beam has been, its intensities are shown.
        if (!Number.isFinite(echo) || echo > range || this.slotBeams[slotOf(log.columns.bearing[beam])] !== beam) continue;
        const [x, y] = place(echo, log.columns.bearing[beam]);
        context.fillRect(x - dot / 2, y - dot / 2, dot, dot);
      }
    }
    context.beginPath();
    context.moveTo(width / 2, height / 2);
    context.lineTo(...place(range, log.columns.bearing[this.beam]));
    context.strokeStyle = "rgb(255 255 255 / 85%)";
    context.lineWidth = 1.5;
    context.stroke();
  }

  /** For each bearing the last beam there, from `first` on; returns the range of the last one. */
  private fillSlots(log: SonarLog, first: number): number {
    this.slotBeams.fill(-1);
    const { bearing } = log.columns;
    for (let beam = first; beam <= this.beam; ++beam) {
      const before = beam > 0 ? angleBetween(bearing[beam - 1], bearing[beam]) : Infinity;
      const after = beam + 1 < bearing.length ? angleBetween(bearing[beam], bearing[beam + 1]) : Infinity;
      const step = Math.min(before > 0 ? before : after, after > 0 ? after : before, widestStep);
      const half = Math.max(1, Math.ceil((step / 2 / (2 * Math.PI)) * slots));
      const middle = slotOf(bearing[beam]);
      for (let slot = middle - half; slot <= middle + half; ++slot) this.slotBeams[(slot + slots) % slots] = beam;
    }
    return log.rangeOf(this.beam);
  }

  private drawWaterfall(
    log: SonarLog,
    { context, width, height, ratio }: NonNullable<ReturnType<typeof fitCanvas>>,
  ): void {
    const { left, right, top, bottom } = waterfallMargin;
    const [across, down] = [width - left - right, height - top - bottom];
    const columns = Math.max(1, Math.round(across * ratio));
    const rows = Math.max(1, Math.round(down * ratio));
    const [from, to] = this.waterfallRange(log);
    let range = 0;
    for (let beam = from; beam < to; ++beam) range = Math.max(range, log.rangeOf(beam));
    const image = this.imageOf(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    const colours = new Uint32Array(echoTable.buffer);
    pixels.fill(colours[0]);
    const { first, binLength, bins, threshold } = log.columns;
    for (let x = 0; x < columns; ++x) {
      const beam = from + Math.floor(((x + 0.5) / columns) * (to - from));
      const values = log.intensities(beam);
      if (!values) continue;
      for (let y = 0; y < rows; ++y) {
        const bin = Math.floor((((rows - y - 0.5) / rows) * range - first[beam]) / binLength[beam]);
        if (bin < 0 || bin >= bins) continue;
        const dim = this.showThreshold && values[bin] < threshold[beam];
        pixels[y * columns + x] = dim ? dimmed(colours[values[bin]]) : colours[values[bin]];
      }
    }
    context.clearRect(0, 0, width, height);
    drawing(this.buffer).putImageData(image, 0, 0);
    context.drawImage(this.buffer, 0, 0, columns, rows, left, top, across, down);
    const placeX = (beam: number) => left + ((beam + 0.5 - from) / (to - from)) * across;
    const placeY = (r: number) => top + (1 - r / range) * down;
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillStyle = styleColour("--quiet");
    const step = roundStep(range / 4);
    for (let r = 0; r <= range * 1.001; r += step) {
      context.fillText(`${step < 1 ? fixed(r, 1) : r} m`, left - 4, Math.min(Math.max(placeY(r), top + 6), height - 6));
    }
    context.textBaseline = "alphabetic";
    if (this.showEchoes) {
      context.fillStyle = styleColour("--accent");
      for (let beam = from; beam < to; ++beam) {
        const echo = log.columns.echo[beam];
        if (Number.isFinite(echo)) context.fillRect(placeX(beam) - 1, placeY(echo) - 1, 2, 2);
      }
    }
    context.fillStyle = "rgb(255 255 255 / 85%)";
    context.fillRect(placeX(this.beam) - 0.75, top, 1.5, down);
  }

  /** Beams of the waterfall: the chosen one is in the middle where there are enough. */
  private waterfallRange(log: SonarLog): [number, number] {
    const count = Math.min(waterfallBeams, log.columns.beams);
    const from = Math.min(Math.max(this.beam - (count >> 1), 0), log.columns.beams - count);
    return [from, from + count];
  }

  private choose(event: PointerEvent): void {
    if (!this.log) return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    if (this.picture === "fan") {
      const turn = Math.atan2(width / 2 - x, height / 2 - y) / (2 * Math.PI);
      const beam = this.slotBeams[Math.floor((turn < 0 ? turn + 1 : turn) * slots) % slots];
      if (beam >= 0) this.onChoose(beam);
      return;
    }
    const { left, right } = waterfallMargin;
    const [from, to] = this.waterfallRange(this.log);
    const part = Math.min(Math.max((x - left) / (width - left - right), 0), 0.999);
    this.onChoose(from + Math.floor(part * (to - from)));
  }
}

/** A third of each channel of a pixel. */
function dimmed(pixel: number): number {
  const third = (shift: number) => Math.floor(((pixel >>> shift) & 255) / 3) << shift;
  return ((pixel & 0xff000000) | third(0) | third(8) | third(16)) >>> 0;
}
