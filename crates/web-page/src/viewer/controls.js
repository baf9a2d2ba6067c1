/** The bar below the picture. It shows what the rack shows. */
class Controls {
  /**
   * @param {PageData} page
   * @param {Rack} rack
   * @param {Player} player
   */
  constructor(page, rack, player) {
    const { stacks } = page;
    this.rack = rack;
    this.apertures = [...new Set(stacks.map((stack) => stack.aperture))];
    this.kinds = [true, false].filter((isPainted) => stacks.some((stack) => stack.isPainted === isPainted));
    this.focusBar = new FocusBar(rack, player);
    this.apertureInputs = addChoices("apertures", this.apertures, (index) => this.chooseAperture(index));
    const names = this.kinds.map((isPainted) => (isPainted ? "Painted" : "Ordinary lens"));
    this.kindInputs = addChoices("focusing", names, (index) => this.chooseKind(this.kinds[index]));
    element("focusing", HTMLDivElement).hidden = this.kinds.length < 2;
    this.paintButton = element("show-paint", HTMLButtonElement);
    this.paintButton.hidden = page.maps.paint === null;
    this.tint = element("tint", HTMLCanvasElement);
    this.paintButton.addEventListener("click", () => this.togglePaint());
    showFullScreenButton();
    element("bar", HTMLDivElement).hidden = false;
    this.update();
  }

  /** Shows the state of the rack. */
  update() {
    const { rack } = this;
    const stack = rack.stacks[rack.stack];
    this.focusBar.update();
    this.apertures.forEach((aperture, index) => {
      const input = this.apertureInputs[index];
      input.checked = aperture === stack.aperture;
      input.disabled = !rack.stacks.some((s) => s.aperture === aperture && s.isPainted === stack.isPainted);
    });
    this.kinds.forEach((isPainted, index) => (this.kindInputs[index].checked = isPainted === stack.isPainted));
  }

  /** @param {number} index */
  chooseAperture(index) {
    const { rack } = this;
    rack.choose(rack.find(this.apertures[index], rack.stacks[rack.stack].isPainted));
  }

  /**
   * The next aperture that there is.
   *
   * @param {number} step 1: smaller, −1: wider.
   */
  stepAperture(step) {
    const current = this.apertures.indexOf(this.rack.stacks[this.rack.stack].aperture);
    const next = this.apertureInputs[current + step];
    if (next && !next.disabled) this.chooseAperture(current + step);
  }

  /** @param {boolean} isPainted */
  chooseKind(isPainted) {
    this.rack.choose(this.rack.find(this.rack.stacks[this.rack.stack].aperture, isPainted));
  }

  toggleKind() {
    if (this.kinds.length > 1) this.chooseKind(!this.rack.stacks[this.rack.stack].isPainted);
  }

  togglePaint() {
    if (this.paintButton.hidden) return;
    this.tint.hidden = !this.tint.hidden;
    this.paintButton.setAttribute("aria-pressed", String(!this.tint.hidden));
  }
}
