/** Keys that work everywhere on the page; those of the map itself are the camera's. */
import type { View } from "./camera";

export interface KeyActions {
  view: (view: View) => void;
  showAll: () => void;
  arrowUp: () => void;
  nextColour: () => void;
  measure: () => void;
  endMeasure: () => void;
  display: () => void;
  sonar: () => void;
  play: () => void;
  step: (direction: number) => void;
  stepTurn: (direction: number) => void;
  help: () => void;
}

export function addKeys(actions: KeyActions): void {
  const keys: Record<string, () => void> = {
    "1": () => actions.view("free"),
    "2": () => actions.view("top"),
    "3": () => actions.view("side"),
    "0": actions.showAll,
    n: actions.arrowUp,
    c: actions.nextColour,
    r: actions.measure,
    Escape: actions.endMeasure,
    d: actions.display,
    s: actions.sonar,
    " ": actions.play,
    ",": () => actions.step(-1),
    ".": () => actions.step(1),
    "<": () => actions.stepTurn(-1),
    ">": () => actions.stepTurn(1),
    ";": () => actions.stepTurn(-1),
    ":": () => actions.stepTurn(1),
    "?": actions.help,
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    const isControl = target.matches("select, button, input[type=checkbox], summary");
    // These take the space bar, and lists letters, themselves.
    if (isControl && (event.key === " " || target.matches("select"))) return;
    const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
