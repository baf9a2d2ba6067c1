/** Where the lens is focused. At rest it is on a slice; while it moves it may be between two. */
class Rack {
  /**
   * @param {PageData} page
   * @param {() => void} onChange
   */
  constructor(page, onChange) {
    const { stacks, range, opening } = page;
    this.stacks = stacks;
    this.farthest = range[0];
    this.nearest = range[1];
    this.stack = opening.stack;
    this.inverseDistance = stacks[opening.stack].inverseDistances[opening.slice];
    this.isMoving = false;
    this.onChange = onChange;
  }

  /** 0 at the nearest distance, 1 at the farthest. */
  get position() {
    const extent = this.nearest - this.farthest;
    return extent > 0 ? (this.nearest - this.inverseDistance) / extent : 0;
  }

  /** The slice of the current stack that is nearest to the distance. */
  get slice() {
    return this.sliceAt(this.inverseDistance);
  }

  /** @param {number} inverseDistance */
  sliceAt(inverseDistance) {
    const off = this.stacks[this.stack].inverseDistances.map((distance) => Math.abs(distance - inverseDistance));
    return off.indexOf(Math.min(...off));
  }

  /**
   * The slices to show, and how much of the second covers the first.
   *
   * @returns {{first: number, second: number, share: number}}
   */
  get fade() {
    const { slice } = this;
    const distances = this.stacks[this.stack].inverseDistances;
    const beyond = this.inverseDistance - distances[slice];
    const second = clamp(slice + Math.sign(beyond), 0, distances.length - 1);
    if (!this.isMoving || second === slice) return { first: slice, second: slice, share: 0 };
    return { first: slice, second, share: beyond / (distances[second] - distances[slice]) };
  }

  /**
   * Focuses on a distance, as exactly as the slices allow, and rests there.
   *
   * @param {number} inverseDistance
   */
  rest(inverseDistance) {
    this.inverseDistance = inverseDistance;
    this.inverseDistance = this.stacks[this.stack].inverseDistances[this.slice];
    this.isMoving = false;
    this.onChange();
  }

  /**
   * Moves to a position, and may move on.
   *
   * @param {number} position
   */
  move(position) {
    this.inverseDistance = this.nearest - clamp(position, 0, 1) * (this.nearest - this.farthest);
    this.isMoving = true;
    this.onChange();
  }

  /** Rests where it is. */
  settle() {
    if (this.isMoving) this.rest(this.inverseDistance);
  }

  /**
   * Goes to a slice some slices farther, and rests there.
   *
   * @param {number} count Negative: nearer.
   */
  step(count) {
    const distances = this.stacks[this.stack].inverseDistances;
    this.rest(distances[clamp(this.slice - count, 0, distances.length - 1)]);
  }

  /**
   * Takes another stack, without a fade.
   *
   * @param {number} stack
   */
  choose(stack) {
    this.stack = stack;
    this.rest(this.inverseDistance);
  }

  /**
   * The stack of an aperture and a kind of focusing; where there is none, the first of that kind.
   *
   * @param {string} aperture
   * @param {boolean} isPainted
   */
  find(aperture, isPainted) {
    const exact = this.stacks.findIndex((s) => s.isPainted === isPainted && s.aperture === aperture);
    return exact >= 0 ? exact : this.stacks.findIndex((s) => s.isPainted === isPainted);
  }
}

/**
 * The distance that a code means; `null` where no distance makes the pixel sharp.
 *
 * @param {number} code
 * @param {[number, number]} range
 * @returns {number | null}
 */
function distanceOfCode(code, [farthest, nearest]) {
  return code === 0 ? null : farthest + ((nearest - farthest) * (code - 1)) / 254;
}
