/** One byte for each pixel of a map that is stretched over the picture. */
class PixelMap {
  /**
   * @param {[number, number]} size Columns and rows.
   * @param {Uint8Array} codes Row by row from the top.
   */
  constructor(size, codes) {
    this.size = size;
    this.codes = codes;
  }

  /**
   * The code at a place of the picture.
   *
   * @param {number} x From 0 at the left to 1.
   * @param {number} y From 0 at the top to 1.
   */
  at(x, y) {
    const [width, height] = this.size;
    const column = clamp(Math.floor(x * width), 0, width - 1);
    const row = clamp(Math.floor(y * height), 0, height - 1);
    return this.codes[row * width + column];
  }
}
