/** The program that draws, and its light field. */
class Engine {
  /** @param {EngineExports} exports */
  constructor(exports) {
    this.exports = exports;
  }

  /**
   * @param {EngineData} page
   * @returns {Promise<Engine>}
   */
  static async open(page) {
    const [program, field] = await Promise.all([inflate(page.program), inflate(page.field)]);
    if (!program || !field) throw new Error("This browser is too old for this page");
    const { instance } = await WebAssembly.instantiate(program, {});
    const engine = new Engine(/** @type {any} */ (instance.exports));
    const start = engine.exports.make_room(field.length);
    new Uint8Array(engine.exports.memory.buffer).set(field, start);
    engine.check(engine.exports.open());
    return engine;
  }

  /**
   * Throws what the module says where a call failed.
   *
   * @param {number} status
   */
  check(status) {
    if (status === 0) return;
    const { memory, message_start, message_length } = this.exports;
    throw new Error(new TextDecoder().decode(new Uint8Array(memory.buffer, message_start(), message_length())));
  }

  /**
   * How the picture is painted, of a size of columns and rows.
   *
   * @param {[number, number]} size
   */
  paintMap(size) {
    const start = this.exports.paint_map();
    return new PixelMap(size, new Uint8Array(this.exports.memory.buffer, start, size[0] * size[1]));
  }

  /** The picture that was drawn last, as it lies in the module's memory: valid until the next call. */
  get picture() {
    const { memory, pixels_start, columns, rows } = this.exports;
    const pixels = new Uint8ClampedArray(memory.buffer, pixels_start(), 4 * columns() * rows());
    return new ImageData(pixels, columns(), rows());
  }
}
