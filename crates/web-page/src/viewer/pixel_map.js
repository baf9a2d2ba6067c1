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
   * Unpacks a map: compressed differences of each byte from its left neighbour. `null` without one, or where the browser
   * cannot decompress.
   *
   * @param {[number, number]} size
   * @param {string | null} packed
   * @returns {Promise<PixelMap | null>}
   */
  static async unpack(size, packed) {
    const codes = packed === null ? null : await inflate(packed);
    if (!codes) return null;
    for (let first = 0; first < codes.length; first += size[0]) {
      for (let k = first + 1; k < first + size[0]; k++) codes[k] += codes[k - 1];
    }
    return new PixelMap(size, codes);
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
