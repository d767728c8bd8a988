/** The chosen time, which all parts of the page show. */
export class Clock {
  speed = 4;
  private readonly listeners: (() => void)[] = [];
  private moment: number;
  private frame = 0;
  private last = 0;

  constructor(
    readonly from: number,
    readonly to: number,
  ) {
    this.moment = from;
  }

  get now(): number {
    return this.moment;
  }

  set now(time: number) {
    this.moment = Math.min(Math.max(time, this.from), this.to);
    for (const listener of this.listeners) listener();
  }

  get isPlaying(): boolean {
    return this.frame !== 0;
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** From the start again when it has come to the end. */
  play(): void {
    if (this.isPlaying) return;
    if (this.moment >= this.to) this.moment = this.from;
    this.last = performance.now();
    const step = () => {
      const now = performance.now();
      const seconds = ((now - this.last) / 1000) * this.speed;
      this.last = now;
      this.frame = this.moment + seconds < this.to ? requestAnimationFrame(step) : 0;
      this.now = this.moment + seconds;
    };
    this.frame = requestAnimationFrame(step);
    this.now = this.moment;
  }

  pause(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.now = this.moment;
  }
}
