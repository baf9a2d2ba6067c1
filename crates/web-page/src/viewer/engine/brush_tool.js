/** The brushes, and the largest blur that one paints, as a share of the picture's height. */
const TOOLS = ["Focus", "Sharp", "Blur", "Erase"];
const MOST_BLUR = 0.25;

/** Paints with the pointer. */
class BrushTool {
  /**
   * @param {HTMLElement} view
   * @param {Zoom} zoom
   * @param {LensRack} rack
   * @param {EngineScreen} screen
   * @param {RecordedStrokes} strokes
   * @param {{painted: () => void, failed: (error: unknown) => void}} on
   */
  constructor(view, zoom, rack, screen, strokes, on) {
    this.zoom = zoom;
    this.rack = rack;
    this.engine = screen.engine;
    this.screen = screen;
    this.strokes = strokes;
    this.on = on;
    /** Index in `TOOLS`. */
    this.tool = 0;
    /** Radius and diameter of the blur as shares of the picture's height. */
    this.size = 0.06;
    this.blur = 0.08;
    /** @type {[number, number, number][]} Of the stroke. */
    this.points = [];
    /** @type {object | null} Of the stroke. */
    this.brush = null;
    /** Whether a frame is requested that draws the stroke. */
    this.isWaiting = false;
    this.ring = document.createElement("div");
    this.ring.className = "brush-ring";
    this.ring.hidden = true;
    view.append(this.ring);
    view.addEventListener("pointermove", (event) => this.moveRing(event));
    view.addEventListener("pointerleave", () => (this.ring.hidden = true));
  }

  get isActive() {
    return this.tool > 0;
  }

  /** @param {PointerEvent} point */
  begin(point) {
    const { exports } = this.engine;
    const height = this.screen.canvas.height;
    const [x, y] = this.zoom.place(point);
    const circle = [NaN, 0, this.blur * height, NaN][this.tool];
    // Painting shows the paint.
    this.rack.isPainted = true;
    exports.begin_stroke(x, y, this.size * height, 0.5, circle);
    const radius = exports.stroke_radius();
    this.points = [[x, y, 1]];
    this.brush = Number.isNaN(radius)
      ? null
      : {
          radius,
          mode: this.tool === 3 ? "reset" : "set",
          target: { t: exports.stroke_t(), anchor: this.tool === 3 ? 0 : 1 },
          normal_limit_degrees: 180,
        };
    this.draw();
  }

  /** @param {PointerEvent} point */
  extend(point) {
    if (!this.brush) return;
    // Where the pointer was since the last frame; scripts' events do not tell.
    const events = point.getCoalescedEvents();
    for (const event of events.length ? events : [point]) {
      const [x, y] = this.zoom.place(event);
      this.points.push([x, y, 1]);
      this.engine.exports.extend_stroke(x, y);
    }
    this.draw();
  }

  /** Draws the stroke with the next frame. */
  draw() {
    if (!this.brush || this.isWaiting) return;
    this.isWaiting = true;
    this.screen.canvas.ariaBusy = "true";
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.attempt(() => this.engine.check(this.engine.exports.draw_stroke()));
    });
  }

  end() {
    const hasPainted = this.engine.exports.end_stroke() !== 0;
    if (hasPainted && this.brush) this.strokes.push(this.brush, this.points);
    this.brush = null;
    this.on.painted();
  }

  undo() {
    this.attempt(() => this.engine.check(this.engine.exports.undo()));
    this.strokes.undo();
    this.on.painted();
  }

  redo() {
    this.attempt(() => this.engine.check(this.engine.exports.redo()));
    this.strokes.redo();
    this.on.painted();
  }

  /** @param {() => void} work */
  attempt(work) {
    try {
      work();
      this.screen.show();
    } catch (error) {
      this.on.failed(error);
    }
  }

  /** @param {{clientX: number, clientY: number}} point */
  moveRing({ clientX, clientY }) {
    const { ring, zoom } = this;
    ring.hidden = !this.isActive;
    const { left, top } = zoom.view.getBoundingClientRect();
    const radius = this.size * zoom.frame.height * zoom.scale;
    ring.style.width = ring.style.height = `${2 * radius}px`;
    ring.style.translate = `${clientX - left - radius}px ${clientY - top - radius}px`;
  }
}
