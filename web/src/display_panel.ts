/** What of the map is shown: heights, threshold, size of cells, free and unknown space, layers. */
import { type Filter } from "./cells";
import { element, fixed } from "./dom";
import type { Space } from "./faces_protocol";
import type { MapLayer } from "./map_layer";

/** Heights in metres, absolute. */
export interface Selection {
  low: number;
  high: number;
  threshold: number;
  /** The cells drawn are 2^level as large as those of the map. */
  level: number;
}

export interface LayerSwitch {
  name: string;
  setVisible: (visible: boolean) => void;
}

/** What a selection means for the cells of a map. */
export function filterOf(selection: Selection, resolution: number): Filter {
  const layer = (metres: number) => Math.round(metres / resolution);
  return { threshold: Math.round(selection.threshold * 255), lowest: layer(selection.low), end: layer(selection.high) };
}

const waitForMore = 60;

export class DisplayPanel {
  readonly selection: Selection;
  /** Called when the selection has changed. */
  onSelection: () => void = () => {};
  onSpace: (space: Space, shown: boolean) => void = () => {};

  private readonly low = element<HTMLInputElement>("slab-low");
  private readonly high = element<HTMLInputElement>("slab-high");
  private readonly threshold = element<HTMLInputElement>("threshold");
  private readonly cellSize = element<HTMLSelectElement>("cell-size");
  private readonly whole: Selection;
  private readonly step: number;
  private timer = 0;

  constructor(layers: readonly MapLayer[], lowestThreshold: number, switches: readonly LayerSwitch[]) {
    this.step = Math.min(...layers.map((layer) => layer.entry.resolution_m));
    const { step } = this;
    this.whole = {
      ...heightsOf(layers),
      threshold: Math.max(layers[0]?.entry.occupancy ?? 0.5, lowestThreshold),
      level: 0,
    };
    this.selection = { ...this.whole };
    for (const slider of [this.low, this.high]) {
      slider.min = "0";
      slider.max = String(Math.round((this.whole.high - this.whole.low) / step));
      slider.step = "1";
    }
    this.threshold.min = lowestThreshold.toFixed(2);
    const metres = (slider: HTMLInputElement) => this.whole.low + Number(slider.value) * step;
    this.low.addEventListener("input", () => {
      this.low.value = String(Math.min(Number(this.low.value), Number(this.high.value) - 1));
      this.change({ low: metres(this.low) });
    });
    this.high.addEventListener("input", () => {
      this.high.value = String(Math.max(Number(this.high.value), Number(this.low.value) + 1));
      this.change({ high: metres(this.high) });
    });
    this.threshold.addEventListener("input", () => this.change({ threshold: Number(this.threshold.value) }));
    this.showCellSizes(layers);
    this.cellSize.addEventListener("change", () => this.change({ level: Number(this.cellSize.value) }));
    for (const space of ["free", "unknown"] as const) {
      const box = element<HTMLInputElement>(space);
      box.closest("label")!.hidden = !layers.some((layer) => layer.entry.free);
      box.addEventListener("change", () => this.onSpace(space, box.checked));
    }
    element("reset").addEventListener("click", () => this.reset());
    this.addSwitches(switches);
    if (layers.length === 0) {
      for (const input of [this.low, this.threshold, this.cellSize])
        (input.closest("fieldset, .row") as HTMLElement).hidden = true;
    }
    this.showValues();
  }

  /** Takes the heights of maps that have changed. What was not cut stays so. */
  update(layers: readonly MapLayer[]): void {
    const { low, high } = heightsOf(layers);
    if (low === this.whole.low && high === this.whole.high) return;
    const isCut = (["low", "high", "threshold", "level"] as const).some((key) => this.selection[key] !== this.whole[key]);
    if (this.selection.low === this.whole.low) this.selection.low = low;
    if (this.selection.high === this.whole.high) this.selection.high = high;
    this.whole.low = low;
    this.whole.high = high;
    for (const slider of [this.low, this.high]) slider.max = String(Math.round((high - low) / this.step));
    this.showCellSizes(layers);
    this.showValues();
    if (isCut) this.onSelection();
  }

  private showCellSizes(layers: readonly MapLayer[]): void {
    const levels = Math.min(5, ...layers.map((layer) => layer.levels));
    if (this.cellSize.options.length === levels) return;
    this.cellSize.replaceChildren(
      ...Array.from(
        { length: levels },
        (_, level) => new Option(`${Number((this.step * 2 ** level).toFixed(3))} m`, String(level)),
      ),
    );
  }

  /** Whether a change was not reported yet. */
  get isPending(): boolean {
    return this.timer !== 0;
  }

  toggle(): void {
    const panel = element("display-panel");
    panel.hidden = !panel.hidden;
    element("display").setAttribute("aria-expanded", String(!panel.hidden));
  }

  private reset(): void {
    for (const space of ["free", "unknown"] as const) {
      const box = element<HTMLInputElement>(space);
      if (box.checked) box.click();
    }
    for (const box of element("layers").querySelectorAll("input")) if (!box.checked) box.click();
    this.change({ ...this.whole });
  }

  private change(part: Partial<Selection>): void {
    Object.assign(this.selection, part);
    this.showValues();
    document.documentElement.dataset.detail = "partial";
    // A slider that is dragged reports each step.
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.onSelection();
    }, waitForMore);
  }

  private showValues(): void {
    const { low, high, threshold, level } = this.selection;
    const steps = Number(this.high.max) / Math.max(this.whole.high - this.whole.low, 1e-9);
    this.low.value = String(Math.round((low - this.whole.low) * steps));
    this.high.value = String(Math.round((high - this.whole.low) * steps));
    this.threshold.value = String(threshold);
    this.cellSize.value = String(level);
    element("slab-text").textContent = `${fixed(low, 2)} to ${fixed(high, 2)} m`;
    element("threshold-text").textContent = threshold.toFixed(2);
    this.low.setAttribute("aria-valuetext", `${fixed(low, 2)} m`);
    this.high.setAttribute("aria-valuetext", `${fixed(high, 2)} m`);
  }

  private addSwitches(switches: readonly LayerSwitch[]): void {
    element("layers").hidden = switches.length < 2;
    for (const { name, setVisible } of switches) {
      const row = document.createElement("label");
      row.className = "row";
      const text = document.createElement("span");
      text.textContent = name;
      const box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => setVisible(box.checked));
      row.append(text, box);
      element("layers").append(row);
    }
  }
}

/** Absolute heights between which all cells are. */
function heightsOf(layers: readonly MapLayer[]): { low: number; high: number } {
  const filled = layers.filter((layer) => !layer.extent.from.every((c, axis) => c === layer.extent.end[axis]));
  const low = Math.min(...filled.map((layer) => layer.extent.from[2] * layer.entry.resolution_m));
  const high = Math.max(...filled.map((layer) => layer.extent.end[2] * layer.entry.resolution_m));
  return { low: Number.isFinite(low) ? low : 0, high: Number.isFinite(high) ? high : 0 };
}
