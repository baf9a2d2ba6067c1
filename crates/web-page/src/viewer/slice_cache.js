/** At most this many slices are decoded at a time: one of 1280 × 720 px takes 3.7 MB. */
const MOST_DECODED = 8;

/** Decodes slices, and keeps those that were used last. */
class SliceCache {
  /**
   * @param {StackData[]} stacks
   * @param {string} poster The slice that the page shows before the script runs, in base64.
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
      const base64 = this.stacks[stack].slices[slice] ?? this.poster;
      picture = this.makeRoom().then(() => createImageBitmap(new Blob([decodeBase64(base64)], { type: "image/webp" })));
    }
    this.decoded.set(key, picture);
    return picture;
  }

  /** Closes what was not used for longest. */
  async makeRoom() {
    const oldest = [...this.decoded].slice(0, Math.max(this.decoded.size - MOST_DECODED + 1, 0));
    oldest.forEach(([key]) => this.decoded.delete(key));
    await Promise.all(oldest.map(([, picture]) => picture.then((bitmap) => bitmap.close(), () => {})));
  }
}
