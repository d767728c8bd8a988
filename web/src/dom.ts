/** Short names for what the modules do with the document. */

export function element<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as Element as T;
}

interface FramedView {
  readonly self: unknown;
  readonly top: unknown;
  readonly location: { readonly hostname: string; readonly ancestorOrigins?: Iterable<string> };
  readonly document: { readonly referrer: string };
}

/** Whether a page of another host shows this one in a frame: it could lead a press on its buttons astray. */
export function isFramedByAnotherHost({ self, top, location, document }: FramedView): boolean {
  if (self === top) return false;
  // Firefox does not name all of them.
  const ancestors = [...(location.ancestorOrigins ?? [document.referrer])];
  return ancestors.some((origin) => hostOf(origin) !== location.hostname);
}

/** Empty for what is no address. */
function hostOf(origin: string): string {
  try {
    return new URL(origin).hostname;
  } catch {
    return "";
  }
}

/** Buttons of a group of which one is pressed; `attribute` of `data-` says what each stands for. */
export class Choice<Value extends string> {
  private readonly buttons: HTMLButtonElement[];

  constructor(
    group: HTMLElement,
    private readonly attribute: string,
    onChoice: (value: Value) => void,
  ) {
    this.buttons = [...group.querySelectorAll("button")];
    for (const button of this.buttons) {
      button.addEventListener("click", () => {
        this.value = this.valueOf(button);
        onChoice(this.value);
      });
    }
  }

  get value(): Value {
    return this.valueOf(
      this.buttons.find((button) => button.getAttribute("aria-pressed") === "true") ?? this.buttons[0],
    );
  }

  set value(value: Value) {
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(this.valueOf(button) === value));
  }

  /** Those that are there to be chosen. */
  get values(): Value[] {
    return this.buttons.filter((button) => !button.hidden).map((button) => this.valueOf(button));
  }

  /** Presses the button of a value. */
  choose(value: Value): void {
    this.buttons.find((button) => this.valueOf(button) === value)?.click();
  }

  show(value: Value, shown: boolean): void {
    const button = this.buttons.find((candidate) => this.valueOf(candidate) === value);
    if (button) button.hidden = !shown;
  }

  private valueOf(button: HTMLButtonElement): Value {
    return button.dataset[this.attribute] as Value;
  }
}

/** A colour that the style sheet names. */
export function styleColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** For canvases that are written pixel by pixel. */
export function drawing(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  return canvas.getContext("2d", { willReadFrequently: true })!;
}

/** Fits a canvas to its size on the screen; null where it has none. */
export function fitCanvas(
  canvas: HTMLCanvasElement,
): { context: CanvasRenderingContext2D; width: number; height: number; ratio: number } | null {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const { clientWidth: width, clientHeight: height } = canvas;
  if (width === 0 || height === 0) return null;
  const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== across || canvas.height !== down) {
    canvas.width = across;
    canvas.height = down;
  }
  const context = drawing(canvas);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height, ratio };
}

/** 1, 2 or 5 times a power of ten: the largest that is not above `most`. */
export function roundStep(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  const step = [5, 2, 1].find((factor) => factor * power <= most * (1 + 1e-9));
  return (step ?? 1) * power;
}

/** Round values between two, at most about `count` of them. */
export function ticksBetween(from: number, to: number, count: number): { values: number[]; digits: number } {
  if (!(to > from)) return { values: [from], digits: 2 };
  const least = (to - from) / count;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= least * (1 - 1e-9))!;
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const values: number[] = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + 1e-9 * step; ++i) values.push(i * step);
  return { values, digits };
}

/** With a proper minus, and never a minus zero. */
export function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

export function bytesText(bytes: number): string {
  if (bytes < 1e3) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
