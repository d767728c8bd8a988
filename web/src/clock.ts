/** The chosen time, which all parts of the page show. */
export class Clock {
  speed = 4;
  /** Whether it goes on with the end, where that grows. */
  isFollowing = true;
  private readonly listeners: (() => void)[] = [];
  private moment: number;
  private frame = 0;
  private last = 0;

  constructor(
    public from: number,
    public to: number,
  ) {
    this.moment = from;
  }

  get now(): number {
    return this.moment;
  }

  set now(time: number) {
    this.isFollowing = time >= this.to;
    this.moment = Math.min(Math.max(time, this.from), this.to);
    for (const listener of this.listeners) listener();
  }

  /** The times that there are to choose from, which may grow. */
  setRange(from: number, to: number): void {
    const { isFollowing } = this;
    this.from = from;
    this.to = to;
    this.now = isFollowing ? to : this.moment;
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
