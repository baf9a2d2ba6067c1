/** The bar below the picture. It shows what lens and brush are. */
class EngineControls {
  /**
   * @param {EngineData} page
   * @param {LensRack} rack
   * @param {Player} player
   * @param {BrushTool} brush
   */
  constructor(page, rack, player, brush) {
    this.page = page;
    this.rack = rack;
    this.brush = brush;
    this.focusBar = new FocusBar(rack, player);
    this.aperture = element("aperture", HTMLInputElement);
    this.apertureText = element("aperture-text", HTMLOutputElement);
    this.aperture.addEventListener("input", () => rack.stopDown(Number(this.aperture.value), true));
    this.aperture.addEventListener("change", () => rack.settle());
    this.blades = page.hasDisc ? [0, 5, 6, 8] : [0, 1, 5, 6, 8];
    const names = this.blades.map((blades) => (blades > 1 ? String(blades) : blades || page.hasDisc ? "Disc" : "As made"));
    this.shapeInputs = addChoices("shape", names, (index) => rack.shape(this.blades[index]));
    this.kindInputs = addChoices("focusing", ["Painted", "Ordinary lens"], (index) => rack.showPaint(index === 0));
    this.tint = element("tint", HTMLCanvasElement);
    this.paintButton = this.button("show-paint", () => this.togglePaint());
    this.toolInputs = addChoices("tools", TOOLS, (index) => this.chooseTool(index));
    this.size = this.brushSlider("brush-size", (value) => (brush.size = value));
    this.blur = this.brushSlider("brush-blur", (value) => (brush.blur = value * MOST_BLUR));
    this.undo = this.button("undo", () => brush.undo());
    this.redo = this.button("redo", () => brush.redo());
    this.save = this.button("save-strokes", () => this.saveStrokes());
    showFullScreenButton();
    element("bar", HTMLDivElement).hidden = false;
    this.update();
  }

  /**
   * @param {string} id
   * @param {() => void} onClick
   */
  button(id, onClick) {
    const button = element(id, HTMLButtonElement);
    button.addEventListener("click", onClick);
    return button;
  }

  /**
   * @param {string} id
   * @param {(value: number) => void} set
   */
  brushSlider(id, set) {
    const slider = element(id, HTMLInputElement);
    slider.addEventListener("input", () => set(Number(slider.value)));
    return slider;
  }

  /** Shows the state of lens and brush. */
  update() {
    const { rack, brush } = this;
    this.focusBar.update();
    this.aperture.value = String(rack.stop);
    this.aperture.setAttribute("aria-valuetext", rack.fNumberText);
    this.apertureText.value = rack.fNumberText;
    this.blades.forEach((blades, index) => (this.shapeInputs[index].checked = blades === rack.blades));
    const hasPaint = this.page.isPainted || brush.strokes.done > 0;
    element("focusing", HTMLDivElement).hidden = this.paintButton.hidden = !hasPaint;
    this.kindInputs.forEach((input, index) => (input.checked = rack.isPainted === (index === 0)));
    this.toolInputs.forEach((input, index) => (input.checked = index === brush.tool));
    this.size.value = String(brush.size);
    this.blur.value = String(brush.blur / MOST_BLUR);
    element("brush", HTMLDivElement).hidden = !brush.isActive;
    element("blur-label", HTMLLabelElement).hidden = brush.tool !== 2;
    this.blur.hidden = brush.tool !== 2;
    const { steps, done } = brush.strokes;
    element("history", HTMLDivElement).hidden = steps.length === 0;
    this.undo.disabled = this.save.disabled = done === 0;
    this.redo.disabled = done === steps.length;
  }

  toggleKind() {
    if (!this.paintButton.hidden) this.rack.showPaint(!this.rack.isPainted);
  }

  togglePaint() {
    if (this.paintButton.hidden) return;
    this.tint.hidden = !this.tint.hidden;
    this.paintButton.setAttribute("aria-pressed", String(!this.tint.hidden));
    this.drawPaint();
  }

  /** Draws the tint of what is painted, where it is shown. */
  drawPaint() {
    const { width, height } = this.brush.screen.canvas;
    if (!this.tint.hidden) drawTint(this.tint, this.brush.engine.paintMap([width, height]));
  }

  /** @param {number} tool */
  chooseTool(tool) {
    this.brush.tool = tool;
    this.brush.ring.hidden = true;
    this.update();
  }

  /** @param {number} factor */
  scaleBrush(factor) {
    this.brush.size = clamp(this.brush.size * factor, Number(this.size.min), Number(this.size.max));
    this.update();
  }

  /** Downloads the strokes. */
  saveStrokes() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([this.brush.strokes.file], { type: "application/json" }));
    link.download = `${this.page.title.replace(/[^\p{L}\p{N} ._-]/gu, "_")}.strokes.json`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }
}
