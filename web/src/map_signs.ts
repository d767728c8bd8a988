/** North arrow and scale bar. */
import type { OrbitCamera } from "./camera";
import { element, roundStep } from "./dom";

const longestBar = 140;

/** @param axes what x and y of the map are, as `scene.json` says */
export class MapSigns {
  private readonly label: string;
  /** Angle from east of what the arrow shows. */
  private readonly arrow: number;

  constructor(
    private readonly orbit: OrbitCamera,
    axes: { x: string; y: string },
  ) {
    const isNorth = axes.y === "north";
    this.label = isNorth ? "N" : axes.x === "ahead" ? "ahead" : "y";
    this.arrow = isNorth || axes.x !== "ahead" ? Math.PI / 2 : 0;
    const text = element<SVGTextElement>("compass-label");
    text.textContent = this.label;
    text.classList.toggle("long", this.label.length > 1);
    const compass = element<HTMLButtonElement>("compass");
    if (!isNorth) {
      compass.title = `${this.label} up (N)`;
      compass.setAttribute("aria-label", compass.title);
    }
    compass.addEventListener("click", () => this.arrowUp());
  }

  /** Turns the camera so that the arrow is upwards. */
  arrowUp(): void {
    this.orbit.turnTo(this.arrow + Math.PI);
  }

  update(): void {
    const { azimuth } = this.orbit.place;
    // The camera looks to azimuth + 180 degrees.
    const angle = azimuth + Math.PI - this.arrow;
    element("needle").setAttribute("transform", `rotate(${((angle * 180) / Math.PI).toFixed(1)})`);
    const metres = roundStep(longestBar * this.orbit.metresPerPixel);
    element("scale-text").textContent =
      metres >= 1000 ? `${metres / 1000} km` : metres >= 1 ? `${metres} m` : `${Math.round(metres * 100)} cm`;
    element("scale-line").style.width = `${(metres / this.orbit.metresPerPixel).toFixed(1)}px`;
  }
}
