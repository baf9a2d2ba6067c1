/** At most this many slices are decoded at a time: one of 1280 × 720 px takes 3.7 MB. */
const MOST_DECODED = 6;
/** And the pixels of so many that others are differences from. */
const MOST_BASES = 2;

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
    /** @type {Map<string, Promise<ImageData>>} Likewise. */
    this.bases = new Map();
    const canvas = document.createElement("canvas");
    this.context = canvas.getContext("2d", { willReadFrequently: true });
  }

  /**
   * The picture of a slice. It is closed once some others were used after it.
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
      picture = this.makeRoom().then(() => this.decode(stack, slice));
    }
    this.decoded.set(key, picture);
    return picture;
  }

  /**
   * @param {number} stack
   * @param {number} slice
   * @returns {Promise<ImageBitmap>}
   */
  async decode(stack, slice) {
    const { slices, bases } = this.stacks[stack];
    const base = bases[slice];
    if (base === null) return this.decodeText(slices[slice]);
    const [under, sum] = await Promise.all([this.base(stack, base), this.pixels(slices[slice])]);
    // Sums are clamped.
    for (let k = 0; k < sum.data.length; k++) sum.data[k] += under.data[k] - 128;
    return createImageBitmap(sum);
  }

  /**
   * The pixels of a whole slice.
   *
   * @param {number} stack
   * @param {number} slice
   * @returns {Promise<ImageData>}
   */
  base(stack, slice) {
    const key = `${stack}/${slice}`;
    const pixels = this.bases.get(key) || this.pixels(this.stacks[stack].slices[slice]);
    this.bases.delete(key);
    this.bases.set(key, pixels);
    if (this.bases.size > MOST_BASES) this.bases.delete([...this.bases.keys()][0]);
    return pixels;
  }

  /**
   * @param {string | null} text
   * @returns {Promise<ImageData>}
   */
  async pixels(text) {
    const { context } = this;
    if (!context) throw new Error("the browser has no canvas");
    const bitmap = await this.decodeText(text);
    const { width, height } = bitmap;
    Object.assign(context.canvas, { width, height });
    context.drawImage(bitmap, 0, 0);
    bitmap.close();
    return context.getImageData(0, 0, width, height);
  }

  /**
   * @param {string | null} text `null`: the poster.
   * @returns {Promise<ImageBitmap>}
   */
  async decodeText(text) {
    if (text !== null) return createImageBitmap(new Blob([decodeBase122(text)], { type: "image/webp" }));
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
