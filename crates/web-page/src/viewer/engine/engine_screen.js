/** Draws what the lens shows: a draft while it moves, all of it at rest. Of wishes that come while it draws, the latest is drawn next. */
class EngineScreen {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Engine} engine
   * @param {LensRack} rack
   * @param {{drawn: () => void, failed: (error: unknown) => void}} on
   */
  constructor(canvas, engine, rack, on) {
    const context = canvas.getContext("2d", { alpha: false });
    const draft = document.createElement("canvas");
    const draftContext = draft.getContext("2d", { alpha: false });
    if (!context || !draftContext) throw new Error("This browser has no canvas");
    this.canvas = canvas;
    this.context = context;
    this.draft = draft;
    this.draftContext = draftContext;
    this.engine = engine;
    this.rack = rack;
    this.on = on;
    /** The number of the requested frame; 0 without one. */
    this.frame = 0;
  }

  /** Draws with the next frame. */
  draw() {
    this.canvas.ariaBusy = "true";
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.drawNow();
    });
  }

  drawNow() {
    const { engine } = this;
    const { inverseDistance, apertureShare, blades, isPainted, isMoving } = this.rack;
    try {
      engine.check(
        engine.exports.refocus(inverseDistance, apertureShare, blades, Number(isPainted), Number(isMoving)),
      );
      this.show();
    } catch (error) {
      this.on.failed(error);
    }
  }

  /** Shows what the engine has drawn. */
  show() {
    const { canvas, context, draft } = this;
    const { picture } = this.engine;
    if (picture.width === canvas.width && picture.height === canvas.height) {
      context.putImageData(picture, 0, 0);
    } else {
      [draft.width, draft.height] = [picture.width, picture.height];
      this.draftContext.putImageData(picture, 0, 0);
      context.drawImage(draft, 0, 0, canvas.width, canvas.height);
    }
    canvas.hidden = false;
    canvas.ariaBusy = "false";
    this.on.drawn();
  }
}
