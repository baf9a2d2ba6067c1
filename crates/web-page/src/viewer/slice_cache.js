/** At most this many slices are decoded at a time: one of 1280 × 720 px takes 3.7 MB. */
const MOST_DECODED = 8;

/** Decodes slices, and keeps those that were used last. */
class SliceCache {
  /**
   * @param {StackData[]} stacks
   * @param {HTMLImageElement} poster The slice that the page shows before the script runs.
   */
  constructor(stacks, poster) {
    this.stacks = stacks;
    this.poster = poster;
    /** @type {Map<string, Promise<ImageBitmap>>} In the order of their use. */
    this.decoded = new Map();
  }

  /**
   * The picture of a slice. It is closed once seven others were used after it.
   *
   * @param {number} stack
   * @param {number} slice
   * @returns {Promise<ImageBitmap>}
   */
  get(stack, slice) {
    const key = `${stack}/${slice}`;
    let picture = this.decoded.get(key);
    if (picture) {
      this.decoded.delete(key);
    } else {
      picture = this.makeRoom().then(() => this.decode(this.stacks[stack].slices[slice]));
    }
    this.decoded.set(key, picture);
    return picture;
  }

  /**
   * @param {string | null} text `null`: the poster.
   * @returns {Promise<ImageBitmap>}
   */
  async decode(text) {
    if (text !== null) return createImageBitmap(new Blob([decodeBase91(text)], { type: "image/webp" }));
    await this.poster.decode();
    return createImageBitmap(this.poster);
  }

  /** Closes what was not used for longest. */
  async makeRoom() {
    const oldest = [...this.decoded].slice(0, Math.max(this.decoded.size - MOST_DECODED + 1, 0));
    oldest.forEach(([key]) => this.decoded.delete(key));
    await Promise.all(oldest.map(([, picture]) => picture.then((bitmap) => bitmap.close(), () => {})));
  }
}
