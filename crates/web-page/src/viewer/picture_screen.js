/** Draws what the rack shows; where slices take time to decode, the latest wish is drawn next. */
class PictureScreen {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {SliceCache} slices
   * @param {Rack} rack
   * @param {() => void} onDrawn
   */
  constructor(canvas, slices, rack, onDrawn) {
    const context = canvas.getContext("2d", { alpha: false });
    if (!context) throw new Error("the browser has no canvas");
    this.canvas = canvas;
    this.context = context;
    this.slices = slices;
    this.rack = rack;
    this.onDrawn = onDrawn;
    this.isDrawing = false;
    this.isStale = false;
    /** What is drawn, as text. */
    this.drawn = "";
  }

  /** Draws as soon as possible. */
  async draw() {
    this.isStale = true;
    if (this.isDrawing) return;
    this.isDrawing = true;
    this.canvas.ariaBusy = "true";
    try {
      while (this.isStale) {
        this.isStale = false;
        await this.drawOnce();
      }
    } finally {
      this.isDrawing = false;
      this.canvas.ariaBusy = "false";
    }
    this.prefetch();
  }

  async drawOnce() {
    const { stack, fade } = this.rack;
    const { first, second, share } = fade;
    const pictures = await Promise.all([this.slices.get(stack, first), this.slices.get(stack, second)]);
    const { context, canvas } = this;
    context.globalAlpha = 1;
    context.drawImage(pictures[0], 0, 0);
    if (share > 0) {
      context.globalAlpha = share;
      context.drawImage(pictures[1], 0, 0);
    }
    this.drawn = share > 0 ? `${stack}/${first}-${second}` : `${stack}/${first}`;
    canvas.hidden = false;
    this.onDrawn();
  }

  /** Decodes the neighbours, which are likely to be next. */
  prefetch() {
    const { stack, slice } = this.rack;
    const last = this.rack.stacks[stack].slices.length - 1;
    for (const neighbour of [slice - 1, slice + 1]) {
      if (neighbour >= 0 && neighbour <= last) this.slices.get(stack, neighbour).catch(() => {});
    }
    // The slice on screen is the last to be dropped.
    this.slices.get(stack, slice).catch(() => {});
  }
}
