/** The strokes of the visitor, as the program replays them. */
class RecordedStrokes {
  /** @param {object} view The view that they are painted in. */
  constructor(view) {
    this.view = view;
    /** @type {object[]} */
    this.steps = [];
    /** How many of them are done; the others are undone. */
    this.done = 0;
  }

  /**
   * @param {object} brush
   * @param {[number, number, number][]} points Places of the picture, and the pressure.
   */
  push(brush, points) {
    this.steps.length = this.done;
    this.steps.push({ stroke: { layer: "Paint", brush, view: this.view, points } });
    this.done = this.steps.length;
  }

  undo() {
    this.done = Math.max(this.done - 1, 0);
  }

  redo() {
    this.done = Math.min(this.done + 1, this.steps.length);
  }

  /** A strokes file. */
  get file() {
    return JSON.stringify({ format: "focus-brush strokes", version: 3, steps: this.steps.slice(0, this.done) });
  }
}
