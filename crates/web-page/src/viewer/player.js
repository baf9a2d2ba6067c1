/** Time of a rack from near to far and back, ms. */
const RACK_PERIOD = 9000;

/** Racks the focus back and forth. */
class Player {
  /**
   * @param {Racking} rack
   * @param {(isPlaying: boolean) => void} onChange
   */
  constructor(rack, onChange) {
    this.rack = rack;
    this.onChange = onChange;
    /** The number of the requested frame; 0 while nothing plays. */
    this.frame = 0;
  }

  get isPlaying() {
    return this.frame !== 0;
  }

  play() {
    if (this.isPlaying) return;
    // From where the focus is, toward the far end.
    const phase = Math.acos(1 - 2 * this.rack.position);
    /** @type {number | null} */
    let start = null;
    /** @param {number} time */
    const step = (time) => {
      start ??= time;
      this.frame = requestAnimationFrame(step);
      this.rack.move((1 - Math.cos(phase + (2 * Math.PI * (time - start)) / RACK_PERIOD)) / 2);
    };
    this.frame = requestAnimationFrame(step);
    this.onChange(true);
  }

  toggle() {
    if (this.isPlaying) this.stop();
    else this.play();
  }

  stop() {
    if (!this.isPlaying) return;
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.rack.settle();
    this.onChange(false);
  }
}
