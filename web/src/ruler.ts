/** Measures between two points of the map. */
import { Vector3 } from "three";
import { element, fixed } from "./dom";
import type { View3D } from "./view3d";
import { WideLines } from "./wide_lines";

export class Ruler {
  readonly line = new WideLines(2.5, { opacity: 0.8 });
  /** Says where it stands; the text goes under the map. */
  onText: (text: string) => void = () => {};
  private points: Vector3[] = [];
  private active = false;

  constructor(private readonly view: View3D) {
    this.line.visible = false;
    view.world.add(this.line);
  }

  get isActive(): boolean {
    return this.active;
  }

  setActive(active: boolean): void {
    this.active = active;
    this.points = [];
    document.documentElement.classList.toggle("measuring", active);
    this.show();
    this.onText(active ? "Measure: choose the first point" : "");
  }

  add(point: Vector3): void {
    if (this.points.length === 2) this.points = [];
    this.points.push(point.clone());
    this.show();
    if (this.points.length === 1) {
      this.onText("Measure: choose the second point");
      return;
    }
    const apart = this.points[1].clone().sub(this.points[0]);
    const level = Math.hypot(apart.x, apart.y);
    this.onText(`${fixed(apart.length(), 2)} m · level ${fixed(level, 2)} m · height ${fixed(apart.z, 2)} m`);
  }

  /** Before each frame: the label stays at the middle of the line. */
  update(): void {
    const label = element("ruler-label");
    label.hidden = this.points.length === 0;
    if (this.points.length === 0) return;
    const middle = this.points[0].clone().lerp(this.points[this.points.length - 1], 0.5);
    const at = this.view.project(middle);
    label.textContent =
      this.points.length === 2 ? `${fixed(this.points[0].distanceTo(this.points[1]), 2)} m` : "from here";
    label.style.transform = `translate(${at.x.toFixed(1)}px, ${(at.y - 16).toFixed(1)}px) translate(-50%, -100%)`;
    label.hidden = !at.inFront;
  }

  private show(): void {
    this.line.visible = this.points.length === 2;
    if (this.line.visible) this.line.setLine(this.points);
    this.view.requestFrame();
  }
}
